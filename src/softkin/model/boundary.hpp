#pragma once

#include <softkin/model/mesh.hpp>

namespace softkin {

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
