#include <cmath>
#include <limits>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/newton.hpp>

namespace softkin::physical {

/// source  the primal-dual step of interior points, with the barrier of contact as it is instead of one that vanishes:
///         Nocedal, Wright 2006, Numerical optimization, chapter 19
Newton::Outcome Newton::correct_pushes(const LoadState& load_state, const std::vector<bool>& active, Iterate& at) {
  requested_.load_state = &load_state;
  requested_.active = &active;
  trial_ = at;
  double damping = 0;
  for (int i = 0; i < work_.options.contact.max_force_steps; ++i) {
    system_.evaluate(trial_, load_state, active, work_, balance_, team_);
    if (balance_.forbidden || !balance_.force.allFinite()) return Outcome::stuck;
    const double missed = missed_by_pushes(system_, work_);
    if (damping == 1 && missed < work_.options.contact.force_agreement) {
      at = std::move(trial_);
      return Outcome::converged;
    }
    const Advance ready = factorise(trial_, Policy::descend);
    if (ready == Advance::interrupted) return Outcome::interrupted;
    if (ready == Advance::none) return Outcome::stuck;
    work_.saddle.first_step(balance_, step_.move, step_.change);
    step_.size = system_.freedoms().size_of(step_.move, trial_.positions);
    const Points from = trial_.positions;
    damping = 1;
    if (!std::isfinite(step_.size.mean) || !advance_clear(system_, step_.move, damping, work_, trial_.positions, team_))
      return Outcome::stuck;
    trial_.multipliers += damping * step_.change;
    system_.contacts()->follow_pushes((trial_.positions - from) / damping, damping, *work_.contacts);
    note_iteration(damping * step_.size.largest);
  }
  return Outcome::stuck;
}

}  // namespace softkin::physical
