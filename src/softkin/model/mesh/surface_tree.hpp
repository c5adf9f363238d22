#pragma once

#include <optional>
#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Squared distance from a point to the triangle a b c [mm^2]; a triangle without area counts as its edges.
[[nodiscard]] double squared_distance_to_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// The point of a triangle that is nearest to another point; of one without area that of its edges.
[[nodiscard]] Vec3 nearest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// Where the line origin + t direction meets the plane of a triangle: t, and the barycentric coordinates there.
struct LineHit {
  double t = 0;
  Vec3 weights;
};

/// Nothing where the line is parallel to the triangle (within 1e-12) or the triangle has no area.
[[nodiscard]] std::optional<LineHit> meet_plane(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b,
                                                const Vec3& c);

/// A triangle surface for intersections with rays and, if it is closed, for whether a point is inside.
class SurfaceTree {
 public:
  SurfaceTree(const Points& vertices, std::vector<Triangle> triangles);

  /// The least t > after at which origin + t direction meets the surface; direction need not have length 1.
  /// triangle: if given, the one that is met there
  [[nodiscard]] std::optional<double> first_hit(const Vec3& origin, const Vec3& direction, double after,
                                                Index* triangle = nullptr) const;

  /// From the point to the surface [mm].
  [[nodiscard]] double distance(const Vec3& point) const;

  /// The point of the surface that is nearest to another one. triangle: if given, the one that it is of; the surface
  /// must have some
  [[nodiscard]] Vec3 nearest(const Vec3& point, Index* triangle = nullptr) const;

  /// Whether the point lies inside; the surface must be closed.
  [[nodiscard]] bool contains(const Vec3& point) const;

 private:
  [[nodiscard]] std::optional<bool> crosses_oddly(const Vec3& point, const Vec3& direction) const;
  [[nodiscard]] double winding_number(const Vec3& point) const;

  Points vertices_;
  std::vector<Triangle> triangles_;
  BoxTree tree_;
};

}  // namespace softkin
