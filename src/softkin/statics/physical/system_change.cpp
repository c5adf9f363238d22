#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

void System::gather(Workspace& work, Team& team) const {
  pattern_->gather(work.slots, work.blocks, team);
}

void System::multiply(const Iterate& at, const Eigen::MatrixXd& vectors, Workspace& work, Eigen::MatrixXd& product,
                      Team& team) const {
  Points force;
  for (Index i = 0; i < vectors.cols(); ++i) {
    freedoms_->expand(vectors.col(i), at.positions, work.moves);
    pattern_->multiply(work.blocks, work.moves, force, team);
    freedoms_->reduce(force, at.positions, product.col(i));
    freedoms_->add_turning(work.gradient, at.positions, vectors.col(i), product.col(i));
  }
}

void System::command_force(const Iterate& at, const Demand& demand, Index actuator, Workspace& work, Points& force,
                           Team& team) const {
  if (model_.actuators[actuator].kind != ActuatorKind::dea) {
    (void)measures_.value(actuator, at.positions, &force);
    force *= sign(actuator) * unit(actuator);
    return;
  }
  // central difference of fourth order; the force is smooth in the ratio
  const double reach = 1e-3 * demand.actuation[actuator];
  const auto at_ratio = [&](double change) {
    Demand changed = demand;
    changed.actuation[actuator] += change;
    elastic_.force(changed.actuation, at.positions, work.elastic, work.moves, team);
    return work.moves;
  };
  force = (8 * (at_ratio(reach) - at_ratio(-reach)) - (at_ratio(2 * reach) - at_ratio(-2 * reach))) / (12 * reach);
}

}  // namespace softkin::physical
