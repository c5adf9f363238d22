#include <softkin/statics/physical/actuator_loads.hpp>

namespace softkin::physical {

void ActuatorLoads::evaluate(const Iterate& at, const Demand& demand, const std::vector<bool>& active,
                             std::vector<Points>& slopes, Points& gradient, Balance& balance) const {
  balance.constraint.setZero(measures_.count());
  balance.load_energy = 0;
  for (Index a = 0; a < measures_.count(); ++a) {
    if (!measures_.measures(a) || (!active[a] && at.multipliers[a] == 0)) continue;
    const double value = measures_.value(a, at.positions, &slopes[a]);
    if (active[a])
      balance.constraint[a] = value - measures_.target(a, demand.actuation);
    else
      balance.load_energy += measures_.sign(a) * at.multipliers[a] * value;
    gradient += measures_.sign(a) * at.multipliers[a] * slopes[a];
  }
}

void ActuatorLoads::stiffness(const Iterate& at, LargeVector<double>& slots, Team& team) const {
  Eigen::VectorXd scale(measures_.count());
  for (Index a = 0; a < measures_.count(); ++a) scale[a] = measures_.sign(a) * at.multipliers[a];
  measures_.second_derivatives(at.positions, scale, slots, team);
}

void ActuatorLoads::add_moves(const std::vector<bool>& active, const Points& positions, const Points& moves,
                              std::vector<Points>& slopes, Eigen::VectorXd& constraint) const {
  for (Index a = 0; a < measures_.count(); ++a) {
    if (!active[a]) continue;
    (void)measures_.value(a, positions, &slopes[a]);
    constraint[a] += slopes[a].cwiseProduct(moves).sum();
  }
}

void ActuatorLoads::add_change(const Demand& from, const Demand& to, const std::vector<bool>& active,
                               const Points& positions, std::vector<Points>& slopes, Eigen::VectorXd& constraint,
                               Points& force) const {
  for (Index a = 0; a < measures_.count(); ++a) {
    const double change = to.actuation[a] - from.actuation[a];
    if (change == 0 || !measures_.measures(a)) continue;
    if (active[a]) {
      constraint[a] += measures_.target(a, from.actuation) - measures_.target(a, to.actuation);
    } else if (!measures_.constrains(a)) {
      (void)measures_.value(a, positions, &slopes[a]);
      force += measures_.sign(a) * measures_.rate(a) * change * slopes[a];
    }
  }
}

void ActuatorLoads::derivative(Index actuator, const Points& positions, Points& force) const {
  force.setZero(positions.rows(), 3);
  if (!measures_.measures(actuator)) return;
  (void)measures_.value(actuator, positions, &force);
  force *= measures_.sign(actuator) * measures_.rate(actuator);
}

}  // namespace softkin::physical
