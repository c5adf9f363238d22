#pragma once

#include <softkin/core/types.hpp>

namespace softkin::calibration {

/// Minimises |A x - b| over x >= 0.
///
/// source  Lawson, Hanson 1974, "Solving Least Squares Problems", chapter 23, algorithm NNLS
[[nodiscard]] Eigen::VectorXd non_negative_fit(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

/// Minimises |A x - b| subject to G x >= h, for A with independent columns.
///
/// source  the same, algorithms LSI and LDP
/// returns not finite values where no x satisfies the conditions
[[nodiscard]] Eigen::VectorXd constrained_fit(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right,
                                              const Eigen::MatrixXd& conditions, const Eigen::VectorXd& bounds);

}  // namespace softkin::calibration
