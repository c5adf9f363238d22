#include <array>
#include <cmath>
#include <softkin/statics/physical/buckling.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/stability.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// An equilibrium to which a perturbation leads.
struct Pushed {
  Iterate at;
  double energy = 0;
  std::vector<bool> active{};
  Judgement last{};
};

/// Moves from an unstable equilibrium at a load state to equilibria of lower energy.
class Downhill {
 public:
  Downhill(Corrector& corrector, const LoadState& load_state)
      : corrector_(corrector),
        load_state_(load_state),
        system_(corrector.system()),
        work_(corrector.work()),
        team_(corrector.team()),
        tuning_(corrector.work().options.path.buckling),
        record_(corrector.record()) {}

  /// Moves to a stable equilibrium if one is found; false: interrupted.
  bool go(Iterate& at) {
    for (int i = 0; i < tuning_.max_buckles; ++i) {
      const LowestMode mode = lowest_mode(system_, at, load_state_, corrector_.active, work_, team_, record_);
      corrector_.last.modes = mode.unstable;
      if (mode.unstable == 0 || mode.direction.size() == 0 || !mode.direction.allFinite()) return true;
      auto [best, interrupted] = lower(at, mode);
      if (interrupted) return false;
      if (!best) return true;
      ++record_.buckled;
      record_.buckled_mm = std::max(record_.buckled_mm, system_.largest_move(at.positions, best->at.positions));
      corrector_.take(at, std::move(best->at));
      corrector_.active = best->active;
      corrector_.last = best->last;
    }
    corrector_.last.modes = 1;  // at least one; the last shape was not examined
    return true;
  }

 private:
  /// Returns the equilibrium of lower energy to which a perturbation leads: of both directions the lower one, and of
  /// two equal ones the first.
  Search<Pushed> lower(const Iterate& from, const LowestMode& mode) {
    double energy = potential(system_, from, load_state_, corrector_.active, work_, team_);
    energy -= tuning_.energy_tie * std::abs(energy);
    const std::vector<bool> active = corrector_.active;
    std::optional<Pushed> best;
    const std::array<double, 3> pushes{tuning_.small_push, tuning_.medium_push, tuning_.large_push};
    for (std::size_t push = 0; push < pushes.size() && !best; ++push)
      for (const double path : {1.0, -1.0}) {
        corrector_.active = active;
        auto [found, interrupted] = pushed(from, mode, path * pushes[push]);
        if (interrupted) return {.interrupted = true};
        if (!found || found->energy >= energy) continue;
        energy = found->energy - tuning_.energy_tie * std::abs(found->energy);
        best = std::move(found);
      }
    corrector_.active = active;
    return {std::move(best)};
  }

  /// Returns the equilibrium that the robot reaches from a perturbation of this size, over its diagonal; none if it
  /// returns.
  Search<Pushed> pushed(const Iterate& from, const LowestMode& mode, double fraction) {
    Pushed found{from};
    const double reach = fraction * system_.model().diagonal_mm;
    double scale = reach / system_.freedoms().size_of(mode.direction, from.positions).largest;
    if (!advance_clear(system_, mode.direction, scale, work_, found.at.positions, team_)) return {};
    double shift = mode.steep_shift();
    bool was_corrected = false;
    for (int i = 0; i < tuning_.max_descent_steps && !was_corrected; ++i) {
      const Descent down = step_down(system_, load_state_, corrector_.active, shift, found.at, work_, team_);
      record_.factorisations += down.factorisations;
      record_.factorisations_in_double += down.factorisations_in_double;
      if (!down.lower) return {};
      if (corrector_.prepare(load_state_, found.at) != 0) continue;
      Iterate there = found.at;
      const auto outcome = corrector_.correct(load_state_, Newton::Policy::descend, there);
      if (outcome == Newton::Outcome::interrupted) return {.interrupted = true};
      was_corrected = outcome == Newton::Outcome::converged;
      if (was_corrected) found.at = std::move(there);
    }
    if (!was_corrected ||
        system_.largest_move(found.at.positions, from.positions) < tuning_.min_departure * std::abs(reach))
      return {};
    found.energy = potential(system_, found.at, load_state_, corrector_.active, work_, team_);
    found.active = corrector_.active;
    found.last = corrector_.judged();
    return {std::move(found)};
  }

  Corrector& corrector_;
  const LoadState& load_state_;
  const System& system_;
  Workspace& work_;
  Team& team_;
  const BucklingOptions& tuning_;
  SolveRecord& record_;
};

}  // namespace

bool buckle(Corrector& corrector, const LoadState& load_state, Iterate& at) {
  return Downhill(corrector, load_state).go(at);
}

}  // namespace softkin::physical
