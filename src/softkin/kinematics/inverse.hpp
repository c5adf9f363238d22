#pragma once

#include <softkin/kinematics/goal.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// newton: damped Gauss-Newton with the exact Jacobian. gradient: Algorithm 2 of the paper with central differences.
enum class InverseMethod { newton, gradient };

struct InverseOptions {
  InverseMethod method = InverseMethod::newton;
  double tolerance_mm = 1e-3;  // every goal's error at which it is reached, > 0; newton goes on to a hundredth
                               // where that costs no further equilibrium
  int max_equilibria = 200;    // >= 1
  Actuation preferred{};       // m: with more actuators than needed, the actuation to stay near; empty: the start's
  std::vector<bool> free{};    // m: actuators that may change; empty: all
  StaticsOptions statics{};
};

/// reached: every goal is met. unreachable: no allowed change of the actuation brings the goals nearer, to first order.
enum class InverseStatus { reached, unreachable, not_converged, interrupted };

struct InverseResult {
  InverseStatus status = InverseStatus::not_converged;
  Equilibrium equilibrium;    // at the best actuation found, inside every range
  Eigen::VectorXd errors_mm;  // per goal
  std::vector<int> active;    // m: -1 at the low end of its range and pushed there, +1 at the high end, else 0
  double slope = 0;           // norm of the projected gradient of the error (root of the weighted sum of squares)
                              // by the share of each range [mm]: 0 where no allowed change helps
  Sensitivity sensitivity;    // at the equilibrium; newton
  int iterations = 0, equilibria = 0;
  std::string remark;  // why it stopped, where status is not reached
  double seconds = 0;
};

/// Actuation at which the goals are met, or met as nearly as the ranges allow.
///
/// start   an equilibrium: State with its actuation, inside the ranges; statics.rest() with empty actuation will do
/// returns not reaching a goal is a status; commands never leave their ranges, not during the search either
/// source  Levenberg 1944, Marquardt 1963; More 1978; active bounds by projection (Kelley 1999, Section 5.5).
///         gradient: Fang et al. 2020, Alg. 2, as corrected in docs/paper.md
/// throws  InvalidInput as check_goals and Statics::solve do
[[nodiscard]] InverseResult solve_inverse(const Model& model, const Statics& statics, const std::vector<Goal>& goals,
                                          const State& start, const InverseOptions& options = {},
                                          const ProgressCallback& progress = {});

}  // namespace softkin
