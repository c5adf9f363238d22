#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/prediction.hpp>
#include <utility>

namespace softkin::physical {

namespace {

bool are_of(const Slopes& slopes, const Iterate& at) {
  return slopes.at.rows() == at.positions.rows() && slopes.at == at.positions;
}

std::vector<bool> held(const Slopes& slopes, Index actuators) {
  std::vector<bool> active(actuators);
  for (const Index a : slopes.held) active[a] = true;
  return active;
}

/// First-order change of unknowns and multipliers.
struct Tangent {
  Eigen::VectorXd step, change;

  /// From the sensitivities that a derivative found before.
  Tangent(const Slopes& slopes, const LoadState& here, const LoadState& there) {
    const Eigen::VectorXd path = there.actuation - here.actuation;
    const Eigen::VectorXd multipliers = slopes.multipliers * path;
    step = slopes.moves * path;
    change.setZero(path.size());
    for (std::size_t i = 0; i < slopes.held.size(); ++i) change[slopes.held[i]] = multipliers[i];
  }

  Tangent(const System& system, const LoadState& here, const LoadState& there, const std::vector<bool>& active,
          Workspace& work, Team& team, const Iterate& at) {
    const Slopes& slopes = work.tangents;
    if (here.load_factor == there.load_factor && here.fading == there.fading && are_of(slopes, at) &&
        held(slopes, system.actuators()) == active) {
      *this = Tangent(slopes, here, there);
      return;
    }
    Balance balance;
    const bool of_here =
        work.factored.exact && work.factored.shape.rows() == at.positions.rows() && work.factored.shape == at.positions;
    // only the factor of the saddle contains the direction in which tendons with friction slip
    const bool refined = (!of_here || !work.saddle.factor().in_double()) && !system.tendons().any();
    const bool assembled = work.stiffness.assembled != 0 && work.stiffness.assembled == work.factored.by;
    if (refined || here.fading != there.fading || here.load_factor != there.load_factor ||
        (!assembled && system.placement().changes(here, there))) {
      hold_friction(system, at, work, team);
      system.evaluate(at, here, active, work, balance, team);
      system.assemble(at, here, balance, System::Stiffness::exact, work, team);
    }
    Balance residual_change;
    system.residual_change(at, here, there, active, work, residual_change, team);
    if (!refined || !refine(system, balance, residual_change, work, team, at))
      work.saddle.step(residual_change, step, change, team);
    if (step.allFinite() && change.allFinite()) return;
    step.setZero();
    change.setZero();
  }

 private:
  /// Solves with the stiffness of the current state; false where that fails.
  bool refine(const System& system, const Balance& balance, const Balance& residual_change, Workspace& work, Team& team,
              const Iterate& at) {
    Bordered equations(system, work, team);
    equations.set(at, balance);
    system.gather(at, balance, work, team);
    const PredictionOptions& options = work.options.path.prediction;
    return equations.step(residual_change, options.tangent_accuracy, options.tangent_rounds, step, change).left < 1;
  }
};

/// Moves multipliers by a fraction of a tangent; given ones become those of `there`.
void follow(const Tangent& tangent, double fraction, const System& system, const LoadState& there,
            const std::vector<bool>& active, Eigen::VectorXd& multipliers) {
  multipliers += fraction * tangent.change;
  for (Index a = 0; a < system.actuators(); ++a)
    if (!active[a] && system.measures().given_load(a)) multipliers[a] = system.measures().given(a, there.actuation[a]);
}

/// Returns a shape that is moved along a tangent to first order, with supported vertices at their targets.
Points moved_straight(const System& system, const Tangent& tangent, const LoadState& there, const Points& from) {
  Points straight = from;
  system.freedoms().move(tangent.step, 1, straight);
  system.placement().hold(there, straight);
  return straight;
}

}  // namespace

double predict(const System& system, const LoadState& here, const LoadState& there, const std::vector<bool>& active,
               Workspace& work, Team& team, Iterate& at) {
  const Tangent tangent(system, here, there, active, work, team, at);
  const Points before = at.positions;
  system.advance(tangent.step, 1, work, at.positions, team, &there);
  follow(tangent, 1, system, there, active, at.multipliers);
  return system.largest_move(before, at.positions);
}

Points first_order_moves(const System& system, const LoadState& here, const LoadState& there,
                         const std::vector<bool>& active, Workspace& work, Team& team, const Iterate& at) {
  const Tangent tangent(system, here, there, active, work, team, at);
  return moved_straight(system, tangent, there, at.positions) - at.positions;
}

ClearPrediction predict_clear(const System& system, const LoadState& here, const LoadState& there,
                              const std::vector<bool>& active, Workspace& work, Team& team, Iterate& at) {
  const PredictionOptions& options = work.options.path.prediction;
  const Tangent tangent(system, here, there, active, work, team, at);
  const Points from = at.positions;
  ClearPrediction clear;
  // supported vertices reach their targets even where the motion is cut
  double held = 1;
  const Motion path = [&](double fraction, Points& out) {
    const LoadState to = between(here, there, fraction / held);
    out = from;
    system.advance(tangent.step, fraction, work, out, team, &to);
  };
  double end = 1;
  for (bool first = true;; first = false) {
    held = end;
    const double fraction = clear_fraction(system, from, path, end, work, at.positions, team);
    if (first) {
      clear.predicted = at.positions;
      clear.straight = moved_straight(system, tangent, there, from);
    }
    if (fraction >= end) break;
    clear.cut = true;
    end = options.clear_fraction * fraction;
    if (end < options.max_cut &&
        system.largest_move(from, clear.predicted) > options.long_move * system.model().diagonal_mm)
      return clear;
    if (end >= options.min_fraction) continue;
    end = 0;  // only supported vertices move
    const Motion alone = [&](double part, Points& out) {
      out = from;
      system.placement().hold(between(here, there, part), out);
    };
    if (clear_fraction(system, from, alone, 1, work, at.positions, team) < 1) return clear;
    break;
  }
  follow(tangent, end, system, there, active, at.multipliers);
  clear.move_mm = system.largest_move(from, at.positions);
  return clear;
}

bool carry_held(const System& system, const LoadState& here, const LoadState& there, const std::vector<bool>& active,
                Workspace& work, Team& team, Iterate& at) {
  Points held = at.positions;
  system.placement().hold(there, held);
  if (held == at.positions) return true;
  Balance balance;
  hold_friction(system, at, work, team);
  system.evaluate(at, here, active, work, balance, team);
  system.assemble(at, here, balance, System::Stiffness::exact, work, team);
  Balance residual_change;
  const Points force = system.residual_change_by_supports(at, there, active, work, residual_change, team);
  residual_change.force.resize(system.freedoms().size());
  system.freedoms().reduce(force, at.positions, residual_change.force);
  Eigen::VectorXd step, change;
  work.saddle.step(residual_change, step, change, team);
  if (!step.allFinite()) return false;
  const Points from = at.positions;
  const Motion path = [&](double fraction, Points& out) {
    const LoadState to = between(here, there, fraction);
    out = from;
    system.advance(step, fraction, work, out, team, &to);
  };
  return clear_fraction(system, from, path, 1, work, at.positions, team) >= 1;
}

bool extrapolate(const System& system, const LoadState& here, const LoadState& there, Workspace& work, Team& team,
                 const Iterate& at, Points& positions) {
  Slopes& slopes = work.tangents;
  if (system.contact() || !are_of(slopes, at)) return false;
  const std::vector<bool> active = held(slopes, system.actuators());
  slopes.extrapolated_for.resize(0);
  Tangent path(slopes, here, there);
  const double length = system.freedoms().size_of(path.step, at.positions).largest;
  const double reach =
      std::min(1.0, work.options.path.prediction.second_order_move * system.model().diagonal_mm / length);
  // residuals at both sides along the tangent; their first order cancels, as the tangent solves those equations
  Balance balance;
  Eigen::VectorXd force, constraint;
  for (const double fraction : {reach, -reach}) {
    Iterate beside = at;
    system.advance(path.step, fraction, work, beside.positions, team);
    follow(path, fraction, system, between(here, there, fraction), active, beside.multipliers);
    system.evaluate(beside, between(here, there, fraction), active, work, balance, team);
    if (balance.forbidden || !balance.force.allFinite()) return false;
    if (fraction > 0) {
      force = balance.force;
      constraint = balance.constraint;
    }
  }
  balance.force = (balance.force + force) / (2 * reach * reach);
  balance.constraint = (balance.constraint + constraint) / (2 * reach * reach);
  Eigen::VectorXd bend, change;
  work.saddle.step(balance, bend, change, team);
  if (!bend.allFinite() || !change.allFinite()) return false;
  path.step += bend;
  path.change += change;
  slopes.extrapolated = at;
  system.advance(path.step, 1, work, slopes.extrapolated.positions, team);
  follow(path, 1, system, there, active, slopes.extrapolated.multipliers);
  slopes.extrapolated_for = there.actuation;
  positions = slopes.extrapolated.positions;
  return true;
}

bool follow_extrapolated(const System& system, const LoadState& here, const LoadState& there,
                         const std::vector<bool>& active, Workspace& work, Team& team, Iterate& at) {
  const Slopes& slopes = work.tangents;
  if (slopes.extrapolated_for.size() == 0 || !are_of(slopes, at) || held(slopes, system.actuators()) != active ||
      here.load_factor != there.load_factor || here.fading != there.fading)
    return false;
  const LoadState extrapolated{slopes.extrapolated_for, there.load_factor};
  if (!((there.actuation - extrapolated.actuation).norm() <
        work.options.path.prediction.max_remainder * (there.actuation - here.actuation).norm()))
    return false;
  // the rest of the path, along the tangents at its start
  const Tangent tangent(slopes, extrapolated, there);
  at = slopes.extrapolated;
  system.advance(tangent.step, 1, work, at.positions, team, &there);
  follow(tangent, 1, system, there, active, at.multipliers);
  return true;
}

bool follow_initial_guess(const LoadState& here, const LoadState& there, Workspace& work, Iterate& at) {
  if (!work.initial_guess) return false;
  const State initial_guess = *std::exchange(work.initial_guess, std::nullopt);
  if (initial_guess.actuation != there.actuation || here.load_factor != there.load_factor || here.fading != 0 ||
      there.fading != 0)
    return false;
  at.positions = initial_guess.positions;
  at.multipliers = initial_guess.multipliers;
  return true;
}

Predictor::Predictor(const System& system, Workspace& work, const State& at, Team& team)
    : system_(system), work_(work), at_(at), iterate_(system.iterate(at)), active_(system.actuators()) {
  for (Index a = 0; a < system.actuators(); ++a) {
    // measures of chambers are always constrained, those of cables where they are in tension
    active_[a] = system.measures().constrains(a) && (!system.measures().only_pulls(a) || iterate_.multipliers[a] > 0);
  }
  Balance balance;
  const LoadState load_state{at.actuation, at.load_factor};
  system.set_time(at.history, at.elapsed_s, work_, team);
  hold_friction(system, iterate_, work_, team);
  system.evaluate(iterate_, load_state, active_, work_, balance, team);
  (void)system.factorise(iterate_, load_state, active_, balance, {}, work_, team);
}

State Predictor::predict(const Actuation& actuation, Team& team) {
  Iterate there = iterate_;
  const LoadState here{at_.actuation, at_.load_factor}, requested{actuation, 1};
  if (!predict_clear(system_, here, requested, active_, work_, team, there).move_mm) return at_;
  if (!there.positions.allFinite() || !there.multipliers.allFinite()) return at_;
  State state{std::move(there.positions),
              actuation,
              std::move(there.multipliers),
              1,
              std::move(there.anchors),
              std::move(there.eyelets),
              {},
              at_.history,
              at_.elapsed_s};
  for (Index a = 0; a < system_.actuators(); ++a) {
    state.multipliers[a] /= system_.measures().unit(a);
    // no cable carries compression
    if (system_.measures().constrains(a) && system_.measures().only_pulls(a))
      state.multipliers[a] = std::max(0.0, state.multipliers[a]);
  }
  return state;
}

}  // namespace softkin::physical
