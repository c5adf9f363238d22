#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/workspace_handle.hpp>

namespace softkin::physical {

State Equilibria::inside(const State& at, Team& team) const {
  const Pressures* pressures = system_.pressures();
  State inner = at;
  if (!pressures) return inner;
  if (at.pressures.size() > 0 && (at.pressures.size() != pressures->count() || !at.pressures.allFinite()))
    throw InvalidInput("the pressures of the elements are of another robot");
  inner.positions.conservativeResize(pressures->first + pressures->count(), 3);
  inner.positions.bottomRows(pressures->count()).setZero();
  if (at.pressures.size() > 0)
    inner.positions.col(0).tail(pressures->count()) = at.pressures / pressures->unit;
  else if (inner.positions != system_.model().rest || at.actuation.size() > 0)
    find_pressures(inner, team);
  return inner;
}

void Equilibria::outside(State& at) const {
  const Pressures* pressures = system_.pressures();
  if (!pressures || at.positions.rows() == 0) return;
  at.pressures = pressures->unit * at.positions.col(0).tail(pressures->count());
  drop_vertices(at.positions);
}

void Equilibria::drop_vertices(Points& points) const {
  if (system_.pressures() && points.rows() > 0) points.conservativeResize(system_.pressures()->first, 3);
}

/// Finds the pressures by one step of Newton's method from zero: with the law's own stiffness A, and B that by the
/// pressures, the step at an equilibrium is (0, p), whatever A is.
void Equilibria::find_pressures(State& at, Team& team) const {
  const Index actuators = system_.actuators();
  const bool known = at.knows(actuators) && at.multipliers.size() == actuators;
  WorkspaceHandle handle(*this, at.positions, false, {});
  Workspace& work = handle.work();
  State loaded = at;
  if (!known) loaded.multipliers = Eigen::VectorXd::Zero(actuators);
  const LoadState load_state{at.actuation.size() == actuators ? at.actuation : system_.model().rest_actuation(),
                             at.load_factor >= 0 ? at.load_factor : 1};
  std::vector<bool> active(actuators);
  for (Index a = 0; a < actuators; ++a) active[a] = !known && system_.measures().constrains(a);
  system_.set_time(at.history, at.elapsed_s, work, team);
  const Iterate shape = system_.iterate(loaded);
  hold_friction(system_, shape, work, team);
  Balance balance;
  system_.evaluate(shape, load_state, active, work, balance, team);
  if (balance.forbidden || !balance.force.allFinite()) return;
  (void)system_.factorise(shape, load_state, active, balance, {System::Stiffness::exact, 0, true}, work, team);
  Eigen::VectorXd step, change;
  work.saddle.first_step(balance, step, change);
  Points moves;
  system_.freedoms().expand(step, shape.positions, moves);
  const Pressures& pressures = *system_.pressures();
  if (moves.allFinite()) at.positions.col(0).tail(pressures.count()) = moves.col(0).tail(pressures.count());
}

}  // namespace softkin::physical
