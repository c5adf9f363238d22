#pragma once

#include <Eigen/Core>

namespace softkin::inverse {

/// min 1/2 s.H s + g.s where rows s >= bounds; H symmetric positive definite, s of a handful of unknowns. bounds <= 0,
/// so that s = 0 is allowed.
///
/// returns  the minimiser, which meets the rows to rounding
/// source   dual active set, which no corner where many rows meet holds up: Goldfarb and Idnani 1983
[[nodiscard]] Eigen::VectorXd solve_small_program(const Eigen::MatrixXd& h, const Eigen::VectorXd& g,
                                                  const Eigen::MatrixXd& rows, const Eigen::VectorXd& bounds);

}  // namespace softkin::inverse
