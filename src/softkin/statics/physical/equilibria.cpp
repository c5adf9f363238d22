#include <cmath>
#include <softkin/statics/physical/contact_at_rest.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>
#include <softkin/statics/physical/lease.hpp>

namespace softkin::physical {

namespace {

/// The rest shape is one of any angles of what turns, as nothing of them is there: of those that are asked for, so that
/// the way goes straight there. And it is one without forces, whatever they are where no command says another.
Demand at_rest(const Model& model, const Actuation& wanted) {
  Demand demand{model.rest_actuation(), 0};
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& of = model.actuators[a];
    if (of.is<TurnCommand>()) demand.actuation[a] = wanted[a];
    if (of.is<ForceCommand>() || of.is<MomentCommand>() || of.is<PressureCommand>()) demand.actuation[a] = 0;
    if (of.is<GrowthDrive>()) demand.actuation[a] = model.actuators[a].rest;
  }
  return demand;
}

/// The command that a start's measure is of. What fills a chamber is told by its pressure, too: where that is not known
/// it is what is asked for, under the pressure that it has in the volume.
double measured_command(const supports::ActuatorMeasures& measures, Index actuator, const State& start, bool rests,
                        double wanted) {
  const double measure = measures.value(actuator, start.positions);
  const bool known = start.multipliers.size() > 0;
  const double pressure = known ? measures.unit(actuator) * start.multipliers[actuator] : 0;
  const Filling* filling = measures.filling(actuator);
  if (!filling || known || rests || !filling->gives_way() || !std::isfinite(filling->pressure(wanted, measure)))
    return measures.command_for(actuator, measure, pressure);
  return wanted;
}

/// Multipliers of a start of which only the shape is known, and what it is taken for: of what fills chambers.
void fill_chambers(const supports::ActuatorMeasures& measures, const Demand& demand, Iterate& at) {
  for (Index a = 0; a < measures.count(); ++a) {
    const Filling* filling = measures.filling(a);
    if (!filling || !filling->gives_way()) continue;
    const double pressure = filling->pressure(demand.actuation[a], measures.value(a, at.positions));
    if (std::isfinite(pressure)) at.multipliers[a] = pressure;
  }
}

/// What the start is an equilibrium of, as far as it tells.
Demand demand_of(const System& system, const Model& model, const State& start, const Actuation& wanted) {
  if (start.actuation.size() > 0) return {start.actuation, start.share};
  const bool rests = start.positions == model.rest;
  Demand demand = at_rest(model, wanted);
  if (!rests) demand.share = start.share >= 0 ? start.share : 1.0;
  for (Index a = 0; a < system.actuators(); ++a) {
    if (system.measures().constrains(a))
      demand.actuation[a] = measured_command(system.measures(), a, start, rests, wanted[a]);
    else if (model.actuators[a].is<MotionCommand>() || (model.actuators[a].is<TurnCommand>() && !rests))
      demand.actuation[a] = system.placement().command_of(a, start.positions);
    else if (!drives(model.actuators[a]) || model.actuators[a].is<GrowthDrive>())
      continue;
    else if (model.actuators[a].is<MagneticDrive>())
      demand.actuation[a] = model.actuators[a].rest;
    else if (model.actuators[a].is<DeaDrive>() && !under_voltage(model.actuators[a]))
      demand.actuation[a] = 1;
    else
      demand.actuation[a] = start.multipliers.size() > 0
                                ? system.measures().command(a, system.measures().unit(a) * start.multipliers[a])
                                : 0;
  }
  return demand;
}

}  // namespace

void Equilibria::measure(const State& state, ElementDeformation& out, Team& team) const {
  const Inside at(*this, state, team);
  Lease lease(*this, at->positions, true);
  system_.set_time(at->history, at->elapsed_s, lease.work(), team);
  const Iterate shape = system_.iterate(*at);
  hold_friction(system_, shape, lease.work(), team);
  system_.measure(shape, {at->actuation, at->share}, lease.work(), out, team);
  out.multipliers = at->multipliers;
  drop_vertices(out.reactions);
}

bool Equilibria::foresee(const Actuation& actuation, const State& state, Points& positions, Team& team) const {
  if (system_.contact()) return false;
  const Inside at(*this, state, team);
  Lease lease(*this, at->positions, true);
  system_.set_time(at->history, at->elapsed_s, lease.work(), team);
  const bool foreseen = physical::foresee(system_, {at->actuation, at->share}, {actuation, at->share}, lease.work(),
                                          team, system_.iterate(*at), positions);
  if (foreseen) drop_vertices(positions);
  return foreseen;
}

bool Equilibria::foretell(const State& at, State there) const {
  if (system_.contact() || system_.pressures()) return false;
  Lease lease(*this, at.positions, true);
  if (lease.work().home.rows() == 0) return false;
  for (Index a = 0; a < system_.actuators(); ++a) there.multipliers[a] *= system_.measures().unit(a);
  lease.work().foretold = std::move(there);
  return true;
}

std::vector<std::vector<Vec3>> Equilibria::pressing_changes(const State& state, const std::vector<Points>& moves,
                                                            Team& team) const {
  const ContactModel& contact = system_.model().contact;
  std::vector<std::vector<Vec3>> changes(moves.size(), std::vector<Vec3>(contact.parts.size(), Vec3::Zero()));
  if (!system_.contact()) return changes;
  const Inside at(*this, state, team);
  Lease lease(*this, at->positions, true);
  const Iterate shape = system_.iterate(*at);
  system_.contacts()->find(shape.positions, *lease.work().contacts, team);
  hold_friction(system_, shape, lease.work(), team);
  Points own = Points::Zero(at->positions.rows(), 3);  // with those of pressures, which touch nothing
  for (std::size_t k = 0; k < moves.size(); ++k) {
    own.topRows(moves[k].rows()) = moves[k];
    const Points change = system_.contacts()->change_along(shape.positions, *lease.work().contacts, own);
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
  Lease lease(*this, at->positions, true);
  system_.set_time(at->history, at->elapsed_s, lease.work(), team);
  flow.history = system_.flow(*at, lease.work(), flow.lost_mJ, team);
  return flow;
}

void Equilibria::forget() const {
  const std::lock_guard lock(mutex_);
  idle_.clear();
}

bool Equilibria::comes_to(const Points& from, const Points& to, Workspace& work, Team& team) const {
  Points end;
  const Way straight = [&](double share, Points& out) { out = from + share * (to - from); };
  return clear_share(system_, from, straight, 1, work, end, team) >= 1;
}

/// From a start that is no equilibrium no path may lead away; from rest one may.
void Equilibria::begin_again(const Demand& to, const Options& options, const ProgressCallback& progress, Team& team,
                             Workspace& work, Iterate& at, SolveReport& report) const {
  const std::string remark = report.remark;
  Iterate fresh{system_.model().rest, Eigen::VectorXd::Zero(system_.actuators()), {}, {}};
  Demand from = at_rest(system_.model(), to.actuation);
  system_.placement().hold(from, fresh.positions);
  fresh.eyelets = system_.tendons().lengths(fresh.positions);
  Continuation continuation(system_, work, team, options, progress, report);
  if (system_.viscous()) {
    hold_friction(system_, fresh, work, team);
    from = system_.unbalanced(fresh, from, work, team);
  }
  const Status status = continuation.follow(from, to, fresh);
  if (status == Status::converged) {
    at = std::move(fresh);
    report.status = status;
    if (report.remark == remark) report.remark.clear();
    return;
  }
  if (status == Status::interrupted) report.status = status;
  report.remark = remark;
  report.reached = 0;
}

Equilibrium Equilibria::solve(const Actuation& actuation, const State& start, const Options& options,
                              const ProgressCallback& progress, Team& team) const {
  Equilibrium found = solve_inside(actuation, *Inside(*this, start, team), options, progress, team);
  outside(found.state);
  return found;
}

/// The start as it is held, with the multipliers of what it is an equilibrium of.
Iterate Equilibria::iterate_at(const State& start, const Demand& from) const {
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

/// Sets the time, and says what the start is an equilibrium of then: what is viscous has crept since.
Demand Equilibria::demand_now(const State& start, const Demand& from, const Iterate& at, const Options& options,
                              Workspace& work, Team& team) const {
  system_.set_time(options.history, options.elapsed_s, work, team);
  const bool rests = start.positions == system_.model().rest && start.actuation.size() == 0;
  const bool same_time =
      rests ? !options.history : start.history == options.history && start.elapsed_s == options.elapsed_s;
  if (!system_.viscous() || same_time || !(rests || start.knows(system_.actuators()))) return from;
  hold_friction(system_, at, work, team);
  return system_.unbalanced(at, from, work, team);
}

State Equilibria::state_at(Iterate&& at, const Demand& demand, const Options& options) const {
  State state;
  state.positions = std::move(at.positions);
  state.anchors = std::move(at.anchors);
  state.eyelets = std::move(at.eyelets);
  state.actuation = demand.actuation;
  state.share = demand.share;
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
  report.reached = 0;
  if (start.actuation.size() == 0 && start.positions != model.rest) check_contact_of_start(model, start.positions);
  Lease lease(*this, start.positions, options.reuse_factor);

  Demand from = demand_of(system_, model, start, actuation);
  const Demand to{actuation, 1};
  Iterate at = iterate_at(start, from);
  from = demand_now(start, from, at, options, lease.work(), team);
  // a start whose supports are elsewhere may have no way there
  const bool clear = !system_.contact() || largest_move(start.positions, at.positions) == 0 ||
                     comes_to(start.positions, at.positions, lease.work(), team);
  Continuation continuation(system_, lease.work(), team, options, progress, report);
  if (clear)
    report.status = continuation.follow(from, to, at);
  else {
    report.status = Status::limit;
    report.remark = "the start's supports are elsewhere, and something is in the way from there";
  }
  // what rubs remembers the way to its equilibrium, and from rest comes to another one
  const bool remembers = (system_.friction() || system_.tendons().any()) && start.knows(system_.actuators());
  if (report.status == Status::limit && report.continuation_steps == 0 && start.positions != model.rest && !remembers &&
      !continuation.at_summit())
    begin_again(to, options, progress, team, lease.work(), at, report);
  if (report.status == Status::converged) lease.work().home = at.positions;
  report.estimated_error_mm = report.step_mm;
  const bool unknown = (start.actuation.size() == 0 && start.positions != model.rest && report.reached == 0) ||
                       (from.fading > 0 && report.reached < 1);
  const bool arrived = report.status == Status::converged || report.reached >= 1;
  result.state = state_at(std::move(at), arrived ? to : clear ? continuation.here() : from, options);
  if (report.status != Status::converged && unknown) {  // of nothing known
    result.state.actuation.resize(0);
    result.state.multipliers.resize(0);
    result.state.share = -1;
  }
  return result;
}

}  // namespace softkin::physical
