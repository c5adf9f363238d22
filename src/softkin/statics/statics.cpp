#include <chrono>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/statics_parts.hpp>
#include <softkin/statics/target_shape_solver.hpp>

namespace softkin {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Source of given equilibria, without a solver.
class GivenSolver : public FormulationSolver {
 public:
  explicit GivenSolver(std::unique_ptr<const GivenEquilibria> given) : given_(std::move(given)) {}

  [[nodiscard]] Equilibrium solve(const Actuation& actuation, const State& start, const StaticsOptions&,
                                  const ProgressCallback&) override {
    return given_->at(actuation, start);
  }
  [[nodiscard]] Sensitivity sensitivity(const State& at, const StaticsOptions&, double) const override {
    return given_->sensitivity(at);
  }

 private:
  std::unique_ptr<const GivenEquilibria> given_;
};

/// Adds to a remark that the limit of iterations ended a solve.
void report_limit(int iterations, SolveReport& report) {
  const std::string reported =
      "the limit of " + counted(static_cast<std::size_t>(iterations), "iteration") + " (max_iterations) was reached";
  report.remark = report.remark.empty() ? reported : report.remark + " (" + reported + ")";
}

std::unique_ptr<FormulationSolver> solver_of(const Model& model, Lender& lender) {
  if (model.formulation == Formulation::physical) return std::make_unique<PhysicalSolver>(model, lender);
  return std::make_unique<TargetShapeSolver>(model, lender);
}

}  // namespace

const char* name_of(Solver solver) {
  return solver == Solver::newton ? "newton" : "local-global";
}

void check_actuation(const Model& model, const Actuation& actuation) {
  if (actuation.size() != std::ssize(model.actuators))
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
  parts_->solver = solver_of(model, parts_->lender);
}
Statics::Statics(const Model& model, const Statics& like) : parts_(std::make_unique<Parts>(model)) {
  const PhysicalSolver* of_like = like.parts_->solver->physical();
  if (model.formulation == Formulation::physical && of_like)
    parts_->solver = std::make_unique<PhysicalSolver>(model, *of_like, parts_->lender);
  else
    parts_->solver = solver_of(model, parts_->lender);
}
Statics::Statics(const Model& model, std::unique_ptr<const GivenEquilibria> given, Given use)
    : parts_(std::make_unique<Parts>(model)) {
  if (use == Given::answers) {
    parts_->solver = std::make_unique<GivenSolver>(std::move(given));
    return;
  }
  parts_->solver = solver_of(model, parts_->lender);
  parts_->starts = std::move(given);
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
                           const ProgressCallback& requested_progress) const {
  const auto begin = std::chrono::steady_clock::now();
  const int most = options.iteration_limit();
  bool stops = false, late = false, spent = false;
  double reached = 0;  // fraction of the path
  int before = 0;      // iterations until then: the limit is one of a step, for as long as the path advances
  const ProgressCallback progress = [&](const Progress& p) {
    if (stops) return false;
    stops = requested_progress && !requested_progress(p);
    late = options.deadline.passed();  // afterwards, as the callback may check the same deadline
    if (p.fraction > reached) {
      reached = p.fraction;
      before = p.iteration;
    }
    spent = !stops && !late && p.iteration - before >= most;
    stops = stops || late || spent;
    return !stops;
  };
  const Model& model = parts_->model;
  check_actuation(model, actuation);
  check_start(model, start, options);
  if (!(options.beyond >= 0 && std::isfinite(options.beyond)))
    throw InvalidInput("beyond must be a volume or length over that at rest, above 0, not " + number(options.beyond));
  State near;
  if (parts_->starts && !model.contact.any()) {
    Equilibrium given = parts_->starts->at(actuation, start);
    if (given.report.status == Status::converged) near = std::move(given.state);
  }
  Equilibrium result = parts_->solver->solve(actuation, near.positions.rows() > 0 ? near : start, options, progress);
  SolveReport& report = result.report;
  if (report.status == Status::interrupted) {
    report.stopped = !spent;
    if (late || spent) report.status = Status::not_converged;
    if (late) report.remark = options.deadline.spent();
    if (spent) report_limit(most, report);
  }
  report.seconds = seconds_since(begin);
  return result;
}

Sensitivity Statics::sensitivity(const State& at, const StaticsOptions& options, double accuracy) const {
  parts_->check_known(at, options, "the sensitivity of a shape");
  return parts_->solver->sensitivity(at, options, accuracy);
}

ParameterSensitivity Statics::sensitivity_along(const State& at, const std::vector<Actuation>& changes,
                                                const StaticsOptions& options, double accuracy, bool reactions) const {
  parts_->check_known(at, options, "the sensitivity of a shape");
  const physical::Equilibria& equilibria =
      parts_->need_equilibria("sensitivities along changes are for the physical formulation");
  for (const Actuation& change : changes)
    if (change.size() != at.actuation.size() || !change.allFinite())
      throw InvalidInput("a change of the actuation must be of a finite value for each of the robot's actuators");
  const TeamPool::Lent team = parts_->lender.lend(options);
  return equilibria.sensitivity(at, changes, parts_->options_of(options), accuracy, reactions, *team);
}

std::vector<Points> Statics::reciprocal_moves(const State& at, const std::vector<Points>& forces,
                                              const StaticsOptions& options, double accuracy) const {
  parts_->check_known(at, options, "the compliance of a shape");
  for (const Points& force : forces)
    if (force.rows() != at.positions.rows() || !force.allFinite())
      throw InvalidInput("forces must be of three finite values for each of the robot's vertices");
  const physical::Equilibria* equilibria = parts_->equilibria();
  if (!equilibria || !equilibria->system().reciprocal()) return {};
  return equilibria->moves_under(at, forces, parts_->options_of(options), accuracy, *parts_->lender.lend(options));
}

bool Statics::extrapolate(const Actuation& actuation, const State& at, const StaticsOptions& options,
                          Points& positions) const {
  check_actuation(parts_->model, actuation);
  parts_->check_known(at, options, "the extrapolation from a shape");
  if (!extrapolates() || !options.reuse_factor) return false;
  return parts_->equilibria()->extrapolate(actuation, at, options.tuning, positions, *parts_->lender.lend(options));
}

bool Statics::set_initial_guess(const State& at, State there, const StaticsOptions& options) const {
  check_actuation(parts_->model, there.actuation);
  parts_->check_known(there, options, "the initial guess");
  if (!extrapolates() || !options.reuse_factor) return false;
  return parts_->equilibria()->set_initial_guess(at, std::move(there));
}

bool Statics::extrapolates() const {
  return parts_->equilibria() && !parts_->model.contact.any();
}

ElementDeformation Statics::measured(const State& at) const {
  ElementDeformation deformation = deformation_of(parts_->model, at.positions);
  const bool unknown = at.load_factor < 0 || (at.actuation.size() == 0 && !parts_->model.actuators.empty());
  const physical::Equilibria* equilibria = parts_->equilibria();
  if (!equilibria || unknown) return deformation;
  const StaticsOptions options;
  parts_->check_known(at, options, "the stress in a shape");
  equilibria->measure(at, deformation, *parts_->lender.lend(options));
  return deformation;
}

std::vector<std::vector<Vec3>> Statics::pressing_changes(const State& at, const std::vector<Points>& moves) const {
  const StaticsOptions options;
  parts_->check_known(at, options, "what presses in a shape");
  const physical::Equilibria& equilibria =
      parts_->need_equilibria("what presses on obstacles is known in the physical formulation alone");
  for (const Points& move : moves)
    if (move.rows() != at.positions.rows() || !move.allFinite())
      throw InvalidInput("moves must be of three finite values for each of the robot's vertices");
  return equilibria.pressing_changes(at, moves, *parts_->lender.lend(options));
}

bool Statics::viscous() const {
  return parts_->equilibria() && parts_->equilibria()->system().viscous();
}

ViscousFlow Statics::flow(const State& at) const {
  const StaticsOptions options;
  parts_->check_actuation(at, options, "what is remembered of a shape");
  if (!viscous()) return {};
  return parts_->solver->physical()->flow(at);
}

void Statics::forget() const {
  parts_->solver->forget();
}

}  // namespace softkin
