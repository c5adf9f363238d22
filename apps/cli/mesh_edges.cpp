#include "mesh_edges.hpp"

#include <algorithm>

namespace softkin::cli {

namespace {

constexpr double farthest = 0.25, even = 1e-3;  // shares of the edge's length

/// Every edge with its node, once, by ascending ends.
std::vector<std::array<Index, 3>> edges_of(const Mesh& mesh) {
  std::vector<std::array<Index, 3>> edges;
  edges.reserve(6 * mesh.edge_nodes.size());
  for (std::size_t t = 0; t < mesh.edge_nodes.size(); ++t)
    for (std::size_t k = 0; k < 6; ++k) {
      const Index a = mesh.tetrahedra[t][static_cast<std::size_t>(tetrahedron_edges[k][0])];
      const Index b = mesh.tetrahedra[t][static_cast<std::size_t>(tetrahedron_edges[k][1])];
      edges.push_back({std::min(a, b), std::max(a, b), mesh.edge_nodes[t][k]});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Nodes that stand on several edges, once each.
std::vector<Index> shared_nodes(const std::vector<std::array<Index, 3>>& edges) {
  std::vector<Index> nodes, shared;
  nodes.reserve(edges.size());
  for (const auto& edge : edges) nodes.push_back(edge[2]);
  std::sort(nodes.begin(), nodes.end());
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i] == nodes[i - 1] && (shared.empty() || shared.back() != nodes[i])) shared.push_back(nodes[i]);
  return shared;
}

}  // namespace

EdgeCheck check_edges(const Mesh& mesh) {
  EdgeCheck check;
  const std::vector<std::array<Index, 3>> edges = edges_of(mesh);
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

}  // namespace softkin::cli
