#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/lease.hpp>
#include <softkin/statics/physical/newton.hpp>

namespace softkin::physical {

namespace {

double largest_move(const Points& a, const Points& b) {
  return (b - a).rowwise().norm().maxCoeff();
}

bool same_shape(const Points& a, const Points& b) {
  return a.rows() == b.rows() && a == b;
}

/// Shortest step of the continuation, over the way asked for.
constexpr double least_advance = 1e-4;
/// A step that moves no vertex farther than so many tolerances and yet fails leads nowhere.
constexpr double least_move = 1000;
/// In steps shorter than this an equilibrium is followed where it is unstable.
constexpr double follow_below = 0.05;
/// Under a growing load an equilibrium this many times as far from the predicted shape as that is from the last one
/// lies beyond a snap.
constexpr double most_correction = 0.5, least_snap = 0.01;
/// A longer step that inverts an element is made shorter: laws that have an energy for it have a mirrored equilibrium.
constexpr double most_inverting = 0.01;

class Continuation {
 public:
  Continuation(const System& system, System::Workspace& work, Team& team, const Equilibria::Options& options,
               const ProgressCallback& progress, SolveReport& report)
      : system_(system),
        work_(work),
        team_(team),
        newton_(system, work, team, {options.tolerance_mm, 30, options.keep_history}, progress, report),
        tolerance_mm_(options.tolerance_mm),
        max_iterations_(options.max_iterations),
        report_(report) {}

  /// Follows the equilibrium from `from` to `to`; at is the last good one.
  Status follow(const Demand& from, const Demand& to, Iterate& at) {
    active_.resize(static_cast<std::size_t>(system_.actuators()));
    for (Index a = 0; a < system_.actuators(); ++a) active_[a] = system_.constrains(a);
    double done = 0, advance = 1;
    Demand here = from;
    const bool loads_change = change_loads(from, to);
    (void)release(to, at, false);
    bool factorised = same_shape(work_.home, at.positions) && factor_holds_active();
    work_.home.resize(0, 3);
    if (!factorised && from.actuation == to.actuation && from.share == to.share) {
      const auto outcome = settle_here(to, at);
      if (outcome == Newton::Outcome::interrupted) return Status::interrupted;
      if (outcome == Newton::Outcome::converged) return Status::converged;
    }
    while (done < 1) {
      const double next = std::min(1.0, done + advance);
      const Demand there = between(from, to, next);
      Iterate trial = at;
      if (release(there, at, false)) factorised = false;
      if (!factorised && !prepare(here, at)) return limit(done, "the stiffness at the start is not stable");
      factorised = true;
      const double move_mm = predict(system_, here, there, active_, work_, team_, trial);
      const Points predicted = trial.positions;
      const int before = report_.iterations;
      auto outcome = settle(there, Newton::Policy::descend, trial);
      if (outcome == Newton::Outcome::stuck && next - done < follow_below && prepare(here, at)) {
        trial = at;
        (void)predict(system_, here, there, active_, work_, team_, trial);
        outcome = settle(there, Newton::Policy::follow, trial);
      }
      if (outcome == Newton::Outcome::interrupted) return Status::interrupted;
      if (loads_change && snapped(move_mm, predicted, trial.positions)) outcome = Newton::Outcome::stuck;
      if (outcome != Newton::Outcome::stuck && newton_.inverted() && !inverted_ && next - done > most_inverting)
        outcome = Newton::Outcome::stuck;
      if (outcome != Newton::Outcome::stuck) {
        at = std::move(trial);
        here = there;
        done = next;
        ++report_.continuation_steps;
        report_.reached = done;
        inverted_ = newton_.inverted();
        const int used = report_.iterations - before;
        advance *= used <= 5 ? 2 : used <= 9 ? 1.4 : 0.8;
        if (outcome == Newton::Outcome::unstable) advance = std::min(advance, follow_below);
      } else {
        factorised = false;
        advance = 0.4 * (next - done);
        if (advance < least_advance || move_mm < least_move * tolerance_mm_)
          return limit(done, "beyond this point no equilibrium follows");
      }
      if (done < 1 && report_.iterations >= max_iterations_) {
        report_.remark = "the limit of iterations was reached";
        return Status::not_converged;
      }
    }
    if (newton_.unstable_modes() > 0) tell_stability(to, at);
    return Status::converged;
  }

 private:
  /// Does the workspace's factor hold the constraints that are active?
  [[nodiscard]] bool factor_holds_active() const {
    std::vector<bool> held(active_.size());
    for (const Index a : work_.active) held[a] = true;
    return held == active_;
  }

  [[nodiscard]] bool snapped(double predicted_mm, const Points& predicted, const Points& found) const {
    const double correction = largest_move(predicted, found);
    return correction > most_correction * predicted_mm && correction > least_snap * system_.model().diagonal_mm;
  }

  [[nodiscard]] bool change_loads(const Demand& from, const Demand& to) const {
    if (system_.any_dead_load() && from.share != to.share) return true;
    for (Index a = 0; a < system_.actuators(); ++a)
      if (system_.measures().measures(a) && !system_.constrains(a) && from.actuation[a] != to.actuation[a]) return true;
    return false;
  }

  static Demand between(const Demand& from, const Demand& to, double share) {
    if (share == 1) return to;
    return {from.actuation + share * (to.actuation - from.actuation), from.share + share * (to.share - from.share)};
  }

  Status limit(double done, const std::string& why) {
    report_.reached = done;
    report_.remark = why;
    return Status::limit;
  }

  /// Slackens cables that may be longer than they are and carry nothing: held to their length they would push the body
  /// there before they are found to be slack. contradicting: those too that carry something, against another one.
  bool release(const Demand& there, Iterate& at, bool contradicting) {
    bool changed = false;
    for (Index a = 0; a < system_.actuators(); ++a) {
      if (!active_[a] || system_.sign(a) < 0 || (at.multipliers[a] > 0 && !contradicting)) continue;
      if (system_.measures().value(a, at.positions) >= system_.target(a, there)) continue;
      active_[a] = false;
      at.multipliers[a] = 0;
      changed = true;
    }
    return changed;
  }

  /// Counts the ways in which the last shape itself is unstable.
  void tell_stability(const Demand& demand, const Iterate& at) {
    System::Balance balance;
    system_.evaluate(at, demand, active_, work_, balance, team_);
    ++report_.factorisations;
    const int modes = system_.factorise(at, demand, active_, System::Stiffness::exact, 0, work_, team_);
    if (modes > 0)
      report_.remark = "this equilibrium is unstable in " + std::to_string(modes) + (modes == 1 ? " way" : " ways") +
                       ": the robot would buckle or snap away from it";
  }

  /// Factorises at an equilibrium, for the predictor.
  bool prepare(const Demand& here, const Iterate& at) {
    System::Balance balance;
    system_.evaluate(at, here, active_, work_, balance, team_);
    ++report_.factorisations;
    (void)system_.factorise(at, here, active_, System::Stiffness::exact, 0, work_, team_);
    return balance.force.allFinite();
  }

  /// Newton at once, where the start is as near to the equilibrium asked for as any prediction from it.
  Newton::Outcome settle_here(const Demand& demand, Iterate& at) {
    const std::vector<bool> before = active_;
    Iterate trial = at;
    auto outcome = settle(demand, Newton::Policy::descend, trial);
    if (newton_.inverted()) outcome = Newton::Outcome::stuck;
    if (outcome == Newton::Outcome::converged) {
      at = std::move(trial);
      ++report_.continuation_steps;
      report_.reached = 1;
    } else {
      active_ = before;
    }
    return outcome;
  }

  /// Newton, with cables released where they would push and taken up where they are too long.
  Newton::Outcome settle(const Demand& demand, Newton::Policy policy, Iterate& at) {
    const std::vector<bool> before = active_;
    for (Index change = 0; change <= 2 * system_.actuators(); ++change) {
      const auto outcome = newton_.solve(demand, active_, policy, at);
      if (outcome == Newton::Outcome::unmet) {
        if (release(demand, at, true)) continue;
        break;
      }
      if (outcome == Newton::Outcome::stuck || outcome == Newton::Outcome::interrupted) {
        active_ = before;
        return outcome;
      }
      if (!change_active(demand, at)) return outcome;
    }
    active_ = before;
    return Newton::Outcome::stuck;
  }

  bool change_active(const Demand& demand, Iterate& at) {
    bool changed = false;
    for (Index a = 0; a < system_.actuators(); ++a) {
      if (!system_.constrains(a) || system_.sign(a) < 0) continue;  // a chamber pushes and pulls
      const double target = system_.target(a, demand);
      if (active_[a] && at.multipliers[a] < 0) {
        active_[a] = false;
        at.multipliers[a] = 0;
        changed = true;
      } else if (!active_[a] && system_.measures().value(a, at.positions) > target * (1 + 1e-12)) {
        active_[a] = true;
        changed = true;
      }
    }
    return changed;
  }

  const System& system_;
  System::Workspace& work_;
  Team& team_;
  Newton newton_;
  double tolerance_mm_;
  int max_iterations_;
  SolveReport& report_;
  std::vector<bool> active_;
  bool inverted_ = false;  // is an element of the last good shape
};

/// What the start is an equilibrium of, as far as it tells.
Demand demand_of(const System& system, const Model& model, const State& start) {
  if (start.actuation.size() > 0) return {start.actuation, start.share};
  Demand demand{model.rest_actuation(), start.positions == model.rest ? 0.0 : 1.0};
  for (Index a = 0; a < system.actuators(); ++a) {
    if (system.constrains(a))
      demand.actuation[a] = system.measures().value(a, start.positions) / system.measures().rest(a);
    else if (model.actuators[a].kind == ActuatorKind::dea)
      demand.actuation[a] = 1;
    else
      demand.actuation[a] = start.multipliers.size() > 0 ? start.multipliers[a] : 0;
  }
  return demand;
}

}  // namespace

/// From a start that is no equilibrium no path may lead away; from rest one may.
void Equilibria::forget() const {
  const std::lock_guard lock(mutex_);
  idle_.clear();
}

void Equilibria::begin_again(const Demand& to, const Options& options, const ProgressCallback& progress, Team& team,
                             System::Workspace& work, Iterate& at, SolveReport& report) const {
  const std::string remark = report.remark;
  Iterate fresh{system_.model().rest, Eigen::VectorXd::Zero(system_.actuators())};
  system_.freedoms().hold(0, fresh.positions);
  Continuation continuation(system_, work, team, options, progress, report);
  const Status status = continuation.follow({system_.model().rest_actuation(), 0}, to, fresh);
  if (status == Status::converged) {
    at = std::move(fresh);
    report.status = status;
    if (report.remark == remark) report.remark.clear();
    return;
  }
  if (status == Status::interrupted) report.status = status;
  report.remark = remark;
  report.reached = 0;
}

Equilibrium Equilibria::solve(const Actuation& actuation, const State& start, const Options& options,
                              const ProgressCallback& progress, Team& team) const {
  const Model& model = system_.model();
  Equilibrium result;
  result.actuation = actuation;
  SolveReport& report = result.report;
  report.solver = "newton";
  report.tolerance_mm = options.tolerance_mm;
  report.reached = 0;
  Lease lease(*this, start.positions, options.reuse_factor);

  const Demand from = demand_of(system_, model, start), to{actuation, 1};
  Iterate at{start.positions, Eigen::VectorXd::Zero(system_.actuators())};
  system_.freedoms().hold(from.share, at.positions);
  if (start.multipliers.size() > 0)
    for (Index a = 0; a < system_.actuators(); ++a) at.multipliers[a] = system_.unit(a) * start.multipliers[a];
  report.status = Continuation(system_, lease.work(), team, options, progress, report).follow(from, to, at);
  if (report.status == Status::limit && report.continuation_steps == 0 && start.positions != model.rest)
    begin_again(to, options, progress, team, lease.work(), at, report);
  if (report.status == Status::converged) lease.work().home = at.positions;
  report.estimated_error_mm = report.step_mm;
  result.state.positions = std::move(at.positions);
  result.state.actuation = actuation;
  if (report.status != Status::converged) {
    result.state.actuation = from.actuation + report.reached * (actuation - from.actuation);
    result.state.share = from.share + report.reached * (to.share - from.share);
  }
  result.state.multipliers = at.multipliers;
  for (Index a = 0; a < system_.actuators(); ++a) result.state.multipliers[a] /= system_.unit(a);
  return result;
}

}  // namespace softkin::physical
