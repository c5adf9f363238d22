#pragma once

#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>

namespace softkin {

/// A prism as three tetrahedra, split along the diagonals from its smallest vertex index, so that neighbours agree.
[[nodiscard]] std::array<Tetrahedron, 3> split(const Prism& prism);

/// A tetrahedron of order 2 as eight with straight edges: one at each corner, four between.
[[nodiscard]] std::array<Tetrahedron, 8> split(const Tetrahedron& corners, const EdgeNodes& edge_nodes);

/// A box around each.
[[nodiscard]] std::vector<Bounds> bounds_of(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra);

/// Coordinates of a point in a tetrahedron with these corners; they are not finite where it has no volume.
[[nodiscard]] Barycentric barycentric(const Vec3 (&corners)[4], const Vec3& point);

}  // namespace softkin
