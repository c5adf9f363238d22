#pragma once

#include <Eigen/Core>

namespace softkin {

/// min 1/2 s.H s + g.s where rows s >= bounds; H symmetric positive definite, s of a handful of unknowns. Rows of zeros
/// are left out.
///
/// start    meets the rows (to rounding)
/// returns  the minimiser; meets the rows as start does
/// source   primal active set, Nocedal and Wright 2006, Algorithm 16.3
[[nodiscard]] Eigen::VectorXd solve_small_program(const Eigen::MatrixXd& h, const Eigen::VectorXd& g,
                                                  const Eigen::MatrixXd& rows, const Eigen::VectorXd& bounds,
                                                  const Eigen::VectorXd& start);

}  // namespace softkin
