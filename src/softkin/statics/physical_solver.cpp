#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/statics/physical_solver.hpp>

namespace softkin {

void PhysicalSolver::check_history(const ViscousHistory* history, double elapsed_s) const {
  check_elapsed(elapsed_s);
  if (history && history->strains.size() != equilibria_.system().remembered())
    throw InvalidInput("the history of the material is of another robot");
}

physical::Equilibria::Options PhysicalSolver::options_of(const StaticsOptions& options) const {
  const double longest = step_tolerance_mm(model_, options);
  const double blur = 1e-6 * std::max(1.0, longest / step_tolerance_mm(model_, {}));
  return {.tolerance_mm = longest,
          .keep_history = options.keep_history,
          .trace = options.trace,
          .reuse_factor = options.reuse_factor,
          .stable = options.stable,
          .beyond = options.beyond,
          .force_fraction = blur,
          .history = options.history,
          .elapsed_s = options.elapsed_s,
          .tuning = options.tuning};
}

/// Finds, once, the relaxed equilibrium of a viscous robot after a long rest, before times begin; else not converged.
Equilibrium PhysicalSolver::long_rest(StaticsOptions options, const ProgressCallback& progress, Team& team) {
  const std::lock_guard lock(rested_mutex_);
  if (rested_) return *rested_;
  options.history = nullptr;
  options.elapsed_s = std::numeric_limits<double>::infinity();
  State start;
  start.positions = model_.rest;
  Equilibrium found = equilibria_.solve(model_.rest_actuation(), start, options_of(options), progress, team);
  if (found.report.status == Status::converged) {
    rested_ = found;
    remembered_ = equilibria_.flow(found.state, team).history;
  }
  return found;
}

Equilibrium PhysicalSolver::solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                                  const ProgressCallback& progress) {
  const TeamPool::Lent team = lender_.lend(options);
  check_history(options.history.get(), options.elapsed_s);
  if (options.solver == Solver::local_global)
    throw InvalidInput("solver local-global is for the target-shape formulation; the physical one has newton");
  const bool begins = equilibria_.system().viscous() && std::isfinite(options.elapsed_s) && !options.history;
  if (!begins) return equilibria_.solve(actuation, start, options_of(options), progress, *team);
  Equilibrium rest = long_rest(options, progress, *team);
  if (rest.report.status != Status::converged) {
    rest.actuation = actuation;
    rest.state.actuation.resize(0);
    rest.state.load_factor = -1;
    rest.report.reached = 0;
    const std::string& why = rest.report.remark;
    rest.report.remark = "the robot finds no rest before times begin" + (why.empty() ? "" : ": " + why);
    return rest;
  }
  physical::Equilibria::Options begun = options_of(options);
  begun.history = remembered_;
  const bool from_rest = start.actuation.size() == 0 && start.positions == model_.rest;
  return equilibria_.solve(actuation, from_rest ? rest.state : start, begun, progress, *team);
}

Sensitivity PhysicalSolver::sensitivity(const State& at, const StaticsOptions& options, double accuracy) const {
  return equilibria_.sensitivity(at, options_of(options), accuracy, *lender_.lend(options));
}

ViscousFlow PhysicalSolver::flow(const State& at) {
  check_history(at.history.get(), at.elapsed_s);
  const StaticsOptions options;
  const TeamPool::Lent team = lender_.lend(options);
  if (at.history || std::isinf(at.elapsed_s)) return equilibria_.flow(at, *team);
  if (long_rest(options, {}, *team).report.status != Status::converged)
    throw InvalidInput("the robot has no equilibrium at rest, where its times begin");
  State begun = at;
  begun.history = remembered_;
  return equilibria_.flow(begun, *team);
}

}  // namespace softkin
