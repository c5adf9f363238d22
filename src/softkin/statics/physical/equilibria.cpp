#include <cmath>
#include <softkin/statics/physical/contact_at_rest.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>
#include <softkin/statics/physical/workspace_handle.hpp>

namespace softkin::physical {

namespace {

/// Returns the load state of the rest shape. Its load factor is 0, so that supports with a turn command may have any
/// angle; they get the requested one and do not turn on the path. Forces, moments and pressures are 0, whatever their
/// commands at rest.
LoadState at_rest(const Model& model, const Actuation& wanted) {
  LoadState load_state{model.rest_actuation(), 0};
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& of = model.actuators[a];
    if (of.is<TurnCommand>()) load_state.actuation[a] = wanted[a];
    if (of.is<ForceCommand>() || of.is<MomentCommand>() || of.is<PressureCommand>()) load_state.actuation[a] = 0;
    if (of.is<GrowthDrive>()) load_state.actuation[a] = model.actuators[a].rest;
  }
  return load_state;
}

/// Returns the command that corresponds to the measure of a start. The filling of a chamber depends on its pressure,
/// too. If the pressure is unknown, the filling is assumed to be the requested one.
double measured_command(const supports::ActuatorMeasures& measures, Index actuator, const State& start, bool rests,
                        double wanted) {
  const double measure = measures.value(actuator, start.positions);
  const bool known = start.multipliers.size() > 0;
  const double pressure = known ? measures.unit(actuator) * start.multipliers[actuator] : 0;
  const Filling* filling = measures.filling(actuator);
  if (!filling || known || rests || !filling->yields() || !std::isfinite(filling->pressure(wanted, measure)))
    return measures.command_for(actuator, measure, pressure);
  return wanted;
}

/// Sets the multipliers of filled chambers for a start of which only the shape is known, at the assumed load state.
void fill_chambers(const supports::ActuatorMeasures& measures, const LoadState& load_state, Iterate& at) {
  for (Index a = 0; a < measures.count(); ++a) {
    const Filling* filling = measures.filling(a);
    if (!filling || !filling->yields()) continue;
    const double pressure = filling->pressure(load_state.actuation[a], measures.value(a, at.positions));
    if (std::isfinite(pressure)) at.multipliers[a] = pressure;
  }
}

/// Returns the load state of which the start is an equilibrium, as far as the start determines it.
LoadState load_state_of(const System& system, const Model& model, const State& start, const Actuation& wanted) {
  if (start.actuation.size() > 0) return {start.actuation, start.load_factor};
  const bool rests = start.positions == model.rest;
  LoadState load_state = at_rest(model, wanted);
  if (!rests) load_state.load_factor = start.load_factor >= 0 ? start.load_factor : 1.0;
  for (Index a = 0; a < system.actuators(); ++a) {
    if (system.measures().constrains(a))
      load_state.actuation[a] = measured_command(system.measures(), a, start, rests, wanted[a]);
    else if (model.actuators[a].is<MotionCommand>() || (model.actuators[a].is<TurnCommand>() && !rests))
      load_state.actuation[a] = system.placement().command_of(a, start.positions);
    else if (!drives(model.actuators[a]) || model.actuators[a].is<GrowthDrive>())
      continue;
    else if (model.actuators[a].is<MagneticDrive>())
      load_state.actuation[a] = model.actuators[a].rest;
    else if (model.actuators[a].is<DeaDrive>() && !under_voltage(model.actuators[a]))
      load_state.actuation[a] = 1;
    else
      load_state.actuation[a] = start.multipliers.size() > 0
                                    ? system.measures().command(a, system.measures().unit(a) * start.multipliers[a])
                                    : 0;
  }
  return load_state;
}

}  // namespace

void Equilibria::measure(const State& state, ElementDeformation& out, Team& team) const {
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, true, {});
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  const Iterate shape = system_.iterate(*at);
  hold_friction(system_, shape, handle.work(), team);
  system_.measure(shape, {at->actuation, at->load_factor}, handle.work(), out, team);
  out.multipliers = at->multipliers;
  drop_vertices(out.reactions);
}

bool Equilibria::extrapolate(const Actuation& actuation, const State& state, const SolverOptions& options,
                             Points& positions, Team& team) const {
  if (system_.contact()) return false;
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, true, options);
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  const bool extrapolated =
      physical::extrapolate(system_, {at->actuation, at->load_factor}, {actuation, at->load_factor}, handle.work(),
                            team, system_.iterate(*at), positions);
  if (extrapolated) drop_vertices(positions);
  return extrapolated;
}

bool Equilibria::set_initial_guess(const State& at, State there) const {
  if (system_.contact() || system_.pressures()) return false;
  WorkspaceHandle handle(*this, at.positions, true, {});
  if (handle.work().solved_shape.rows() == 0) return false;
  for (Index a = 0; a < system_.actuators(); ++a) there.multipliers[a] *= system_.measures().unit(a);
  handle.work().initial_guess = std::move(there);
  return true;
}

std::vector<std::vector<Vec3>> Equilibria::pressing_changes(const State& state, const std::vector<Points>& moves,
                                                            Team& team) const {
  const ContactModel& contact = system_.model().contact;
  std::vector<std::vector<Vec3>> changes(moves.size(), std::vector<Vec3>(contact.parts.size(), Vec3::Zero()));
  if (!system_.contact()) return changes;
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, true, {});
  const Iterate shape = system_.iterate(*at);
  system_.contacts()->find(shape.positions, *handle.work().contacts, team);
  hold_friction(system_, shape, handle.work(), team);
  Points own = Points::Zero(at->positions.rows(), 3);  // with the vertices of pressures, which have no contact
  for (std::size_t k = 0; k < moves.size(); ++k) {
    own.topRows(moves[k].rows()) = moves[k];
    const Points change = system_.contacts()->change_along(shape.positions, *handle.work().contacts, own);
    for (std::size_t p = 0; p < contact.parts.size(); ++p) {
      if (contact.parts[p].rank == ContactRank::robot) continue;
      const auto [begin, end] = system_.model().vertices_of_part(p);
      if (begin < end) changes[k][p] = -change.middleRows(begin, end - begin).colwise().sum().transpose();
    }
  }
  return changes;
}

ViscousFlow Equilibria::flow(const State& state, Team& team) const {
  ViscousFlow flow;
  if (!system_.viscous()) return flow;
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, true, {});
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  flow.history = system_.flow(*at, handle.work(), flow.lost_mJ, team);
  return flow;
}

void Equilibria::forget() const {
  const std::lock_guard lock(mutex_);
  idle_.clear();
}

bool Equilibria::comes_to(const Points& from, const Points& to, Workspace& work, Team& team) const {
  Points end;
  const Motion straight = [&](double fraction, Points& out) { out = from + fraction * (to - from); };
  return clear_fraction(system_, from, straight, 1, work, end, team) >= 1;
}

/// Starts again from rest: from a start that is not an equilibrium there may be no path, but from rest there may be
/// one.
void Equilibria::begin_again(const LoadState& to, const Options& options, const ProgressCallback& progress, Team& team,
                             Workspace& work, Iterate& at, SolveRecord& record, SolveReport& report) const {
  std::string remark = std::exchange(report.remark, "");
  Iterate fresh{system_.model().rest, Eigen::VectorXd::Zero(system_.actuators()), {}, {}};
  LoadState from = at_rest(system_.model(), to.actuation);
  system_.placement().hold(from, fresh.positions);
  fresh.eyelets = system_.tendons().lengths(fresh.positions);
  Continuation continuation(system_, work, team, options, progress, record, report);
  if (system_.viscous()) {
    hold_friction(system_, fresh, work, team);
    from = system_.unbalanced(fresh, from, work, team);
  }
  const Status status = continuation.follow(from, to, fresh);
  if (status == Status::converged) {
    at = std::move(fresh);
    report.status = status;
    return;
  }
  if (status == Status::interrupted) report.status = status;
  report.remark = std::move(remark);
  record.reached = 0;
}

Equilibrium Equilibria::solve(const Actuation& actuation, const State& start, const Options& options,
                              const ProgressCallback& progress, Team& team) const {
  Equilibrium found = solve_inside(actuation, *Inside(*this, start, team), options, progress, team);
  outside(found.state);
  return found;
}

/// Returns the start with its supports in place and with the multipliers of its load state.
Iterate Equilibria::iterate_at(const State& start, const LoadState& from) const {
  Iterate at{start.positions, Eigen::VectorXd::Zero(system_.actuators()), start.anchors, start.eyelets};
  system_.placement().hold(from, at.positions);
  if (at.eyelets.empty()) at.eyelets = system_.tendons().lengths(at.positions);
  if (start.multipliers.size() > 0)
    for (Index a = 0; a < system_.actuators(); ++a)
      at.multipliers[a] = system_.measures().measures(a) && system_.measures().given_load(a)
                              ? system_.measures().given(a, from.actuation[a])  // of this robot's factor
                              : system_.measures().unit(a) * start.multipliers[a];
  else if (start.positions != system_.model().rest)
    fill_chambers(system_.measures(), from, at);
  return at;
}

/// Sets the time and returns the load state of which the start is an equilibrium then: viscous parts have crept since.
LoadState Equilibria::load_state_now(const State& start, const LoadState& from, const Iterate& at,
                                     const Options& options, Workspace& work, Team& team) const {
  system_.set_time(options.history, options.elapsed_s, work, team);
  const bool rests = start.positions == system_.model().rest && start.actuation.size() == 0;
  const bool same_time =
      rests ? !options.history : start.history == options.history && start.elapsed_s == options.elapsed_s;
  if (!system_.viscous() || same_time || !(rests || start.knows(system_.actuators()))) return from;
  hold_friction(system_, at, work, team);
  return system_.unbalanced(at, from, work, team);
}

State Equilibria::state_at(Iterate&& at, const LoadState& load_state, const Options& options) const {
  State state;
  state.positions = std::move(at.positions);
  state.anchors = std::move(at.anchors);
  state.eyelets = std::move(at.eyelets);
  state.actuation = load_state.actuation;
  state.load_factor = load_state.load_factor;
  state.multipliers = at.multipliers;
  for (Index a = 0; a < system_.actuators(); ++a) state.multipliers[a] /= system_.measures().unit(a);
  if (system_.viscous()) {
    state.history = options.history;
    state.elapsed_s = options.elapsed_s;
  }
  return state;
}

Equilibrium Equilibria::solve_inside(const Actuation& actuation, const State& start, const Options& options,
                                     const ProgressCallback& progress, Team& team) const {
  const Model& model = system_.model();
  Equilibrium result;
  result.actuation = actuation;
  SolveReport& report = result.report;
  report.solver = "newton";
  report.tolerance_mm = options.tolerance_mm;
  SolveRecord record;
  if (start.actuation.size() == 0 && start.positions != model.rest) check_contact_of_start(model, start.positions);
  WorkspaceHandle handle(*this, start.positions, options.reuse_factor, options.tuning);

  LoadState from = load_state_of(system_, model, start, actuation);
  const LoadState to{actuation, 1};
  Iterate at = iterate_at(start, from);
  from = load_state_now(start, from, at, options, handle.work(), team);
  // if the supports of the start are elsewhere, there may be no free motion to their positions
  const bool clear = !system_.contact() || largest_move(start.positions, at.positions) == 0 ||
                     comes_to(start.positions, at.positions, handle.work(), team);
  Continuation continuation(system_, handle.work(), team, options, progress, record, report);
  if (clear)
    report.status = continuation.follow(from, to, at);
  else {
    report.status = Status::limit;
    report.remark = "the start's supports are elsewhere, and something is in the way from there";
  }
  // friction depends on the path to the equilibrium, and a solve from rest would find another one
  const bool remembers = (system_.friction() || system_.tendons().any()) && start.knows(system_.actuators());
  if (report.status == Status::limit && record.continuation_steps == 0 && start.positions != model.rest && !remembers &&
      !continuation.at_limit_point())
    begin_again(to, options, progress, team, handle.work(), at, record, report);
  if (report.status == Status::converged) handle.work().solved_shape = at.positions;
  record.write_to(report);
  report.estimated_error_mm = record.step_mm;
  const bool unknown = (start.actuation.size() == 0 && start.positions != model.rest && record.reached == 0) ||
                       (from.fading > 0 && record.reached < 1);
  const bool arrived = report.status == Status::converged || record.reached >= 1;
  result.state = state_at(std::move(at), arrived ? to : clear ? continuation.here() : from, options);
  if (report.status != Status::converged && unknown) {  // of an unknown load state
    result.state.actuation.resize(0);
    result.state.multipliers.resize(0);
    result.state.load_factor = -1;
  }
  return result;
}

}  // namespace softkin::physical
