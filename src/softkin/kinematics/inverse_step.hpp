#pragma once

#include <Eigen/Core>
#include <softkin/kinematics/inverse_response.hpp>

namespace softkin::inverse {

/// How long a step may be, and what counts as nothing.
struct StepLimits {
  double radius = 1;            // of every share
  double sideways = 1;          // of what the step adds towards the preferred actuation
  double resolution_mm = 1e-4;  // a change of actuation over whole ranges that moves the terms by less moves nothing
};

struct InverseStep {
  Eigen::VectorXd move;       // f, shares
  double predicted = 0;       // reduction of half the sum of squares [mm^2]
  double predicted_norm = 0;  // of the terms after the step, to first order [mm]
  double sideways = 0;        // largest share moved towards the preferred actuation, had it no limit
};

/// The step that reduces the sum of squares most, in the ranges and with no cable pushing; of all steps that do, the
/// one that ends nearest to the preferred actuation.
///
/// curvature  f by f, of the terms, times the terms: what J^T J lacks of the Hessian [mm^2 per range^2]
/// preferred  f, shares; a slack cable that may be longer than its path is where it is preferred already
[[nodiscard]] InverseStep find_step(const Pose& pose, const Slopes& slopes, const Eigen::MatrixXd& curvature,
                                    const Eigen::VectorXd& preferred, const StepLimits& limits);

/// Model of half the sum of squares: its reduction by a move [mm^2].
[[nodiscard]] double predicted_reduction(const Pose& pose, const Slopes& slopes, const Eigen::MatrixXd& curvature,
                                         const Eigen::VectorXd& move);

/// Half the squared distance from the preferred actuation, in shares.
[[nodiscard]] double distance_from(const Pose& pose, const Eigen::VectorXd& preferred);

/// Norm of the projected gradient of the root of the sum of squares by the shares [mm per range].
[[nodiscard]] double projected_slope(const Pose& pose, const Slopes& slopes);

/// min 1/2 s.H s + g.s where rows s >= bounds; H symmetric positive definite, s of a handful of unknowns. bounds <= 0,
/// so that s = 0 is allowed.
///
/// returns  the minimiser, which meets the rows to rounding
/// source   dual active set, which no corner where many rows meet holds up: Goldfarb and Idnani 1983
[[nodiscard]] Eigen::VectorXd solve_small_program(const Eigen::MatrixXd& h, const Eigen::VectorXd& g,
                                                  const Eigen::MatrixXd& rows, const Eigen::VectorXd& bounds);

}  // namespace softkin::inverse
