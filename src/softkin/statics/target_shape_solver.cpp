#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/statics/target_shape_solver.hpp>

namespace softkin {

namespace {

/// Patience of Algorithm 1 where it is selected: where it converges slowly, its steps hardly shrink for long.
constexpr target_shape::Patience patience = {2000, std::numeric_limits<double>::infinity(), true};

void check_target_shape(const StaticsOptions& options) {
  if (options.beyond > 0)
    throw InvalidInput("beyond is for the physical formulation: target shapes have no pressures and tensions");
  if (options.stable)
    throw InvalidInput("stable is for the physical formulation: target shapes have no stiffness that buckles");
}

}  // namespace

TargetShapeSolver::TargetShapeSolver(const Model& model, Lender& lender)
    : model_(model),
      lender_(lender),
      system_(model),
      turning_(model),
      unknowns_(model, system_),
      global_(model, system_.global_matrix(), unknowns_.freedoms.vertex_order()),
      newton_(unknowns_, global_) {}

Equilibrium TargetShapeSolver::solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                                     const ProgressCallback& progress) {
  const TeamPool::Lent team = lender_.lend(options);
  check_elapsed(options.elapsed_s);
  if (options.history) throw InvalidInput("the history of the material is of another robot");
  check_target_shape(options);
  Equilibrium result;
  result.actuation = actuation;
  result.state.positions = start.positions;
  result.report.tolerance_mm = step_tolerance_mm(model_, options);
  follow_turns(start.actuation, options, progress, *team, result);
  if (result.report.status == Status::converged) result.state.actuation = actuation;
  result.state.multipliers = Eigen::VectorXd::Zero(actuation.size());
  return result;
}

/// Solves from result.state.positions. Where supports turn far it goes through intermediate equilibria: supported
/// vertices are put in their places at once, and elements that this turns over would stay so.
void TargetShapeSolver::follow_turns(const Actuation& start, const StaticsOptions& options,
                                     const ProgressCallback& progress, Team& team, Equilibrium& result) const {
  const Actuation requested = result.actuation;
  Actuation from = start.size() > 0 ? start : requested;
  for (Index a = 0; start.size() == 0 && a < requested.size(); ++a)
    if (model_.actuators[a].is<TurnCommand>()) from[a] = turning_.angle(a, result.state.positions);
  const int steps = std::max(1, static_cast<int>(std::ceil(turning_.largest_turn(from, 1, requested, 1) /
                                                           options.tuning.target_shape.max_turn)));
  Actuation last = steps > 1 ? from : start;
  int intermediate = 0;
  for (int step = 1; step <= steps; ++step) {
    result.actuation = step == steps ? requested : Actuation(from + (requested - from) * step / steps);
    result.report.status = Status::not_converged;
    if (options.solver == Solver::newton)
      newton_.solve(last, options, progress, team, result);
    else
      target_shape::solve_local_global({model_, system_, global_}, options, patience, progress, team, result);
    intermediate += result.report.continuation_steps;
    if (result.report.status != Status::converged) break;
    last = result.actuation;
  }
  if (options.solver == Solver::newton) result.report.continuation_steps = intermediate;
  result.actuation = requested;
}

Sensitivity TargetShapeSolver::sensitivity(const State& at, const StaticsOptions& options, double accuracy) const {
  return newton_.sensitivity(at, options.reuse_factor, accuracy, *lender_.lend(options));
}

}  // namespace softkin
