#pragma once

#include <optional>
#include <softkin/core/types.hpp>

namespace softkin {

[[nodiscard]] inline Vec3 vertex_at(const Points& points, Index i) {
  return points.row(i).transpose();
}

/// Squared distance from a point to the triangle a b c [mm^2]; a triangle without area counts as its edges.
[[nodiscard]] double squared_distance_to_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// Where the line origin + t direction meets the plane of a triangle: t, and the barycentric coordinates there.
struct LineHit {
  double t = 0;
  Vec3 weights;
};

/// Nothing where the line is parallel to the triangle (within 1e-12) or the triangle has no area.
[[nodiscard]] std::optional<LineHit> meet_plane(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b,
                                                const Vec3& c);

}  // namespace softkin
