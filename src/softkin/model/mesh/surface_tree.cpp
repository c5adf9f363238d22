#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

constexpr double margin = 1e-9;  // in barycentric coordinates: nearer to an edge than this is doubtful

std::vector<Bounds> triangle_bounds(const Points& vertices, const std::vector<Triangle>& triangles) {
  Bounds all;
  for (Index i = 0; i < vertices.rows(); ++i) all.extend(vertex_at(vertices, i));
  const Vec3 padding = Vec3::Constant(vertices.rows() > 0 ? 1e-9 * all.diagonal().norm() : 0);
  std::vector<Bounds> bounds;
  bounds.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    Bounds box;
    for (const Index i : t) box.extend(vertex_at(vertices, i));
    bounds.emplace_back(box.min() - padding, box.max() + padding);
  }
  return bounds;
}

Vec3 nearest_on_segment(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a, offset = point - a;
  const double length2 = edge.squaredNorm();
  const double t = length2 > 0 ? std::clamp(offset.dot(edge) / length2, 0.0, 1.0) : 0.0;
  return a + t * edge;
}

double squared_distance_to_segment(const Vec3& point, const Vec3& a, const Vec3& b) {
  return (point - nearest_on_segment(point, a, b)).squaredNorm();
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

Vec3 nearest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, offset = point - a, normal = u.cross(v);
  const double area2 = normal.squaredNorm();
  if (area2 > 0) {
    const double wb = offset.cross(v).dot(normal), wc = u.cross(offset).dot(normal);
    if (wb >= 0 && wc >= 0 && wb + wc <= area2) return point - offset.dot(normal) / area2 * normal;
  }
  Vec3 nearest = nearest_on_segment(point, a, b);
  for (const Vec3& other : {nearest_on_segment(point, b, c), nearest_on_segment(point, c, a)})
    if ((other - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = other;
  return nearest;
}

std::optional<LineHit> meet_plane(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b,
                                  const Vec3& c) {
  const Vec3 u = b - a, v = c - a, offset = origin - a, normal = u.cross(v);
  const double slope = direction.dot(normal);
  if (!(std::abs(slope) > 1e-12 * direction.norm() * normal.norm())) return std::nullopt;
  const double wb = direction.dot(offset.cross(v)) / slope, wc = direction.dot(u.cross(offset)) / slope;
  return LineHit{-offset.dot(normal) / slope, Vec3(1 - wb - wc, wb, wc)};
}

SurfaceTree::SurfaceTree(const Points& vertices, std::vector<Triangle> triangles)
    : vertices_(vertices), triangles_(std::move(triangles)), tree_(triangle_bounds(vertices_, triangles_)) {}

std::optional<double> SurfaceTree::first_hit(const Vec3& origin, const Vec3& direction, double after,
                                             Index* triangle) const {
  std::optional<double> first;
  tree_.visit_ray(origin, direction, [&](Index item) {
    const Triangle& t = triangles_[item];
    const auto hit = meet_plane(origin, direction, vertex_at(vertices_, t[0]), vertex_at(vertices_, t[1]),
                                vertex_at(vertices_, t[2]));
    if (hit && hit->weights.minCoeff() >= -margin && hit->t > after && (!first || hit->t < *first)) {
      first = hit->t;
      if (triangle != nullptr) *triangle = item;
    }
    return true;
  });
  return first;
}

double SurfaceTree::distance(const Vec3& point) const {
  double nearest2 = std::numeric_limits<double>::infinity();
  tree_.visit_near(point, [&](Index item) {
    const Triangle& t = triangles_[item];
    nearest2 = std::min(nearest2, squared_distance_to_triangle(point, vertex_at(vertices_, t[0]),
                                                               vertex_at(vertices_, t[1]), vertex_at(vertices_, t[2])));
    return nearest2;
  });
  return std::sqrt(nearest2);
}

Vec3 SurfaceTree::nearest(const Vec3& point, Index* triangle) const {
  Vec3 found = point;
  double least = std::numeric_limits<double>::infinity();
  tree_.visit_near(point, [&](Index item) {
    const Triangle& t = triangles_[item];
    const Vec3 near =
        nearest_on_triangle(point, vertex_at(vertices_, t[0]), vertex_at(vertices_, t[1]), vertex_at(vertices_, t[2]));
    if (const double distance2 = (near - point).squaredNorm(); distance2 < least) {
      least = distance2;
      found = near;
      if (triangle) *triangle = item;
    }
    return least;
  });
  return found;
}

std::optional<bool> SurfaceTree::crosses_oddly(const Vec3& point, const Vec3& direction) const {
  bool odd = false, clear = true;
  tree_.visit_ray(point, direction, [&](Index item) {
    const Triangle& t = triangles_[item];
    const auto hit = meet_plane(point, direction, vertex_at(vertices_, t[0]), vertex_at(vertices_, t[1]),
                                vertex_at(vertices_, t[2]));
    const double inside = hit ? hit->weights.minCoeff() : 0;
    if (std::abs(inside) < margin) return clear = false;
    if (inside > 0 && hit->t > 0) odd = !odd;
    return true;
  });
  return clear ? std::optional<bool>(odd) : std::nullopt;
}

double SurfaceTree::winding_number(const Vec3& point) const {
  double solid_angle = 0;
  for (const Triangle& t : triangles_) {
    const Vec3 a = vertex_at(vertices_, t[0]) - point, b = vertex_at(vertices_, t[1]) - point,
               c = vertex_at(vertices_, t[2]) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return solid_angle / (4 * std::numbers::pi);
}

bool SurfaceTree::contains(const Vec3& point) const {
  if (!tree_.contains(point)) return false;
  // directions that no designed part is likely to be aligned with
  static const Vec3 directions[] = {{0.8371, 0.4127, 0.3589}, {-0.2953, 0.9013, 0.3163}, {0.1789, -0.3371, 0.9241}};
  for (const Vec3& direction : directions)
    if (const auto odd = crosses_oddly(point, direction)) return *odd;
  return std::abs(winding_number(point)) > 0.5;
}

}  // namespace softkin
