#pragma once

#include <softkin/model/mesh/mesh.hpp>
#include <vector>

namespace softkin {

/// solid: a volume. flat: the points lie in a plane. line: on a line. point: they are one point.
enum class HullShape { solid, flat, line, point };

/// Convex hull of points.
struct Hull {
  HullShape shape = HullShape::point;  // a solid, flat, a line or a point
  Points vertices;                     // corners of the hull [mm]; line: its two ends
  std::vector<Triangle> triangles;     // solid: its surface, normals outwards; flat: its area, in one sense; else none
  double volume = 0;                   // solid [mm^3]
  double area = 0;                     // of the surface, or of one side where flat [mm^2]
  Vec3 extents = Vec3::Zero();         // along the principal axes of the points, descending [mm]
};

/// Points that are less than 1e-6 of their largest extent off a plane (or line) count as in it.
///
/// source  Barber, Dobkin, Huhdanpaa 1996 (Qhull)
/// throws  InvalidInput on no points or one that is not finite
[[nodiscard]] Hull convex_hull(const Points& points);

}  // namespace softkin
