#pragma once

#include <optional>
#include <softkin/kinematics/map.hpp>
#include <vector>

namespace softkin {

/// A command that was not measured, such as a force that has a range in the scene, and its prior.
struct MapUnknown {
  Index input = 0;                 // of the map
  double mean = 0, deviation = 1;  // in its unit; deviation > 0
};

/// An estimate, from outputs of a map, of commands that were not measured.
struct MapEstimate {
  bool converged = false;      // did the search end by itself
  Eigen::VectorXd commands;    // inputs: those that were given, and the estimated ones
  Eigen::MatrixXd covariance;  // of the unknowns, in their order
  Eigen::VectorXd computed;    // outputs
  double chi_square = 0;       // of the readings
  double freedoms = 0;         // degrees of freedom: readings less the unknowns that they determine
  int iterations = 0;          // that it took

  /// Returns by how many standard deviations the chi-square is too large.
  [[nodiscard]] double misfit() const;
};

/// Estimates commands that were not measured from measured outputs of a map: the most probable ones inside their
/// ranges. It takes microseconds; wrong readings are not searched for, but the misfit shows that there is one.
///
/// minimises   sum over readings of ((output - read) / deviation)^2 + sum over unknowns of
///             ((command - mean) / deviation)^2, by the Gauss-Newton method, damped in units of the prior standard
///             deviations
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
