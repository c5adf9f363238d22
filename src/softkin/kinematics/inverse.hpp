#pragma once

#include <softkin/kinematics/goal.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// newton: damped Gauss-Newton with the exact Jacobian. gradient: Algorithm 2 of the paper with central differences.
enum class InverseMethod { newton, gradient };
/// "newton" or "gradient".
[[nodiscard]] const char* name_of(InverseMethod method);

/// How inverse kinematics searches. Ranges stand behind the values.
struct InverseOptions {
  InverseMethod method = InverseMethod::newton;  // how it searches
  double tolerance_mm = 1e-3;                    // every goal's error at which it is reached, > 0
  int max_equilibria = 200;                      // >= 1; newton
  int max_iterations = 30;                       // >= 1; gradient: i_max
  int other_starts = 3;   // >= 0; newton: further starts that are tried before a goal is reported as unreachable
  Actuation preferred{};  // m, in the ranges: with more actuators than needed, the actuation to stay near; empty:
                          // the start's
  double preferred_tolerance = 1e-3;  // > 0; distance from the nearest such actuation, over each range [-]; newton
  std::vector<bool> free{};           // m: actuators that may change; empty: all
  const Sensitivity* start_sensitivity = nullptr;  // of the start, an equilibrium, such as the last
                                                   // result's; null: is computed
  StaticsOptions statics{};                        // at their deadline the search ends, not converged, with its best
};

/// Returns the default options of a method; the tolerance depends on it: 0.2 mm with gradient, the paper's lambda.
[[nodiscard]] InverseOptions usual_options(InverseMethod method);

/// reached: every goal is met. unreachable: no allowed change of the actuation brings the goals nearer, to first order.
enum class InverseStatus { reached, unreachable, not_converged, interrupted };
/// "reached", "not reached", "not converged" or "interrupted".
[[nodiscard]] const char* name_of(InverseStatus status);

/// An equilibrium that a search solved for.
struct InverseTrial {
  Actuation actuation;                    // requested
  Status status = Status::not_converged;  // of its solve
  double error_mm = 0;                    // largest of the goals; infinite where status is not converged
  int iterations = 0;                     // of Newton's method or Algorithm 1
};

/// The best actuation that a search found, and how it ended.
struct InverseResult {
  InverseStatus status = InverseStatus::not_converged;  // of the search
  bool stopped = false;                                 // by progress or the deadline: the best so far
  Equilibrium equilibrium;                              // at the best actuation found, inside every range
  Eigen::VectorXd errors_mm;                            // per goal; of a force times its mm_per_N
  std::vector<int> active;  // m: -1 at the low end of its range and pushed there, +1 at the high end, else 0
  double slope = 0;         // norm of the projected gradient of the error (root of the weighted sum of squares)
                            // by the fraction of each range [mm]: 0 where no allowed change helps; newton
  Sensitivity sensitivity;  // at the equilibrium, to 1e-6; newton
  int iterations = 0, equilibria = 0;  // steps of the search, and equilibria solved for
  std::vector<InverseTrial> history;   // every equilibrium
  std::string remark;                  // why it stopped, where status is not reached
  double seconds = 0;                  // that it took [s]
};

/// Finds the actuation at which the goals are met, or met as closely as the ranges allow.
///
/// start     an equilibrium: State with its actuation, inside the ranges; statics.rest() with empty actuation is
///           sufficient. Where it remains the best one it is solved for, so that the report describes it
/// progress  iteration: equilibria so far; step_mm: the least error so far, of the farthest goal [mm]
/// returns   the best result: a goal that is not reached is a status; commands never leave their ranges, not during the
///           search either. A cable that ends slack keeps its preferred length where its path allows it
/// source    Gauss-Newton in a trust region: Levenberg 1944, Marquardt 1963, More 1978; ranges and slack cables as
///           inequalities of its quadratic steps (Nocedal and Wright 2006, Section 16.5); curvature of the remaining
///           errors: Dennis, Gay and Welsch 1981; updated slopes: Broyden 1965.
///           The problem is Eq. (13) of Fang et al. 2020; gradient: their Alg. 2, as corrected in docs/paper.md
/// throws    InvalidInput as check_goals and Statics::solve do; on options out of range, sizes that do not fit, a
///           preferred actuation or a start outside the ranges
[[nodiscard]] InverseResult solve_inverse(const Statics& statics, const std::vector<Goal>& goals, const State& start,
                                          const InverseOptions& options = {}, const ProgressCallback& progress = {});

/// The same from an equilibrium that solve() returned, which need not be solved for again: where it remains the best
/// one, its report is that of the result.
[[nodiscard]] InverseResult solve_inverse(const Statics& statics, const std::vector<Goal>& goals,
                                          const Equilibrium& start, const InverseOptions& options = {},
                                          const ProgressCallback& progress = {});

/// The same from an actuation, whose equilibrium is found first, from rest; it is the first of the history. Where it
/// has none, errors_mm is empty and the remark contains the reason; where the solve was stopped before it got there,
/// they belong to the last good shape.
[[nodiscard]] InverseResult solve_inverse_from(const Statics& statics, const std::vector<Goal>& goals,
                                               const Actuation& start, const InverseOptions& options = {},
                                               const ProgressCallback& progress = {});

}  // namespace softkin
