#pragma once

#include <cstddef>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <vector>

namespace softkin {

/// 1 or 2
[[nodiscard]] int order_of(const Mesh& mesh);

/// Returns why a mesh of these numbers of tetrahedra, those of order 2 among them, and prisms cannot be read or
/// written, or "".
[[nodiscard]] std::string refusal_of_orders(std::size_t tetrahedra, std::size_t quadratic, std::size_t prisms);
/// The same of a Mesh, or of a type with the same arrays of elements.
template <class Elements>
[[nodiscard]] std::string refusal_of_orders(const Elements& mesh) {
  return refusal_of_orders(mesh.tetrahedra.size(), mesh.edge_nodes.size(), mesh.prisms.size());
}

/// Every edge with its node, once, by ascending ends; one that has several nodes is there as often. Order 1: none.
[[nodiscard]] std::vector<EdgeWithNode> edges_with_nodes(const Mesh& mesh);

/// The nodes of a mesh of order 2 by the ends of their edges; empty for one of order 1.
class EdgeTable {
 public:
  /// The mesh's indices must be in range.
  /// throws  InvalidInput where an edge has different nodes in two elements, or two edges have the same node
  explicit EdgeTable(const Mesh& mesh);

  [[nodiscard]] bool empty() const { return edges_.empty(); }
  /// The node between two corners, or -1 where no element and no sheet has the edge.
  [[nodiscard]] Index find(Index a, Index b) const;
  /// The nodes on the edges 01, 12, 20 of a triangle; -1 as in find().
  [[nodiscard]] std::array<Index, 3> of(const Triangle& triangle) const;
  /// The nodes of the edges both of whose ends are among the vertices, which are in ascending order.
  [[nodiscard]] std::vector<Index> between(const std::vector<Index>& vertices) const;

 private:
  std::vector<EdgeWithNode> edges_;
};

/// Reorders the edge nodes of an element as exchanging its corners 2 and 3 does.
void exchange_corners_2_and_3(EdgeNodes& edge_nodes);

/// The node on the edge between two corners of an element, which must be there.
[[nodiscard]] Index edge_node(const Tetrahedron& element, const EdgeNodes& edge_nodes, Index a, Index b);

/// A triangle of order 2: its corners, then the nodes on its edges 01, 12, 20.
using QuadraticTriangle = std::array<Index, 6>;

/// The triangles with the nodes on their edges, where every edge has one; else nothing.
[[nodiscard]] std::vector<QuadraticTriangle> quadratic_triangles(const Mesh& mesh);

/// A triangle of order 2 as four flat ones, the last of which lies between the nodes on its edges.
[[nodiscard]] std::array<Triangle, 4> quarters(const Triangle& corners, const std::array<Index, 3>& edges);

/// Boundary as flat triangles with normals outwards (for positively oriented elements): quads in two, faces of order 2
/// in four, the last of which lies between the nodes on its edges. edge_nodes: of every tetrahedron, or empty.
///
/// owners  if given: whose face each is of, tetrahedra first
[[nodiscard]] std::vector<Triangle> boundary_triangles(const std::vector<Tetrahedron>& tetrahedra,
                                                       const std::vector<EdgeNodes>& edge_nodes,
                                                       const std::vector<Prism>& prisms,
                                                       std::vector<Index>* owners = nullptr);

/// A mesh of order 1 with a node in the middle of every edge of a tetrahedron or a triangle, shared by them, after the
/// vertices that it had. Regions of dimension 1 and 0 get the nodes of the edges both of whose ends they hold.
/// The mesh's indices must be in range.
///
/// throws  InvalidInput where the mesh has prisms or is of order 2 already
[[nodiscard]] Mesh elevated(const Mesh& mesh);

/// A mesh of order 2 without its edge nodes: they stay as vertices of no element, in no region.
[[nodiscard]] Mesh lowered(Mesh mesh);

}  // namespace softkin
