#pragma once

#include <optional>
#include <softkin/kinematics/map.hpp>
#include <vector>

namespace softkin {

/// A command that was not measured, such as a force that the scene gives a range, and what was known of it before.
struct MapUnknown {
  Index input = 0;                 // of the map
  double mean = 0, deviation = 1;  // in its unit; deviation > 0
};

/// What outputs of a map tell of commands that were not measured.
struct MapEstimate {
  bool converged = false;      // did the search end by itself
  Eigen::VectorXd commands;    // inputs: those that were given, and what was told
  Eigen::MatrixXd covariance;  // of the unknowns, in their order
  Eigen::VectorXd computed;    // outputs
  double chi_square = 0;       // of what was read
  double freedoms = 0;         // which it is to be compared with: readings less what they had to tell
  int iterations = 0;          // that it took

  /// By how many standard deviations the chi-square is too large.
  [[nodiscard]] double misfit() const;
};

/// What outputs of a map that were read tell of commands that were not: the most probable ones inside their ranges.
/// Microseconds; a wrong reading is not looked for, but its misfit says that there is one.
///
/// minimises   sum over readings of ((output - read) / deviation)^2 + sum over unknowns of
///             ((command - mean) / deviation)^2, by Gauss' and Newton's method, damped in units of what was known
///             before
/// commands    inputs of the map; of the unknowns where the search begins
/// values      of the outputs; NaN: not read
/// deviations  of the outputs that were read, > 0
/// returns     nothing where the search begins outside the map; covariance of the normal equations at the end
/// throws      InvalidInput on sizes, numbers that are not finite, deviations that are not > 0, an input that the map
///             does not have or that is unknown twice
[[nodiscard]] std::optional<MapEstimate> estimate_by_map(const KinematicMap& map,
                                                         const std::vector<MapUnknown>& unknowns,
                                                         const Eigen::VectorXd& commands, const Eigen::VectorXd& values,
                                                         const Eigen::VectorXd& deviations);

}  // namespace softkin
