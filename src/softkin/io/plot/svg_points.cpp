#include <cmath>
#include <set>
#include <softkin/io/plot/svg_points.hpp>
#include <utility>

namespace softkin {

std::vector<SvgPoint> apart_along(const std::vector<SvgPoint>& points, double distance) {
  std::vector<SvgPoint> kept;
  for (const SvgPoint& point : points)
    if (kept.empty() || std::hypot(point.x - kept.back().x, point.y - kept.back().y) >= distance) kept.push_back(point);
  return kept;
}

std::vector<SvgPoint> thinned_line(const std::vector<SvgPoint>& points) {
  constexpr double unseen = 0.25;  // [pixel]
  std::vector<SvgPoint> kept = apart_along(points, unseen);
  if (points.empty()) return kept;
  if (kept.size() == 1 || kept.back().x != points.back().x || kept.back().y != points.back().y)
    kept.push_back(points.back());
  return kept;
}

std::vector<SvgPoint> apart_on_grid(const std::vector<SvgPoint>& points) {
  constexpr double cell = 0.5;  // [pixel]
  std::set<std::pair<double, double>> taken;
  std::vector<SvgPoint> kept;
  for (const SvgPoint& point : points)
    if (taken.emplace(std::floor(point.x / cell), std::floor(point.y / cell)).second) kept.push_back(point);
  return kept;
}

}  // namespace softkin
