#include <softkin/model/compile/parts.hpp>

namespace softkin {

std::pair<Index, Index> vertices_of(const Compilation& c, const std::string& robot) {
  const auto end = static_cast<Index>(c.mesh.vertices.rows());
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
    if (c.model.used[v]) bounds.extend(vertex_at(c.model.rest, v));
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
  for (std::size_t i = 0; i < model.tetrahedra.size(); ++i) {
    if (model.tetrahedron_roles[i].material < 0 || !is_of(model.tetrahedra[i])) continue;
    tetrahedra.push_back(model.tetrahedra[i]);
    if (!model.edge_nodes.empty()) edge_nodes.push_back(model.edge_nodes[i]);
  }
  for (const Prism& prism : model.prisms)
    if (is_of(prism)) prisms.push_back(prism);
  Embedder embedder(model.rest, tetrahedra, prisms, edge_nodes);
  Body body{std::move(tetrahedra), std::move(prisms), std::move(embedder), diagonal_of(c, robot)};
  return c.robot_bodies.emplace(robot, std::move(body)).first->second;
}

}  // namespace softkin
