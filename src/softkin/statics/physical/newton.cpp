#include <cmath>
#include <limits>
#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/newton.hpp>
#include <softkin/statics/physical/stability.hpp>
#include <utility>

namespace softkin::physical {

Newton::Newton(const System& system, Workspace& work, Team& team, const Settings& settings,
               const ProgressCallback& progress, SolveRecord& record)
    : system_(system),
      work_(work),
      team_(team),
      settings_(settings),
      progress_(progress),
      tuning_(work.options.newton),
      record_(record) {}

void Newton::note_iteration(double step_mm) {
  const IterationRecord entry{.energy = balance_.energy, .step_mm = step_mm, .gradient_norm = balance_.force.norm()};
  ending_.step_mm = step_mm;
  record_.note_iteration(entry, settings_.keep_history);
}

bool Newton::may_continue() const {
  return !progress_ || progress_({record_.iterations, record_.step_mm, settings_.tolerance_mm, record_.reached});
}

/// Factorises the exact stiffness if it is stable under the constraints or requested. Otherwise the stiffness is
/// projected element by element, or shifted where projection converges slowly, then both. Returns `none` if no shift
/// makes it positive.
Newton::Advance Newton::factorise(const Iterate& at, Policy policy) {
  using Stiffness = System::Stiffness;
  using Precision = linear::MixedLdlt::Precision;
  const Precision usual = work_.saddle.precision();
  // descent takes no step with an unstable stiffness; if its inertia is uncertain, a slightly shifted one is factorised
  // with a higher precision
  const bool guess = policy == Policy::descend && usual == Precision::enough;
  int negative = 0;
  const auto attempted = [&](Stiffness kind, double shift, Precision precision) {
    if (!may_continue()) return Advance::interrupted;  // each factorisation of a large robot takes long
    factor_.shape = at.positions;
    secants_.clear();
    factor_.looked_at = false;
    const Temporarily scope(work_.saddle.precision(), precision);
    negative =
        system_.factorise(at, *requested_.load_state, *requested_.active, balance_, {kind, shift, true}, work_, team_);
    record_.note_factorisation(work_.saddle.factor().in_double());
    return negative == 0 ? Advance::made : Advance::none;
  };
  Advance end = attempted(Stiffness::exact, 0, guess ? Precision::sign : usual);
  if (end == Advance::interrupted) return end;
  factor_.negative = negative;
  factor_.doubtful = !work_.saddle.factor().trusted();
  ending_.rounded = ending_.rounded || factor_.doubtful;
  const Precision closer = factor_.doubtful ? Precision::good : usual;
  if (end == Advance::made || policy != Policy::descend) return Advance::made;
  for (double shift = std::max(tuning_.regularisation.slight_shift, factor_.shift);
       pace_.slow && end == Advance::none && shift < tuning_.regularisation.clear_shift;
       shift *= tuning_.regularisation.shift_growth) {
    ++record_.shifts;
    // compressed sheets have many buckling modes, none of which leads to the wrinkled shape
    end = attempted(system_.has_wrinkling() ? Stiffness::projected : Stiffness::exact, shift, closer);
    factor_.shift = shift / tuning_.regularisation.shift_decay;
  }
  if (end != Advance::none) return end;
  ++record_.projections;
  end = attempted(Stiffness::projected, 0, closer);
  for (double shift = system_.has_wrinkling() ? tuning_.regularisation.min_wrinkled_shift
                                              : tuning_.regularisation.min_shift;
       end == Advance::none && shift < tuning_.regularisation.max_shift;
       shift *= tuning_.regularisation.projected_growth) {
    ++record_.shifts;
    end = attempted(Stiffness::projected, shift, closer);
  }
  return end;
}

/// Returns the merit function, which a Newton step with a positive stiffness decreases: the Lagrangian with the
/// multipliers before the step plus the weighted constraint violations. A penalty alone, with weights above the
/// multipliers, would forbid steps along curved constraints.
///
/// source  Nocedal, Wright 2006, Numerical optimization, 15.5 (the Maratos effect), with 17.4 as the function of merit
double Newton::merit(const Balance& balance) const {
  const auto missed = [](const Price& price, const auto& by) {
    return price.multipliers.dot(by) + price.above.dot(by.cwiseAbs());
  };
  return balance.energy + balance.load_energy + missed(prices_.constraints, balance.constraint) +
         missed(prices_.volumes, balance.force(system_.freedoms().scalar_unknowns()));
}

/// Sets the weights of violated constraints from their multipliers and the changes of these in a step. Adds their part
/// of the slope of the merit function along the step, which satisfies the constraints.
void Newton::Price::set(const Eigen::VectorXd& multipliers_before, const Eigen::VectorXd& changes,
                        const Eigen::VectorXd& missed, const LineSearchOptions& by, double& slope) {
  multipliers = multipliers_before;
  above = by.change_weight * changes.cwiseAbs() + by.multiplier_weight * multipliers.cwiseAbs();
  slope -= above.dot(missed.cwiseAbs());
}

/// Chooses the weights of violated constraints for the current step.
///
/// returns  the slope of the merit function along the step, which is to be negative
/// source   Nocedal, Wright 2006, Numerical optimization, theorem 18.2
double Newton::weigh_constraints(const Iterate& at) {
  double slope = balance_.force.dot(step_.move);
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(system_.actuators()), changes = multipliers;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!(*requested_.active)[a]) continue;
    multipliers[a] = system_.measures().sign(a) * at.multipliers[a];
    changes[a] = step_.change[a];
  }
  prices_.constraints.set(multipliers, changes, balance_.constraint, tuning_.line_search, slope);
  if (!system_.pressures()) return slope;
  // pressures are the multipliers of the volume constraints of mixed elements
  const std::vector<Index>& unknowns = system_.freedoms().scalar_unknowns();
  Points moves;
  system_.freedoms().expand(step_.move, at.positions, moves);
  Eigen::VectorXd pressures = Eigen::VectorXd::Zero(step_.move.size()), more = pressures;
  system_.freedoms().reduce(at.positions, at.positions, pressures);
  system_.freedoms().reduce(moves, at.positions, more);
  prices_.volumes.set(pressures(unknowns), more(unknowns), balance_.force(unknowns), tuning_.line_search, slope);
  return slope;
}

/// Accepts the trial iterate. One that has converged counts as converged even if the caller interrupts the solve then.
Newton::Advance Newton::accept(double moved_mm, bool arrives, Iterate& at) {
  note_iteration(moved_mm);
  std::swap(at, trial_);
  std::swap(balance_, trial_balance_);
  const bool on = may_continue();
  return arrives ? Advance::arrived : on ? Advance::made : Advance::interrupted;
}

/// Evaluates the workspace at the iterate again, as the next factorisation requires.
Newton::Advance Newton::reject(const Iterate& at) {
  system_.evaluate(at, *requested_.load_state, *requested_.active, work_, balance_, team_);
  return Advance::made;
}

/// Are all constraint violations small enough to be closed by steps within the tolerance?
bool Newton::meets_constraints() const {
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!(*requested_.active)[a]) continue;
    const double reach = 2 * tolerance_mm() * work_.slopes[a].rowwise().norm().sum();
    if (!(std::abs(balance_.constraint[a]) <= reach + 1e-9 * system_.measures().rest(a))) return false;
  }
  return true;
}

bool Newton::balanced() const {
  return imbalance_.residual <= ending_.loose * settings_.force_fraction * imbalance_.pull + imbalance_.rounding;
}

/// The steps are small enough. Is the residual still too large, and do more iterations reduce it?
bool Newton::improve_balance() {
  const double before = std::exchange(imbalance_, system_.imbalance(balance_, work_, team_)).residual;
  return !balanced() && imbalance_.residual < tuning_.convergence.min_balance_gain * before;
}

/// The same question for the constraints on commanded lengths and volumes.
bool Newton::improve_constraints() {
  double missed = 0;
  for (Index a = 0; a < system_.actuators(); ++a)
    if ((*requested_.active)[a])
      missed = std::max(missed, std::abs(balance_.constraint[a]) / system_.measures().rest(a));
  return missed > ending_.loose * tuning_.convergence.constraint_tolerance &&
         missed < tuning_.convergence.min_balance_gain * std::exchange(ending_.missed, missed);
}

/// Sets the pressure of a sealed gas to that of its volume, so that the reported values satisfy the gas law to the last
/// digit. The pressure of a nearly incompressible liquid is more accurate from the equilibrium of forces.
void Newton::correct_gases(Iterate& at) const {
  for (Index a = 0; a < system_.actuators(); ++a) {
    const Filling* filling = system_.measures().filling(a);
    if (filling && !filling->liquid && (*requested_.active)[a])
      at.multipliers[a] =
          filling->pressure(requested_.load_state->actuation[a], system_.measures().value(a, at.positions));
  }
}

/// Is the number of negative eigenvalues uncertain, by rounding or because the factorised shape is too far from the
/// equilibrium? If the number is 0, the curvature along the softest mode decides. The workspace is left as it was.
bool Newton::doubts_stability(const Iterate& at) {
  if (factor_.negative != 0 && factor_.doubtful) return true;
  const double moved = (at.positions - factor_.shape).rowwise().norm().maxCoeff();
  if (!(moved > tuning_.factor.max_count_distance * system_.model().diagonal_mm)) return false;
  if (factor_.negative != 0) return true;
  const bool as_stiff =
      as_stiff_as_factorised(system_, at, *requested_.load_state, *requested_.active, balance_, work_, team_);
  (void)reject(at);
  return !as_stiff;
}

/// Determines the number of negative eigenvalues at an iterate reliably, by a factorisation in double precision.
void Newton::make_sure(const Iterate& at) {
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  factor_.negative = system_.factorise(at, *requested_.load_state, *requested_.active, balance_, {}, work_, team_);
  record_.note_factorisation(true);
  factor_.doubtful = false;
}

Newton::Outcome Newton::solve(const LoadState& load_state, const std::vector<bool>& active, Policy policy,
                              bool factorised, Iterate& at) {
  requested_.load_state = &load_state;
  requested_.active = &active;
  const int before = record_.factorisations - record_.factorisations_in_double;
  start_ = at;
  const Outcome outcome = descend(policy, factorised, at);
  if (outcome != Outcome::stuck) return outcome;
  const bool in_single = record_.factorisations - record_.factorisations_in_double != before && !system_.contact();
  // with sheets that wrinkle rounding may also be why an intermediate solve with a relaxed tolerance failed
  const double near =
      tuning_.factor.rounded_steps * (system_.has_wrinkling() ? tolerance_mm() : settings_.tolerance_mm);
  const bool rounded = ending_.rounded || ending_.step_mm < near;
  if (!in_single || ending_.brief || !rounded) return outcome;
  at = start_;
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  return descend(policy, false, at);
}

/// Are flat sheets without loads? They have no stiffness there, and so no Newton step.
bool Newton::rests() {
  imbalance_ = system_.imbalance(balance_, work_, team_);
  if (!(imbalance_.residual <= imbalance_.rounding) || !balance_.constraint.isZero(0)) return false;
  ending_.missed = 0;
  factor_.negative = 0;
  return true;
}

/// Resets the records of steps before a solve.
void Newton::begin_steps() {
  ending_.why = "its iterations were not enough";
  ending_.rounded = false;
  secants_.clear();
  pace_ = {.slow = system_.has_wrinkling()};
  factor_.refines = factor_.looked_at = false;
}

Newton::Outcome Newton::descend(Policy policy, bool factorised, Iterate& at) {
  ending_.step_mm = std::numeric_limits<double>::infinity();
  system_.evaluate(at, *requested_.load_state, *requested_.active, work_, balance_, team_);
  ending_.why = "the law has no energy at its begin";
  if (balance_.forbidden || !balance_.force.allFinite()) return Outcome::stuck;
  begin_steps();
  Advance advance = Advance::made;
  double damping = 1;
  if (system_.has_wrinkling() && system_.layers()->flat(at.positions) && rests()) return Outcome::converged;
  imbalance_.residual = ending_.missed = std::numeric_limits<double>::infinity();
  const int most = ending_.brief ? std::min(settings_.max_iterations, tuning_.convergence.max_brief_iterations)
                                 : settings_.max_iterations;
  for (int iteration = 0; advance == Advance::made && iteration < most; ++iteration) {
    if (factorised && iteration == 0) {
      factor_.negative = 0;
      factor_.shape = at.positions;
      advance = steps_from_nearby(at);
    } else {
      const Advance ready = factorise(at, policy);
      if (ready == Advance::interrupted) return Outcome::interrupted;
      if (ready == Advance::none) {
        ending_.why = "no shift makes the stiffness positive";
        return Outcome::stuck;
      }
      advance =
          policy == Policy::near && factor_.negative > 0 ? step_to_stable(at, damping) : steps_from_here(at, damping);
      if (policy == Policy::near) policy = Policy::descend;
    }
    if (advance == Advance::arrived && (improve_balance() || improve_constraints())) {
      advance = Advance::made;
      policy = Policy::follow;  // a stiffness made positive gives small steps where the residual is large
    }
  }
  if (advance == Advance::interrupted) return Outcome::interrupted;
  if (advance != Advance::arrived) {
    if (!std::isfinite(imbalance_.residual) || ending_.step_mm >= tolerance_mm()) return Outcome::stuck;
    (void)reject(at);  // the last step was small enough, and none follows it
    imbalance_ = system_.imbalance(balance_, work_, team_);
    // steps with a stiffness that is too large are small anywhere
    if (advance == Advance::none && !balanced() && step_.size.largest > tolerance_mm()) return Outcome::stuck;
  }
  record_.gradient_norm = balance_.force.norm();
  record_.energy = balance_.energy;
  if (!meets_constraints()) {
    ending_.why = "what actuators command contradicts each other";
    return Outcome::unmet;
  }
  work_.saddle.correct_multipliers(balance_, at.multipliers, team_);
  correct_gases(at);
  if (doubts_stability(at)) make_sure(at);
  return factor_.negative == 0 ? Outcome::converged : Outcome::unstable;
}

}  // namespace softkin::physical
