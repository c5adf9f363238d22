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

  /// What a derivative found before.
  Tangent(const Slopes& slopes, const Demand& here, const Demand& there) {
    const Eigen::VectorXd way = there.actuation - here.actuation;
    const Eigen::VectorXd multipliers = slopes.multipliers * way;
    step = slopes.moves * way;
    change.setZero(way.size());
    for (std::size_t i = 0; i < slopes.held.size(); ++i) change[slopes.held[i]] = multipliers[i];
  }

  Tangent(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
          Workspace& work, Team& team, const Iterate& at) {
    const Slopes& slopes = work.tangents;
    if (here.share == there.share && here.fading == there.fading && are_of(slopes, at) &&
        held(slopes, system.actuators()) == active) {
      *this = Tangent(slopes, here, there);
      return;
    }
    Balance balance;
    const bool of_here =
        work.factored.exact && work.factored.shape.rows() == at.positions.rows() && work.factored.shape == at.positions;
    // of what rubs the saddle alone knows whether it goes on or back
    const bool refined = (!of_here || !work.saddle.factor().in_double()) && !system.tendons().any();
    const bool assembled = work.stiffness.assembled != 0 && work.stiffness.assembled == work.factored.by;
    if (refined || here.fading != there.fading || here.share != there.share ||
        (!assembled && system.placement().changes(here, there))) {
      hold_friction(system, at, work, team);
      system.evaluate(at, here, active, work, balance, team);
      system.assemble(at, here, balance, System::Stiffness::exact, work, team);
    }
    Balance upset;
    system.upset(at, here, there, active, work, upset, team);
    if (!refined || !refine(system, balance, upset, work, team, at)) work.saddle.step(upset, step, change, team);
    if (step.allFinite() && change.allFinite()) return;
    step.setZero();
    change.setZero();
  }

 private:
  /// The step of the stiffness here; false where there is none.
  bool refine(const System& system, const Balance& balance, const Balance& upset, Workspace& work, Team& team,
              const Iterate& at) {
    constexpr double accuracy = 1e-3;
    constexpr int rounds = 6;
    Bordered equations(system, work, team);
    equations.set(at, balance);
    system.gather(at, balance, work, team);
    return equations.step(upset, accuracy, rounds, step, change).left < 1;
  }
};

/// Multipliers at a share of a tangent; those that are given are those of `there`.
void follow(const Tangent& tangent, double share, const System& system, const Demand& there,
            const std::vector<bool>& active, Eigen::VectorXd& multipliers) {
  multipliers += share * tangent.change;
  for (Index a = 0; a < system.actuators(); ++a)
    if (!active[a] && system.measures().given_load(a)) multipliers[a] = system.measures().given(a, there.actuation[a]);
}

/// A shape moved along a tangent as by first order, and what is held to its place.
Points moved_straight(const System& system, const Tangent& tangent, const Demand& there, const Points& from) {
  Points straight = from;
  system.freedoms().move(tangent.step, 1, straight);
  system.placement().hold(there, straight);
  return straight;
}

}  // namespace

double predict(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
               Workspace& work, Team& team, Iterate& at) {
  const Tangent tangent(system, here, there, active, work, team, at);
  const Points before = at.positions;
  system.advance(tangent.step, 1, work, at.positions, team, &there);
  follow(tangent, 1, system, there, active, at.multipliers);
  return system.largest_move(before, at.positions);
}

Points first_order_moves(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
                         Workspace& work, Team& team, const Iterate& at) {
  const Tangent tangent(system, here, there, active, work, team, at);
  return moved_straight(system, tangent, there, at.positions) - at.positions;
}

ClearPrediction predict_clear(const System& system, const Demand& here, const Demand& there,
                              const std::vector<bool>& active, Workspace& work, Team& team, Iterate& at) {
  constexpr double shorter = 0.9;                    // than what is clear
  constexpr double most_cut = 0.5, long_way = 0.05;  // of the way, of the diagonal
  constexpr double least = 1e-3;
  const Tangent tangent(system, here, there, active, work, team, at);
  const Points from = at.positions;
  ClearPrediction clear;
  // what is held comes to its place whatever is left of the way
  double held = 1;
  const Way way = [&](double share, Points& out) {
    const Demand to = between(here, there, share / held);
    out = from;
    system.advance(tangent.step, share, work, out, team, &to);
  };
  double end = 1;
  for (bool first = true;; first = false) {
    held = end;
    const double share = clear_share(system, from, way, end, work, at.positions, team);
    if (first) {
      clear.predicted = at.positions;
      clear.straight = moved_straight(system, tangent, there, from);
    }
    if (share >= end) break;
    clear.cut = true;
    end = shorter * share;
    if (end < most_cut && system.largest_move(from, clear.predicted) > long_way * system.model().diagonal_mm)
      return clear;
    if (end >= least) continue;
    end = 0;  // only what is held moves
    const Way alone = [&](double part, Points& out) {
      out = from;
      system.placement().hold(between(here, there, part), out);
    };
    if (clear_share(system, from, alone, 1, work, at.positions, team) < 1) return clear;
    break;
  }
  follow(tangent, end, system, there, active, at.multipliers);
  clear.move_mm = system.largest_move(from, at.positions);
  return clear;
}

bool carry_held(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
                Workspace& work, Team& team, Iterate& at) {
  Points held = at.positions;
  system.placement().hold(there, held);
  if (held == at.positions) return true;
  Balance balance;
  hold_friction(system, at, work, team);
  system.evaluate(at, here, active, work, balance, team);
  system.assemble(at, here, balance, System::Stiffness::exact, work, team);
  Balance upset;
  const Points force = system.upset_by_held(at, there, active, work, upset, team);
  upset.force.resize(system.freedoms().size());
  system.freedoms().reduce(force, at.positions, upset.force);
  Eigen::VectorXd step, change;
  work.saddle.step(upset, step, change, team);
  if (!step.allFinite()) return false;
  const Points from = at.positions;
  const Way way = [&](double share, Points& out) {
    const Demand to = between(here, there, share);
    out = from;
    system.advance(step, share, work, out, team, &to);
  };
  return clear_share(system, from, way, 1, work, at.positions, team) >= 1;
}

bool foresee(const System& system, const Demand& here, const Demand& there, Workspace& work, Team& team,
             const Iterate& at, Points& positions) {
  constexpr double longest = 5e-3;  // of the diagonal, that the difference moves
  Slopes& slopes = work.tangents;
  if (system.contact() || !are_of(slopes, at)) return false;
  const std::vector<bool> active = held(slopes, system.actuators());
  slopes.foreseen_for.resize(0);
  Tangent way(slopes, here, there);
  const double length = system.freedoms().size_of(way.step, at.positions).largest;
  const double reach = std::min(1.0, longest * system.model().diagonal_mm / length);
  // what the way upsets on both sides but for its first order, which are the equations of the tangent
  Balance balance;
  Eigen::VectorXd force, constraint;
  for (const double share : {reach, -reach}) {
    Iterate beside = at;
    system.advance(way.step, share, work, beside.positions, team);
    follow(way, share, system, between(here, there, share), active, beside.multipliers);
    system.evaluate(beside, between(here, there, share), active, work, balance, team);
    if (balance.forbidden || !balance.force.allFinite()) return false;
    if (share > 0) {
      force = balance.force;
      constraint = balance.constraint;
    }
  }
  balance.force = (balance.force + force) / (2 * reach * reach);
  balance.constraint = (balance.constraint + constraint) / (2 * reach * reach);
  Eigen::VectorXd bend, change;
  work.saddle.step(balance, bend, change, team);
  if (!bend.allFinite() || !change.allFinite()) return false;
  way.step += bend;
  way.change += change;
  slopes.foreseen = at;
  system.advance(way.step, 1, work, slopes.foreseen.positions, team);
  follow(way, 1, system, there, active, slopes.foreseen.multipliers);
  slopes.foreseen_for = there.actuation;
  positions = slopes.foreseen.positions;
  return true;
}

bool follow_foreseen(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
                     Workspace& work, Team& team, Iterate& at) {
  constexpr double most_left = 0.03;  // of the way: what is left is gone along tangents at its begin
  const Slopes& slopes = work.tangents;
  if (slopes.foreseen_for.size() == 0 || !are_of(slopes, at) || held(slopes, system.actuators()) != active ||
      here.share != there.share || here.fading != there.fading)
    return false;
  const Demand foreseen{slopes.foreseen_for, there.share};
  if (!((there.actuation - foreseen.actuation).norm() < most_left * (there.actuation - here.actuation).norm()))
    return false;
  // what is left of the way, along the tangents that were known before it
  const Tangent tangent(slopes, foreseen, there);
  at = slopes.foreseen;
  system.advance(tangent.step, 1, work, at.positions, team, &there);
  follow(tangent, 1, system, there, active, at.multipliers);
  return true;
}

bool follow_foretold(const Demand& here, const Demand& there, Workspace& work, Iterate& at) {
  if (!work.foretold) return false;
  const State foretold = *std::exchange(work.foretold, std::nullopt);
  if (foretold.actuation != there.actuation || here.share != there.share || here.fading != 0 || there.fading != 0)
    return false;
  at.positions = foretold.positions;
  at.multipliers = foretold.multipliers;
  return true;
}

Predictor::Predictor(const System& system, Workspace& work, const State& at, Team& team)
    : system_(system), work_(work), at_(at), iterate_(system.iterate(at)), active_(system.actuators()) {
  for (Index a = 0; a < system.actuators(); ++a) {
    // chambers are held always, cables where they pull
    active_[a] = system.measures().constrains(a) && (!system.measures().only_pulls(a) || iterate_.multipliers[a] > 0);
  }
  Balance balance;
  const Demand demand{at.actuation, at.share};
  system.set_time(at.history, at.elapsed_s, work_, team);
  hold_friction(system, iterate_, work_, team);
  system.evaluate(iterate_, demand, active_, work_, balance, team);
  (void)system.factorise(iterate_, demand, active_, balance, {}, work_, team);
}

State Predictor::predict(const Actuation& actuation, Team& team) {
  Iterate there = iterate_;
  const Demand here{at_.actuation, at_.share}, asked{actuation, 1};
  if (!predict_clear(system_, here, asked, active_, work_, team, there).move_mm) return at_;
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
    // no cable pushes
    if (system_.measures().constrains(a) && system_.measures().only_pulls(a))
      state.multipliers[a] = std::max(0.0, state.multipliers[a]);
  }
  return state;
}

}  // namespace softkin::physical
