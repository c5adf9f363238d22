#include <cmath>
#include <softkin/statics/physical/settling.hpp>

namespace softkin::physical {

namespace {

/// How smoothly sheets that were flat wrinkle at last, and from one solve to the next; how pressures fall from one to
/// the next; and up to where less boldly from a shape that leads nowhere.
constexpr double narrowest_barrier = 1e-11, narrower = 0.1, hardly_narrower = 0.4, fall = 0.2, gentlest_fall = 0.9;

}  // namespace

/// A demand whose pressures are so many times as large.
Demand Settler::pressed(Demand demand, double times) const {
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (active[a] || !system_.measures().given_load(a) || system_.measures().sign(a) > 0) continue;
    demand.actuation[a] *= times;
  }
  return demand;
}

/// asked  is it the shape that is asked for, or one on the way there
Newton::Outcome Settler::settle_wrinkled(const Demand& demand, double barrier, bool asked, Iterate& trial) {
  const auto loosely = newton_.loosely(asked ? 1 : Newton::by_far);
  const Temporarily smoothly(work_.layers->barrier, barrier);
  return settle(demand, Newton::Policy::descend, trial);
}

/// What wrinkles does so without kinks at first, then with ever sharper ones, at last with its own; from what leads
/// nowhere, back to the shape before, by less.
///
/// asked  as of settle_wrinkled()
Newton::Outcome Settler::sharpen_swollen(const Demand& demand, double barrier, bool asked, Iterate& trial) {
  std::optional<Iterate> good;
  double before = barrier;
  for (double by = narrower;;) {
    const bool sharp = barrier <= narrowest_barrier;
    const auto outcome = settle_wrinkled(demand, sharp ? 0 : barrier, sharp && asked, trial);
    const bool stuck = outcome == Newton::Outcome::stuck && good;
    if (outcome == Newton::Outcome::interrupted || (stuck && by >= hardly_narrower) || (sharp && !stuck))
      return outcome;
    if (stuck) {
      by = std::sqrt(by);
      trial = *good;
    } else {
      by = std::max(narrower, by * by);
      good = trial;
      before = barrier;
    }
    barrier = by * before;
  }
}

/// Under pressures that stretch it, which fall to those that are asked for: from a shape that leads nowhere, back to
/// the one before, by less.
Newton::Outcome Settler::settle_swollen(const Demand& there, const Swelling& how, Iterate& trial) {
  double times = how.boost;
  auto outcome = sharpen_swollen(pressed(there, times), how.barrier, times == 1, trial);
  for (double falls = fall; times > 1;) {
    if (outcome == Newton::Outcome::stuck || outcome == Newton::Outcome::interrupted) return outcome;
    const Iterate before = trial;
    const double next = std::max(1.0, falls * times);
    outcome = settle_wrinkled(pressed(there, next), 0, next == 1, trial);
    if (outcome == Newton::Outcome::stuck && falls < gentlest_fall) {
      trial = before;
      outcome = Newton::Outcome::converged;
      falls = std::sqrt(falls);
      continue;
    }
    times = next;
    falls = std::max(fall, falls * falls);
  }
  return outcome;
}

/// Does what moves run into sheets that lie flat?
bool Settler::runs_into_flat(const Demand& there, const Iterate& at) {
  if (!system_.contact()) return false;
  Points held = at.positions;
  system_.placement().hold(there, held);
  return system_.contacts()->longest_step(at.positions, held, *work_.contacts, team_) < 1;
}

}  // namespace softkin::physical
