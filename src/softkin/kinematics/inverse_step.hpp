#pragma once

#include <Eigen/Core>
#include <softkin/kinematics/inverse_response.hpp>

namespace softkin::inverse {

/// The maximum length of a step, and the smallest effect that counts.
struct StepLimits {
  double radius = 1;            // of every fraction
  double sideways = 1;          // of the part of the step towards the preferred actuation
  double resolution_mm = 1e-4;  // a change of actuation over whole ranges that changes the terms by less has no effect
};

struct InverseStep {
  Eigen::VectorXd move;       // f, fractions
  double predicted = 0;       // reduction of half the sum of squares [mm^2]
  double predicted_norm = 0;  // of the terms after the step, to first order [mm]
  double sideways = 0;        // largest fraction of a range moved towards the preferred actuation, without limit
};

/// The step that reduces the sum of squares most, in the ranges and with no cable pushing; of all steps that do, the
/// one that ends nearest to the preferred actuation.
///
/// curvature  f by f, of the terms, times the terms: what J^T J lacks of the Hessian [mm^2 per range^2]
/// preferred  f, fractions; a slack cable that is preferred longer than its path has reached it already
[[nodiscard]] InverseStep find_step(const Pose& pose, const Slopes& slopes, const Eigen::MatrixXd& curvature,
                                    const Eigen::VectorXd& preferred, const StepLimits& limits);

/// Returns the reduction of half the sum of squares by a move, as the quadratic model predicts it [mm^2].
[[nodiscard]] double predicted_reduction(const Pose& pose, const Slopes& slopes, const Eigen::MatrixXd& curvature,
                                         const Eigen::VectorXd& move);

/// Returns half the squared distance from the preferred actuation, in fractions of the ranges.
[[nodiscard]] double distance_from(const Pose& pose, const Eigen::VectorXd& preferred);

/// Returns the norm of the projected gradient of the root of the sum of squares by the fractions [mm per range].
[[nodiscard]] double projected_slope(const Pose& pose, const Slopes& slopes);

/// Solves min 1/2 s.H s + g.s subject to rows s >= bounds; H is symmetric positive definite and has few unknowns;
/// bounds <= 0, so that s = 0 is feasible.
///
/// returns  the minimiser, which satisfies the rows within rounding
/// source   dual active-set method, which does not cycle at corners where many rows meet: Goldfarb and Idnani 1983
[[nodiscard]] Eigen::VectorXd solve_small_program(const Eigen::MatrixXd& h, const Eigen::VectorXd& g,
                                                  const Eigen::MatrixXd& rows, const Eigen::VectorXd& bounds);

}  // namespace softkin::inverse
