#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Corners of the faces of an element, in the order that makes the normal point outwards.
inline constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
inline constexpr int prism_triangles[2][3] = {{0, 2, 1}, {3, 4, 5}};
inline constexpr int prism_quads[3][4] = {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};

/// Faces that belong to exactly one of the elements, vertices in the order that makes the normal point outwards
/// (for positively oriented elements), and whose face it is: elements are numbered tetrahedra first, then prisms.
struct Boundary {
  std::vector<Triangle> triangles;
  std::vector<Index> triangle_owners;
  std::vector<Quad> quads;
  std::vector<Index> quad_owners;
};

[[nodiscard]] Boundary boundary_of(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms);

/// The boundary as triangles, quads split along their first diagonal; owners (if given) run along.
[[nodiscard]] std::vector<Triangle> triangulated(const Boundary& boundary, std::vector<Index>* owners = nullptr);

}  // namespace softkin
