#pragma once

#include <softkin/kinematics/estimate/memory.hpp>

namespace softkin::estimate {

/// Unknowns as numbers, then three coordinates of each place at rest.
[[nodiscard]] Eigen::VectorXd coordinates_of(const Variables& variables, const Eigen::VectorXd& values,
                                             const std::vector<Place>& places);

/// How these change with the columns of Variables: identity, and the tangents.
[[nodiscard]] Eigen::MatrixXd directions_at(const Variables& variables, const std::vector<Place>& places);

/// The prior of the unknowns before a reading: a normal distribution of their coordinates, and the information of
/// earlier readings.
struct Knowledge {
  Eigen::VectorXd mean;
  Eigen::MatrixXd information;  // inverse of the covariance, on what it spans

  const Memory* memory = nullptr;  // the information of earlier readings; null: none

  /// The prior before any reading: numbers as given, places anywhere on their patches.
  explicit Knowledge(const Variables& variables);

  /// The cost of the prior at given unknowns, to second order in the columns of Variables: half its Hessian matrix,
  /// half its gradient, and its value.
  struct Cost {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
    double value = 0;
  };
  [[nodiscard]] Cost cost(const Variables& variables, const Eigen::VectorXd& values,
                          const std::vector<Place>& places) const;
  [[nodiscard]] double value(const Variables& variables, const Eigen::VectorXd& values,
                             const std::vector<Place>& places) const;
};

}  // namespace softkin::estimate
