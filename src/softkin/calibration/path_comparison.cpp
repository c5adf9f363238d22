#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <softkin/calibration/path_comparison.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>

namespace softkin::calibration {

namespace {

constexpr double rounding = 1e-9;  // relative, of places and starts

Vec3 masked(const Vec3& point, const std::array<bool, 3>& axes) {
  Vec3 result = point;
  for (std::size_t a = 0; a < 3; ++a)
    if (!axes[a]) result[static_cast<Index>(a)] = 0;
  return result;
}

/// Shares of the length, from 0 to 1.
std::vector<double> shares_of(const Track& track, const std::array<bool, 3>& axes) {
  std::vector<double> shares{0};
  for (std::size_t i = 1; i < track.points.size(); ++i)
    shares.push_back(shares.back() + masked(track.points[i] - track.points[i - 1], axes).norm());
  if (!(shares.back() > 0)) throw InvalidInput({track.name}, "the track has no length, so it has no arc to compare by");
  for (double& share : shares) share /= shares.back();
  shares.back() = 1;
  return shares;
}

std::vector<double> places_of(const Track& track, Resampling by, const std::array<bool, 3>& axes) {
  if (by == Resampling::arc) return shares_of(track, axes);
  if (by == Resampling::parameter) {
    if (track.parameter.empty()) throw InvalidInput({track.name}, "the track has no times (column t_s) to compare by");
    return track.parameter;
  }
  std::vector<double> rows(track.points.size());
  std::iota(rows.begin(), rows.end(), 0.0);
  return rows;
}

/// The point at a place, straight between its neighbours; none outside. places do not descend.
std::optional<Vec3> point_at(const Track& track, const std::vector<double>& places, double place) {
  const double slack = rounding * std::max(std::abs(places.front()), std::abs(places.back()));
  if (place < places.front() - slack || place > places.back() + slack) return std::nullopt;
  const auto above = std::lower_bound(places.begin(), places.end(), place);
  if (above == places.begin()) return track.points.front();
  if (above == places.end()) return track.points.back();
  const auto i = static_cast<std::size_t>(above - places.begin());
  const double share = (place - places[i - 1]) / (places[i] - places[i - 1]);
  return track.points[i - 1] + share * (track.points[i] - track.points[i - 1]);
}

/// Moves the other points onto the reference's.
void align(PathComparison& comparison) {
  const auto count = static_cast<double>(comparison.waypoints.size());
  Vec3 mean_reference = Vec3::Zero(), mean_other = Vec3::Zero();
  for (const WaypointError& each : comparison.waypoints) {
    mean_reference += each.reference / count;
    mean_other += each.other / count;
  }
  Mat3 covariance = Mat3::Zero();
  for (const WaypointError& each : comparison.waypoints)
    covariance += (each.reference - mean_reference) * (each.other - mean_other).transpose();
  // axes that are not compared stay as they are: their singular value is above all others
  const double scale = 1 + covariance.cwiseAbs().sum();
  for (std::size_t a = 0; a < 3; ++a)
    if (!comparison.axes[a]) covariance(static_cast<Index>(a), static_cast<Index>(a)) = 10 * scale;
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  comparison.rotation = svd.matrixU() * Vec3(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  comparison.translation = mean_reference - comparison.rotation * mean_other;
  comparison.aligned = true;
  // determined where all directions but one are spanned; an axis that is not compared counts as spanned
  comparison.unique = svd.singularValues()[1] > rounding * (scale - 1);
  for (WaypointError& each : comparison.waypoints)
    each.other = masked(comparison.rotation * each.other + comparison.translation, comparison.axes);
}

void judge(PathComparison& comparison) {
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < comparison.waypoints.size(); ++i) {
    WaypointError& each = comparison.waypoints[i];
    each.error_mm = (each.other - each.reference).norm();
    sum += each.error_mm;
    squares += each.error_mm * each.error_mm;
    if (each.error_mm > comparison.largest_mm) {
      comparison.largest_mm = each.error_mm;
      comparison.worst = i;
    }
  }
  const auto count = static_cast<double>(comparison.waypoints.size());
  comparison.mean_mm = sum / count;
  comparison.rms_mm = std::sqrt(squares / count);
}

Vec3 point_of_sweep(const SingleSweep& sweep, double command) {
  if (command == sweep.commands.front()) return sweep.points.front();
  for (std::size_t i = 0; i + 1 < sweep.commands.size(); ++i) {
    const double a = sweep.commands[i], b = sweep.commands[i + 1];
    if (a == b || command < std::min(a, b) || command > std::max(a, b)) continue;
    return sweep.points[i] + (command - a) / (b - a) * (sweep.points[i + 1] - sweep.points[i]);
  }
  const auto [low, high] = std::minmax_element(sweep.commands.begin(), sweep.commands.end());
  throw InvalidInput({sweep.name}, "the command " + number(command) + " is outside this sweep, " + number(*low) +
                                       " to " + number(*high));
}

}  // namespace

Resampling natural_resampling(const Track& reference, const Track& other) {
  if (!reference.parameter.empty() && !other.parameter.empty()) return Resampling::parameter;
  return reference.points.size() == other.points.size() ? Resampling::waypoint : Resampling::arc;
}

PathComparison compare_paths(const Track& reference, const Track& other, Resampling by, bool aligned) {
  PathComparison comparison;
  comparison.by = by;
  for (std::size_t a = 0; a < 3; ++a) comparison.axes[a] = reference.axes[a] && other.axes[a];
  if (std::count(comparison.axes.begin(), comparison.axes.end(), true) == 0)
    throw InvalidInput({other.name}, "the track has no axis in common with " + reference.name);
  for (const Track* track : {&reference, &other})
    if (track->points.empty()) throw InvalidInput({track->name}, "the track has no point");
  if (by == Resampling::waypoint && reference.points.size() != other.points.size())
    throw InvalidInput({other.name}, "the track has " + std::to_string(other.points.size()) + " waypoints, " +
                                         reference.name + " has " + std::to_string(reference.points.size()) +
                                         ": compare them by time or by arc");
  const std::vector<double> places = places_of(reference, by, comparison.axes);
  const std::vector<double> others = places_of(other, by, comparison.axes);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::optional<Vec3> point = point_at(other, others, places[i]);
    if (!point) {
      ++comparison.left_out;
      continue;
    }
    comparison.waypoints.push_back(
        {i, places[i], masked(reference.points[i], comparison.axes), masked(*point, comparison.axes), 0});
  }
  if (comparison.waypoints.empty())
    throw InvalidInput({other.name}, "no waypoint of " + reference.name + " lies within its range, " +
                                         number(others.front()) + " to " + number(others.back()));
  if (aligned) align(comparison);
  judge(comparison);
  return comparison;
}

Vec3 superposed(const std::vector<SingleSweep>& sweeps, const std::vector<double>& commands) {
  if (sweeps.empty() || sweeps.size() != commands.size()) throw InvalidInput("a sum needs a command for each sweep");
  const Vec3 start = sweeps.front().points.at(0);
  Vec3 sum = start;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    const SingleSweep& sweep = sweeps[s];
    if ((sweep.points.at(0) - start).norm() > 1e-3)
      throw InvalidInput({sweep.name}, "the sweep starts " + number((sweep.points[0] - start).norm()) +
                                           " mm away from where " + sweeps.front().name + " starts");
    sum += point_of_sweep(sweep, commands[s]) - sweep.points[0];
  }
  return sum;
}

}  // namespace softkin::calibration
