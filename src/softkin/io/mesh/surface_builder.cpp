#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/mesh/surface_builder.hpp>
#include <utility>

namespace softkin {

namespace {

using Vec2 = Eigen::Vector2d;

constexpr double max_off_plane = 0.05;    // of a polygon's vertex, over its size
constexpr double min_part = 1e-12;        // of a polygon's area that a triangle of it has
constexpr std::size_t max_corners = 500;  // of a polygon that is not convex

Vec3 vector_of(const SurfaceCorner& corner) {
  return {corner[0], corner[1], corner[2]};
}

double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Triangles of a polygon in its plane, counterclockwise.
class Polygon {
 public:
  Polygon(std::vector<Vec2> points, double double_area) : points_(std::move(points)), area_(double_area) {}

  using Corners = std::array<std::size_t, 3>;

  /// From one corner to all others; nothing where a triangle would have no area or be turned over.
  [[nodiscard]] std::vector<Corners> fan() const {
    std::vector<Corners> triangles;
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
      if (!(area(0, i, i + 1) > min_part * area_)) return {};
      triangles.push_back({0, i, i + 1});
    }
    return triangles;
  }

  /// Cuts off corner after corner, of those that can be the roundest; nothing where none can.
  [[nodiscard]] std::vector<Corners> ears() const {
    std::vector<std::size_t> left(points_.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
    std::vector<Corners> triangles;
    double rest = area_;
    while (left.size() > 3) {
      std::size_t best = left.size();
      double roundest = 0;
      for (std::size_t i = 0; i < left.size(); ++i) {
        const Corners ear = at(left, i);
        const double own = area(ear[0], ear[1], ear[2]);
        const bool fits = own > min_part * area_ && rest - own > min_part * area_ && !holds_another(left, ear);
        if (fits && roundness(ear) > roundest) {
          roundest = roundness(ear);
          best = i;
        }
      }
      if (best == left.size()) return {};
      const Corners ear = at(left, best);
      triangles.push_back(ear);
      rest -= area(ear[0], ear[1], ear[2]);
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
    if (!(area(left[0], left[1], left[2]) > min_part * area_)) return {};
    triangles.push_back({left[0], left[1], left[2]});
    return triangles;
  }

 private:
  static Corners at(const std::vector<std::size_t>& left, std::size_t i) {
    return {left[(i + left.size() - 1) % left.size()], left[i], left[(i + 1) % left.size()]};
  }

  [[nodiscard]] double area(std::size_t a, std::size_t b, std::size_t c) const {
    return cross(points_[a], points_[b], points_[c]);
  }

  [[nodiscard]] double roundness(const Corners& t) const {
    const double longest =
        std::max({(points_[t[1]] - points_[t[0]]).squaredNorm(), (points_[t[2]] - points_[t[1]]).squaredNorm(),
                  (points_[t[0]] - points_[t[2]]).squaredNorm()});
    return area(t[0], t[1], t[2]) / longest;
  }

  [[nodiscard]] bool holds_another(const std::vector<std::size_t>& left, const Corners& t) const {
    return std::any_of(left.begin(), left.end(), [&](std::size_t p) {
      if (p == t[0] || p == t[1] || p == t[2]) return false;
      return area(t[0], t[1], p) >= 0 && area(t[1], t[2], p) >= 0 && area(t[2], t[0], p) >= 0;
    });
  }

  std::vector<Vec2> points_;
  double area_;  // twice
};

}  // namespace

Vec3 facet_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  const double longest = std::max({u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff(), (c - b).cwiseAbs().maxCoeff()});
  if (!(longest > 0) || !std::isfinite(longest)) return Vec3::Zero();
  const Vec3 normal = (u / longest).cross(v / longest);
  return normal.norm() > 1e-12 ? normal : Vec3::Zero();
}

std::size_t Welder::Hash::operator()(const SurfaceCorner& point) const {
  std::size_t hash = 0;
  for (const double x : point) hash = hash * 0x9E3779B97F4A7C15u + std::hash<double>{}(x);
  return hash;
}

Index Welder::vertex(SurfaceCorner point) {
  for (double& x : point) x += 0.0;  // -0 becomes 0
  const auto [found, is_new] = known_.try_emplace(point, static_cast<Index>(known_.size()));
  if (is_new) coordinates_.insert(coordinates_.end(), point.begin(), point.end());
  return found->second;
}

void Welder::add(const FacetCorners& corners) {
  Triangle triangle;
  std::transform(corners.begin(), corners.end(), triangle.begin(), [&](const auto& c) { return vertex(c); });
  triangles_.push_back(triangle);
}

TriangleSurface Welder::surface() && {
  TriangleSurface result;
  result.vertices = Eigen::Map<const Points>(coordinates_.data(), static_cast<Index>(coordinates_.size() / 3), 3);
  result.triangles = std::move(triangles_);
  return result;
}

std::vector<FacetCorners> triangulated(std::vector<SurfaceCorner> polygon,
                                       const std::function<void(const std::string&)>& fail) {
  polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
  while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
  const std::size_t count = polygon.size();
  if (count < 3) return {};
  const Vec3 first = vector_of(polygon[0]);
  double size = 0;  // largest difference of coordinates from the first corner's
  for (const SurfaceCorner& corner : polygon) size = std::max(size, (vector_of(corner) - first).cwiseAbs().maxCoeff());
  if (!std::isfinite(size)) fail("has coordinates that are too large");
  std::vector<Vec3> arms;  // to the corners, over the size
  for (const SurfaceCorner& corner : polygon) arms.push_back((vector_of(corner) - first) / size);
  Vec3 normal = Vec3::Zero();  // twice the area
  for (std::size_t i = 1; i + 1 < count; ++i) normal += arms[i].cross(arms[i + 1]);
  const double area = normal.norm();
  if (!(area > 1e-12)) fail("has no area");
  if (count == 3) return {FacetCorners{polygon[0], polygon[1], polygon[2]}};
  normal /= area;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& arm : arms) middle += arm / static_cast<double>(count);
  double farthest = 0;
  for (const Vec3& arm : arms) farthest = std::max(farthest, std::abs(normal.dot(arm - middle)));
  if (farthest > max_off_plane)
    fail("is not planar: a vertex lies " + number(100 * farthest, 2) +
         " % of its size off its mean plane, more than 5 %: cut it into triangles");
  const Vec3 along = normal.unitOrthogonal(), across = normal.cross(along);
  std::vector<Vec2> points;
  for (const Vec3& arm : arms) points.emplace_back(along.dot(arm), across.dot(arm));
  const Polygon flat(std::move(points), area);
  std::vector<Polygon::Corners> triangles = flat.fan();
  if (triangles.empty() && count > max_corners)
    fail("is not convex and has more than " + std::to_string(max_corners) + " corners: cut it into triangles");
  if (triangles.empty()) triangles = flat.ears();
  if (triangles.empty()) fail("crosses itself or touches itself: cut it into triangles");
  std::vector<FacetCorners> facets;
  for (const auto& [a, b, c] : triangles) facets.push_back({polygon[a], polygon[b], polygon[c]});
  return facets;
}

}  // namespace softkin
