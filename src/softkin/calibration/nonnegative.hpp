#pragma once

#include <Eigen/Core>

namespace softkin::calibration {

/// Minimises |A x - b| where all but the first `free` entries of x are >= 0. Columns that depend on others get 0.
///
/// source  Lawson, Hanson, "Solving Least Squares Problems", 1974, chapter 23
[[nodiscard]] Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right,
                                                        Eigen::Index free = 0);

}  // namespace softkin::calibration
