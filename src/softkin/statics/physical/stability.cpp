#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/stability.hpp>

namespace softkin::physical {

bool as_stiff_as_factorised(const System& system, const Iterate& at, const LoadState& load_state,
                            const std::vector<bool>& active, const Balance& balance, Workspace& work, Team& team) {
  const StabilityOptions& options = work.options.newton.stability;
  if (!work.factored.softest) {
    Balance right;
    right.constraint = Eigen::VectorXd::Zero(system.actuators());
    Eigen::VectorXd next, multipliers;
    Workspace::Softest softest{unsymmetric(system.freedoms().size()).normalized(), 0};
    for (int i = 0; i < options.softest_iterations; ++i) {
      right.force = -softest.direction;
      system.drop_pressures(right.force);
      work.saddle.step(right, next, multipliers, team);
      Eigen::VectorXd moves = next;  // pressures follow them
      system.drop_pressures(moves);
      softest.curvature = softest.direction.dot(moves) / moves.squaredNorm();
      softest.direction = next / moves.norm();
    }
    work.factored.softest = std::move(softest);
  }
  const Eigen::VectorXd& direction = work.factored.softest->direction;
  Iterate beside = at;
  const double largest = system.freedoms().size_of(direction, at.positions).largest;
  const double reach = options.difference * system.model().diagonal_mm / largest;
  system.freedoms().move(direction, reach, beside.positions);
  Balance there;
  system.evaluate(beside, load_state, active, work, there, team);
  Eigen::VectorXd moves = direction;
  system.drop_pressures(moves);
  double curvature = moves.dot(there.force - balance.force) / reach;
  for (Index a = 0; a < std::ssize(balance.compliance); ++a)  // of fillings of sealed chambers
    if (active[a] && balance.compliance[a] > 0)
      curvature += std::pow((there.constraint[a] - balance.constraint[a]) / reach, 2) / balance.compliance[a];
  const double expected = work.factored.softest->curvature;
  return std::abs(curvature - expected) <= options.max_change * expected;
}

LowestMode lowest_mode(const System& system, const Iterate& at, const LoadState& load_state,
                       const std::vector<bool>& active, Workspace& work, Team& team, SolveRecord& record) {
  const StabilityOptions& options = work.options.newton.stability;
  Balance balance;
  system.evaluate(at, load_state, active, work, balance, team);
  double mean = 0;
  const auto negative = [&](double shift) {
    record.note_factorisation(true);
    const int count = system.factorise(at, load_state, active, balance, {System::Stiffness::exact, shift}, work, team);
    if (shift == 0) mean = work.saddle.spectrum().mean;
    return count;
  };
  const Temporarily twice(work.saddle.precision(),
                          linear::MixedLdlt::Precision::twice);  // curvatures are differences of nearly equal numbers
  LowestMode mode;
  mode.unstable = negative(0);
  mode.mean = mean;
  if (mode.unstable == 0) return mode;
  double low = 0, high = options.min_shift;
  for (; negative(high) > 0; high *= 10) {
    low = high;
    if (high > options.max_shift) return mode;
  }
  while (low > 0 && high > options.close_shift * low) {
    const double middle = std::sqrt(low * high);
    (negative(middle) > 0 ? low : high) = middle;
  }
  (void)negative(high);
  // the constraints are met by every step, so that the iteration stays among the directions that keep them
  Balance right;
  right.constraint = Eigen::VectorXd::Zero(system.actuators());
  Eigen::VectorXd vector = unsymmetric(system.freedoms().size()), next, multipliers;
  system.drop_pressures(vector);
  vector.normalize();
  for (int i = 0; i < options.max_inverse_iterations; ++i) {
    right.force = -vector;
    work.saddle.step(right, next, multipliers, team);
    system.drop_pressures(next);
    const double curvature = 1 / vector.dot(next) - high * mean;
    vector = next.normalized();
    if (i > 2 && std::abs(curvature - mode.curvature) < options.curvature_accuracy * std::abs(curvature)) break;
    mode.curvature = curvature;
  }
  Index largest = 0;
  vector.cwiseAbs().maxCoeff(&largest);
  mode.direction = vector[largest] < 0 ? Eigen::VectorXd(-vector) : vector;
  return mode;
}

namespace {

/// Returns the Lagrangian of the shape, except for constants: the potential, active measures with given multipliers,
/// the energy of fillings of sealed chambers, and kept volumes with the pressures of another shape.
double lagrangian(const System& system, const LoadState& load_state, const Balance& balance, const Points& positions,
                  const Points& pressed, const Eigen::VectorXd& multipliers) {
  double energy = balance.energy + system.pressure_work(pressed, balance.force);
  for (Index a = 0; a < system.actuators(); ++a) {
    if (!system.measures().measures(a)) continue;
    const Filling* filling = system.measures().filling(a);
    if (filling && filling->yields())
      energy += filling->energy(load_state.actuation[a], system.measures().value(a, positions));
    else if (multipliers[a] != 0)
      energy += system.measures().sign(a) * multipliers[a] * system.measures().value(a, positions);
  }
  return energy;
}

}  // namespace

Descent step_down(const System& system, const LoadState& load_state, const std::vector<bool>& active, double& shift,
                  Iterate& at, Workspace& work, Team& team) {
  const StabilityOptions& options = work.options.newton.stability;
  Descent down;
  Balance balance, there;
  Eigen::VectorXd step, change;
  for (; shift < options.max_shift; shift *= 4) {
    system.evaluate(at, load_state, active, work, balance, team);
    ++down.factorisations;
    const int modes = system.factorise(at, load_state, active, balance, {System::Stiffness::exact, shift}, work, team);
    down.factorisations_in_double += work.saddle.factor().in_double();
    if (modes > 0) continue;
    work.saddle.step(balance, step, change, team);
    if (!step.allFinite() || !change.allFinite()) continue;
    Iterate trial = at;
    double scale = 1;
    if (!advance_clear(system, step, scale, work, trial.positions, team)) continue;
    trial.multipliers += scale * change;
    system.evaluate(trial, load_state, active, work, there, team);
    if (there.forbidden || !there.force.allFinite()) continue;
    if (!(lagrangian(system, load_state, there, trial.positions, at.positions, at.multipliers) <
          lagrangian(system, load_state, balance, at.positions, at.positions, at.multipliers)))
      continue;
    at = std::move(trial);
    shift = std::max(options.min_shift, shift / 4);
    down.lower = true;
    break;
  }
  return down;
}

double potential(const System& system, const Iterate& at, const LoadState& load_state, const std::vector<bool>& active,
                 Workspace& work, Team& team) {
  Balance balance;
  system.evaluate(at, load_state, active, work, balance, team);
  return balance.energy + balance.load_energy;
}

}  // namespace softkin::physical
