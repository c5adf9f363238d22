#include <array>
#include <cmath>
#include <softkin/statics/physical/buckling.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/stability.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// How often a robot is taken from one unstable equilibrium to the next below it, and how far it is pushed, over its
/// diagonal.
constexpr int most_buckles = 20, most_downhill = 60;
constexpr double tie = 1e-9;
constexpr std::array<double, 3> pushes{0.003, 0.02, 0.1};

/// A shape that a push leads to.
struct Pushed {
  Iterate at;
  double energy = 0;
  std::vector<bool> active{};
  Judgement last{};
};

/// From an equilibrium under a demand to others.
class Downhill {
 public:
  Downhill(Settler& settler, const Demand& demand)
      : settler_(settler),
        demand_(demand),
        system_(settler.system()),
        work_(settler.work()),
        team_(settler.team()),
        report_(settler.report()) {}

  /// False: interrupted.
  bool go(Iterate& at) {
    for (int i = 0; i < most_buckles; ++i) {
      const LowestMode mode = lowest_mode(system_, at, demand_, settler_.active, work_, team_, report_);
      settler_.last.modes = mode.unstable;
      if (mode.unstable == 0 || mode.direction.size() == 0 || !mode.direction.allFinite()) return true;
      auto [best, interrupted] = lower(at, mode);
      if (interrupted) return false;
      if (!best) return true;
      ++report_.physical.buckled;
      report_.physical.buckled_mm =
          std::max(report_.physical.buckled_mm, system_.largest_move(at.positions, best->at.positions));
      settler_.take(at, std::move(best->at));
      settler_.active = best->active;
      settler_.last = best->last;
    }
    settler_.last.modes = 1;  // at least; it was not looked at
    return true;
  }

 private:
  /// The equilibrium of less energy to which a push leads, of those of both ways the lower, of two that are alike the
  /// first.
  Search<Pushed> lower(const Iterate& from, const LowestMode& mode) {
    double energy = potential(system_, from, demand_, settler_.active, work_, team_);
    energy -= tie * std::abs(energy);
    const std::vector<bool> active = settler_.active;
    std::optional<Pushed> best;
    for (std::size_t push = 0; push < pushes.size() && !best; ++push)
      for (const double way : {1.0, -1.0}) {
        settler_.active = active;
        auto [found, interrupted] = pushed(from, mode, way * pushes[push]);
        if (interrupted) return {.interrupted = true};
        if (!found || found->energy >= energy) continue;
        energy = found->energy - tie * std::abs(found->energy);
        best = std::move(found);
      }
    settler_.active = active;
    return {std::move(best)};
  }

  /// The equilibrium to which the robot goes when it is pushed away so far, over its diagonal; none where it comes
  /// back.
  Search<Pushed> pushed(const Iterate& from, const LowestMode& mode, double share) {
    Pushed found{from};
    const double reach = share * system_.model().diagonal_mm;
    double scale = reach / system_.freedoms().size_of(mode.direction, from.positions).largest;
    if (!advance_clear(system_, mode.direction, scale, work_, found.at.positions, team_)) return {};
    double shift = mode.steep_shift();
    bool settled = false;
    for (int i = 0; i < most_downhill && !settled; ++i) {
      const Descent down = step_down(system_, demand_, settler_.active, shift, found.at, work_, team_);
      report_.factorisations += down.factorisations;
      report_.factorisations_in_double += down.factorisations_in_double;
      if (!down.lower) return {};
      if (settler_.prepare(demand_, found.at) != 0) continue;
      Iterate there = found.at;
      const auto outcome = settler_.settle(demand_, Newton::Policy::descend, there);
      if (outcome == Newton::Outcome::interrupted) return {.interrupted = true};
      settled = outcome == Newton::Outcome::converged;
      if (settled) found.at = std::move(there);
    }
    if (!settled || system_.largest_move(found.at.positions, from.positions) < 0.1 * std::abs(reach)) return {};
    found.energy = potential(system_, found.at, demand_, settler_.active, work_, team_);
    found.active = settler_.active;
    found.last = settler_.judged();
    return {std::move(found)};
  }

  Settler& settler_;
  const Demand& demand_;
  const System& system_;
  Workspace& work_;
  Team& team_;
  SolveReport& report_;
};

}  // namespace

bool buckle(Settler& settler, const Demand& demand, Iterate& at) {
  return Downhill(settler, demand).go(at);
}

}  // namespace softkin::physical
