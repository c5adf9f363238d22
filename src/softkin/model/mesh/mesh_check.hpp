#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// What mesh check finds. Indices are into the mesh's arrays, from 0; elements count tetrahedra first, then prisms.
/// An element is listed once for its worst: a degenerate one is neither negative nor overlapping, and a duplicate is
/// left out of the findings about faces, edges and vertices.
struct MeshCheck {
  std::vector<Index> negative;    // elements whose vertex order is reversed
  std::vector<Index> degenerate;  // elements without volume (below 1e-9 longest edge^3), or prisms that fold over
  std::vector<Index> duplicate_elements;          // same vertices as an earlier element
  std::vector<Index> duplicate_vertices;          // same coordinates as an earlier vertex (within 1e-9 of the diagonal)
  std::vector<Index> unreferenced;                // vertices of no element
  std::vector<std::array<Index, 2>> overlapping;  // elements that lie on the same side of a common face
  std::vector<Triangle> nonmanifold_faces;        // faces of more than two elements
  std::vector<Quad> nonmanifold_quads;            // the same, of prisms
  std::vector<std::array<Index, 2>> nonmanifold_edges;  // boundary edges of more than two boundary faces
  std::vector<Index> nonmanifold_vertices;              // vertices where parts touch in a point only
  std::vector<std::vector<Index>> parts;  // vertices of each part connected through elements, largest first
  std::vector<double>
      quality;  // per element: 1 regular, 0 flat; tetrahedron: 3 * inradius / circumradius, prism: least
                // Jacobian of its corners over their edges' lengths, 2/sqrt(3) times; reversed as if not
};

/// Linear in the number of elements but for sorting. The mesh's indices must be in range. Of elements of order 2 the
/// corners are checked; their edge nodes are no unreferenced vertices and belong to their parts.
[[nodiscard]] MeshCheck check_mesh(const Mesh& mesh);

/// Do two of the elements, all positively oriented, lie on the same side of a common face? True where check_mesh finds
/// duplicate or overlapping elements or nonmanifold faces among them, in a fraction of its time.
///
/// count  of vertices
[[nodiscard]] bool have_common_side(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Tetrahedron>& more,
                                    const std::vector<Prism>& prisms, Index count);

}  // namespace softkin
