#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <span>
#include <utility>

namespace softkin {

namespace {

using Edge = std::pair<Index, Index>;

/// Mean of vertices [mm].
Vec3 mean_position(const Mesh& mesh, std::span<const Index> vertices) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : vertices) sum += vertex_at(mesh.vertices, v);
  return sum / static_cast<double>(vertices.size());
}

double face_area(const Points& vertices, const Triangle& t) {
  const Eigen::RowVector3d a = vertices.row(t[0]);
  return 0.5 * Vec3(vertices.row(t[1]) - a).cross(Vec3(vertices.row(t[2]) - a)).norm();
}

double face_area(const Points& vertices, const Quad& q) {
  return face_area(vertices, Triangle{q[0], q[1], q[2]}) + face_area(vertices, Triangle{q[0], q[2], q[3]});
}

template <class Element>
double volume(const Points& vertices, const Element& element) {
  return std::abs(signed_volume(vertices, element));
}

constexpr int triangle_edges[3][2] = {{0, 1}, {1, 2}, {2, 0}};

/// Returns the value below which a fraction of the sorted values lies, by nearest rank; 0 for no values.
double percentile(const std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  const double rank = std::ceil(fraction * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

template <class Element, std::size_t N>
void add_edges(const std::vector<Element>& elements, const int (&corners)[N][2], std::vector<Edge>& edges) {
  for (const Element& element : elements)
    for (const auto& [a, b] : corners) edges.push_back(std::minmax({element[a], element[b]}));
}

std::vector<double> edge_lengths(const Mesh& mesh) {
  std::vector<Edge> edges;
  add_edges(mesh.tetrahedra, tetrahedron_edges, edges);
  add_edges(mesh.prisms, prism_edges, edges);
  if (edges.empty()) add_edges(mesh.triangles, triangle_edges, edges);
  sort_unique(edges);
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
    const Cell& cell = cells[i];
    measures.measure += measure_of(cell);
    vertices.insert(vertices.end(), cell.begin(), cell.end());
  }
  measures.cells += chosen.size();
}

template <class Nodes>
void add_edge_nodes(const std::vector<Nodes>& nodes, const std::vector<Index>& chosen, std::vector<Index>& vertices) {
  if (nodes.empty()) return;
  for (const Index i : chosen) vertices.insert(vertices.end(), nodes[i].begin(), nodes[i].end());
}

RegionMeasures measure_region(const Mesh& mesh, const std::vector<QuadraticTriangle>& triangles, const Region& region) {
  RegionMeasures measures{region.name, region.dimension};
  std::vector<Index> vertices = region.vertices;
  const auto volume_of = [&](const auto& element) { return volume(mesh.vertices, element); };
  const auto area_of = [&](const auto& face) { return face_area(mesh.vertices, face); };
  add_cells(mesh.tetrahedra, region.tetrahedra, volume_of, measures, vertices);
  add_cells(mesh.prisms, region.prisms, volume_of, measures, vertices);
  add_cells(mesh.triangles, region.triangles, area_of, measures, vertices);
  add_cells(mesh.quads, region.quads, area_of, measures, vertices);
  add_edge_nodes(mesh.edge_nodes, region.tetrahedra, vertices);
  add_edge_nodes(triangles, region.triangles, vertices);
  sort_unique(vertices);
  measures.vertices = vertices.size();
  return measures;
}

void measure_box(const Mesh& mesh, const MeshCheck& check, MeshMeasures& measures) {
  Eigen::AlignedBox3d box;
  for (const auto& part : check.parts)
    for (const Index v : part) box.extend(Vec3(mesh.vertices.row(v).transpose()));
  if (check.parts.empty())  // sheets without elements
    for (const Triangle& t : mesh.triangles)
      for (const Index v : t) box.extend(Vec3(mesh.vertices.row(v).transpose()));
  measures.low = box.min();
  measures.high = box.max();
}

template <class Element>
void add_to_parts(const Mesh& mesh, const std::vector<Element>& elements, const std::vector<std::size_t>& part_of,
                  std::vector<PartMeasures>& parts) {
  for (const Element& element : elements) {
    PartMeasures& part = parts[part_of[element[0]]];
    const double fraction = volume(mesh.vertices, element);
    part.volume += fraction;
    part.centroid += fraction * mean_position(mesh, element);
  }
}

constexpr std::size_t max_places = 5;
constexpr double farthest = 0.25, even = 1e-3;  // of an edge's node from its middle, fractions of its length

/// The edges of tetrahedra of order 2 that are wrong or uneven: vertices, an edge's ends first, then its node.
struct EdgeCheck {
  std::vector<EdgeWithNode> far;            // nodes further than a quarter of the edge's length from its middle
  std::vector<EdgeWithNode> uneven;         // the others that are further than a thousandth of it
  std::vector<std::array<Index, 4>> split;  // edges on which tetrahedra have different nodes; two of these
  std::vector<Index> shared;                // nodes of several edges
};

/// Nodes that stand on several edges, once each.
std::vector<Index> shared_nodes(const std::vector<EdgeWithNode>& edges) {
  std::vector<Index> nodes, shared;
  nodes.reserve(edges.size());
  for (const auto& edge : edges) nodes.push_back(edge[2]);
  std::sort(nodes.begin(), nodes.end());
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i] == nodes[i - 1] && (shared.empty() || shared.back() != nodes[i])) shared.push_back(nodes[i]);
  return shared;
}

EdgeCheck check_edges(const Mesh& mesh) {
  EdgeCheck check;
  const std::vector<EdgeWithNode> edges = edges_with_nodes(mesh);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto& [a, b, node] = edges[i];
    const Vec3 start = mesh.vertices.row(a), end = mesh.vertices.row(b), at = mesh.vertices.row(node);
    const double distance = (at - (start + end) / 2).norm(), length = (end - start).norm();
    if (distance > farthest * length)
      check.far.push_back(edges[i]);
    else if (distance > even * length)
      check.uneven.push_back(edges[i]);
    if (i > 0 && edges[i - 1][0] == a && edges[i - 1][1] == b) check.split.push_back({a, b, edges[i - 1][2], node});
  }
  check.shared = shared_nodes(edges);
  return check;
}

std::span<const Index> members(const Index& one) {
  return {&one, 1};
}

template <std::size_t N>
std::span<const Index> members(const std::array<Index, N>& group) {
  return group;
}

class Collector {
 public:
  explicit Collector(const Mesh& mesh) : mesh_(mesh) {}

  template <class Items>
  void elements(MeshSeverity severity, const char* kind, const char* meaning, const Items& items) {
    findings_.push_back({kind, meaning, severity, 0, {}});
    add(items, [&](std::span<const Index> group) { return place_of(group); });
  }

  template <class... Items>
  void vertices(MeshSeverity severity, const char* kind, const char* meaning, const Items&... items) {
    findings_.push_back({kind, meaning, severity, 0, {}});
    const auto place = [&](std::span<const Index> group) {
      return MeshPlace{{}, {}, {group.begin(), group.end()}, mean_position(mesh_, group)};
    };
    (add(items, place), ...);
  }

  std::vector<MeshFinding> take() { return std::move(findings_); }

 private:
  template <class Items, class PlaceOf>
  void add(const Items& items, const PlaceOf& make_place) {
    MeshFinding& finding = findings_.back();
    finding.count += items.size();
    for (std::size_t i = 0; i < items.size() && finding.first.size() < max_places; ++i)
      finding.first.push_back(make_place(members(items[i])));
  }

  MeshPlace place_of(std::span<const Index> elements) const {
    MeshPlace place{{}, {}, {}, Vec3::Zero()};
    const auto fraction = static_cast<double>(elements.size());
    const Index prisms_from = mesh_.tetrahedra.size();
    for (const Index element : elements) {
      const std::size_t i = element;
      if (element < prisms_from) {
        place.tetrahedra.push_back(element);
        place.position += mean_position(mesh_, mesh_.tetrahedra[i]) / fraction;
      } else {
        place.prisms.push_back(element - prisms_from);
        place.position += mean_position(mesh_, mesh_.prisms[i - mesh_.tetrahedra.size()]) / fraction;
      }
    }
    return place;
  }

  const Mesh& mesh_;
  std::vector<MeshFinding> findings_;
};

}  // namespace

std::string missing_volume(const Mesh& mesh) {
  if (!mesh.tetrahedra.empty() || !mesh.prisms.empty()) return "";
  const bool faces = !mesh.triangles.empty();
  return std::string("the mesh has ") +
         (faces ? "triangles and no volume element" : "no volume element and no triangle") +
         ": mesh it in three dimensions, with tetrahedra or prisms; where that was done, the file lacks them: in "
         "Gmsh, " +
         "which saves physical groups alone where there are any, add the volume to a physical group, too, or save "
         "all " +
         "elements (Mesh.SaveAll = 1)" +
         (faces ? "; a mesh of triangles alone serves a robot of fabric or film, which the scene describes by `layers` "
                  "in the physical formulation"
                : "");
}

MeshMeasures measure_mesh(const Mesh& mesh, const MeshCheck& check) {
  MeshMeasures measures;
  measures.order = order_of(mesh);
  measures.vertices = mesh.vertices.rows();
  measures.tetrahedra = mesh.tetrahedra.size();
  measures.prisms = mesh.prisms.size();
  measures.triangles = mesh.triangles.size();
  measures.quads = mesh.quads.size();
  measures.parts = check.parts.size();
  measure_box(mesh, check, measures);
  for (const Tetrahedron& t : mesh.tetrahedra) measures.volume += volume(mesh.vertices, t);
  for (const Prism& p : mesh.prisms) measures.volume += volume(mesh.vertices, p);
  const Boundary boundary = boundary_of(mesh.tetrahedra, mesh.prisms);
  for (const Triangle& t : boundary.triangles) measures.boundary += face_area(mesh.vertices, t);
  for (const Quad& q : boundary.quads) measures.boundary += face_area(mesh.vertices, q);
  std::vector<double> quality = check.quality;
  std::sort(quality.begin(), quality.end());
  const double fractions[] = {0, 0.01, 0.5};
  for (int i = 0; i < 3; ++i) measures.quality[i] = percentile(quality, fractions[i]);
  const std::vector<double> lengths = edge_lengths(mesh);
  const double length_fractions[] = {0, 0.5, 1};
  for (int i = 0; i < 3; ++i) measures.edge_length[i] = percentile(lengths, length_fractions[i]);
  const std::vector<QuadraticTriangle> triangles = quadratic_triangles(mesh);
  for (const Region& region : mesh.regions) measures.regions.push_back(measure_region(mesh, triangles, region));
  return measures;
}

CurvedMeasures measure_curved(const Mesh& mesh) {
  CurvedMeasures measures;
  const auto volume_of = [&](Index t) {
    return std::abs(shape_integrals(nodes_of(mesh.vertices, mesh.tetrahedra[t], mesh.edge_nodes[t])).sum());
  };
  const auto area_of = [&](const QuadraticTriangle& face) {
    TriangleNodes nodes;
    for (int i = 0; i < 6; ++i) nodes.row(i) = mesh.vertices.row(face[i]);
    return shape_integrals(nodes).sum();
  };
  for (Index t = 0; t < std::ssize(mesh.tetrahedra); ++t) measures.volume += volume_of(t);
  const Boundary boundary = boundary_of(mesh.tetrahedra, {});
  for (std::size_t i = 0; i < boundary.triangles.size(); ++i) {
    const auto& [a, b, c] = boundary.triangles[i];
    const auto owner = boundary.triangle_owners[i];
    const auto node = [&](Index from, Index to) {
      return edge_node(mesh.tetrahedra[owner], mesh.edge_nodes[owner], from, to);
    };
    measures.boundary += area_of({a, b, c, node(a, b), node(b, c), node(c, a)});
  }
  const std::vector<QuadraticTriangle> triangles = quadratic_triangles(mesh);
  for (const Region& region : mesh.regions) {
    double& measure = measures.regions.emplace_back();
    for (const Index t : region.tetrahedra) measure += volume_of(t);
    if (region.dimension == 2 && !triangles.empty())
      for (const Index t : region.triangles) measure += area_of(triangles[t]);
  }
  return measures;
}

std::vector<PartMeasures> measure_parts(const Mesh& mesh, const MeshCheck& check) {
  std::vector<std::size_t> part_of(mesh.vertices.rows());
  for (std::size_t part = 0; part < check.parts.size(); ++part)
    for (const Index v : check.parts[part]) part_of[v] = part;
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

std::vector<MeshFinding> findings_of(const Mesh& mesh, const MeshCheck& check) {
  using enum MeshSeverity;
  Collector collect(mesh);
  collect.elements(error, "degenerate_elements", "without volume, or folded over", check.degenerate);
  collect.elements(error, "duplicate_elements", "same vertices as an earlier element", check.duplicate_elements);
  collect.elements(error, "overlapping_elements", "on the same side of a common face", check.overlapping);
  collect.vertices(error, "nonmanifold_faces", "faces of more than two elements", check.nonmanifold_faces,
                   check.nonmanifold_quads);
  const EdgeCheck edges = check_edges(mesh);
  const bool quadratic = !mesh.edge_nodes.empty();
  if (quadratic) {
    collect.vertices(error, "split_edges", "tetrahedra have different nodes on the edge: not connected there",
                     edges.split);
    collect.vertices(error, "shared_edge_nodes", "nodes of several edges", edges.shared);
    collect.vertices(error, "far_edge_nodes", "more than a quarter of the edge's length from its middle", edges.far);
  }
  collect.vertices(warning, "duplicate_vertices", "same place as an earlier vertex: not connected there",
                   check.duplicate_vertices);
  collect.vertices(warning, "nonmanifold_edges", "the body touches itself along an edge only", check.nonmanifold_edges);
  collect.vertices(warning, "nonmanifold_vertices", "the body touches itself in a point only",
                   check.nonmanifold_vertices);
  collect.elements(remark, "negative_elements", "vertices in reversed order: softkin reorders them", check.negative);
  if (quadratic)
    collect.vertices(remark, "uneven_edges", "node off the middle of the edge: curved, or of uneven halves",
                     edges.uneven);
  collect.vertices(remark, "unreferenced_vertices", "of no element: they stay where they are", check.unreferenced);
  return collect.take();
}

namespace {

void name(const std::vector<Index>& indices, const char* one, const char* many, std::string& text) {
  for (std::size_t i = 0; i < indices.size(); ++i) {
    text += text.empty() ? "" : i == 0 ? " and " : ", ";
    if (i == 0) text += std::string(indices.size() == 1 ? one : many) + " ";
    text += std::to_string(indices[i]);
  }
}

}  // namespace

std::string words_of(const MeshFinding& finding) {
  std::string text = finding.kind;
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string text_of(const MeshPlace& place) {
  std::string text;
  name(place.tetrahedra, "tetrahedron", "tetrahedra", text);
  name(place.prisms, "prism", "prisms", text);
  name(place.vertices, "vertex", "vertices", text);
  return text + " at " + point_text(place.position) + " mm";
}

}  // namespace softkin
