#include <algorithm>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/element_order.hpp>
#include <utility>

namespace softkin {

namespace {

/// -1 where no tetrahedron has the edge.
Index node_on(const std::vector<EdgeWithNode>& edges, Index a, Index b) {
  const EdgeWithNode first{std::min(a, b), std::max(a, b), -1};
  const auto found = std::lower_bound(edges.begin(), edges.end(), first);
  const bool has = found != edges.end() && (*found)[0] == first[0] && (*found)[1] == first[1];
  return has ? (*found)[2] : -1;
}

Index node_between(const Tetrahedron& corners, const EdgeNodes& nodes, Index a, Index b) {
  for (std::size_t k = 0; k < 6; ++k) {
    const Index first = corners[static_cast<std::size_t>(tetrahedron_edges[k][0])];
    const Index second = corners[static_cast<std::size_t>(tetrahedron_edges[k][1])];
    if ((first == a && second == b) || (first == b && second == a)) return nodes[k];
  }
  return -1;  // a and b are corners of the tetrahedron
}

}  // namespace

int order_of(const Mesh& mesh) {
  return mesh.edge_nodes.empty() ? 1 : 2;
}

std::string refusal_of_orders(std::size_t tetrahedra, std::size_t quadratic, std::size_t prisms) {
  if (quadratic == 0) return "";
  if (quadratic != tetrahedra)
    return "tetrahedra of order 1 and of order 2 in one mesh are not supported: mesh with one order";
  if (prisms > 0) return "tetrahedra of order 2 beside prisms are not supported: mesh with order 1";
  return "";
}

std::vector<EdgeWithNode> edges_with_nodes(const Mesh& mesh) {
  std::vector<EdgeWithNode> edges;
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

std::vector<QuadraticTriangle> quadratic_triangles(const Mesh& mesh) {
  if (mesh.edge_nodes.empty()) return {};
  const std::vector<EdgeWithNode> edges = edges_with_nodes(mesh);
  std::vector<QuadraticTriangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({a, b, c, node_on(edges, a, b), node_on(edges, b, c), node_on(edges, c, a)});
    if (std::count(triangles.back().begin(), triangles.back().end(), -1) > 0) return {};
  }
  return triangles;
}

std::vector<Triangle> boundary_triangles(const std::vector<Tetrahedron>& tetrahedra,
                                         const std::vector<EdgeNodes>& edge_nodes, const std::vector<Prism>& prisms) {
  const Boundary boundary = boundary_of(tetrahedra, prisms);
  if (edge_nodes.empty()) return triangulated(boundary);
  std::vector<Triangle> triangles;
  triangles.reserve(4 * boundary.triangles.size());
  for (std::size_t i = 0; i < boundary.triangles.size(); ++i) {
    const auto& [a, b, c] = boundary.triangles[i];
    const auto owner = static_cast<std::size_t>(boundary.triangle_owners[i]);
    const Index ab = node_between(tetrahedra[owner], edge_nodes[owner], a, b);
    const Index bc = node_between(tetrahedra[owner], edge_nodes[owner], b, c);
    const Index ca = node_between(tetrahedra[owner], edge_nodes[owner], c, a);
    triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return triangles;
}

void reverse(Tetrahedron& tetrahedron, EdgeNodes* edge_nodes) {
  std::swap(tetrahedron[2], tetrahedron[3]);
  if (edge_nodes == nullptr) return;
  std::swap((*edge_nodes)[1], (*edge_nodes)[4]);  // 12 and 13
  std::swap((*edge_nodes)[2], (*edge_nodes)[3]);  // 02 and 03
}

}  // namespace softkin
