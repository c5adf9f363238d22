#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/corrector.hpp>
#include <utility>

namespace softkin::physical {

namespace {

int max_iterations_of(const System& system, const ConvergenceOptions& options) {
  return system.contact() || system.has_wrinkling() ? options.max_contact_iterations : options.max_iterations;
}

}  // namespace

Corrector::Corrector(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
                     const ProgressCallback& progress, SolveRecord& record, SolveReport& report)
    : system_(system),
      work_(work),
      team_(team),
      tuning_(work.options),
      record_(record),
      report_(report),
      newton_(system, work, team,
              {options.tolerance_mm, options.force_fraction, max_iterations_of(system, work.options.newton.convergence),
               options.keep_history},
              progress, record) {}

/// Sets the given loads to those of the load state, whatever the prediction has: a prediction along a curved path of
/// several commands misses them, and no equation would correct that.
void Corrector::give_loads(const LoadState& load_state, Iterate& at) const {
  for (Index a = 0; a < system_.actuators(); ++a)
    if (!active[a] && system_.measures().given_load(a))
      at.multipliers[a] = system_.measures().given(a, load_state.actuation[a]);
}

/// Do dead loads change, and may contact carry a part of them?
bool Corrector::weighs(const LoadState& here, const LoadState& there) const {
  return system_.contact() && here.load_factor != there.load_factor && system_.model().loads.dead.size() > 0 &&
         !system_.model().loads.dead.isZero(0);
}

/// Are there contact forces at a shape?
bool Corrector::touches(const Iterate& at) const {
  OtherContact contact(system_, work_, team_);
  contact.straighten(at, 1);
  return contact.any_push();
}

/// Corrects a shape with a softer contact of larger reach. With `falls` larger reaches are tried until collisions no
/// longer cut the steps to nothing; the reach is then reduced again.
Newton::Outcome Corrector::correct_softly(const LoadState& load_state, bool falls, OtherContact& contact, Iterate& at) {
  const double nearest = tuning_.contact.soft_reach, finer = tuning_.contact.soft_reduction;
  const double most = falls ? std::max(nearest, tuning_.contact.fall_reach * system_.model().diagonal_mm /
                                                    system_.model().contact.distance_mm)
                            : nearest;
  const std::vector<bool> before = active;
  const Iterate begun = at;
  const auto relaxed = newton_.with_relaxed_tolerance(tuning_.newton.convergence.coarse_tolerance);
  auto outcome = Newton::Outcome::stuck;
  const int iterations = record_.iterations;
  for (double first = nearest; outcome == Newton::Outcome::stuck && first <= most; first *= finer) {
    if (record_.iterations - iterations > tuning_.contact.max_soft_iterations) break;
    at = begun;
    active = before;
    outcome = Newton::Outcome::converged;
    for (double reach = first; outcome == Newton::Outcome::converged && reach > nearest / finer; reach /= finer) {
      contact.set_stiffness_scale({tuning_.contact.soft_modulus, reach, 1});
      outcome = correct_constraints(load_state, Newton::Policy::descend, at, false);
    }
  }
  if (outcome == Newton::Outcome::converged) contact.straighten(at, nearest);
  return outcome;
}

/// Moves a prediction, made from an equilibrium, to a shape with consistent contact forces. Newton's method on the
/// shape alone loses a face that rests on another: its pressure is so small that the face lies within a hundredth of
/// the contact distance of where the forces end. Without contact so far, softer contact is used. Friction is added
/// later.
Newton::Outcome Corrector::predict_contact(const LoadState& load_state, const Iterate& from, bool falls, Iterate& at) {
  const std::vector<bool> before = active;
  Iterate trial = at;
  work_.contacts->holds.clear();
  OtherContact contact(system_, work_, team_);
  contact.straighten(from, tuning_.contact.linear_reach);
  auto outcome = Newton::Outcome::converged;
  if (!contact.any_push()) {
    contact.forget();
    outcome = correct_softly(load_state, falls, contact, trial);
  } else {
    system_.contacts()->follow_pushes(trial.positions - from.positions, 1, *work_.contacts);
  }
  if (outcome == Newton::Outcome::converged) outcome = newton_.correct_pushes(load_state, active, trial);
  if (outcome == Newton::Outcome::converged)
    at = std::move(trial);
  else
    active = before;
  return outcome;
}

/// Are the constraints of the last factorisation the active ones?
bool Corrector::factor_holds_active() const {
  std::vector<bool> held(active.size());
  for (const Index a : work_.saddle.active()) held[a] = true;
  return held == active;
}

double Corrector::renew_anchors(Iterate& at) {
  const bool known = free_motion.turned.rows() > 0;
  return renew_friction(system_, good_shape, known ? free_motion : FreeMotion{at.positions, at.positions}, at, work_,
                        team_);
}

/// Solves with friction that follows the normal forces; if that fails, with friction from fixed normal forces, which
/// are updated after each solve.
Newton::Outcome Corrector::correct(const LoadState& load_state, Newton::Policy policy, Iterate& at, bool factorised) {
  const int max_rounds = tuning_.contact.fixed_friction_rounds;
  give_loads(load_state, at);
  if (!system_.friction()) return correct_constraints(load_state, policy, at, factorised);
  auto outcome = correct_following(load_state, policy, at, factorised);
  if (outcome != Newton::Outcome::stuck) return outcome;
  hold_friction(system_, at, work_, team_);
  for (int round = 1; round <= max_rounds; ++round) {
    const bool near = round > 1 && factorised_nearby(at.positions) && factor_holds_active();
    outcome = correct_constraints(load_state, policy, at, near);
    rounds_ = round;
    if (outcome != Newton::Outcome::converged && outcome != Newton::Outcome::unstable) return outcome;
    record_.friction_change = renew_anchors(at);
    if (record_.friction_change <= tuning_.contact.friction_tolerance) break;
    if (round > 8 || (round & (round - 1)) != 0) continue;  // 1, 2, 4, 8
    const auto followed = correct_following(load_state, policy, at, false);
    if (followed != Newton::Outcome::stuck) return followed;
    hold_friction(system_, at, work_, team_);
  }
  return outcome;
}

/// Solves with friction that follows its normal forces, until no new contact begins. If it fails, nothing has changed.
Newton::Outcome Corrector::correct_following(const LoadState& load_state, Newton::Policy policy, Iterate& at,
                                             bool factorised) {
  const int max_rounds = tuning_.contact.following_friction_rounds;
  const std::vector<bool> before = active;
  Iterate trial = at;
  rounds_ = 1;
  for (int round = 0; round < max_rounds; ++round) {
    const auto outcome = [&] {
      const FollowingFriction following(work_);
      return correct_constraints(load_state, policy, trial, factorised);
    }();
    if (outcome != Newton::Outcome::converged && outcome != Newton::Outcome::unstable) {
      active = before;
      return outcome;
    }
    record_.friction_change = renew_anchors(trial);
    if (record_.friction_change <= tuning_.contact.friction_tolerance) {
      at = std::move(trial);
      return outcome;
    }
    factorised = factorised_nearby(trial.positions) && factor_holds_active();
  }
  active = before;
  return Newton::Outcome::stuck;
}

/// Replaces the current equilibrium by another one; sliding contacts and tendons continue from there.
void Corrector::take(Iterate& at, Iterate&& found) {
  at = std::move(found);
  slide_friction(system_, at, work_, team_);
  if (system_.tendons().any()) system_.tendons().slide(at.positions, at.eyelets);
  good_shape = at.positions;
}

/// Solves with an active set of cables: deactivates those that would push and activates those that are too long.
Newton::Outcome Corrector::correct_constraints(const LoadState& load_state, Newton::Policy policy, Iterate& at,
                                               bool factorised) {
  const std::vector<bool> before = active;
  for (Index change = 0; change <= 2 * system_.actuators(); ++change) {
    const auto outcome = newton_.solve(load_state, active, policy, factorised && change == 0, at);
    if (outcome == Newton::Outcome::unmet) {
      if (release(load_state, at, true)) continue;
      break;
    }
    if (outcome == Newton::Outcome::stuck || outcome == Newton::Outcome::interrupted) {
      active = before;
      return outcome;
    }
    if (!change_active(load_state, at)) return outcome;
  }
  active = before;
  return Newton::Outcome::stuck;
}

bool Corrector::change_active(const LoadState& load_state, Iterate& at) {
  bool changed = false;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!system_.measures().constrains(a) || !system_.measures().only_pulls(a)) continue;  // a chamber pushes and pulls
    const double target = system_.measures().target(a, load_state.actuation, at.multipliers[a]);
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

/// Deactivates cables that are shorter than commanded and have no tension: as constraints they would push the body
/// before they are found to be slack. contradicting: also cables with tension, which contradict another one.
bool Corrector::release(const LoadState& there, Iterate& at, bool contradicting) {
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

Judgement Corrector::judged() const {
  return {newton_.imbalance(), newton_.balanced(), newton_.inverted(), newton_.unstable_modes()};
}

/// Is the last factorisation exact, stable and of a nearby shape?
bool Corrector::factorised_nearby(const Points& shape) const {
  return work_.factored.exact && work_.saddle.spectrum().unstable == 0 && work_.factored.shape.rows() == shape.rows() &&
         system_.largest_move(work_.factored.shape, shape) <=
             tuning_.newton.factor.max_distance * system_.model().diagonal_mm;
}

/// Factorises at an equilibrium, for the predictor. Returns the number of unstable modes; -1: forces are not finite.
int Corrector::prepare(const LoadState& here, const Iterate& at) {
  Balance balance;
  hold_friction(system_, at, work_, team_);
  system_.evaluate(at, here, active, work_, balance, team_);
  const int modes = system_.factorise(at, here, active, balance, {}, work_, team_);
  record_.note_factorisation(work_.saddle.factor().in_double());
  return balance.force.allFinite() ? modes : -1;
}

}  // namespace softkin::physical
