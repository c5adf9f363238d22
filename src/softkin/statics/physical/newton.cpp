#include <cmath>
#include <limits>
#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/newton.hpp>
#include <softkin/statics/physical/stability.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// By which a stiffness that is hardly unstable is made positive, over its mean diagonal.
constexpr double slight_shift = 1e-7, clear_shift = 1;
/// From one that is not enough to the next, and from the last of a shape to the first of the next one: a factor each.
constexpr double stiffer = 30, softer = 10;
/// The first and the last of one that was made positive element by element, and yet is not; limp sheets are held by
/// more.
constexpr double least_shift = 1e-5, least_limp_shift = 1e-4, most_shift = 100;
/// Where steps are small but forces are not in balance, each iteration must bring them so much nearer to it.
constexpr double worthwhile_balance = 0.7;
/// Of the diagonal, that the last steps may lead away from the factor whose negative pivots are told.
constexpr double near_factor = 2e-4;
/// Factors of a solve that is brief.
constexpr int most_briefly = 10;
/// A solve that got stuck may have done so by rounding where its last step was so many tolerances at most.
constexpr double near_tolerance = 100;

}  // namespace

Newton::Newton(const System& system, Workspace& work, Team& team, const Settings& settings,
               const ProgressCallback& progress, SolveReport& report)
    : system_(system), work_(work), team_(team), settings_(settings), progress_(progress), report_(report) {}

void Newton::record(double step_mm) {
  IterationRecord entry;
  entry.energy = balance_.energy;
  entry.gradient_norm = balance_.force.norm();
  entry.step_mm = step_mm;
  ++report_.iterations;
  report_.energy = entry.energy;
  report_.step_mm = step_mm;
  report_.gradient_norm = entry.gradient_norm;
  if (settings_.keep_history) report_.history.push_back(entry);
}

bool Newton::goes_on() const {
  return !progress_ || progress_({report_.iterations, report_.step_mm, settings_.tolerance_mm, report_.reached});
}

/// The exact stiffness where it is stable under the constraints or asked for; else made so element by element, or by a
/// shift where that is slow, then by both. none: no shift makes it positive.
Newton::Advance Newton::factorise(const Iterate& at, Policy policy) {
  using Stiffness = System::Stiffness;
  using Precision = linear::MixedLdlt::Precision;
  const Precision usual = work_.saddle.precision();
  // one that is not stable is not stepped with where Newton descends; and where its sign is a guess, one that is hardly
  // stiffer wants a closer look
  const bool guess = policy == Policy::descend && usual == Precision::enough;
  int negative = 0;
  const auto attempted = [&](Stiffness kind, double shift, Precision precision) {
    if (!goes_on()) return Advance::interrupted;  // of a large robot each takes as long as many iterations
    ++report_.factorisations;
    factor_.shape = at.positions;
    secants_.clear();
    factor_.looked_at = false;
    const Temporarily scope(work_.saddle.precision(), precision);
    negative = system_.factorise(at, *asked_.demand, *asked_.active, balance_, {kind, shift, true}, work_, team_);
    report_.factorisations_in_double += work_.saddle.factor().in_double();
    return negative == 0 ? Advance::made : Advance::none;
  };
  Advance end = attempted(Stiffness::exact, 0, guess ? Precision::sign : usual);
  if (end == Advance::interrupted) return end;
  factor_.negative = negative;
  factor_.doubtful = !work_.saddle.factor().trusted();
  ending_.rounded = ending_.rounded || factor_.doubtful;
  const Precision closer = factor_.doubtful ? Precision::good : usual;
  if (end == Advance::made || policy != Policy::descend) return Advance::made;
  for (double shift = std::max(slight_shift, factor_.shift); pace_.slow && end == Advance::none && shift < clear_shift;
       shift *= stiffer) {
    ++report_.shifts;
    // pressed sheets buckle in many ways, of which none leads to where they wrinkle
    end = attempted(system_.limp() ? Stiffness::projected : Stiffness::exact, shift, closer);
    factor_.shift = shift / softer;
  }
  if (end != Advance::none) return end;
  ++report_.projections;
  end = attempted(Stiffness::projected, 0, closer);
  for (double shift = system_.limp() ? least_limp_shift : least_shift; end == Advance::none && shift < most_shift;
       shift *= 10) {
    ++report_.shifts;
    end = attempted(Stiffness::projected, shift, closer);
  }
  return end;
}

/// What a step of Newton's makes less where the stiffness is positive: the Lagrangian by the multipliers before it, and
/// what constraints are missed by. Weights above the multipliers in place of the Lagrangian would forbid steps along
/// constraints that are curved.
///
/// source  Nocedal, Wright 2006, Numerical optimization, 15.5 (the Maratos effect), with 17.4 as the function of merit
double Newton::merit(const Balance& balance) const {
  const auto missed = [](const Price& price, const auto& by) {
    return price.multipliers.dot(by) + price.above.dot(by.cwiseAbs());
  };
  return balance.energy + balance.load_energy + missed(prices_.constraints, balance.constraint) +
         missed(prices_.volumes, balance.force(system_.freedoms().scalar_unknowns()));
}

/// Of constraints that are missed, with their multipliers and what a step changes these by. It adds what they have of
/// the merit function's slope along the step, which meets them.
void Newton::Price::set(const Eigen::VectorXd& multipliers_before, const Eigen::VectorXd& changes,
                        const Eigen::VectorXd& missed, double& slope) {
  constexpr double beyond = 2;    // what multipliers change by
  constexpr double least = 0.01;  // of the multipliers
  multipliers = multipliers_before;
  above = beyond * changes.cwiseAbs() + least * multipliers.cwiseAbs();
  slope -= above.dot(missed.cwiseAbs());
}

/// Chooses the prices of missed constraints for the step at hand.
///
/// returns  the slope of the merit function along the step, which is to be negative
/// source   Nocedal, Wright 2006, Numerical optimization, theorem 18.2
double Newton::weigh_constraints(const Iterate& at) {
  double slope = balance_.force.dot(step_.move);
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(system_.actuators()), changes = multipliers;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!(*asked_.active)[a]) continue;
    multipliers[a] = system_.measures().sign(a) * at.multipliers[a];
    changes[a] = step_.change[a];
  }
  prices_.constraints.set(multipliers, changes, balance_.constraint, slope);
  if (!system_.pressures()) return slope;
  // pressures are multipliers of volumes that are kept
  const std::vector<Index>& unknowns = system_.freedoms().scalar_unknowns();
  Points moves;
  system_.freedoms().expand(step_.move, at.positions, moves);
  Eigen::VectorXd pressures = Eigen::VectorXd::Zero(step_.move.size()), more = pressures;
  system_.freedoms().reduce(at.positions, at.positions, pressures);
  system_.freedoms().reduce(moves, at.positions, more);
  prices_.volumes.set(pressures(unknowns), more(unknowns), balance_.force(unknowns), slope);
  return slope;
}

/// What arrives has arrived, whoever stops it then.
Newton::Advance Newton::accept(double moved_mm, bool arrives, Iterate& at) {
  record(moved_mm);
  std::swap(at, trial_);
  std::swap(balance_, trial_balance_);
  const bool on = goes_on();
  return arrives ? Advance::arrived : on ? Advance::made : Advance::interrupted;
}

/// The workspace is back at the iterate, as the next factorisation wants it.
Newton::Advance Newton::reject(const Iterate& at) {
  system_.evaluate(at, *asked_.demand, *asked_.active, work_, balance_, team_);
  return Advance::made;
}

/// Does no constraint miss its demand by more than steps that are small enough can close?
bool Newton::meets_constraints() const {
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!(*asked_.active)[a]) continue;
    const double reach = 2 * tolerance_mm() * work_.slopes[a].rowwise().norm().sum();
    if (!(std::abs(balance_.constraint[a]) <= reach + 1e-9 * system_.measures().rest(a))) return false;
  }
  return true;
}

bool Newton::balanced() const {
  return imbalance_.residual <= ending_.loose * settings_.force_share * imbalance_.pull + imbalance_.rounding;
}

/// Steps are small enough. Are the forces out of balance, and do more iterations help?
bool Newton::improve_balance() {
  const double before = std::exchange(imbalance_, system_.imbalance(balance_, work_, team_)).residual;
  return !balanced() && imbalance_.residual < worthwhile_balance * before;
}

/// The same of lengths and volumes that are commanded.
bool Newton::improve_constraints() {
  constexpr double promised = 1e-8;  // of the measure at rest
  double missed = 0;
  for (Index a = 0; a < system_.actuators(); ++a)
    if ((*asked_.active)[a]) missed = std::max(missed, std::abs(balance_.constraint[a]) / system_.measures().rest(a));
  return missed > ending_.loose * promised && missed < worthwhile_balance * std::exchange(missed_, missed);
}

/// The pressure of a gas is that of its volume, to the last digit: its law holds for what is told. Of a liquid, which
/// hardly gives way, the balance of forces knows it better.
void Newton::settle_gases(Iterate& at) const {
  for (Index a = 0; a < system_.actuators(); ++a) {
    const Filling* filling = system_.measures().filling(a);
    if (filling && !filling->liquid && (*asked_.active)[a])
      at.multipliers[a] = filling->pressure(asked_.demand->actuation[a], system_.measures().value(a, at.positions));
  }
}

/// Is the count of negative eigenvalues one of rounding, or of a shape that is too far from an equilibrium? Where the
/// count is 0 the softest change of shape tells. The workspace is left as it was.
bool Newton::doubts_stability(const Iterate& at) {
  if (factor_.negative != 0 && factor_.doubtful) return true;
  const double moved = (at.positions - factor_.shape).rowwise().norm().maxCoeff();
  if (!(moved > near_factor * system_.model().diagonal_mm)) return false;
  if (factor_.negative != 0) return true;
  const bool as_stiff = as_stiff_as_factorised(system_, at, *asked_.demand, *asked_.active, balance_, work_, team_);
  (void)reject(at);
  return !as_stiff;
}

/// The number of negative eigenvalues at an iterate, without a doubt.
void Newton::make_sure(const Iterate& at) {
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  factor_.negative = system_.factorise(at, *asked_.demand, *asked_.active, balance_, {}, work_, team_);
  ++report_.factorisations;
  ++report_.factorisations_in_double;
  factor_.doubtful = false;
}

Newton::Outcome Newton::solve(const Demand& demand, const std::vector<bool>& active, Policy policy, bool factorised,
                              Iterate& at) {
  asked_.demand = &demand;
  asked_.active = &active;
  const int before = report_.factorisations - report_.factorisations_in_double;
  start_ = at;
  const Outcome outcome = descend(policy, factorised, at);
  if (outcome != Outcome::stuck) return outcome;
  const bool in_single = report_.factorisations - report_.factorisations_in_double != before && !system_.contact();
  // of limp sheets rounding may be why wherever they are on the way
  const double near = near_tolerance * (system_.limp() ? tolerance_mm() : settings_.tolerance_mm);
  const bool rounded = ending_.rounded || report_.step_mm < near;
  if (!in_single || ending_.brief || !rounded) return outcome;
  at = start_;
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  return descend(policy, false, at);
}

/// Does nothing do anything to limp sheets? There they have no stiffness, and so no step.
bool Newton::rests() {
  imbalance_ = system_.imbalance(balance_, work_, team_);
  if (!(imbalance_.residual <= imbalance_.rounding) || !balance_.constraint.isZero(0)) return false;
  missed_ = 0;
  factor_.negative = 0;
  return true;
}

/// Nothing is known of steps yet.
void Newton::begin_steps() {
  ending_.why = "its iterations were not enough";
  ending_.rounded = false;
  secants_.clear();
  pace_ = {.slow = system_.limp()};
  factor_.refines = factor_.looked_at = false;
}

Newton::Outcome Newton::descend(Policy policy, bool factorised, Iterate& at) {
  system_.evaluate(at, *asked_.demand, *asked_.active, work_, balance_, team_);
  ending_.why = "the law has no energy at its begin";
  if (balance_.forbidden || !balance_.force.allFinite()) return Outcome::stuck;
  begin_steps();
  Advance advance = Advance::made;
  double damping = 1;
  if (system_.limp() && system_.layers()->flat(at.positions) && rests()) return Outcome::converged;
  imbalance_.residual = missed_ = std::numeric_limits<double>::infinity();
  const int most = ending_.brief ? std::min(settings_.max_iterations, most_briefly) : settings_.max_iterations;
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
      policy = Policy::follow;  // a stiffness that was made positive makes steps small where forces are not
    }
  }
  if (advance == Advance::interrupted) return Outcome::interrupted;
  if (advance != Advance::arrived) {
    if (!std::isfinite(imbalance_.residual) || report_.step_mm >= tolerance_mm()) return Outcome::stuck;
    (void)reject(at);  // the last step was small enough, and none follows it
    imbalance_ = system_.imbalance(balance_, work_, team_);
    // steps of a factor that is too stiff are small wherever they end
    if (advance == Advance::none && !balanced() && step_.size.largest > tolerance_mm()) return Outcome::stuck;
  }
  report_.gradient_norm = balance_.force.norm();
  report_.energy = balance_.energy;
  if (!meets_constraints()) {
    ending_.why = "what actuators command contradicts each other";
    return Outcome::unmet;
  }
  work_.saddle.correct_multipliers(balance_, at.multipliers, team_);
  settle_gases(at);
  if (doubts_stability(at)) make_sure(at);
  return factor_.negative == 0 ? Outcome::converged : Outcome::unstable;
}

}  // namespace softkin::physical
