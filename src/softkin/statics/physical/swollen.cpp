#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/settling.hpp>

namespace softkin::physical {

namespace {

/// How smoothly sheets that were flat wrinkle at last, and from one solve to the next; how pressures fall from one to
/// the next; both less boldly where that leads nowhere.
constexpr double narrowest_barrier = 1e-11, narrower = 0.1, hardly_narrower = 0.6, fall = 0.2, gentlest_fall = 0.9;

}  // namespace

/// A demand whose pressures are so many times as large.
Demand Settler::pressed(Demand demand, double times) const {
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (active[a] || !system_.measures().given_load(a) || system_.measures().sign(a) > 0) continue;
    demand.actuation[a] *= times;
  }
  return demand;
}

/// Of sheets that were flat, where something touches a second time, less boldly.
Newton::Outcome Settler::settle_swollen(const Demand& there, const Swelling& how, Iterate& trial) {
  const Iterate begin = trial;
  const auto outcome = sharpen_swollen(there, how, narrower, trial);
  if (outcome != Newton::Outcome::stuck || !system_.contact()) return outcome;
  trial = begin;
  return sharpen_swollen(there, how, hardly_narrower, trial);
}

/// First what wrinkles does so without kinks, then with ever sharper ones, at last with its own; under pressures that
/// stretch it, which fall to those that are asked for: from a shape that leads nowhere, back to the one before, by
/// less.
Newton::Outcome Settler::sharpen_swollen(const Demand& there, Swelling how, double by, Iterate& trial) {
  const auto settled = [&](double barrier, double times) {
    work_.layers->barrier = barrier;
    const auto outcome = settle(pressed(there, times), Newton::Policy::descend, trial);
    work_.layers->barrier = 0;
    return outcome;
  };
  for (double barrier = how.barrier; barrier > narrowest_barrier; barrier *= by)
    if (settled(barrier, how.boost) == Newton::Outcome::interrupted) return Newton::Outcome::interrupted;
  auto outcome = settled(0, how.boost);
  for (double falls = fall; how.boost > 1;) {
    if (outcome == Newton::Outcome::stuck || outcome == Newton::Outcome::interrupted) return outcome;
    const Iterate before = trial;
    const double next = std::max(1.0, falls * how.boost);
    outcome = settled(0, next);
    if (outcome == Newton::Outcome::stuck && falls < gentlest_fall) {
      trial = before;
      outcome = Newton::Outcome::converged;
      falls = std::sqrt(falls);
      continue;
    }
    how.boost = next;
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
