#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/settling.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// Steps are tried with the stiffness of a shape that is nearer than this share of the diagonal.
constexpr double nearby = 1e-3;

}  // namespace

Settler::Settler(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
                 const ProgressCallback& progress, SolveReport& report)
    : system_(system),
      work_(work),
      team_(team),
      report_(report),
      newton_(system, work, team,
              {options.tolerance_mm, options.force_share, system.contact() || system.limp() ? 100 : 30,
               options.keep_history},
              progress, report) {}

/// Loads that are given are the demand's, wherever a prediction has them: one that goes on along a bent way of several
/// commands misses them, and no equation would tell.
void Settler::give_loads(const Demand& demand, Iterate& at) const {
  for (Index a = 0; a < system_.actuators(); ++a)
    if (!active[a] && system_.measures().given_load(a))
      at.multipliers[a] = system_.measures().given(a, demand.actuation[a]);
}

/// Do weights come, or dead forces, of which something may bear some?
bool Settler::weighs(const Demand& here, const Demand& there) const {
  return system_.contact() && here.share != there.share && system_.model().loads.dead.size() > 0 &&
         !system_.model().loads.dead.isZero(0);
}

/// Does anything push in a shape?
bool Settler::touches(const Iterate& at) const {
  OtherContact contact(system_, work_, team_);
  contact.straighten(at, 1);
  return contact.any_push();
}

/// To where softer contact holds, felt from farther away; of what falls from as far as is wanted for steps that what is
/// in the way does not cut to nothing, then nearer and nearer.
Newton::Outcome Settler::settle_softly(const Demand& demand, bool falls, OtherContact& contact, Iterate& at) {
  constexpr double modulus = 1e-4;
  constexpr double nearest = 6, finer = 8;  // reaches, over the contact distance
  constexpr double farthest = 0.1;          // of the diagonal
  const double most =
      falls ? std::max(nearest, farthest * system_.model().diagonal_mm / system_.model().contact.distance_mm) : nearest;
  constexpr int most_iterations = 20;  // of what was stuck for want of a way
  const std::vector<bool> before = active;
  const Iterate begun = at;
  const auto loosely = newton_.loosely(Newton::by_far);
  auto outcome = Newton::Outcome::stuck;
  const int iterations = report_.iterations;
  for (double first = nearest; outcome == Newton::Outcome::stuck && first <= most; first *= finer) {
    if (report_.iterations - iterations > most_iterations) break;
    at = begun;
    active = before;
    outcome = Newton::Outcome::converged;
    for (double reach = first; outcome == Newton::Outcome::converged && reach > nearest / finer; reach /= finer) {
      contact.set_firmness({modulus, reach, 1});
      outcome = settle_constraints(demand, Newton::Policy::descend, at, false);
    }
  }
  if (outcome == Newton::Outcome::converged) contact.straighten(at, nearest);
  return outcome;
}

/// From a prediction to where what touches pushes as it will, from an equilibrium: Newton's method on the shape alone
/// loses a face that rests on another, as it presses so little that it lies within a hundredth of the contact distance
/// of where forces end. Where nothing touched yet, through softer contact. What rubs does not yet.
Newton::Outcome Settler::foresee_contact(const Demand& demand, const Iterate& from, bool falls, Iterate& at) {
  constexpr double foresight = 2;
  const std::vector<bool> before = active;
  Iterate trial = at;
  work_.contacts->holds.clear();
  OtherContact contact(system_, work_, team_);
  contact.straighten(from, foresight);
  auto outcome = Newton::Outcome::converged;
  if (!contact.any_push()) {
    contact.forget();
    outcome = settle_softly(demand, falls, contact, trial);
  } else {
    system_.contacts()->follow_pushes(trial.positions - from.positions, 1, *work_.contacts);
  }
  if (outcome == Newton::Outcome::converged) outcome = newton_.settle_pushes(demand, active, trial);
  if (outcome == Newton::Outcome::converged)
    at = std::move(trial);
  else
    active = before;
  return outcome;
}

/// Does the workspace's factor hold the constraints that are active?
bool Settler::factor_holds_active() const {
  std::vector<bool> held(active.size());
  for (const Index a : work_.saddle.active()) held[a] = true;
  return held == active;
}

double Settler::renew_anchors(Iterate& at) {
  const bool known = free_way.turned.rows() > 0;
  return renew_friction(system_, good_shape, known ? free_way : FreeWay{at.positions, at.positions}, at, work_, team_);
}

/// Newton with friction that follows the normal forces by which it is limited; where that leads nowhere, with those
/// that it led to, and again from there.
Newton::Outcome Settler::settle(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised) {
  constexpr int most_rounds = 40;
  give_loads(demand, at);
  if (!system_.friction()) return settle_constraints(demand, policy, at, factorised);
  auto outcome = settle_following(demand, policy, at, factorised);
  if (outcome != Newton::Outcome::stuck) return outcome;
  hold_friction(system_, at, work_, team_);
  for (int round = 1; round <= most_rounds; ++round) {
    const bool near = round > 1 && factorised_nearby(at.positions) && factor_holds_active();
    outcome = settle_constraints(demand, policy, at, near);
    rounds_ = round;
    if (outcome != Newton::Outcome::converged && outcome != Newton::Outcome::unstable) return outcome;
    report_.physical.friction_change = renew_anchors(at);
    if (report_.physical.friction_change <= frictions_agree) break;
    if (round > 8 || (round & (round - 1)) != 0) continue;  // 1, 2, 4, 8
    const auto followed = settle_following(demand, policy, at, false);
    if (followed != Newton::Outcome::stuck) return followed;
    hold_friction(system_, at, work_, team_);
  }
  return outcome;
}

/// With friction that follows its normal forces, until nothing begins to touch any more. Where it is stuck nothing has
/// changed.
Newton::Outcome Settler::settle_following(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised) {
  constexpr int most_rounds = 5;
  const std::vector<bool> before = active;
  Iterate trial = at;
  rounds_ = 1;
  for (int round = 0; round < most_rounds; ++round) {
    const auto outcome = [&] {
      const FollowingFriction following(work_);
      return settle_constraints(demand, policy, trial, factorised);
    }();
    if (outcome != Newton::Outcome::converged && outcome != Newton::Outcome::unstable) {
      active = before;
      return outcome;
    }
    report_.physical.friction_change = renew_anchors(trial);
    if (report_.physical.friction_change <= frictions_agree) {
      at = std::move(trial);
      return outcome;
    }
    factorised = factorised_nearby(trial.positions) && factor_holds_active();
  }
  active = before;
  return Newton::Outcome::stuck;
}

/// Another equilibrium instead of the one at hand: what slips goes on from there.
void Settler::take(Iterate& at, Iterate&& found) {
  at = std::move(found);
  slide_friction(system_, at, work_, team_);
  if (system_.tendons().any()) system_.tendons().slide(at.positions, at.eyelets);
  good_shape = at.positions;
}

/// Newton, with cables released where they would push and taken up where they are too long.
Newton::Outcome Settler::settle_constraints(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised) {
  const std::vector<bool> before = active;
  for (Index change = 0; change <= 2 * system_.actuators(); ++change) {
    const auto outcome = newton_.solve(demand, active, policy, factorised && change == 0, at);
    if (outcome == Newton::Outcome::unmet) {
      if (release(demand, at, true)) continue;
      break;
    }
    if (outcome == Newton::Outcome::stuck || outcome == Newton::Outcome::interrupted) {
      active = before;
      return outcome;
    }
    if (!change_active(demand, at)) return outcome;
  }
  active = before;
  return Newton::Outcome::stuck;
}

bool Settler::change_active(const Demand& demand, Iterate& at) {
  bool changed = false;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!system_.measures().constrains(a) || !system_.measures().only_pulls(a)) continue;  // a chamber pushes and pulls
    const double target = system_.measures().target(a, demand.actuation, at.multipliers[a]);
    if (active[a] && at.multipliers[a] < 0) {
      active[a] = false;
      at.multipliers[a] = 0;
      changed = true;
    } else if (!active[a] && system_.measures().value(a, at.positions) > target * (1 + 1e-12)) {
      active[a] = true;
      changed = true;
    }
  }
  return changed;
}

/// Slackens cables that may be longer than they are and carry nothing: held to their length they would push the body
/// there before they are found to be slack. contradicting: those too that carry something, against another one.
bool Settler::release(const Demand& there, Iterate& at, bool contradicting) {
  bool changed = false;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!active[a] || !system_.measures().only_pulls(a) || (at.multipliers[a] > 0 && !contradicting)) continue;
    if (system_.measures().value(a, at.positions) >= system_.measures().target(a, there.actuation, 0)) continue;
    active[a] = false;
    at.multipliers[a] = 0;
    changed = true;
  }
  return changed;
}

Judgement Settler::judged() const {
  return {newton_.imbalance(), newton_.balanced(), newton_.inverted(), newton_.unstable_modes()};
}

/// Does the workspace hold the stable stiffness of a shape close by?
bool Settler::factorised_nearby(const Points& shape) const {
  return work_.factored.exact && work_.saddle.spectrum().unstable == 0 && work_.factored.shape.rows() == shape.rows() &&
         system_.largest_move(work_.factored.shape, shape) <= nearby * system_.model().diagonal_mm;
}

/// Factorises at an equilibrium, for the predictor. Returns in how many ways it is unstable; -1: it is none.
int Settler::prepare(const Demand& here, const Iterate& at) {
  Balance balance;
  hold_friction(system_, at, work_, team_);
  system_.evaluate(at, here, active, work_, balance, team_);
  ++report_.factorisations;
  const int modes = system_.factorise(at, here, active, balance, {}, work_, team_);
  report_.factorisations_in_double += work_.saddle.factor().in_double();
  return balance.force.allFinite() ? modes : -1;
}

}  // namespace softkin::physical
