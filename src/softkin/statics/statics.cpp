#include <chrono>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/lease.hpp>
#include <softkin/statics/statics_parts.hpp>

namespace softkin {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check_formulation(const StaticsOptions& options, Formulation formulation) {
  if (formulation == Formulation::physical) {
    if (options.solver == Solver::local_global)
      throw InvalidInput("solver local-global is for the target-shape formulation; the physical one has newton");
    return;
  }
  if (options.beyond > 0)
    throw InvalidInput("beyond is for the physical formulation: target shapes have no pressures and tensions");
  if (options.stable)
    throw InvalidInput("stable is for the physical formulation: target shapes have no stiffness that buckles");
}

}  // namespace

const char* name_of(Solver solver) {
  return solver == Solver::newton ? "newton" : "local-global";
}

void check_actuation(const Model& model, const Actuation& actuation) {
  if (actuation.size() != static_cast<Index>(model.actuators.size()))
    throw InvalidInput("the actuation has " + std::to_string(actuation.size()) + " values, the robot " +
                       std::to_string(model.actuators.size()) + " actuators");
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const double value = actuation[a];
    if (!(value >= actuator.low && value <= actuator.high))
      throw InvalidInput("actuator '" + actuator.name + "': the " + command_name(actuator) + " " + number(value) +
                         " is outside its range " + number(actuator.low) + " to " +
                         command_text(actuator, actuator.high));
  }
}

Statics::Statics(const Model& model) : parts_(std::make_unique<Parts>(model)) {
  parts_->assemble(model);
}
Statics::Statics(const Model& model, const Statics& like) : parts_(std::make_unique<Parts>(model)) {
  if (model.formulation == Formulation::physical && like.parts_->physical)
    parts_->physical.emplace(model, *like.parts_->physical);
  else
    parts_->assemble(model);
}
Statics::Statics(const Model& model, std::unique_ptr<const GivenEquilibria> given, Given use)
    : parts_(std::make_unique<Parts>(model)) {
  parts_->given = std::move(given);
  if (use == Given::starts) parts_->assemble(model);
}
Statics::~Statics() = default;
Statics::Statics(Statics&&) noexcept = default;
Statics& Statics::operator=(Statics&&) noexcept = default;

const Model& Statics::model() const {
  return parts_->model;
}

State Statics::rest() const {
  State state;
  state.positions = parts_->model.rest;
  return state;
}

Equilibrium Statics::solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                           const ProgressCallback& asked_progress) const {
  const auto begin = std::chrono::steady_clock::now();
  bool late = false;
  const ProgressCallback until_deadline = [&](const Progress& p) {
    late = options.deadline.passed();
    return !late && (!asked_progress || asked_progress(p));
  };
  const ProgressCallback& progress = options.deadline.any() ? until_deadline : asked_progress;
  const Model& model = parts_->model;
  check_actuation(model, actuation);
  check_start(model, start, options);
  if (!(options.beyond >= 0 && std::isfinite(options.beyond)))
    throw InvalidInput("beyond must be a volume or length over that at rest, above 0, not " + number(options.beyond));
  if (parts_->given && !parts_->assembled()) {
    Equilibrium given = parts_->given->at(actuation, start);
    given.report.seconds = seconds_since(begin);
    return given;
  }
  State near;
  if (parts_->given && !model.contact.any()) {
    Equilibrium given = parts_->given->at(actuation, start);
    if (given.report.status == Status::converged) near = std::move(given.state);
  }
  const State& begun = near.positions.rows() > 0 ? near : start;
  const TeamPool::Lent team = parts_->team(options);
  Equilibrium result;
  parts_->check_history(options.history.get(), options.elapsed_s);
  check_formulation(options, parts_->physical ? Formulation::physical : Formulation::target_shape);
  if (parts_->physical) {
    result = parts_->solve(actuation, begun, options, progress, *team);
  } else {
    result.actuation = actuation;
    result.state.positions = begun.positions;
    result.report.tolerance_mm = parts_->tolerance(options);
    parts_->solve_target_shape(begun.actuation, options, progress, *team, result);
    if (result.report.status == Status::converged) result.state.actuation = actuation;
    result.state.multipliers = Eigen::VectorXd::Zero(actuation.size());
  }
  SolveReport& report = result.report;
  report.stopped = report.status == Status::interrupted;
  if (report.stopped && late) {
    report.status = Status::not_converged;
    report.remark = options.deadline.spent();
  }
  report.seconds = seconds_since(begin);
  return result;
}

Sensitivity Statics::sensitivity(const State& at, const StaticsOptions& options, double accuracy) const {
  parts_->check_known(at, options, "the sensitivity of a shape");
  if (parts_->given && !parts_->assembled()) return parts_->given->sensitivity(at);
  const TeamPool::Lent team = parts_->team(options);
  if (parts_->physical) return parts_->physical->sensitivity(at, options.reuse_factor, accuracy, *team);
  return parts_->target_shape->newton.sensitivity(at, options.reuse_factor, accuracy, *team);
}

ParameterSensitivity Statics::sensitivity_along(const State& at, const std::vector<Actuation>& changes,
                                                const StaticsOptions& options, double accuracy, bool reactions) const {
  parts_->check_known(at, options, "the sensitivity of a shape");
  if (!parts_->physical) throw InvalidInput("sensitivities along changes are for the physical formulation");
  for (const Actuation& change : changes)
    if (change.size() != at.actuation.size() || !change.allFinite())
      throw InvalidInput("a change of the actuation must be of a finite value for each of the robot's actuators");
  const TeamPool::Lent team = parts_->team(options);
  return parts_->physical->sensitivity(at, changes, options.reuse_factor, accuracy, reactions, *team);
}

std::vector<Points> Statics::reciprocal_moves(const State& at, const std::vector<Points>& forces,
                                              const StaticsOptions& options, double accuracy) const {
  parts_->check_known(at, options, "how a shape gives way");
  for (const Points& force : forces)
    if (force.rows() != at.positions.rows() || !force.allFinite())
      throw InvalidInput("forces must be of three finite values for each of the robot's vertices");
  if (!parts_->physical || !parts_->physical->system().reciprocal()) return {};
  return parts_->physical->moves_under(at, forces, options.reuse_factor, accuracy, *parts_->team(options));
}

bool Statics::foresee(const Actuation& actuation, const State& at, const StaticsOptions& options,
                      Points& positions) const {
  check_actuation(parts_->model, actuation);
  parts_->check_known(at, options, "what is foreseen from a shape");
  if (!foresees() || !options.reuse_factor) return false;
  return parts_->physical->foresee(actuation, at, positions, *parts_->team(options));
}

bool Statics::foretell(const State& at, State there, const StaticsOptions& options) const {
  check_actuation(parts_->model, there.actuation);
  parts_->check_known(there, options, "what is foretold");
  if (!foresees() || !options.reuse_factor) return false;
  return parts_->physical->foretell(at, std::move(there));
}

bool Statics::foresees() const {
  return parts_->physical && !parts_->model.contact.any();
}

ElementDeformation Statics::measured(const State& at) const {
  ElementDeformation deformation = deformation_of(parts_->model, at.positions);
  const bool unknown = at.share < 0 || (at.actuation.size() == 0 && !parts_->model.actuators.empty());
  if (!parts_->physical || unknown) return deformation;
  const StaticsOptions options;
  parts_->check_known(at, options, "the stress in a shape");
  parts_->physical->measure(at, deformation, *parts_->team(options));
  return deformation;
}

std::vector<std::vector<Vec3>> Statics::pressing_changes(const State& at, const std::vector<Points>& moves) const {
  const StaticsOptions options;
  parts_->check_known(at, options, "what presses in a shape");
  if (!parts_->physical) throw InvalidInput("what presses on obstacles is known in the physical formulation alone");
  for (const Points& move : moves)
    if (move.rows() != at.positions.rows() || !move.allFinite())
      throw InvalidInput("moves must be of three finite values for each of the robot's vertices");
  return parts_->physical->pressing_changes(at, moves, *parts_->team(options));
}

bool Statics::viscous() const {
  return parts_->physical && parts_->physical->system().viscous();
}

ViscousFlow Statics::flow(const State& at) const {
  const StaticsOptions options;
  parts_->check_actuation(at, options, "what is remembered of a shape");
  if (!viscous()) return {};
  parts_->check_history(at.history.get(), at.elapsed_s);
  const TeamPool::Lent team = parts_->team(options);
  if (at.history || std::isinf(at.elapsed_s)) return parts_->physical->flow(at, *team);
  if (parts_->long_rest(options, {}, *team).report.status != Status::converged)
    throw InvalidInput("the robot has no equilibrium at rest, where its times begin");
  State begun = at;
  begun.history = parts_->remembered;
  return parts_->physical->flow(begun, *team);
}

void Statics::forget() const {
  if (parts_->physical) parts_->physical->forget();
  if (parts_->target_shape) parts_->target_shape->newton.forget();
}

}  // namespace softkin
