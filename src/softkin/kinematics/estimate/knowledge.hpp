#pragma once

#include <softkin/kinematics/estimate/variables.hpp>

namespace softkin::estimate {

/// Unknowns as numbers, then three coordinates of each place at rest.
[[nodiscard]] Eigen::VectorXd coordinates_of(const Variables& variables, const Eigen::VectorXd& values,
                                             const std::vector<Place>& places);

/// How these change with the columns of Variables: identity, and the tangents.
[[nodiscard]] Eigen::MatrixXd directions_at(const Variables& variables, const std::vector<Place>& places);

/// What is known of the unknowns before a reading: a normal distribution of their coordinates.
struct Knowledge {
  Eigen::VectorXd mean;
  Eigen::MatrixXd information;  // inverse of the covariance, on what it spans

  /// Before any reading: of numbers as given, of places anywhere on their patches.
  explicit Knowledge(const Variables& variables);

  /// After a time in which what was told may have changed: x - mean decays and is stirred so that without readings it
  /// comes to be known as before any, with this share of it left.
  ///
  /// told        coordinates of the last estimate, covariance theirs
  /// share       exp(-elapsed / fade), 0 <= share <= 1
  /// source      Ornstein-Uhlenbeck process: mean m + a (x - m), covariance a^2 P + (1 - a^2) C
  Knowledge(const Variables& variables, const Eigen::VectorXd& told, const Eigen::MatrixXd& covariance, double share);
};

}  // namespace softkin::estimate
