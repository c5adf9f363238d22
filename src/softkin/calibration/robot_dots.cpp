#include <algorithm>
#include <cmath>
#include <softkin/calibration/assignment.hpp>
#include <softkin/calibration/robot_dots.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>

namespace softkin::calibration {

namespace {

constexpr double dot_nan = std::numeric_limits<double>::quiet_NaN();
/// Of the median distance: how far dots may be off while the numbers are far off themselves.
constexpr double loose = 3;
/// Deviations by which another match must be worse, or it is a rival: 7 to 1 for the better one.
constexpr double doubtful = 2;

}  // namespace

/// Squared distances of the dots that a pose shows from the markers that they may be.
struct DotMatcher::Costs {
  std::vector<std::size_t> dots;  // per row
  std::vector<Index> markers;     // per column
  Eigen::MatrixXd squares;        // [mm^2]

  /// What every match costs less than, that leaves out no dot for which there is a marker.
  [[nodiscard]] double any() const {
    return squares.size() > 0 ? (1 + squares.maxCoeff()) * static_cast<double>(1 + dots.size()) : 1;
  }
  [[nodiscard]] double sum(const std::vector<Index>& columns, double alone) const {
    double all = 0;
    for (std::size_t row = 0; row < columns.size(); ++row) all += columns[row] < 0 ? alone : squares(row, columns[row]);
    return all;
  }
};

DotMatcher::DotMatcher(const MeasuredPoses& poses, const Model& model, double within_mm)
    : seen_(poses), named_(poses), requested_mm_(within_mm) {
  if (any() && !(within_mm > 0))
    throw InvalidInput(
        {poses.file},
        "it has dots without names: say within which distance of a marker, in mm, a dot is matched to it");
  if (!any() && within_mm > 0)
    throw InvalidInput({poses.file}, "it has no dot without a name to be matched within " + number(within_mm) + " mm");
  if (!any()) return;
  columns_.resize(model.markers.size());
  for (std::size_t m = 0; m < model.markers.size(); ++m)
    for (const int axis : poses.dots.axes) {
      const auto same = std::find_if(named_.columns.begin(), named_.columns.end(), [&](const PoseColumn& column) {
        return column.marker == static_cast<Index>(m) && column.axis == axis;
      });
      columns_[m].push_back(same - named_.columns.begin());
      if (same == named_.columns.end())
        named_.columns.push_back({model.markers[m].name + "_" + axis_names[axis] + "_mm", static_cast<Index>(m), axis});
    }
  named_.values.setConstant(poses.values.rows(), named_.columns.size(), dot_nan);
  named_.values.leftCols(poses.values.cols()) = poses.values;
  markers_.assign(poses.commands.size(), std::vector<Index>(poses.dots.names.size(), -1));
}

std::size_t DotMatcher::seen(Index pose) const {
  std::size_t count = 0;
  for (std::size_t d = 0; d < seen_.dots.names.size(); ++d)
    count += !std::isnan(seen_.dots.places(pose, d * seen_.dots.axes.size()));
  return count;
}

DotMatcher::Costs DotMatcher::costs(const Eigen::MatrixXd& computed, Index pose) const {
  const Index axes = seen_.dots.axes.size();
  Costs costs;
  for (std::size_t d = 0; d < seen_.dots.names.size(); ++d)
    if (!std::isnan(seen_.dots.places(pose, static_cast<Index>(d) * axes))) costs.dots.push_back(d);
  for (std::size_t m = 0; m < columns_.size(); ++m) {
    bool named = std::isnan(computed(pose, columns_[m][0]));
    for (std::size_t c = 0; c < seen_.columns.size(); ++c)
      named = named || (seen_.columns[c].marker == static_cast<Index>(m) && !std::isnan(seen_.values(pose, c)));
    if (!named) costs.markers.push_back(m);
  }
  costs.squares.setZero(costs.dots.size(), costs.markers.size());
  for (std::size_t d = 0; d < costs.dots.size(); ++d)
    for (std::size_t m = 0; m < costs.markers.size(); ++m)
      for (Index axis = 0; axis < axes; ++axis)
        costs.squares(d, m) += std::pow(seen_.dots.places(pose, static_cast<Index>(costs.dots[d]) * axes + axis) -
                                            computed(pose, columns_[costs.markers[m]][axis]),
                                        2);
  return costs;
}

double DotMatcher::typical_mm(const Eigen::MatrixXd& computed, const std::vector<bool>& counts) const {
  std::vector<double> distances;
  for (std::size_t pose = 0; pose < markers_.size(); ++pose) {
    if (!counts[pose]) continue;
    const Costs all = costs(computed, pose);
    const std::vector<Index> columns = min_assignment(all.squares, all.any());
    for (std::size_t row = 0; row < columns.size(); ++row)
      if (columns[row] >= 0) distances.push_back(std::sqrt(all.squares(row, columns[row])));
  }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

bool DotMatcher::match(const Eigen::MatrixXd& computed, const std::vector<bool>* counts) {
  if (!any()) return false;
  const double within = counts ? std::max(requested_mm_, loose * typical_mm(computed, *counts)) : requested_mm_;
  const std::vector<std::vector<Index>> before = markers_;
  within_mm_ = within;
  for (std::size_t pose = 0; pose < markers_.size(); ++pose) {
    const Costs all = costs(computed, pose);
    name(pose, all, min_assignment(all.squares, within * within));
  }
  return markers_ != before;
}

/// Makes dots readings of their markers.
void DotMatcher::name(Index pose, const Costs& costs, const std::vector<Index>& columns) {
  const Index axes = seen_.dots.axes.size();
  named_.values.row(pose).setConstant(dot_nan);
  named_.values.row(pose).head(seen_.values.cols()) = seen_.values.row(pose);
  std::vector<Index>& markers = markers_[pose];
  std::fill(markers.begin(), markers.end(), -1);
  for (std::size_t row = 0; row < columns.size(); ++row) {
    if (columns[row] < 0) continue;
    const std::size_t dot = costs.dots[row];
    markers[dot] = costs.markers[columns[row]];
    for (Index axis = 0; axis < axes; ++axis)
      named_.values(pose, columns_[markers[dot]][axis]) =
          seen_.dots.places(pose, static_cast<Index>(dot) * axes + axis);
  }
}

/// What a dot is in the best match in which it is not what it is.
std::optional<Index> DotMatcher::rival(const Costs& costs, Eigen::Index row, double deviation_mm) const {
  const double alone = within_mm_ * within_mm_;
  const std::vector<Index> best = min_assignment(costs.squares, alone);
  Costs other = costs;
  other.squares(row, best[row]) = std::numeric_limits<double>::infinity();
  const std::vector<Index> second = min_assignment(other.squares, alone);
  if (costs.sum(second, alone) - costs.sum(best, alone) >= std::pow(doubtful * deviation_mm, 2)) return std::nullopt;
  const Index column = second[row];
  return column < 0 ? -1 : costs.markers[column];
}

DotMatches DotMatcher::matches(const Eigen::MatrixXd& computed, double deviation_mm) const {
  DotMatches all(markers_.size(), std::vector<DotMatch>(seen_.dots.names.size()));
  for (std::size_t pose = 0; pose < markers_.size(); ++pose) {
    const Costs of = costs(computed, pose);
    for (std::size_t r = 0; r < of.dots.size(); ++r) {
      const Eigen::Index row = r;
      DotMatch& match = all[pose][of.dots[r]];
      match.seen = true;
      match.marker = match.nearest = markers_[pose][of.dots[r]];
      if (of.markers.empty()) continue;
      Eigen::Index column = 0;
      double square = of.squares.row(row).minCoeff(&column);
      if (match.marker >= 0) {
        column = std::find(of.markers.begin(), of.markers.end(), match.marker) - of.markers.begin();
        square = of.squares(row, column);
        match.rival = rival(of, row, deviation_mm);
      }
      match.nearest = of.markers[column];
      match.distance_mm = std::sqrt(square);
    }
  }
  return all;
}

}  // namespace softkin::calibration
