#include <array>
#include <cmath>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// How often a robot is taken from one unstable equilibrium to the next below it, and how far it is pushed, over its
/// diagonal.
constexpr int most_buckles = 20, most_downhill = 60;
constexpr double tie = 1e-9;
constexpr std::array<double, 3> pushes{0.003, 0.02, 0.1};

}  // namespace

/// From an unstable equilibrium along its lowest mode to one of less energy, until it is stable or none is found.
/// False: interrupted.
bool Continuation::buckle(const Demand& demand, Iterate& at) {
  for (int i = 0; i < most_buckles; ++i) {
    const LowestMode mode = lowest_mode(system_, at, demand, active_, work_, team_, report_);
    last_.modes = mode.unstable;
    if (mode.unstable == 0 || mode.direction.size() == 0 || !mode.direction.allFinite()) return true;
    auto [best, interrupted] = lower(demand, at, mode);
    if (interrupted) return false;
    if (!best) return true;
    ++report_.buckled;
    report_.buckled_mm = std::max(report_.buckled_mm, system_.largest_move(at.positions, best->at.positions));
    take(at, std::move(best->at));
    active_ = best->active;
    last_ = best->last;
  }
  last_.modes = 1;  // at least; it was not looked at
  return true;
}

/// The equilibrium of less energy to which a push leads, of those of both ways the lower, of two that are alike the
/// first.
Continuation::Search<Continuation::Pushed> Continuation::lower(const Demand& demand, const Iterate& from,
                                                               const LowestMode& mode) {
  double energy = potential(system_, from, demand, active_, work_, team_);
  energy -= tie * std::abs(energy);
  const std::vector<bool> active = active_;
  std::optional<Pushed> best;
  for (std::size_t push = 0; push < pushes.size() && !best; ++push)
    for (const double way : {1.0, -1.0}) {
      active_ = active;
      auto [found, interrupted] = pushed(demand, from, mode, way * pushes[push]);
      if (interrupted) return {.interrupted = true};
      if (!found || found->energy >= energy) continue;
      energy = found->energy - tie * std::abs(found->energy);
      best = std::move(found);
    }
  active_ = active;
  return {std::move(best)};
}

/// The equilibrium to which the robot goes when it is pushed away so far, over its diagonal; none where it comes back.
Continuation::Search<Continuation::Pushed> Continuation::pushed(const Demand& demand, const Iterate& from,
                                                                const LowestMode& mode, double share) {
  Pushed found{from};
  const double reach = share * system_.model().diagonal_mm;
  double scale = reach / system_.freedoms().size_of(mode.direction, from.positions).largest;
  if (!advance_clear(system_, mode.direction, scale, work_, found.at.positions, team_)) return {};
  double shift = mode.steep_shift();
  bool settled = false;
  for (int i = 0; i < most_downhill && !settled; ++i) {
    const Descent down = step_down(system_, demand, active_, shift, found.at, work_, team_);
    report_.factorisations += down.factorisations;
    report_.factorisations_in_double += down.factorisations_in_double;
    if (!down.lower) return {};
    if (prepare(demand, found.at) != 0) continue;
    Iterate there = found.at;
    const auto outcome = settle(demand, Newton::Policy::descend, there);
    if (outcome == Newton::Outcome::interrupted) return {.interrupted = true};
    settled = outcome == Newton::Outcome::converged;
    if (settled) found.at = std::move(there);
  }
  if (!settled || system_.largest_move(found.at.positions, from.positions) < 0.1 * std::abs(reach)) return {};
  found.energy = potential(system_, found.at, demand, active_, work_, team_);
  found.active = active_;
  found.last = judged();
  return {std::move(found)};
}

}  // namespace softkin::physical
