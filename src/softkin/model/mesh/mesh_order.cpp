#include <softkin/core/error.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <tuple>
#include <utility>

namespace softkin {

namespace {

using Ends = std::pair<Index, Index>;  // of an edge, ascending

Ends ends_of(const Tetrahedron& element, int edge) {
  return std::minmax({element[tetrahedron_edges[edge][0]], element[tetrahedron_edges[edge][1]]});
}

/// Edges of triangles that are none of these.
std::vector<Ends> edges_beside(const std::vector<Triangle>& triangles, const std::vector<Ends>& ascending) {
  std::vector<Ends> edges;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Ends ends = std::minmax(t[k], t[(k + 1) % 3]);
      if (!std::binary_search(ascending.begin(), ascending.end(), ends)) edges.push_back(ends);
    }
  sort_unique(edges);
  return edges;
}

std::vector<Ends> edges_of(const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<Ends> edges;
  edges.reserve(6 * tetrahedra.size());
  for (const Tetrahedron& t : tetrahedra)
    for (int e = 0; e < 6; ++e) edges.push_back(ends_of(t, e));
  sort_unique(edges);
  return edges;
}

bool same_ends(const EdgeWithNode& a, const EdgeWithNode& b) {
  return a[0] == b[0] && a[1] == b[1];
}

/// -1 where no edge has these ends.
Index node_on(const std::vector<EdgeWithNode>& edges, Index a, Index b) {
  const EdgeWithNode first{std::min(a, b), std::max(a, b), -1};
  const auto found = std::lower_bound(edges.begin(), edges.end(), first);
  return found != edges.end() && same_ends(*found, first) ? (*found)[2] : -1;
}

std::array<Index, 3> nodes_on(const std::vector<EdgeWithNode>& edges, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return {node_on(edges, a, b), node_on(edges, b, c), node_on(edges, c, a)};
}

}  // namespace

int order_of(const Mesh& mesh) {
  return mesh.edge_nodes.empty() && mesh.sheet_edges.empty() ? 1 : 2;
}

std::string refusal_of_orders(std::size_t tetrahedra, std::size_t quadratic, std::size_t prisms) {
  if (quadratic == 0) return "";
  if (quadratic != tetrahedra)
    return "tetrahedra of order 1 and of order 2 in one mesh are not supported: mesh with one order";
  if (prisms > 0) return "tetrahedra of order 2 beside prisms are not supported: mesh with order 1";
  return "";
}

std::vector<EdgeWithNode> edges_with_nodes(const Mesh& mesh) {
  std::vector<EdgeWithNode> edges = mesh.sheet_edges;
  edges.reserve(edges.size() + 6 * mesh.edge_nodes.size());
  for (std::size_t t = 0; t < mesh.edge_nodes.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const auto [low, high] = ends_of(mesh.tetrahedra[t], e);
      edges.push_back({low, high, mesh.edge_nodes[t][e]});
    }
  sort_unique(edges);
  return edges;
}

EdgeTable::EdgeTable(const Mesh& mesh) : edges_(edges_with_nodes(mesh)) {
  if (const auto twice = std::adjacent_find(edges_.begin(), edges_.end(), same_ends); twice != edges_.end()) {
    const auto& [low, high, node] = *twice;
    throw InvalidInput("the edge between the vertices " + std::to_string(low) + " and " + std::to_string(high) +
                       " (from 0) has two nodes, " + std::to_string(node) + " and " +
                       std::to_string((*std::next(twice))[2]));
  }
  std::vector<Index> nodes;
  nodes.reserve(edges_.size());
  for (const EdgeWithNode& edge : edges_) nodes.push_back(edge[2]);
  std::sort(nodes.begin(), nodes.end());
  if (const auto shared = std::adjacent_find(nodes.begin(), nodes.end()); shared != nodes.end())
    throw InvalidInput("vertex " + std::to_string(*shared) + " (from 0) is the node of two edges");
}

Index EdgeTable::find(Index a, Index b) const {
  return node_on(edges_, a, b);
}

std::array<Index, 3> EdgeTable::of(const Triangle& triangle) const {
  return nodes_on(edges_, triangle);
}

std::vector<Index> EdgeTable::between(const std::vector<Index>& vertices) const {
  const auto held = [&](Index v) { return std::binary_search(vertices.begin(), vertices.end(), v); };
  std::vector<Index> nodes;
  for (const auto& [low, high, node] : edges_)
    if (held(low) && held(high)) nodes.push_back(node);
  return nodes;
}

void exchange_corners_2_and_3(EdgeNodes& edge_nodes) {
  // 01 and 23 stay, 12 becomes 13, 02 becomes 03
  std::swap(edge_nodes[1], edge_nodes[4]);
  std::swap(edge_nodes[2], edge_nodes[3]);
}

Index edge_node(const Tetrahedron& element, const EdgeNodes& edge_nodes, Index a, Index b) {
  for (int e = 0; e < 6; ++e)
    if (ends_of(element, e) == Ends(std::minmax(a, b))) return edge_nodes[e];
  throw InvalidInput("the vertices " + std::to_string(a) + " and " + std::to_string(b) +
                     " (from 0) are no edge of the element");
}

std::vector<QuadraticTriangle> quadratic_triangles(const Mesh& mesh) {
  const std::vector<EdgeWithNode> edges = edges_with_nodes(mesh);
  std::vector<QuadraticTriangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const Triangle& corners : mesh.triangles) {
    const std::array<Index, 3> nodes = nodes_on(edges, corners);
    if (std::count(nodes.begin(), nodes.end(), -1) > 0) return {};
    triangles.push_back({corners[0], corners[1], corners[2], nodes[0], nodes[1], nodes[2]});
  }
  return triangles;
}

std::array<Triangle, 4> quarters(const Triangle& corners, const std::array<Index, 3>& edges) {
  const auto& [a, b, c] = corners;
  const auto& [ab, bc, ca] = edges;
  return {{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}};
}

std::vector<Triangle> boundary_triangles(const std::vector<Tetrahedron>& tetrahedra,
                                         const std::vector<EdgeNodes>& edge_nodes, const std::vector<Prism>& prisms,
                                         std::vector<Index>* owners) {
  const Boundary boundary = boundary_of(tetrahedra, prisms);
  if (edge_nodes.empty()) return triangulated(boundary, owners);
  std::vector<Triangle> triangles;
  triangles.reserve(4 * boundary.triangles.size());
  for (std::size_t i = 0; i < boundary.triangles.size(); ++i) {
    const auto& [a, b, c] = boundary.triangles[i];
    const std::size_t owner = boundary.triangle_owners[i];
    const auto node = [&](Index from, Index to) { return edge_node(tetrahedra[owner], edge_nodes[owner], from, to); };
    const std::array<Triangle, 4> parts = quarters(boundary.triangles[i], {node(a, b), node(b, c), node(c, a)});
    triangles.insert(triangles.end(), parts.begin(), parts.end());
    if (owners) owners->insert(owners->end(), 4, boundary.triangle_owners[i]);
  }
  return triangles;
}

Mesh elevated(const Mesh& mesh) {
  if (!mesh.prisms.empty()) throw InvalidInput("a mesh with prisms cannot be of order 2: prisms are linear");
  if (order_of(mesh) == 2) throw InvalidInput("the mesh is of order 2 already");
  Mesh raised = mesh;
  const std::vector<Ends> edges = edges_of(mesh.tetrahedra);
  const std::vector<Ends> beside = edges_beside(mesh.triangles, edges);
  const Index corners = mesh.vertices.rows();
  raised.vertices.conservativeResize(corners + static_cast<Index>(edges.size() + beside.size()), 3);
  Index next = corners;
  const auto add_node = [&](const Ends& ends) {
    raised.vertices.row(next) = 0.5 * (mesh.vertices.row(ends.first) + mesh.vertices.row(ends.second));
    return next++;
  };
  for (const Ends& ends : edges) add_node(ends);
  for (const Ends& ends : beside) raised.sheet_edges.push_back({ends.first, ends.second, add_node(ends)});
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
  std::vector<bool> on_edge(mesh.vertices.rows());
  for (const EdgeNodes& nodes : mesh.edge_nodes)
    for (const Index v : nodes) on_edge[v] = true;
  for (const auto& edge : mesh.sheet_edges) on_edge[edge[2]] = true;
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const Index v : t) on_edge[v] = false;
  const auto is_on_edge = [&](Index v) { return v >= 0 && static_cast<std::size_t>(v) < on_edge.size() && on_edge[v]; };
  for (Region& region : mesh.regions) std::erase_if(region.vertices, is_on_edge);
  mesh.edge_nodes.clear();
  mesh.sheet_edges.clear();
  return mesh;
}

}  // namespace softkin
