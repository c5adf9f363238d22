#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <softkin/model/compile/embedding.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/mesh/surface_tree.hpp>
#include <softkin/model/mesh/tetrahedra.hpp>

namespace softkin {

namespace {

std::vector<Tetrahedron> as_tetrahedra(const Points& vertices, std::vector<Tetrahedron> tetrahedra,
                                       const std::vector<Prism>& prisms) {
  for (const Prism& prism : prisms)
    for (const Tetrahedron& piece : split(prism)) {
      const double longest = longest_edge(vertices, piece);
      // a strongly twisted prism can have a flat piece, which its neighbours cover
      if (signed_volume(vertices, piece) > 1e-9 * longest * longest * longest) tetrahedra.push_back(piece);
    }
  return tetrahedra;
}

// The nearest point of a tetrahedron lies on a face that the point is on the outer side of.
double squared_distance(const Vec3 (&corners)[4], const Barycentric& weights, const Vec3& point) {
  if (weights.minCoeff() >= 0) return 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; ++i) {
    if (weights[i] >= 0) continue;
    nearest = std::min(
        nearest, squared_distance_to_triangle(point, corners[(i + 1) % 4], corners[(i + 2) % 4], corners[(i + 3) % 4]));
  }
  return nearest;
}

template <std::size_t K, class Weights>
void add_weights(const std::array<Index, K>& vertices, const Weights& weights, EmbeddedPoint& embedded) {
  for (std::size_t i = 0; i < K; ++i) {
    const double weight = weights[i];
    if (std::abs(weight) < 1e-12) continue;
    embedded.vertices.push_back(vertices[i]);
    embedded.weights.push_back(weight);
  }
}

EmbeddedPoint normalised(EmbeddedPoint embedded) {
  double sum = 0;
  for (const double w : embedded.weights) sum += w;
  for (double& w : embedded.weights) w /= sum;
  return embedded;
}

/// Returns where the line from the element's middle to the point leaves the element; the point itself where it is
/// inside.
Barycentric drawn_inside(const Barycentric& l) {
  const Barycentric middle = Barycentric::Constant(0.25);
  const double least = l.minCoeff();
  return least >= 0 ? l : Barycentric(middle + 0.25 / (0.25 - least) * (l - middle));
}

using VertexWeights = std::map<Index, double>;

template <class Cell>
void spread(const Cell& cell, double measure, VertexWeights& weights) {
  for (const Index i : cell) weights[i] += measure / static_cast<double>(cell.size());
}

double area(const Points& vertices, const Triangle& t) {
  const Vec3 a = vertex_at(vertices, t[0]);
  return 0.5 * (vertex_at(vertices, t[1]) - a).cross(vertex_at(vertices, t[2]) - a).norm();
}

void spread_quad(const Points& vertices, const Quad& q, VertexWeights& weights) {
  for (const Triangle& t :
       {Triangle{q[0], q[1], q[2]}, Triangle{q[0], q[2], q[3]}, Triangle{q[0], q[1], q[3]}, Triangle{q[1], q[2], q[3]}})
    spread(t, 0.5 * area(vertices, t), weights);
}

void spread_quadratic(const Mesh& mesh, Index tetrahedron, VertexWeights& weights) {
  const Tetrahedron& corners = mesh.tetrahedra[tetrahedron];
  const EdgeNodes& edge_nodes = mesh.edge_nodes[tetrahedron];
  TetrahedronWeights integrals = shape_integrals(nodes_of(mesh.vertices, corners, edge_nodes));
  if (integrals.sum() < 0) integrals = -integrals;  // in the file's order the corners may be reversed
  for (int i = 0; i < 10; ++i) weights[i < 4 ? corners[i] : edge_nodes[i - 4]] += integrals[i];
}

void spread_quadratic(const Points& vertices, const Triangle& corners, const std::array<Index, 3>& edge_nodes,
                      VertexWeights& weights) {
  if (*std::min_element(edge_nodes.begin(), edge_nodes.end()) < 0)
    throw InvalidInput("a triangle of the region is not a face of an element of order 2");
  TriangleNodes nodes;
  for (int i = 0; i < 3; ++i) {
    nodes.row(i) = vertices.row(corners[i]);
    nodes.row(i + 3) = vertices.row(edge_nodes[i]);
  }
  const Eigen::Matrix<double, 6, 1> integrals = shape_integrals(nodes);
  for (int i = 0; i < 6; ++i) weights[i < 3 ? corners[i] : edge_nodes[i - 3]] += integrals[i];
}

/// By integrals of the shape functions over the region's cells.
VertexWeights integrated(const Region& region, const Mesh& mesh, const EdgeTable& edges) {
  VertexWeights weights;
  if (region.dimension == 3)
    for (const Index i : region.tetrahedra) spread_quadratic(mesh, i, weights);
  else
    for (const Index i : region.triangles)
      spread_quadratic(mesh.vertices, mesh.triangles[i], edges.of(mesh.triangles[i]), weights);
  double total = 0;
  for (const auto& [vertex, weight] : weights) total += weight;
  // corners of straight cells weigh nothing, but for rounding
  std::erase_if(weights, [&](const auto& entry) { return std::abs(entry.second) < 1e-15 * total; });
  return weights;
}

}  // namespace

Embedder::Embedder(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms,
                   const std::vector<EdgeNodes>& edge_nodes)
    : vertices_(vertices),
      tetrahedra_(as_tetrahedra(vertices, tetrahedra, prisms)),
      edge_nodes_(edge_nodes),
      tree_(bounds_of(vertices, tetrahedra_)) {
  Bounds bounds;
  for (Index i = 0; i < vertices_.rows(); ++i) bounds.extend(vertex_at(vertices_, i));
  if (!bounds.isEmpty()) tolerance_ = 1e-13 * bounds.diagonal().norm();
}

Embedder::Nearest Embedder::seen_from(Index element, const Vec3& point) const {
  Vec3 corners[4];
  for (int i = 0; i < 4; ++i) corners[i] = vertex_at(vertices_, tetrahedra_[element][i]);
  const Barycentric weights = barycentric(corners, point);
  return {element, std::sqrt(squared_distance(corners, weights, point)), weights};
}

Embedder::Nearest Embedder::nearest(const Vec3& point) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Nearest found{-1, infinity, Barycentric::Constant(-infinity)};
  tree_.visit_near(point, [&](Index item) {
    const auto [element, d, w] = seen_from(item, point);
    const bool nearer = d < found.distance - tolerance_;
    if (nearer || (d <= found.distance + tolerance_ && w.minCoeff() > found.coordinates.minCoeff()))
      found = {item, d, w};
    return (found.distance + tolerance_) * (found.distance + tolerance_);
  });
  return found;
}

EmbeddedPoint Embedder::embed(const Vec3& point) const {
  if (empty()) throw InvalidInput("there is no element to embed a point in");
  if (!point.allFinite()) throw InvalidInput("a point to embed is not finite");
  return weighted(nearest(point), point);
}

EmbeddedPoint Embedder::embed_in(Index element, const Vec3& point) const {
  return weighted(seen_from(element, point), point);
}

std::vector<Embedder::Piece> Embedder::pieces(const Vec3& from, const Vec3& to) const {
  constexpr double inside = -1e-9, beyond = 1e-7, outside = 0.125;  // a coordinate; fractions of the longest edge
  std::vector<Piece> pieces;
  const double length = (to - from).norm();
  const auto at = [&](double fraction) -> Vec3 { return from + fraction * (to - from); };
  for (double begin = 0; begin < 1;) {
    Nearest near = nearest(at(begin));
    const double edge = edge_of(near.element) / length;
    const double ahead = std::min(1.0, begin + beyond * edge);
    near = nearest(at(ahead));
    double end = 1;
    if (near.coordinates.minCoeff() >= inside) {
      const Barycentric far = seen_from(near.element, to).coordinates;
      for (int i = 0; i < 4; ++i)
        if (far[i] < inside)
          end = std::min(end, ahead + (1 - ahead) * (near.coordinates[i] - inside) / (near.coordinates[i] - far[i]));
    } else {
      end = std::min(1.0, begin + outside * edge);
      near = nearest(at(0.5 * (begin + end)));
    }
    end = std::max(end, ahead);
    if (1 - end < beyond * edge) end = 1;
    if (!pieces.empty() && pieces.back().element == near.element)
      pieces.back().end = end;
    else
      pieces.push_back({near.element, begin, end});
    begin = end;
  }
  return pieces;
}

EmbeddedPoint Embedder::weighted(const Nearest& by, const Vec3& point) const {
  auto [element, distance, weights] = by;
  EmbeddedPoint embedded;
  if (edge_nodes_.empty()) {
    add_weights(tetrahedra_[element], weights, embedded);
  } else {
    const TetrahedronWeights quadratic = quadratic_weights(element, point, weights, distance);
    add_weights(tetrahedra_[element], quadratic.head<4>(), embedded);
    add_weights(edge_nodes_[element], quadratic.tail<6>(), embedded);
  }
  embedded.distance_mm = distance;
  return normalised(std::move(embedded));
}

double Embedder::edge_of(Index element) const {
  return longest_edge(vertices_, tetrahedra_[element]);
}

double Embedder::edge_near(const Vec3& point) const {
  return edge_of(nearest(point).element);
}

TetrahedronWeights Embedder::quadratic_weights(Index element, const Vec3& point, Barycentric coordinates,
                                               double& distance) const {
  constexpr int max_iterations = 50;
  const TetrahedronNodes nodes = nodes_of(vertices_, tetrahedra_[element], edge_nodes_[element]);
  for (int i = 0; i < max_iterations; ++i) {
    const Barycentric inside = drawn_inside(coordinates);
    const Eigen::Matrix<double, 10, 4> slope = quadratic_slope(inside);
    const TetrahedronWeights weights = quadratic_shape(inside) + slope * (coordinates - inside);
    const Vec3 missing = point - nodes.transpose() * weights;
    if (missing.norm() <= 10 * tolerance_) {
      // the distance from the corners' tetrahedron is not that from the curved element
      if (i > 0) distance = std::min(distance, (point - nodes.transpose() * quadratic_shape(inside)).norm());
      return weights;
    }
    const Eigen::Matrix<double, 3, 4> along = nodes.transpose() * slope;
    const Vec3 step = (along.rightCols<3>().colwise() - along.col(0)).eval().inverse() * missing;
    coordinates += Barycentric(-step.sum(), step[0], step[1], step[2]);
  }
  throw InvalidInput("the nearest element is too strongly curved to carry the point");
}

EmbeddedPoint mean_of(const Region& region, const Mesh& mesh, const EdgeTable& edges) {
  const Points& vertices = mesh.vertices;
  VertexWeights weights;
  if (region.dimension >= 2 && !edges.empty()) {
    weights = integrated(region, mesh, edges);
  } else if (region.dimension == 3) {
    for (const Index i : region.tetrahedra)
      spread(mesh.tetrahedra[i], std::abs(signed_volume(vertices, mesh.tetrahedra[i])), weights);
    for (const Index i : region.prisms)
      spread(mesh.prisms[i], std::abs(signed_volume(vertices, mesh.prisms[i])), weights);
  } else if (region.dimension == 2) {
    for (const Index i : region.triangles) spread(mesh.triangles[i], area(vertices, mesh.triangles[i]), weights);
    for (const Index i : region.quads) spread_quad(vertices, mesh.quads[i], weights);
  } else {
    for (const Index i : region.vertices) weights[i] = 1;
  }
  double total = 0;
  for (const auto& [vertex, weight] : weights) total += weight;
  if (!(total > 0)) throw InvalidInput("region '" + region.name + "' has no extent to take the mean of");
  EmbeddedPoint mean;
  for (const auto& [vertex, weight] : weights) {
    mean.vertices.push_back(vertex);
    mean.weights.push_back(weight / total);
  }
  return mean;
}

}  // namespace softkin
