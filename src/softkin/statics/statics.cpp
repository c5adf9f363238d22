#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/equilibria.hpp>
#include <softkin/statics/physical/lease.hpp>
#include <softkin/statics/physical/newton.hpp>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/target_shape/local_global.hpp>
#include <softkin/statics/target_shape/newton.hpp>

namespace softkin {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check_start(const Model& model, const State& start, const StaticsOptions& options) {
  if (start.positions.rows() != model.rest.rows())
    throw InvalidInput("the start has " + std::to_string(start.positions.rows()) + " vertices, the robot " +
                       std::to_string(model.rest.rows()));
  if (!start.positions.allFinite()) throw InvalidInput("the start holds a coordinate that is not finite");
  for (const Eigen::VectorXd* values : {&start.actuation, &start.multipliers}) {
    const char* name = values == &start.actuation ? "actuation" : "multipliers";
    if (values->size() > 0 && values->size() != static_cast<Index>(model.actuators.size()))
      throw InvalidInput(std::string("the start's ") + name + " has " + std::to_string(values->size()) +
                         " values, the robot " + std::to_string(model.actuators.size()) + " actuators");
    if (!values->allFinite())
      throw InvalidInput(std::string("the start's ") + name + " holds a value that is not finite");
  }
  const auto lies_on_model = [&](const Anchor& anchor) {
    return anchor.vertex >= 0 && anchor.vertex < static_cast<Index>(model.contact.area.size()) &&
           anchor.triangle >= 0 && anchor.triangle < static_cast<Index>(model.contact.triangles.size()) &&
           anchor.weights.allFinite();
  };
  const auto finite = [](double length) { return std::isfinite(length); };
  if (!start.eyelets.empty() && (start.eyelets.size() != physical::Tendons(model).remembered() ||
                                 !std::all_of(start.eyelets.begin(), start.eyelets.end(), finite)))
    throw InvalidInput("the start's cables rub elsewhere than the robot's");
  if (!std::all_of(start.anchors.begin(), start.anchors.end(), lies_on_model))
    throw InvalidInput("the start's friction is of another robot");
  if (!(options.step_tolerance_mm >= 0) || options.max_iterations < 1 || options.anderson < 0 ||
      options.anderson > 20 || options.threads < 0)
    throw InvalidInput(
        "solver options out of range: tolerance >= 0 mm, iterations >= 1, anderson 0 to 20, threads >= 0");
  if (options.as_published && options.solver != Solver::local_global)
    throw InvalidInput("to stop as published is for solver local-global");
  if (options.as_published && model.markers.empty())
    throw InvalidInput("to stop as published watches the robot's markers, and it has none");
}

/// Waking a thread for every loop costs as much as some hundred elements.
int worthwhile_threads(const Model& model) {
  constexpr std::size_t elements_each = 1000;
  const std::size_t elements = model.tetrahedra.size() + model.prisms.size();
  return static_cast<int>(
      std::clamp<std::size_t>(elements / elements_each, 1, std::max(1u, std::thread::hardware_concurrency())));
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
    const double value = actuation[static_cast<Index>(a)];
    if (!(value >= actuator.low && value <= actuator.high))
      throw InvalidInput("actuator '" + actuator.name + "': the " + command_name(actuator) + " " + number(value) +
                         " is outside its range " + number(actuator.low) + " to " +
                         command_text(actuator, actuator.high));
  }
}

struct Statics::Parts {
  explicit Parts(const Model& robot) : model(robot), worthwhile(worthwhile_threads(robot)) {}

  void assemble(const Model& robot) {
    if (robot.formulation == Formulation::physical)
      physical.emplace(robot);
    else
      target_shape.emplace(robot);
  }
  struct TargetShape {
    explicit TargetShape(const Model& robot)
        : system(robot),
          turning(robot),
          unknowns(robot, system),
          global(robot, system.global_matrix(), unknowns.freedoms.vertex_order()),
          newton(unknowns, global) {}
    target_shape::System system;
    supports::Turning turning;
    target_shape::Unknowns unknowns;
    supports::GlobalStep global;
    target_shape::Newton newton;
  };
  [[nodiscard]] TeamPool::Lent team(const StaticsOptions& options) {
    if (options.threads > 0) return teams.lend(options.threads);
    try {
      return teams.lend(worthwhile);
    } catch (const InvalidInput&) {  // nobody asked for so many; the result is the same
      worthwhile = 1;
      return teams.lend(1);
    }
  }

  /// of: for messages
  void check_actuation(const State& at, const StaticsOptions& options, const std::string& of) const {
    check_start(model, at, options);
    if (!at.knows(static_cast<Index>(model.actuators.size())))
      throw InvalidInput(of + " needs the actuation of which it is the equilibrium");
    if (!std::isfinite(at.share)) throw InvalidInput("the share of the loads at the shape is not finite");
  }
  void check_known(const State& at, const StaticsOptions& options, const std::string& of) const {
    check_actuation(at, options, of);
    if (physical && at.multipliers.size() != at.actuation.size())
      throw InvalidInput(of + " needs the tensions and pressures of its equilibrium");
  }

  void check_history(const ViscousHistory* history, double elapsed_s) const {
    if (!(elapsed_s >= 0))
      throw InvalidInput("the time of a step must be 0 s or more, not " + number(elapsed_s) + " s");
    if (history && (!physical || history->strains.size() != physical->system().remembered()))
      throw InvalidInput("the history of the material is of another robot");
  }

  [[nodiscard]] double paper_tolerance() const { return 8e-8 * model.diagonal_mm; }
  [[nodiscard]] double tolerance(const StaticsOptions& options) const {
    return options.step_tolerance_mm > 0 ? options.step_tolerance_mm : paper_tolerance();
  }
  [[nodiscard]] physical::Equilibria::Options physical_options(const StaticsOptions& options) const {
    const double longest = tolerance(options), blur = 1e-6 * std::max(1.0, longest / paper_tolerance());
    return {longest,
            options.max_iterations,
            options.keep_history,
            options.trace,
            options.reuse_factor,
            options.stable,
            options.beyond,
            blur,
            options.history,
            options.elapsed_s};
  }

  /// Where a viscous robot has stood for long, relaxed, before times begin: found once. Else not converged.
  Equilibrium long_rest(StaticsOptions options, const ProgressCallback& progress, Team& team) {
    const std::lock_guard lock(rested_mutex);
    if (rested) return *rested;
    options.history = nullptr;
    options.elapsed_s = std::numeric_limits<double>::infinity();
    State start;
    start.positions = model.rest;
    Equilibrium found = physical->solve(model.rest_actuation(), start, physical_options(options), progress, team);
    if (found.report.status == Status::converged) {
      rested = found;
      remembered = physical->flow(found.state, team).history;
    }
    return found;
  }

  /// In the physical formulation.
  Equilibrium solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                    const ProgressCallback& progress, Team& team) {
    const bool begins = physical->system().viscous() && std::isfinite(options.elapsed_s) && !options.history;
    if (!begins) return physical->solve(actuation, start, physical_options(options), progress, team);
    Equilibrium rest = long_rest(options, progress, team);
    if (rest.report.status != Status::converged) {
      rest.actuation = actuation;
      rest.state.actuation.resize(0);
      rest.state.share = -1;
      rest.report.reached = 0;
      rest.report.remark = "where the robot rests before times begin: " + rest.report.remark;
      return rest;
    }
    physical::Equilibria::Options begun = physical_options(options);
    begun.history = remembered;
    const bool from_rest = start.actuation.size() == 0 && start.positions == model.rest;
    return physical->solve(actuation, from_rest ? rest.state : start, begun, progress, team);
  }

  /// In target shapes, from result.state.positions. Where supports turn far, by equilibria on the way: what is held is
  /// put in its place at once, and elements that it turns over would stay so.
  void solve_target_shape(const Actuation& start, const StaticsOptions& options, const ProgressCallback& progress,
                          Team& team, Equilibrium& result) {
    constexpr double most_turn = 10;  // at once [degrees]
    const TargetShape& parts = *target_shape;
    const Actuation asked = result.actuation;
    Actuation from = start.size() > 0 ? start : asked;
    for (Index a = 0; start.size() == 0 && a < asked.size(); ++a)
      if (model.actuators[static_cast<std::size_t>(a)].kind == ActuatorKind::turn)
        from[a] = parts.turning.angle(a, result.state.positions);
    const int steps =
        std::max(1, static_cast<int>(std::ceil(parts.turning.largest_turn(from, 1, asked, 1) / most_turn)));
    Actuation last = steps > 1 ? from : start;
    int on_the_way = 0;
    for (int step = 1; step <= steps; ++step) {
      result.actuation = step == steps ? asked : Actuation(from + (asked - from) * step / steps);
      result.report.status = Status::not_converged;
      if (options.solver == Solver::newton)
        parts.newton.solve(last, options, progress, team, result);
      else
        target_shape::solve_local_global(model, parts.system, parts.global, options, progress, team, result);
      on_the_way += result.report.continuation_steps;
      if (result.report.status != Status::converged) break;
      last = result.actuation;
    }
    if (options.solver == Solver::newton) result.report.continuation_steps = on_the_way;
    result.actuation = asked;
  }

  const Model& model;
  std::mutex rested_mutex;
  std::optional<Equilibrium> rested;
  std::shared_ptr<const ViscousHistory> remembered;  // of rested
  std::atomic<int> worthwhile = 1;                   // threads
  TeamPool teams;
  std::optional<TargetShape> target_shape;
  std::optional<physical::Equilibria> physical;
  std::unique_ptr<const GivenEquilibria> given;

  [[nodiscard]] bool assembled() const { return physical || target_shape; }
};

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
  if (parts_->physical) {
    if (options.solver == Solver::local_global)
      throw InvalidInput("solver local-global is for the target-shape formulation; the physical one has newton");
    result = parts_->solve(actuation, begun, options, progress, *team);
  } else {
    if (options.beyond > 0)
      throw InvalidInput("beyond is for the physical formulation: target shapes have no pressures and tensions");
    if (options.stable)
      throw InvalidInput("stable is for the physical formulation: target shapes have no stiffness that buckles");
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
  if (!parts_->physical || !parts_->physical->system().symmetric()) return {};
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

struct Perturbations::Parts {
  const Statics& statics;
  std::vector<physical::Perturbation> perturbations{};
};

Perturbations::Perturbations(const Statics& statics, const std::vector<Perturbed>& perturbed)
    : parts_(std::make_unique<Parts>(Parts{statics})) {
  if (!statics.parts_->physical)
    throw InvalidInput("derivatives by numbers of the robot are for the physical formulation");
  for (const Perturbed& each : perturbed) {
    if (!(each.difference != 0 && std::isfinite(each.difference)))
      throw InvalidInput("a number is not perturbed, or by a difference that is not finite");
    parts_->perturbations.emplace_back(each, statics.parts_->physical->system());
  }
}

Perturbations::~Perturbations() = default;
Perturbations::Perturbations(Perturbations&&) noexcept = default;
Perturbations& Perturbations::operator=(Perturbations&&) noexcept = default;

ParameterSensitivity Perturbations::at(const State& at, const StaticsOptions& options, double accuracy,
                                       bool reactions) const {
  Statics::Parts& statics = *parts_->statics.parts_;
  statics.check_known(at, options, "the sensitivity of a shape");
  const TeamPool::Lent team = statics.team(options);
  return statics.physical->sensitivity(at, parts_->perturbations, options.reuse_factor, accuracy, reactions, *team);
}

struct Neighbourhood::Parts {
  Parts(const Model& robot, const State& centre, TeamPool::Lent lent)
      : model(robot), at(centre), team(std::move(lent)) {}
  const Model& model;
  State at;
  TeamPool::Lent team;
  const physical::Equilibria* equilibria = nullptr;
  std::optional<physical::Equilibria::Lease> lease;
  std::optional<physical::Predictor> physical;
};

Neighbourhood::Neighbourhood(const Statics& statics, const State& at, int threads) {
  const Model& model = statics.parts_->model;
  StaticsOptions options;
  options.threads = threads;
  check_start(model, at, options);
  if (!at.knows(static_cast<Index>(model.actuators.size())))
    throw InvalidInput("predictions around a shape need the actuation of which it is the equilibrium");
  parts_ = std::make_unique<Parts>(model, at, statics.parts_->team(options));
  if (!statics.parts_->physical || at.multipliers.size() == 0) return;
  const physical::Equilibria& physical = *statics.parts_->physical;
  parts_->equilibria = &physical;
  const physical::Equilibria::Inside inside(physical, at, *parts_->team);
  parts_->lease.emplace(physical, inside->positions, false);
  parts_->physical.emplace(physical.system(), parts_->lease->work(), *inside, *parts_->team);
}

Neighbourhood::~Neighbourhood() = default;
Neighbourhood::Neighbourhood(Neighbourhood&&) noexcept = default;
Neighbourhood& Neighbourhood::operator=(Neighbourhood&&) noexcept = default;

State Neighbourhood::predict(const Actuation& actuation) {
  check_actuation(parts_->model, actuation);
  if (!parts_->physical) return parts_->at;
  State predicted = parts_->physical->predict(actuation, *parts_->team);
  parts_->equilibria->outside(predicted);
  return predicted;
}

}  // namespace softkin
