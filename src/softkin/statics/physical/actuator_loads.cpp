#include <softkin/statics/physical/actuator_loads.hpp>

namespace softkin::physical {

void ActuatorLoads::evaluate(const Iterate& at, const LoadState& load_state, const std::vector<bool>& active,
                             std::vector<Points>& slopes, Points& gradient, Balance& balance) const {
  balance.constraint.setZero(measures_.count());
  balance.load_energy = 0;
  if (tendons_.any()) balance.slips = tendons_.slips(at);
  if (measures_.any_filling()) balance.compliance.setZero(measures_.count());
  Points pulls;
  for (Index a = 0; a < measures_.count(); ++a) {
    if (!measures_.measures(a) || (!active[a] && at.multipliers[a] == 0)) continue;
    const double value = measures_.value(a, at.positions, &slopes[a]);
    if (active[a] && measures_.filling(a))
      fill(a, value, at.multipliers[a], load_state, balance);
    else if (active[a])
      balance.constraint[a] = value - measures_.target(a, load_state.actuation, at.multipliers[a]);
    else
      balance.load_energy += measures_.sign(a) * at.multipliers[a] * value;
    if (tendons_.has_friction(a)) tendons_.pull(a, at, pulls);
    gradient += measures_.sign(a) * at.multipliers[a] * (tendons_.has_friction(a) ? pulls : slopes[a]);
  }
}

void ActuatorLoads::fill(Index actuator, double volume, double pressure, const LoadState& load_state,
                         Balance& balance) const {
  const Filling& filling = *measures_.filling(actuator);
  if (!filling.exists(pressure)) {
    balance.forbidden = true;
    return;
  }
  const double command = load_state.actuation[actuator], target = filling.volume(command, pressure);
  balance.constraint[actuator] = volume - target;
  balance.compliance[actuator] = filling.compliance(command, pressure);
  balance.load_energy += filling.energy(command, target);
}

void ActuatorLoads::stiffness(const Iterate& at, LargeVector<double>& slots, Team& team) const {
  Eigen::VectorXd scale(measures_.count());
  std::vector<Eigen::VectorXd> fractions(measures_.count());
  for (Index a = 0; a < measures_.count(); ++a) {
    scale[a] = measures_.sign(a) * at.multipliers[a];
    if (tendons_.has_friction(a)) fractions[a] = tendons_.fractions(a, at);
  }
  measures_.second_derivatives(at.positions, scale, fractions, slots, team);
}

void ActuatorLoads::add_moves(const std::vector<bool>& active, const Points& positions, const Points& moves,
                              std::vector<Points>& slopes, Eigen::VectorXd& constraint) const {
  for (Index a = 0; a < measures_.count(); ++a) {
    if (!active[a]) continue;
    (void)measures_.value(a, positions, &slopes[a]);
    constraint[a] += slopes[a].cwiseProduct(moves).sum();
  }
}

void ActuatorLoads::add_change(const Iterate& at, const LoadState& from, const LoadState& to,
                               const std::vector<bool>& active, std::vector<Points>& slopes,
                               Eigen::VectorXd& constraint, Points& force) const {
  for (Index a = 0; a < measures_.count(); ++a) {
    const double change = to.actuation[a] - from.actuation[a];
    if (change == 0 || !measures_.measures(a)) continue;
    if (active[a]) {
      constraint[a] +=
          measures_.target(a, from.actuation, at.multipliers[a]) - measures_.target(a, to.actuation, at.multipliers[a]);
    } else if (!measures_.constrains(a)) {
      pull(a, at, slopes[a]);
      // a cable that is slack because of a negative offset gets no tension
      force +=
          measures_.sign(a) * (measures_.given(a, to.actuation[a]) - measures_.given(a, from.actuation[a])) * slopes[a];
    }
  }
}

void ActuatorLoads::add_response(const Iterate& at, const Points& moves, Points& force) const {
  for (Index a = 0; a < measures_.count(); ++a)
    if (tendons_.has_friction(a) && at.multipliers[a] != 0)
      tendons_.add_response(a, at.multipliers[a], at, moves, force);
}

void ActuatorLoads::pull(Index actuator, const Iterate& at, Points& force) const {
  if (tendons_.has_friction(actuator))
    tendons_.pull(actuator, at, force);
  else
    (void)measures_.value(actuator, at.positions, &force);
}

void ActuatorLoads::derivative(Index actuator, const Iterate& at, double command, Points& force) const {
  force.setZero(at.positions.rows(), 3);
  if (!measures_.measures(actuator)) return;
  pull(actuator, at, force);
  force *= measures_.sign(actuator) * measures_.rate(actuator, command);
}

}  // namespace softkin::physical
