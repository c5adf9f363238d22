#pragma once

#include <limits>
#include <optional>
#include <softkin/model/measured_poses.hpp>
#include <softkin/model/model.hpp>

namespace softkin::calibration {

/// Which marker a dot of a pose is taken for.
struct DotMatch {
  bool seen = false;
  Index marker = -1;   // of the model; -1: none
  Index nearest = -1;  // the marker that is, or of those not read by name the one nearest to it; -1: none
  double distance_mm = std::numeric_limits<double>::quiet_NaN();  // from where that one is computed
  std::optional<Index> rival{};  // what else it may be, hardly worse: a marker, or -1: none; no value: nothing else
};

/// Per pose, per dot.
using DotMatches = std::vector<std::vector<DotMatch>>;

/// Dots as readings of the markers that they are: in each pose the pairs of dots and markers with the least sum of
/// squared distances, where a dot that is farther than a distance from each marker counts as that far off. A marker
/// that a pose reads by name is none of its dots.
class DotMatcher {
 public:
  /// within_mm  how far a dot may be from its marker
  /// throws     InvalidInput naming the file: dots and no such distance, or a distance and no dot
  DotMatcher(const MeasuredPoses& poses, const Model& model, double within_mm);

  [[nodiscard]] bool any() const { return !seen_.dots.names.empty(); }
  /// The poses, the dots among the readings of their markers; columns that the file does not have come behind.
  [[nodiscard]] const MeasuredPoses& poses() const { return named_; }
  /// Dots that were seen in a pose.
  [[nodiscard]] std::size_t seen(Index pose) const;

  /// Matches the dots anew.
  ///
  /// computed  poses by columns of poses(); NaN: a pose without equilibrium, whose dots match nothing
  /// counts    the poses that set the limit of the distance while the numbers are far from the solution: three times
  ///           the median distance of a complete match; null: the limit is the requested distance
  /// returns   has the match changed?
  bool match(const Eigen::MatrixXd& computed, const std::vector<bool>* counts);

  /// The last match. deviation_mm  of a coordinate: what is another match but by less than two of them is a rival
  [[nodiscard]] DotMatches matches(const Eigen::MatrixXd& computed, double deviation_mm) const;

 private:
  struct Costs;

  [[nodiscard]] Costs costs(const Eigen::MatrixXd& computed, Index pose) const;
  [[nodiscard]] double typical_mm(const Eigen::MatrixXd& computed, const std::vector<bool>& counts) const;
  void name(Index pose, const Costs& costs, const std::vector<Index>& columns);
  [[nodiscard]] std::optional<Index> rival(const Costs& costs, Eigen::Index row, double deviation_mm) const;

  MeasuredPoses seen_, named_;
  double requested_mm_, within_mm_ = std::numeric_limits<double>::infinity();
  std::vector<std::vector<Index>> columns_;  // of poses(), per marker, per axis of the dots
  std::vector<std::vector<Index>> markers_;  // per pose, per dot: -1: none
};

}  // namespace softkin::calibration
