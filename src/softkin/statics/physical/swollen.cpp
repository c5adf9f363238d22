#include <cmath>
#include <softkin/statics/physical/corrector.hpp>

namespace softkin::physical {

/// Returns the load state with its given pressures multiplied by `times`.
LoadState Corrector::pressed(LoadState load_state, double times) const {
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (active[a] || !system_.measures().given_load(a) || system_.measures().sign(a) > 0) continue;
    load_state.actuation[a] *= times;
  }
  return load_state;
}

/// requested  is this the requested shape, or an intermediate one
Newton::Outcome Corrector::correct_wrinkled(const LoadState& load_state, double barrier, bool requested,
                                            Iterate& trial) {
  const auto relaxed = newton_.with_relaxed_tolerance(requested ? 1 : tuning_.newton.convergence.coarse_tolerance);
  const Temporarily smoothly(work_.layers->barrier, barrier);
  return correct(load_state, Newton::Policy::descend, trial);
}

/// Reduces the smoothing of wrinkles from solve to solve, at last to none. After a failed solve it returns to the shape
/// before and reduces the smoothing by less.
///
/// requested  see correct_wrinkled()
Newton::Outcome Corrector::sharpen_swollen(const LoadState& load_state, double barrier, bool requested,
                                           Iterate& trial) {
  std::optional<Iterate> good;
  double before = barrier;
  for (double by = tuning_.wrinkling.smoothing_reduction;;) {
    const bool sharp = barrier <= tuning_.wrinkling.min_smoothing;
    const auto outcome = correct_wrinkled(load_state, sharp ? 0 : barrier, sharp && requested, trial);
    const bool stuck = outcome == Newton::Outcome::stuck && good;
    if (outcome == Newton::Outcome::interrupted || (stuck && by >= tuning_.wrinkling.max_smoothing_reduction) ||
        (sharp && !stuck))
      return outcome;
    if (stuck) {
      by = std::sqrt(by);
      trial = *good;
    } else {
      by = std::max(tuning_.wrinkling.smoothing_reduction, by * by);
      good = trial;
      before = barrier;
    }
    barrier = by * before;
  }
}

/// Solves under increased pressures that stretch the sheets, and reduces these to the requested ones. After a failed
/// solve it returns to the shape before and reduces the pressures by less.
Newton::Outcome Corrector::correct_swollen(const LoadState& there, const Swelling& how, Iterate& trial) {
  double times = how.boost;
  auto outcome = sharpen_swollen(pressed(there, times), how.barrier, times == 1, trial);
  for (double falls = tuning_.wrinkling.pressure_reduction; times > 1;) {
    if (outcome == Newton::Outcome::stuck || outcome == Newton::Outcome::interrupted) return outcome;
    const Iterate before = trial;
    const double next = std::max(1.0, falls * times);
    outcome = correct_wrinkled(pressed(there, next), 0, next == 1, trial);
    if (outcome == Newton::Outcome::stuck && falls < tuning_.wrinkling.max_pressure_reduction) {
      trial = before;
      outcome = Newton::Outcome::converged;
      falls = std::sqrt(falls);
      continue;
    }
    times = next;
    falls = std::max(tuning_.wrinkling.pressure_reduction, falls * falls);
  }
  return outcome;
}

/// Do moving supports run into flat sheets?
bool Corrector::runs_into_flat(const LoadState& there, const Iterate& at) {
  if (!system_.contact()) return false;
  Points held = at.positions;
  system_.placement().hold(there, held);
  return system_.contacts()->longest_step(at.positions, held, *work_.contacts, team_) < 1;
}

}  // namespace softkin::physical
