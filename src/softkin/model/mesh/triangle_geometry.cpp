#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/model/mesh/triangle_geometry.hpp>

namespace softkin {

namespace {

double squared_distance_to_segment(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a, offset = point - a;
  const double length2 = edge.squaredNorm();
  const double t = length2 > 0 ? std::clamp(offset.dot(edge) / length2, 0.0, 1.0) : 0.0;
  return (offset - t * edge).squaredNorm();
}

}  // namespace

double squared_distance_to_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, offset = point - a, normal = u.cross(v);
  const double area2 = normal.squaredNorm();
  if (area2 > 0) {
    const double wb = offset.cross(v).dot(normal), wc = u.cross(offset).dot(normal);
    if (wb >= 0 && wc >= 0 && wb + wc <= area2) {
      const double height = offset.dot(normal);
      return height * height / area2;
    }
  }
  return std::min({squared_distance_to_segment(point, a, b), squared_distance_to_segment(point, b, c),
                   squared_distance_to_segment(point, c, a)});
}

std::optional<LineHit> meet_plane(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b,
                                  const Vec3& c) {
  const Vec3 u = b - a, v = c - a, offset = origin - a, normal = u.cross(v);
  const double slope = direction.dot(normal);
  if (!(std::abs(slope) > 1e-12 * direction.norm() * normal.norm())) return std::nullopt;
  const double wb = direction.dot(offset.cross(v)) / slope, wc = direction.dot(u.cross(offset)) / slope;
  return LineHit{-offset.dot(normal) / slope, Vec3(1 - wb - wc, wb, wc)};
}

}  // namespace softkin
