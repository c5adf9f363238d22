#include <cmath>
#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/newton.hpp>
#include <softkin/statics/physical/stability.hpp>
#include <utility>

// Steps of Newton's method with one factor.

namespace softkin::physical {

/// Is a step the last? The remaining error is the same fraction of the step as the step is of the one before, or zero
/// with a factor in double precision.
///
/// before  largest move of the undamped step before it; 0: none
bool Newton::last(const Step& step, double before) const {
  const double size = step.size.largest, fraction = before > 0 ? std::min(1.0, size / before) : 1;
  return size < tolerance_mm() &&
         (work_.saddle.factor().in_double() || fraction * size < tuning_.convergence.max_last_error * tolerance_mm());
}

/// Moves by `damping` times a step, or less where surfaces would pass through each other. False where the law has no
/// energy, or where hardly any move is possible.
bool Newton::attempt(const Step& step, double& damping, const Iterate& from) {
  trial_ = from;
  if (!advance_clear(system_, step.move, damping, work_, trial_.positions, team_)) return false;
  trial_.multipliers += damping * step.change;
  system_.evaluate(trial_, *requested_.load_state, *requested_.active, work_, trial_balance_, team_);
  return !trial_balance_.forbidden && trial_balance_.force.allFinite();
}

bool Newton::attempt_whole(const Step& step, const Iterate& from) {
  double damping = 1;
  return attempt(step, damping, from) && damping == 1;
}

/// Solves for the step of the last factorised matrix, more accurately than the factor's precision allows.
///
/// returns  relative difference of the factor's own step from it; 0 where the refinement fails
double Newton::refine(const Balance& balance, const Iterate& at, Step& step) {
  Bordered equations(system_, work_, team_);
  equations.set_factorised(at);
  Step found;
  const linear::Remainder remainder = equations.step(balance, tuning_.factor.refined_accuracy,
                                                     tuning_.factor.refinement_rounds, found.move, found.change);
  if (!(remainder.left < tuning_.factor.max_refined_error)) return 0;
  found.size = system_.freedoms().size_of(found.move, at.positions);
  step = std::move(found);
  return remainder.apart;
}

/// Refines step_ where rounding of the factor may be why the next step is hardly shorter. If it is, all later steps
/// with this factor are refined, and the next factors are in double precision.
bool Newton::refine_first(const Iterate& at) {
  if (factor_.looked_at || work_.saddle.factor().in_double() || system_.contact() || system_.tendons().any())
    return false;
  if (next_.size.mean < tuning_.factor.suspect_contraction * step_.size.mean) return false;
  factor_.looked_at = true;
  factor_.refines = refine(balance_, at, step_) > tuning_.factor.rounded_change;
  if (factor_.refines) work_.saddle.factor().distrust();
  ending_.rounded = ending_.rounded || factor_.refines;
  return factor_.refines;
}

/// Solves for the step with the current factor.
void Newton::find(const Balance& balance, const Iterate& at, Step& step) {
  const bool refined = factor_.refines && !work_.saddle.factor().in_double() && refine(balance, at, step) > 0;
  if (!refined) work_.saddle.step(balance, step.move, step.change, team_);
  for (const Secant& secant : secants_) {
    const double part = secant.step.dot(step.move);
    step.move += part * secant.left;
    step.change += part * secant.left_change;
  }
  step.size = system_.freedoms().size_of(step.move, at.positions);
}

/// Detects steps in a row that make hardly any progress. With contacts or fibres these are strongly damped steps, as a
/// shorter load step is cheaper then, and with friction undamped steps of equal length, as parts slide without
/// resistance. Else they lower the merit function alone, as steps with a projected stiffness do where there is no
/// equilibrium.
bool Newton::stagnates(double damping) {
  pace_.poor = damping < tuning_.convergence.poor_damping ? pace_.poor + 1 : 0;
  pace_.same =
      damping == 1 && next_.size.mean > tuning_.convergence.no_contraction * step_.size.mean ? pace_.same + 1 : 0;
  if (!system_.kinked()) return pace_.downhill >= tuning_.convergence.max_descent_steps;
  return pace_.poor >= tuning_.convergence.max_poor_steps ||
         (has_friction(work_) && pace_.same >= tuning_.convergence.max_equal_steps);
}

/// Detects slow convergence with a stiffness that was projected element by element. Where few modes are unstable, it is
/// far too stiff along these: many steps follow, each nearly as long as the one before.
void Newton::note_pace(double damping) {
  if (factor_.negative == 0)
    pace_.slow = system_.has_wrinkling();
  else if (system_.contact() && factor_.negative <= tuning_.convergence.few_modes && damping == 1)
    pace_.slow |= next_.size.mean > tuning_.convergence.slow_contraction * step_.size.mean;
}

/// Returns the factor of a damping that was too large: with it a quadratic model of the residual is just good enough.
double Newton::shorter(double damping) const {
  if (system_.contact() || system_.has_wrinkling() || !std::isfinite(next_.size.mean))
    return tuning_.line_search.halving;
  const double residue = (next_.move - (1 - damping) * step_.move).norm() / step_.move.norm();
  return std::min(tuning_.line_search.halving, damping / (2 * residue));
}

/// Makes a Newton step, damped until the simplified step that follows it is shorter. next_ becomes that step.
Newton::Advance Newton::damped_step(Iterate& at, double& damping) {
  const auto ends = [this](const char* why) {
    ending_.why = why;
    return Advance::none;
  };
  work_.saddle.first_step(balance_, step_.move, step_.change);
  step_.size = system_.freedoms().size_of(step_.move, at.positions);
  if (factor_.refines && !work_.saddle.factor().in_double()) (void)refine(balance_, at, step_);
  if (!std::isfinite(step_.size.mean)) return ends("the stiffness is singular");
  damping = system_.contact() ? 1 : std::min(1.0, 2 * damping);  // the obstacle to the last step may be gone
  // where a gap closes, the current factor lacks the contact force to come, but the potential contains it
  // friction that follows its normal forces has no potential
  // a projected stiffness gives a descent direction; near an equilibrium it leads to no unstable shape
  const bool potential = (system_.kinked() || !work_.factored.exact) && system_.conservative() &&
                         !(work_.contacts && work_.contacts->friction_follows);
  double slope = potential ? weigh_constraints(at) : 0;
  pace_.steepest = std::min(pace_.steepest, slope);
  if (!system_.contact() && !system_.has_wrinkling() && slope > tuning_.line_search.min_slope * pace_.steepest)
    slope = 0;
  const double before = slope < 0 ? merit(balance_) : 0;
  for (;;) {
    double factor = tuning_.line_search.halving;
    if (attempt(step_, damping, at)) {
      if (last(step_, 0)) return accept(damping * step_.size.largest, damping == 1, at);
      const double rise = slope < 0 ? merit(trial_balance_) - before : 0;
      const bool lower = rise < tuning_.line_search.armijo * damping * slope;
      // with contact the simplified step after a damped one is no criterion
      if (lower && system_.contact() && damping < 1) break;
      // up to rounding: with contact, steps that get shorter while the merit function rises go round in circles
      if (!(system_.contact() && rise > tuning_.line_search.max_rise * std::abs(before))) {
        find(trial_balance_, trial_, next_);
        if (refine_first(at)) continue;
        // near a singular stiffness the next step may be long although the residual is small
        const bool nearer =
            next_.size.mean < step_.size.mean || trial_balance_.force.norm() < 0.5 * balance_.force.norm();
        pace_.downhill = nearer ? 0 : pace_.downhill + lower;
        if (lower || nearer) break;
        factor = shorter(damping);
      }
    }
    damping *= factor;
    if (!(damping >= tuning_.line_search.min_damping)) {
      ending_.rounded = true;  // near a singular stiffness it may be by rounding, and nothing else shows it
      return ends("no length of a step comes nearer");
    }
  }
  if (damping * step_.size.largest > tuning_.line_search.runaway * system_.model().diagonal_mm)
    return ends("the shape runs away");
  note_pace(damping);
  if (stagnates(damping)) return ends("step after step hardly comes nearer");
  if (slope < 0 && damping == 1 && !work_.factored.exact && (system_.contact() || system_.has_wrinkling()))
    lengthen(damping);
  return accept(damping * step_.size.largest, false, at);
}

/// Away from a saddle point, a step with a projected stiffness leaves nearly its own length in the same direction.
/// Doubles the step as long as that lowers the merit function. Multipliers are those of the step.
void Newton::lengthen(double& damping) {
  if (!(step_.move.dot(next_.move) > tuning_.factor.max_along * step_.move.squaredNorm())) return;
  Step on = step_;
  on.change.setZero();
  double lowest = merit(trial_balance_);
  while (damping < tuning_.line_search.max_extension) {
    Iterate nearer = trial_;
    double more = damping;
    const bool lower = attempt(on, more, nearer) && more == damping && merit(trial_balance_) < lowest;
    if (!lower) {
      trial_ = std::move(nearer);
      system_.evaluate(trial_, *requested_.load_state, *requested_.active, work_, trial_balance_, team_);
      return;
    }
    lowest = merit(trial_balance_);
    damping *= 2;
  }
}

/// Turns the simplified step next_ that follows a whole step into Broyden's. False where it does not fit.
bool Newton::update_next() {
  const double square = step_.move.squaredNorm(), part = step_.move.dot(next_.move) / square;
  const double size = next_.size.mean / step_.size.mean;
  if (!(part < tuning_.factor.max_along && size < tuning_.factor.max_contraction * (1 - part))) return false;
  const double scale = 1 / (square * (1 - part));
  secants_.push_back({step_.move, scale * next_.move, scale * next_.change});
  next_.move /= 1 - part;
  next_.change /= 1 - part;
  next_.size = system_.freedoms().size_of(next_.move, trial_.positions);
  return true;
}

/// Broyden's steps after the whole step step_, with next_ the simplified one that follows it. Where they end because
/// they shrink too little, and rounding may be why, the next factors are in double precision.
///
/// source  Deuflhard 2011, QNERR: the "good" rank-1 updates, which serve as long as the factor does
Newton::Advance Newton::quasi_newton_steps(Iterate& at) {
  linear::MixedLdlt& factor = work_.saddle.factor();
  const auto slow = [&] {
    if (factor.rounded() > tuning_.factor.much_rounded && !system_.contact()) factor.distrust();
  };
  for (int made = 1; made <= tuning_.factor.max_updates; ++made) {
    if (!update_next()) {
      slow();
      break;
    }
    std::swap(step_, next_);
    if (!attempt_whole(step_, at)) return reject(at);
    const bool arrives = last(step_, next_.size.largest);
    if (!arrives) {
      find(trial_balance_, trial_, next_);
      if (!(next_.size.mean < step_.size.mean)) {
        slow();
        return reject(at);
      }
    }
    const Advance advance = accept(step_.size.largest, arrives, at);
    if (advance != Advance::made) return advance;
  }
  return Advance::made;
}

/// Steps with the factor of the iterate.
Newton::Advance Newton::steps_from_here(Iterate& at, double& damping) {
  const Advance advance = damped_step(at, damping);
  return advance == Advance::made && damping == 1 ? quasi_newton_steps(at) : advance;
}

/// One step with an exact stiffness that is not stable, from near a stable equilibrium.
Newton::Advance Newton::step_to_stable(Iterate& at, double& damping) {
  const Advance advance = damped_step(at, damping);
  damping = 1;
  if (advance == Advance::none) return reject(at);
  return advance == Advance::arrived ? Advance::made : advance;
}

/// Do steps shrink so fast that a new factor costs more than they do?
bool Newton::shrink_fast() const {
  const double rate = next_.size.largest / step_.size.largest;
  if (!(rate < tuning_.factor.max_contraction)) return false;
  const double left = std::log(tolerance_mm() / next_.size.largest) / std::log(rate);
  return left < tuning_.factor.cost;
}

/// Steps with the factor of a shape close by, as long as they shrink fast enough.
Newton::Advance Newton::steps_from_nearby(Iterate& at) {
  if (!as_stiff_as_factorised(system_, at, *requested_.load_state, *requested_.active, balance_, work_, team_))
    return reject(at);
  find(balance_, at, step_);
  if (!std::isfinite(step_.size.mean) || !attempt_whole(step_, at)) return reject(at);
  const bool arrives = last(step_, 0);
  if (!arrives) {
    find(trial_balance_, trial_, next_);
    if (!shrink_fast()) return reject(at);
  }
  const Advance advance = accept(step_.size.largest, arrives, at);
  return advance == Advance::made ? quasi_newton_steps(at) : advance;
}

}  // namespace softkin::physical
