#include <algorithm>
#include <cmath>
#include <softkin/calibration/robot_outlines.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/runs/body_surface.hpp>

namespace softkin::calibration {

namespace {

using Eigen::Vector2d;

constexpr double within_fraction = 0.05;  // of the robot's diagonal
constexpr double loose_outline = 3;       // of the median distance: limit while the numbers are far from the solution
constexpr double gap_outline = 5;         // of the median step: a longer one is a gap of the outline
constexpr double on_outline_mm = 1e-9;    // closer than this the direction to the outline is its normal

/// A closed outline with gaps.
struct Loop {
  const std::vector<Vector2d>& points;
  std::vector<double> steps;  // to the next point, from the last to the first; 0: a gap
  double length = 0, sense = 1;

  explicit Loop(const std::vector<Vector2d>& of) : points(of) {
    double area = 0;
    for (std::size_t i = 0; i < of.size(); ++i) {
      const Vector2d &a = of[i], &b = of[(i + 1) % of.size()];
      steps.push_back((b - a).norm());
      area += a.x() * b.y() - a.y() * b.x();
    }
    sense = area < 0 ? -1 : 1;
    std::vector<double> sorted = steps;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (double& step : steps) {
      if (step > gap_outline * *middle) step = 0;
      length += step;
    }
  }

  /// From a point so far along the outline, or to the next gap; back: against it.
  [[nodiscard]] Vector2d along(std::size_t i, double reach, bool back) const {
    const std::size_t count = points.size();
    double walked = 0;
    for (std::size_t n = 0; n < count && walked < reach; ++n) {
      const double step = steps[back ? (i + count - 1) % count : i];
      if (step == 0) break;
      walked += step;
      i = (back ? i + count - 1 : i + 1) % count;
    }
    return points[i];
  }

  /// Of the chord that reaches so far to both sides: steps of a picture's pixels are no slope.
  [[nodiscard]] Vector2d outward(std::size_t i, double reach) const {
    const Vector2d chord = along(i, reach, false) - along(i, reach, true);
    const Vector2d normal = sense * Vector2d(chord.y(), -chord.x());
    return normal.norm() > 0 ? Vector2d(normal.normalized()) : normal;
  }
};

Points seen_by(const Points& positions, const MeasuringFrame& frame) {
  return (positions * frame.rotation.transpose()).rowwise() + frame.place.transpose();
}

OutlineMiss miss_of(const OutlinePoint& point, const std::optional<OutlinePlace>& nearest) {
  OutlineMiss miss;
  if (!nearest) return miss;
  miss.nearest = *nearest;
  const Vector2d arm = point.place - nearest->place;
  const double side = arm.dot(nearest->outward);
  // beyond the end of an edge, at a corner, the direction is that to the corner
  const double distance = arm.norm();
  miss.off_mm = side < 0 ? -distance : distance;
  miss.path = distance > on_outline_mm ? Vector2d(arm / miss.off_mm) : nearest->outward;
  return miss;
}

}  // namespace

std::vector<OutlinePoint> thinned_outline(const std::vector<Vector2d>& points, int count) {
  const Loop loop(points);
  const double spacing = loop.length / count;
  const bool all = points.size() <= static_cast<std::size_t>(count);
  std::vector<OutlinePoint> thinned;
  double walked = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // one for each middle of a spacing that is passed
    const double half = walked / spacing + 0.5;
    if (all || std::floor(half + loop.steps[i] / spacing) > std::floor(half))
      thinned.push_back({points[i], loop.outward(i, spacing)});
    walked += loop.steps[i];
  }
  return thinned;
}

RobotOutlines::RobotOutlines(const MeasuredPoses& poses, const Model& model, const OutlineOptions& options) {
  if (options.points <= 0)
    throw InvalidInput({poses.file},
                       "outlines are thinned to a number of points above 0, not " + std::to_string(options.points));
  if (options.within_mm && !(*options.within_mm > 0))
    throw InvalidInput(
        {poses.file}, "how far a point of an outline may be off must be above 0 mm, not " + number(*options.within_mm));
  if (poses.outlines.file.empty()) {
    const auto any_read = [](const Eigen::MatrixXd& values) { return (values.array() == values.array()).any(); };
    if (!poses.pictures.empty() && !any_read(poses.values) && !any_read(poses.dots.places))
      throw InvalidInput({poses.file}, "its poses have pictures and no other reading: give the outlines in these");
    if (options.within_mm) throw InvalidInput({poses.file}, "there is no outline whose points may be so far off");
    return;
  }
  surface_.emplace(runs::body_surface(model).triangles);
  if (surface_->triangles().empty()) throw InvalidInput({poses.outlines.file}, "the robot has no surface to be seen");
  requested_mm_ = options.within_mm.value_or(within_fraction * model.diagonal_mm);
  for (const std::vector<Vector2d>& points : poses.outlines.points) {
    points_.push_back(points.empty() ? std::vector<OutlinePoint>() : thinned_outline(points, options.points));
    counts_.emplace_back(points_.back().size(), true);
  }
}

std::vector<OutlineMiss> RobotOutlines::misses(Index pose, const Points& positions, const MeasuringFrame& frame) const {
  std::vector<OutlineMiss> misses;
  if (points(pose) == 0) return misses;
  const Points seen = seen_by(positions, frame);
  const SeenOutline outline(*surface_, seen);
  for (const OutlinePoint& point : points_[pose])
    misses.push_back(miss_of(point, outline.nearest(point.place, point.outward)));
  return misses;
}

OutlineLines RobotOutlines::lines(const Points& positions, const MeasuringFrame& frame) const {
  const Points seen = seen_by(positions, frame);
  return SeenOutline(*surface_, seen).lines();
}

bool RobotOutlines::match(const OutlineMisses& misses, const std::vector<bool>* fitted) {
  if (!any()) return false;
  double within = requested_mm_;
  std::vector<double> distances;
  for (std::size_t pose = 0; fitted && pose < misses.size(); ++pose)
    for (const OutlineMiss& miss : misses[pose])
      if ((*fitted)[pose] && std::isfinite(miss.off_mm)) distances.push_back(std::abs(miss.off_mm));
  if (!distances.empty()) {
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    within = std::max(within, loose_outline * *middle);
  }
  const std::vector<std::vector<bool>> before = counts_;
  for (std::size_t pose = 0; pose < misses.size(); ++pose)
    for (std::size_t k = 0; k < misses[pose].size(); ++k)
      counts_[pose][k] = std::abs(misses[pose][k].off_mm) <= within;  // not where that is NaN
  return counts_ != before;
}

std::vector<OutlineReading> RobotOutlines::readings(Index pose, const std::vector<OutlineMiss>& misses) const {
  std::vector<OutlineReading> all;
  for (std::size_t k = 0; k < points(pose); ++k) {
    OutlineReading& reading = all.emplace_back();
    reading.measured = points_[pose][k].place;
    if (misses.empty()) continue;  // no equilibrium
    reading.nearest = misses[k].nearest.place;
    reading.off_mm = misses[k].off_mm;
    reading.counts = counts(pose, k) && std::isfinite(reading.off_mm);
  }
  return all;
}

// That the outline moves over the surface, and the nearest place along the outline, changes the distance to second
// order alone: of a smooth outline these derivatives are exact.
Eigen::VectorXd outline_slopes(const std::vector<OutlineMiss>& misses, const Points& positions,
                               const MeasuringFrame& frame, const Mat3& turns, const Vec3& shifts,
                               const Points* moves) {
  Eigen::VectorXd slopes = Eigen::VectorXd::Zero(misses.size());
  for (std::size_t k = 0; k < misses.size(); ++k) {
    if (!std::isfinite(misses[k].off_mm)) continue;
    const OutlinePlace& place = misses[k].nearest;
    const auto at = [&](const Points& of) -> Vec3 {
      return ((1 - place.fraction) * of.row(place.vertices[0]) + place.fraction * of.row(place.vertices[1]))
          .transpose();
    };
    Vec3 moved = turns * at(positions) + shifts;
    if (moves) moved += frame.rotation * at(*moves);
    slopes[k] = -misses[k].path.dot(moved.head<2>());
  }
  return slopes;
}

}  // namespace softkin::calibration
