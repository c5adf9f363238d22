#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <tuple>
#include <utility>

namespace softkin {

EdgeTable::EdgeTable(const Mesh& mesh) {
  edges_.reserve(6 * mesh.edge_nodes.size());
  for (std::size_t t = 0; t < mesh.edge_nodes.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const auto [low, high] =
          std::minmax(mesh.tetrahedra[t][tetrahedron_edges[e][0]], mesh.tetrahedra[t][tetrahedron_edges[e][1]]);
      edges_.push_back({low, high, mesh.edge_nodes[t][e]});
    }
  const auto key = [](const Edge& edge) { return std::tie(edge.low, edge.high, edge.node); };
  std::sort(edges_.begin(), edges_.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
  edges_.erase(
      std::unique(edges_.begin(), edges_.end(), [&](const Edge& a, const Edge& b) { return key(a) == key(b); }),
      edges_.end());
  const auto twice = std::adjacent_find(
      edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; });
  if (twice != edges_.end())
    throw InvalidInput("the edge between the vertices " + std::to_string(twice->low) + " and " +
                       std::to_string(twice->high) + " (from 0) has two nodes, " + std::to_string(twice->node) +
                       " and " + std::to_string(std::next(twice)->node));
  std::vector<Index> nodes;
  nodes.reserve(edges_.size());
  for (const Edge& edge : edges_) nodes.push_back(edge.node);
  std::sort(nodes.begin(), nodes.end());
  if (const auto shared = std::adjacent_find(nodes.begin(), nodes.end()); shared != nodes.end())
    throw InvalidInput("vertex " + std::to_string(*shared) + " (from 0) is the node of two edges");
}

Index EdgeTable::find(Index a, Index b) const {
  const auto ends = std::minmax(a, b);
  const auto found = std::lower_bound(edges_.begin(), edges_.end(), ends, [](const Edge& edge, const auto& wanted) {
    return std::tie(edge.low, edge.high) < std::tie(wanted.first, wanted.second);
  });
  return found != edges_.end() && found->low == ends.first && found->high == ends.second ? found->node : -1;
}

std::array<Index, 3> EdgeTable::of(const Triangle& triangle) const {
  return {find(triangle[0], triangle[1]), find(triangle[1], triangle[2]), find(triangle[2], triangle[0])};
}

std::vector<Index> EdgeTable::between(const std::vector<Index>& vertices) const {
  const auto held = [&](Index v) { return std::binary_search(vertices.begin(), vertices.end(), v); };
  std::vector<Index> nodes;
  for (const Edge& edge : edges_)
    if (held(edge.low) && held(edge.high)) nodes.push_back(edge.node);
  return nodes;
}

void exchange_corners_2_and_3(EdgeNodes& edge_nodes) {
  // 01 and 23 stay, 12 becomes 13, 02 becomes 03
  std::swap(edge_nodes[1], edge_nodes[4]);
  std::swap(edge_nodes[2], edge_nodes[3]);
}

Index edge_node(const Tetrahedron& element, const EdgeNodes& edge_nodes, Index a, Index b) {
  for (int e = 0; e < 6; ++e) {
    const Index start = element[tetrahedron_edges[e][0]], end = element[tetrahedron_edges[e][1]];
    if ((start == a && end == b) || (start == b && end == a)) return edge_nodes[e];
  }
  throw InvalidInput("the vertices " + std::to_string(a) + " and " + std::to_string(b) +
                     " (from 0) are no edge of the element");
}

namespace {

using Ends = std::pair<Index, Index>;

Ends ends_of(const Tetrahedron& element, int edge) {
  return std::minmax({element[tetrahedron_edges[edge][0]], element[tetrahedron_edges[edge][1]]});
}

std::vector<Ends> edges_of(const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<Ends> edges;
  edges.reserve(6 * tetrahedra.size());
  for (const Tetrahedron& t : tetrahedra)
    for (int e = 0; e < 6; ++e) edges.push_back(ends_of(t, e));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

void sort_unique(std::vector<Index>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

Mesh elevated(const Mesh& mesh) {
  if (!mesh.prisms.empty()) throw InvalidInput("a mesh with prisms cannot be of order 2: prisms are linear");
  if (!mesh.edge_nodes.empty()) throw InvalidInput("the mesh is of order 2 already");
  Mesh raised = mesh;
  const std::vector<Ends> edges = edges_of(mesh.tetrahedra);
  const auto corners = static_cast<Index>(mesh.vertices.rows());
  raised.vertices.conservativeResize(corners + static_cast<Index>(edges.size()), 3);
  for (std::size_t e = 0; e < edges.size(); ++e)
    raised.vertices.row(corners + static_cast<Index>(e)) =
        0.5 * (mesh.vertices.row(edges[e].first) + mesh.vertices.row(edges[e].second));
  raised.edge_nodes.resize(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const auto found = std::lower_bound(edges.begin(), edges.end(), ends_of(mesh.tetrahedra[t], e));
      raised.edge_nodes[t][e] = corners + static_cast<Index>(found - edges.begin());
    }
  const EdgeTable table(raised);
  for (Region& region : raised.regions) {
    if (region.dimension > 1) continue;
    sort_unique(region.vertices);
    const std::vector<Index> nodes = table.between(region.vertices);
    region.vertices.insert(region.vertices.end(), nodes.begin(), nodes.end());
    sort_unique(region.vertices);
  }
  return raised;
}

Mesh lowered(Mesh mesh) {
  std::vector<bool> on_edge(static_cast<std::size_t>(mesh.vertices.rows()));
  for (const EdgeNodes& nodes : mesh.edge_nodes)
    for (const Index v : nodes) on_edge[v] = true;
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const Index v : t) on_edge[v] = false;
  const auto is_on_edge = [&](Index v) { return v >= 0 && static_cast<std::size_t>(v) < on_edge.size() && on_edge[v]; };
  for (Region& region : mesh.regions) std::erase_if(region.vertices, is_on_edge);
  mesh.edge_nodes.clear();
  return mesh;
}

}  // namespace softkin
