#include <algorithm>
#include <softkin/io/mesh/element_order.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <tuple>
#include <utility>

namespace softkin {

namespace {

/// Edges of tetrahedra of order 2 with the nodes on them.
class EdgeTable {
 public:
  explicit EdgeTable(const Mesh& mesh) {
    rows_.reserve(6 * mesh.edge_nodes.size());
    for (std::size_t e = 0; e < mesh.edge_nodes.size(); ++e)
      for (std::size_t k = 0; k < 6; ++k) {
        const auto& [a, b] = tetrahedron_edges[k];
        rows_.push_back(row(mesh.tetrahedra[e][static_cast<std::size_t>(a)],
                            mesh.tetrahedra[e][static_cast<std::size_t>(b)], mesh.edge_nodes[e][k]));
      }
    std::sort(rows_.begin(), rows_.end());
  }

  /// -1 where no tetrahedron has the edge.
  [[nodiscard]] Index node_on(Index a, Index b) const {
    const auto found = std::lower_bound(rows_.begin(), rows_.end(), row(a, b, -1));
    const bool has = found != rows_.end() && row(a, b, std::get<2>(*found)) == *found;
    return has ? std::get<2>(*found) : -1;
  }

 private:
  using Row = std::tuple<Index, Index, Index>;  // corners, ascending; node

  static Row row(Index a, Index b, Index node) { return {std::min(a, b), std::max(a, b), node}; }

  std::vector<Row> rows_;
};

Index node_between(const Tetrahedron& corners, const EdgeNodes& nodes, Index a, Index b) {
  for (std::size_t k = 0; k < 6; ++k) {
    const Index first = corners[static_cast<std::size_t>(tetrahedron_edges[k][0])];
    const Index second = corners[static_cast<std::size_t>(tetrahedron_edges[k][1])];
    if ((first == a && second == b) || (first == b && second == a)) return nodes[k];
  }
  return -1;  // a and b are corners of the tetrahedron
}

}  // namespace

std::string refusal_of_orders(std::size_t tetrahedra, std::size_t quadratic, std::size_t prisms) {
  if (quadratic == 0) return "";
  if (quadratic != tetrahedra)
    return "tetrahedra of order 1 and of order 2 in one mesh are not supported: mesh with one order";
  if (prisms > 0) return "tetrahedra of order 2 beside prisms are not supported: mesh with order 1";
  return "";
}

std::vector<QuadraticTriangle> quadratic_triangles(const Mesh& mesh) {
  if (mesh.edge_nodes.empty()) return {};
  const EdgeTable edges(mesh);
  std::vector<QuadraticTriangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({a, b, c, edges.node_on(a, b), edges.node_on(b, c), edges.node_on(c, a)});
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
