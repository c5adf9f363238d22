#pragma once

#include <cstddef>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <vector>

namespace softkin {

/// 1 or 2
[[nodiscard]] int order_of(const Mesh& mesh);

/// Why a mesh of so many tetrahedra, of which so many are of order 2, and prisms cannot be read or written, or "".
[[nodiscard]] std::string refusal_of_orders(std::size_t tetrahedra, std::size_t quadratic, std::size_t prisms);

/// An edge of tetrahedra of order 2: its ends, ascending, and the node on it.
using EdgeWithNode = std::array<Index, 3>;

/// Every edge with its node, once, by ascending ends; one that has several nodes is there as often. Order 1: none.
[[nodiscard]] std::vector<EdgeWithNode> edges_with_nodes(const Mesh& mesh);

/// A triangle of order 2: its corners, then the nodes on its edges 01, 12, 20.
using QuadraticTriangle = std::array<Index, 6>;

/// The triangles with the nodes on their edges, where every edge is one of a tetrahedron of order 2; else nothing.
[[nodiscard]] std::vector<QuadraticTriangle> quadratic_triangles(const Mesh& mesh);

/// Boundary as flat triangles with normals outwards (for positively oriented elements): quads in two, faces of order 2
/// in four. edge_nodes: of every tetrahedron, or empty.
[[nodiscard]] std::vector<Triangle> boundary_triangles(const std::vector<Tetrahedron>& tetrahedra,
                                                       const std::vector<EdgeNodes>& edge_nodes,
                                                       const std::vector<Prism>& prisms);

/// The tetrahedron in the opposite orientation.
void reverse(Tetrahedron& tetrahedron, EdgeNodes* edge_nodes);

}  // namespace softkin
