#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/element_order.hpp>
#include <softkin/model/mesh/mesh_measures.hpp>
#include <utility>

namespace softkin {

namespace {

using Edge = std::pair<Index, Index>;

double area(const Points& vertices, const Triangle& t) {
  const Eigen::RowVector3d a = vertices.row(t[0]);
  return 0.5 * Vec3(vertices.row(t[1]) - a).cross(Vec3(vertices.row(t[2]) - a)).norm();
}

double area(const Points& vertices, const Quad& q) {
  return area(vertices, Triangle{q[0], q[1], q[2]}) + area(vertices, Triangle{q[0], q[2], q[3]});
}

template <class Element>
double volume(const Points& vertices, const Element& element) {
  return std::abs(signed_volume(vertices, element));
}

/// The value below which a share of the values lies, by nearest rank; values are sorted.
double percentile(const std::vector<double>& values, double share) {
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

template <class Element, std::size_t N>
void add_edges(const std::vector<Element>& elements, const std::array<std::array<std::size_t, 2>, N>& corners,
               std::vector<Edge>& edges) {
  for (const Element& element : elements)
    for (const auto& [a, b] : corners) edges.push_back(std::minmax({element[a], element[b]}));
}

std::vector<double> edge_lengths(const Mesh& mesh) {
  constexpr std::array<std::array<std::size_t, 2>, 6> of_tetrahedron{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  constexpr std::array<std::array<std::size_t, 2>, 9> of_prism{
      {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
  std::vector<Edge> edges;
  add_edges(mesh.tetrahedra, of_tetrahedron, edges);
  add_edges(mesh.prisms, of_prism, edges);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<double> lengths;
  lengths.reserve(edges.size());
  for (const auto& [a, b] : edges) lengths.push_back((mesh.vertices.row(a) - mesh.vertices.row(b)).norm());
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

template <class Cell, class Measure>
void add_cells(const std::vector<Cell>& cells, const std::vector<Index>& chosen, const Measure& measure_of,
               RegionMeasures& measures, std::vector<Index>& vertices) {
  for (const Index i : chosen) {
    const Cell& cell = cells[static_cast<std::size_t>(i)];
    measures.measure += measure_of(cell);
    vertices.insert(vertices.end(), cell.begin(), cell.end());
  }
  measures.cells += chosen.size();
}

template <class Nodes>
void add_edge_nodes(const std::vector<Nodes>& nodes, const std::vector<Index>& chosen, std::vector<Index>& vertices) {
  if (nodes.empty()) return;
  for (const Index i : chosen)
    vertices.insert(vertices.end(), nodes[static_cast<std::size_t>(i)].begin(),
                    nodes[static_cast<std::size_t>(i)].end());
}

RegionMeasures measure_region(const Mesh& mesh, const std::vector<QuadraticTriangle>& triangles, const Region& region) {
  RegionMeasures measures{region.name, region.dimension};
  std::vector<Index> vertices = region.vertices;
  const auto volume_of = [&](const auto& element) { return volume(mesh.vertices, element); };
  const auto area_of = [&](const auto& face) { return area(mesh.vertices, face); };
  add_cells(mesh.tetrahedra, region.tetrahedra, volume_of, measures, vertices);
  add_cells(mesh.prisms, region.prisms, volume_of, measures, vertices);
  add_cells(mesh.triangles, region.triangles, area_of, measures, vertices);
  add_cells(mesh.quads, region.quads, area_of, measures, vertices);
  add_edge_nodes(mesh.edge_nodes, region.tetrahedra, vertices);
  add_edge_nodes(triangles, region.triangles, vertices);
  std::sort(vertices.begin(), vertices.end());
  measures.vertices = static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
  return measures;
}

void measure_box(const Mesh& mesh, const MeshCheck& check, MeshMeasures& measures) {
  Eigen::AlignedBox3d box;
  for (const auto& part : check.parts)
    for (const Index v : part) box.extend(Vec3(mesh.vertices.row(v).transpose()));
  measures.low = box.min();
  measures.high = box.max();
}

template <class Element>
void add_to_parts(const Mesh& mesh, const std::vector<Element>& elements, const std::vector<std::size_t>& part_of,
                  std::vector<PartMeasures>& parts) {
  for (const Element& element : elements) {
    PartMeasures& part = parts[part_of[static_cast<std::size_t>(element[0])]];
    const double share = volume(mesh.vertices, element);
    part.volume += share;
    part.centroid += share * mean_position(mesh, element);
  }
}

}  // namespace

MeshMeasures measure_mesh(const Mesh& mesh, const MeshCheck& check) {
  MeshMeasures measures;
  measures.order = order_of(mesh);
  measures.vertices = static_cast<std::size_t>(mesh.vertices.rows());
  measures.tetrahedra = mesh.tetrahedra.size();
  measures.prisms = mesh.prisms.size();
  measures.triangles = mesh.triangles.size();
  measures.quads = mesh.quads.size();
  measures.parts = check.parts.size();
  measure_box(mesh, check, measures);
  for (const Tetrahedron& t : mesh.tetrahedra) measures.volume += volume(mesh.vertices, t);
  for (const Prism& p : mesh.prisms) measures.volume += volume(mesh.vertices, p);
  const Boundary boundary = boundary_of(mesh.tetrahedra, mesh.prisms);
  for (const Triangle& t : boundary.triangles) measures.boundary += area(mesh.vertices, t);
  for (const Quad& q : boundary.quads) measures.boundary += area(mesh.vertices, q);
  std::vector<double> quality = check.quality;
  std::sort(quality.begin(), quality.end());
  const double shares[] = {0, 0.01, 0.5};
  for (int i = 0; i < 3; ++i) measures.quality[i] = percentile(quality, shares[i]);
  const std::vector<double> lengths = edge_lengths(mesh);
  const double length_shares[] = {0, 0.5, 1};
  for (int i = 0; i < 3; ++i) measures.edge_length[i] = percentile(lengths, length_shares[i]);
  const std::vector<QuadraticTriangle> triangles = quadratic_triangles(mesh);
  for (const Region& region : mesh.regions) measures.regions.push_back(measure_region(mesh, triangles, region));
  return measures;
}

std::vector<PartMeasures> measure_parts(const Mesh& mesh, const MeshCheck& check) {
  std::vector<std::size_t> part_of(static_cast<std::size_t>(mesh.vertices.rows()));
  for (std::size_t part = 0; part < check.parts.size(); ++part)
    for (const Index v : check.parts[part]) part_of[static_cast<std::size_t>(v)] = part;
  std::vector<PartMeasures> parts(check.parts.size(), {0, 0, Vec3::Zero()});
  add_to_parts(mesh, mesh.tetrahedra, part_of, parts);
  add_to_parts(mesh, mesh.prisms, part_of, parts);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    PartMeasures& part = parts[i];
    part.vertices = check.parts[i].size();
    part.centroid = part.volume > 0 ? Vec3(part.centroid / part.volume) : mean_position(mesh, check.parts[i]);
  }
  return parts;
}

}  // namespace softkin
