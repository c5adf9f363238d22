#include <softkin/statics/physical_lease.hpp>

namespace softkin {

Sensitivity PhysicalStatics::sensitivity(const State& at, bool reuse_factor, Team& team) const {
  const Index actuators = system_.actuators();
  Sensitivity result;
  result.positions.assign(static_cast<std::size_t>(actuators), Points::Zero(at.positions.rows(), 3));
  result.multipliers.setZero(actuators, actuators);
  Lease lease(*this, at.positions, reuse_factor);
  PhysicalSystem::Workspace& work = lease.work();
  work.home.resize(0, 3);

  Iterate shape{at.positions, at.multipliers};
  const Demand demand{at.actuation, at.share};
  std::vector<bool> active(static_cast<std::size_t>(actuators));
  for (Index a = 0; a < actuators; ++a) {
    shape.multipliers[a] *= system_.unit(a);
    active[a] = system_.constrains(a) && (system_.sign(a) < 0 || shape.multipliers[a] > 0);
  }
  PhysicalSystem::Balance balance;
  system_.evaluate(shape, demand, active, work, balance, team);
  (void)system_.factorise(shape, demand, active, PhysicalSystem::Stiffness::exact, 0, work, team);
  if (!work.active.empty() && work.schur.rank() < static_cast<Index>(work.active.size())) return result;
  Sensitivity found = result;
  Eigen::VectorXd step, change;
  for (Index a = 0; a < actuators; ++a) {
    Demand next = demand;
    next.actuation[a] += 1;
    system_.upset(shape, demand, next, active, work, balance, team);
    system_.step(balance, work, step, change, team);
    if (!step.allFinite() || !change.allFinite()) return result;
    system_.freedoms().expand(step, shape.positions, found.positions[a]);
    for (Index i = 0; i < actuators; ++i) found.multipliers(i, a) = change[i] / system_.unit(i);
    if (!system_.constrains(a) && system_.measures().measures(a)) found.multipliers(a, a) = 1;
  }
  work.home = shape.positions;
  found.regular = true;
  return found;
}

}  // namespace softkin
