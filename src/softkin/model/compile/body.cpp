#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <softkin/model/compile/layers.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/triangle_points.hpp>

namespace softkin {

std::pair<Index, Index> vertices_of(const Compilation& c, const std::string& robot) {
  const Index end = c.mesh.vertices.rows();
  if (robot.empty()) return {0, end};
  const std::vector<RobotPart>& robots = c.spec.robots;
  for (std::size_t r = 0; r < robots.size(); ++r)
    if (robots[r].name == robot) return {robots[r].vertices, r + 1 < robots.size() ? robots[r + 1].vertices : end};
  throw InvalidInput(c.origin, "there is no robot '" + robot + "'");
}

double diagonal_of(const Compilation& c, const std::string& robot) {
  Bounds bounds;
  const auto [begin, end] = vertices_of(c, robot);
  for (Index v = begin; v < end; ++v)
    if (c.model.elements.used[v]) bounds.extend(vertex_at(c.model.rest, v));
  return bounds.diagonal().norm();
}

const Body& body_of(Compilation& c, const std::string& robot) {
  if (const auto known = c.robot_bodies.find(robot); known != c.robot_bodies.end()) return known->second;
  const Model& model = c.model;
  const auto [begin, end] = vertices_of(c, robot);
  const auto is_of = [begin = begin, end = end](const auto& element) {
    return element[0] >= begin && element[0] < end;
  };
  std::vector<Tetrahedron> tetrahedra;
  std::vector<EdgeNodes> edge_nodes;
  std::vector<Prism> prisms;
  for (std::size_t i = 0; i < model.elements.tetrahedra.size(); ++i) {
    if (model.elements.tetrahedron_roles[i].material < 0 || !is_of(model.elements.tetrahedra[i])) continue;
    tetrahedra.push_back(model.elements.tetrahedra[i]);
    if (!model.elements.edge_nodes.empty()) edge_nodes.push_back(model.elements.edge_nodes[i]);
  }
  for (const Prism& prism : model.elements.prisms)
    if (is_of(prism)) prisms.push_back(prism);
  Embedder embedder(model.rest, tetrahedra, prisms, edge_nodes);
  Body body{std::move(tetrahedra), std::move(prisms), std::move(embedder), diagonal_of(c, robot)};
  for (const Triangle& t : c.sheets)
    if (is_of(t)) body.sheets.push_back(face_of(c, t));
  return c.robot_bodies.emplace(robot, std::move(body)).first->second;
}

namespace {

/// The face of a sheet that is nearest to a point, and its point there.
struct NearestFace {
  CavityFace face{};
  Vec3 at{0, 0, 0};
};

/// None where an element is as near.
std::optional<NearestFace> nearest_face(const Body& body, const Points& rest, const Vec3& point) {
  if (body.sheets.empty() || !point.allFinite()) return std::nullopt;
  std::vector<Triangle> corners;
  for (const CavityFace& face : body.sheets) corners.push_back(face.corners);
  Index nearest = 0;
  const Vec3 at = SurfaceTree(rest, corners).nearest(point, &nearest);
  if (!body.embedder.empty() && body.embedder.embed(point).distance_mm <= (point - at).norm()) return std::nullopt;
  return NearestFace{body.sheets[nearest], at};
}

}  // namespace

EmbeddedPoint carried(const Body& body, const Points& rest, const Vec3& point) {
  constexpr double min_weight = 1e-12;
  const std::optional<NearestFace> nearest = nearest_face(body, rest, point);
  if (!nearest) return body.embedder.embed(point);
  const auto& [face, at] = *nearest;
  const Vec3 a = vertex_at(rest, face.corners[0]), b = vertex_at(rest, face.corners[1]),
             c = vertex_at(rest, face.corners[2]);
  const Vec3 normal = (b - a).cross(c - a);
  const Vec3 fractions =
      Vec3((b - at).cross(c - at).dot(normal), (c - at).cross(a - at).dot(normal), (a - at).cross(b - at).dot(normal)) /
      normal.squaredNorm();
  const std::vector<Index> nodes = nodes_of(face);
  const TrianglePoint quadratic = triangle_point(fractions[1], fractions[2], 0);
  EmbeddedPoint embedded;
  embedded.distance_mm = (point - at).norm();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Eigen::Index k = i;
    const double weight = nodes.size() == 3 ? fractions[k] : quadratic.shape[k];
    if (std::abs(weight) < min_weight) continue;
    embedded.vertices.push_back(nodes[i]);
    embedded.weights.push_back(weight);
  }
  return embedded;
}

double max_outside(const Body& body, const Points& rest, const Vec3& point) {
  const std::optional<NearestFace> nearest = nearest_face(body, rest, point);
  const double edge = nearest ? longest_edge(rest, nearest->face.corners) : body.embedder.edge_near(point);
  return std::min(0.5 * edge, 0.1 * body.diagonal_mm);
}

}  // namespace softkin
