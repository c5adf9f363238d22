#pragma once

#include <array>
#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// A piece of a triangle surface: triangles that are connected by edges of two triangles.
struct Shell {
  std::vector<Index> triangles;  // of the surface, ascending
  bool closed = true;            // every edge is passed equally often in both senses
  double volume = 0;             // enclosed, positive where the normals point outwards [mm^3]
  Vec3 center{0, 0, 0};          // of the enclosed volume; of the vertices where there is none [mm]
  Bounds bounds;
};

/// Returns the pieces of a surface, in the order of their first triangles.
[[nodiscard]] std::vector<Shell> shells_of(const Points& vertices, const std::vector<Triangle>& triangles);

/// Returns the triangles, oriented so that neighbours agree and the normals of each piece point outwards.
///
/// throws  InvalidInput where the surface has no triangle or names a vertex that is not there; naming the place [mm],
///         where it has a rim or an edge of more than two triangles, one side only, or encloses no volume
[[nodiscard]] std::vector<Triangle> turned_outwards(const Points& vertices, std::vector<Triangle> triangles);
/// The same where pieces may be flat, as an empty bag: in these neighbours agree, and the first triangle determines the
/// outer side.
[[nodiscard]] std::vector<Triangle> turned_outwards_or_flat(const Points& vertices, std::vector<Triangle> triangles);

/// Returns the triangles of a surface that may be open, oriented so that neighbours agree.
///
/// throws  InvalidInput as turned_outwards, but not on a rim or on a surface that encloses no volume
[[nodiscard]] std::vector<Triangle> turned_alike(const Points& vertices, std::vector<Triangle> triangles);
/// Returns the rim of a surface: edges of one triangle alone, from end to end as that triangle passes them.
[[nodiscard]] std::vector<std::array<Index, 2>> rim_of(const std::vector<Triangle>& triangles);

/// An empty space that elements enclose, bounded by a piece of their boundary.
struct EmptySpace {
  std::vector<Triangle> triangles;  // corners of its faces (quads split), normals out of the space
  double volume = 0;                // by the corners [mm^3]
  Vec3 center{0, 0, 0};             // of the volume [mm]
  Bounds bounds;
};

/// Returns the empty spaces, the largest first. Elements may have either orientation.
[[nodiscard]] std::vector<EmptySpace> empty_spaces_in(const Points& vertices,
                                                      const std::vector<Tetrahedron>& tetrahedra,
                                                      const std::vector<Prism>& prisms);

/// "1000 mm^3 (12 faces) around (15, 15, 15) mm"
[[nodiscard]] std::string text_of(const EmptySpace& space);

}  // namespace softkin
