#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <softkin/calibration/quad_edges.hpp>
#include <utility>
#include <vector>

namespace softkin {

namespace {

constexpr double step = 0.5;           // along a profile [px]
constexpr double least_contrast = 25;  // of 255
constexpr double end_share = 0.12;     // of an edge: left out at both ends, where blur rounds the corner

struct Line {
  Vec2 point, direction;
};

/// Brightness across an edge, from inside (dark) outwards.
std::vector<double> profile(const RgbImage& picture, const Vec2& at, const Vec2& outwards, double reach) {
  std::vector<double> values;
  for (double s = -reach; s <= reach + 1e-9; s += step) values.push_back(brightness(picture, at + s * outwards));
  return values;
}

/// Distance outwards from the middle of the profile at which it passes the level, nearest to the middle.
std::optional<double> passage(const std::vector<double>& values, double reach, double level) {
  std::optional<double> best;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    if (!(values[i] <= level && values[i + 1] > level)) continue;
    const double s = -reach + step * (static_cast<double>(i) + (level - values[i]) / (values[i + 1] - values[i]));
    if (!best || std::abs(s) < std::abs(*best)) best = s;
  }
  return best;
}

std::optional<Line> fitted(std::vector<Vec2> points) {
  Line line;
  for (int round = 0; round < 2; ++round) {
    if (points.size() < 5) return std::nullopt;
    line.point.setZero();
    for (const Vec2& point : points) line.point += point / static_cast<double>(points.size());
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const Vec2& point : points) spread += (point - line.point) * (point - line.point).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
    line.direction = solver.eigenvectors().col(1);
    const double width = std::sqrt(solver.eigenvalues()[0] / static_cast<double>(points.size()));
    const Vec2 normal = solver.eigenvectors().col(0);
    std::erase_if(points, [&](const Vec2& point) {
      return std::abs(normal.dot(point - line.point)) > std::max(0.05, 2.5 * width);
    });
  }
  return line;
}

/// Darkest on the inner half and lightest on the outer half of the mean profile: ink and paper, also where the dark
/// border and the margin are hardly wider than the blur.
std::pair<double, double> levels_of(const std::vector<std::vector<double>>& profiles) {
  const std::size_t size = profiles[0].size();
  double dark = 255, light = 0;
  for (std::size_t k = 0; k < size; ++k) {
    double mean = 0;
    for (const std::vector<double>& each : profiles) mean += each[k] / static_cast<double>(profiles.size());
    if (2 * k < size) dark = std::min(dark, mean);
    if (2 * k >= size) light = std::max(light, mean);
  }
  return {dark, light};
}

std::optional<Line> edge_line(const RgbImage& picture, const Vec2& from, const Vec2& to, const Vec2& middle,
                              double module, const std::optional<Camera>& camera) {
  const double length = (to - from).norm();
  const Vec2 along = (to - from) / length;
  Vec2 outwards(along.y(), -along.x());
  if (outwards.dot(middle - from) > 0) outwards = -outwards;
  const double depth = 2 * std::abs(outwards.dot(middle - from));  // of the square behind this edge
  const double reach = std::clamp(0.75 * module * depth, 1.5, 5.0);
  const int count = std::clamp(static_cast<int>(length), 10, 60);
  std::vector<std::vector<double>> profiles;
  std::vector<Vec2> places;
  for (int i = 0; i < count; ++i) {
    const double share = end_share + (1 - 2 * end_share) * (i + 0.5) / count;
    places.push_back(from + share * (to - from));
    profiles.push_back(profile(picture, places.back(), outwards, reach));
  }
  const auto [dark, light] = levels_of(profiles);
  if (!(light - dark > least_contrast)) return std::nullopt;
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) {
    const auto s = passage(profiles[std::size_t(i)], reach, (dark + light) / 2);
    if (!s) continue;
    const Vec2 seen = places[std::size_t(i)] + *s * outwards;
    points.push_back(camera ? undistorted(*camera, seen) : seen);
  }
  return fitted(std::move(points));
}

}  // namespace

double brightness(const RgbImage& picture, const Vec2& pixel) {
  const double x = std::clamp(pixel.x(), 0.0, picture.width - 1.0),
               y = std::clamp(pixel.y(), 0.0, picture.height - 1.0);
  const int i = std::min(static_cast<int>(x), picture.width - 2), j = std::min(static_cast<int>(y), picture.height - 2);
  const auto value = [&](int column, int row) {
    const std::uint8_t* c = picture.bytes.data() + 3 * (std::size_t(row) * picture.width + column);
    return 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
  };
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * value(i, j) + u * value(i + 1, j)) +
         v * ((1 - u) * value(i, j + 1) + u * value(i + 1, j + 1));
}

Vec2 crossing(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 u = b - a, v = d - c, w = c - a;
  return a + (w.x() * v.y() - w.y() * v.x()) / (u.x() * v.y() - u.y() * v.x()) * u;
}

std::optional<std::array<Vec2, 4>> refine_quad(const RgbImage& picture, std::array<Vec2, 4> corners, double module,
                                               const std::optional<Camera>& camera) {
  std::array<Vec2, 4> ideal = corners;
  for (int round = 0; round < 2; ++round) {
    const Vec2 middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
    std::array<Line, 4> lines;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto line = edge_line(picture, corners[i], corners[(i + 1) % 4], middle, module, camera);
      if (!line) return std::nullopt;
      lines[i] = *line;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const Line &before = lines[(i + 3) % 4], &after = lines[i];
      ideal[i] = crossing(before.point, before.point + before.direction, after.point, after.point + after.direction);
      const Vec2 seen = camera ? distorted(*camera, ideal[i]) : ideal[i];
      // a corner that runs away is that of something else
      if (!((seen - corners[i]).norm() < 5)) return std::nullopt;
      corners[i] = seen;
    }
  }
  return ideal;
}

}  // namespace softkin
