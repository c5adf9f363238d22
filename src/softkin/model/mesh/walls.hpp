#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// A place of a body's surface, the wall behind it, and the element there.
struct WallSample {
  Index element = -1;       // a tetrahedron
  double area_mm2 = 0;      // of the face
  double thickness_mm = 0;  // from the face's centroid straight inwards to where the body ends
  double across_mm = 0;     // extent of the element through the wall
  double along_mm = 0;      // side of the square of twice the face's area: extent of the element along the wall
};

/// Returns the walls behind faces of tetrahedra on the boundary: of all these faces, or of at most `most` that are
/// distributed evenly over them. Places whose other side is not nearly parallel are left out, as they are edges and no
/// walls. Elements must have positive volume; of order 2 the corners count.
[[nodiscard]] std::vector<WallSample> wall_samples(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra,
                                                   const std::vector<Prism>& prisms, std::size_t most);

/// By how much of its stiffness a wall of tetrahedra of order 1 is too stiff in bending: 1 is twice as stiff.
///
/// returns    (1 + K / (20 G)) (1.75 (across / thickness)^2 + 0.8 (along / thickness)^2) with
///            K / G = 2 (1 + nu) / (3 (1 - 2 nu))
/// source     fitted to loaded bars of regular and free meshes, order 1 against order 2: within a factor of 2.5 up to a
///            Poisson's ratio of 0.45. Beyond, it depends on how elements meet, from a third to four times of it;
///            elements much longer than the wall is thick are less stiff than it predicts
[[nodiscard]] double bending_excess(const WallSample& wall, double poisson_ratio);

}  // namespace softkin
