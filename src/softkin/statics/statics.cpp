#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/statics/anderson.hpp>
#include <softkin/statics/global_step.hpp>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/target_shape_system.hpp>

namespace softkin {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (!text.empty() && text.back() == '.') text.pop_back();
  return text;
}

void check_start(const Model& model, const State& start, const StaticsOptions& options) {
  if (start.positions.rows() != model.rest.rows())
    throw InvalidInput("the start has " + std::to_string(start.positions.rows()) + " vertices, the robot " +
                       std::to_string(model.rest.rows()));
  if (!start.positions.allFinite()) throw InvalidInput("the start holds a coordinate that is not finite");
  if (!(options.step_tolerance_mm >= 0) || options.max_iterations < 1 || options.anderson < 0 ||
      options.anderson > 20 || options.threads < 0)
    throw InvalidInput(
        "solver options out of range: tolerance >= 0 mm, iterations >= 1, anderson 0 to 20, threads >= 0");
}

/// Starting a thread costs as much as some hundred elements.
int worthwhile_threads(const Model& model) {
  constexpr std::size_t elements_each = 1500;
  const std::size_t elements = model.tetrahedra.size() + model.prisms.size();
  return static_cast<int>(
      std::clamp<std::size_t>(elements / elements_each, 1, std::max(1u, std::thread::hardware_concurrency())));
}

/// Accelerated steps may raise the energy a little on their way, and have to where R_omega < 1 or ratios are
/// redistributed; those that raise it more lead to other equilibria.
constexpr double tolerated_growth = 1.2;

/// How far the fixed point may be: the step over the least change of steps per change of shape in the last iterations,
/// which for a linear iteration x <- G x is bounded by 1 - (largest eigenvalue of G), accelerated or not.
class ErrorEstimate {
 public:
  void add(const Points& at, const Points& step) {
    if (last_at_.size() > 0) {
      const double moved = (at - last_at_).norm();
      if (moved > 0) slopes_[count_++ % slopes_.size()] = (step - last_step_).norm() / moved;
    }
    last_at_ = at;
    last_step_ = step;
  }
  [[nodiscard]] double mm(double step_mm) const {
    double least = 1;
    for (std::size_t i = 0; i < std::min(count_, slopes_.size()); ++i) least = std::min(least, slopes_[i]);
    return step_mm / std::max(least, 1e-9);
  }

 private:
  Points last_at_, last_step_;
  std::array<double, 20> slopes_{};
  std::size_t count_ = 0;
};

void accept(const IterationRecord& record, bool keep_history, SolveReport& report) {
  ++report.iterations;
  report.energy = record.energy;
  report.step_mm = record.step_mm;
  report.gradient_norm = record.gradient_norm;
  if (keep_history) report.history.push_back(record);
}

}  // namespace

void check_actuation(const Model& model, const Actuation& actuation) {
  if (actuation.size() != static_cast<Index>(model.actuators.size()))
    throw InvalidInput("the actuation has " + std::to_string(actuation.size()) + " values, the robot " +
                       std::to_string(model.actuators.size()) + " actuators");
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const double value = actuation[static_cast<Index>(a)];
    if (!(value >= actuator.low && value <= actuator.high))
      throw InvalidInput("actuator '" + actuator.name + "': the ratio " + number(value) + " is outside its range " +
                         number(actuator.low) + " to " + number(actuator.high));
  }
}

struct Statics::Parts {
  explicit Parts(const Model& robot) : model(robot), system(robot), global(robot, system.global_matrix()) {}
  const Model& model;
  TargetShapeSystem system;
  GlobalStep global;
};

Statics::Statics(const Model& model) : parts_(std::make_unique<Parts>(model)) {}
Statics::~Statics() = default;
Statics::Statics(Statics&&) noexcept = default;
Statics& Statics::operator=(Statics&&) noexcept = default;

State Statics::rest() const {
  State state;
  state.positions = parts_->model.rest;
  return state;
}

Equilibrium Statics::solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                           const ProgressCallback& progress) const {
  const auto begin = std::chrono::steady_clock::now();
  const Model& model = parts_->model;
  check_actuation(model, actuation);
  check_start(model, start, options);
  Team team(options.threads > 0 ? options.threads : worthwhile_threads(model));
  const double paper_tolerance = 8e-8 * model.diagonal_mm;

  Equilibrium result;
  result.actuation = actuation;
  SolveReport& report = result.report;
  report.solver = "local-global";
  report.tolerance_mm = options.step_tolerance_mm > 0 ? options.step_tolerance_mm : paper_tolerance;
  Points& positions = result.state.positions;
  positions = start.positions;
  std::vector<Pose> poses = parts_->global.project(positions);
  TargetShapeSystem::Scratch scratch = parts_->system.make_scratch();
  Anderson anderson(options.anderson);
  ErrorEstimate estimate;
  Points before, accepted = positions;
  double tolerated = std::numeric_limits<double>::infinity();
  while (report.iterations < options.max_iterations) {
    IterationRecord record;
    record.energy = parts_->system.local_step(actuation, positions, scratch, team);
    record.gradient_norm = 2 * parts_->global.free_norm(scratch.residual, poses);
    if (record.energy > tolerated) {  // the extrapolation went astray: on from the plain step
      positions = accepted;
      poses = parts_->global.project(positions);
      tolerated = std::numeric_limits<double>::infinity();
      anderson.restart();
      continue;
    }
    tolerated = options.anderson > 0 ? tolerated_growth * record.energy : tolerated;
    before = positions;
    parts_->global.step(scratch.residual, positions, poses, team);
    record.step_mm = (positions - before).rowwise().norm().maxCoeff();
    // the squares of far-off coordinates overflow
    if (!std::isfinite(record.energy + record.gradient_norm + record.step_mm) || !positions.allFinite()) {
      positions = accepted;
      break;
    }
    accept(record, options.keep_history, report);
    estimate.add(before, positions - before);
    if (report.step_mm < report.tolerance_mm) {
      report.status = Status::converged;
      break;
    }
    if (progress && !progress({report.iterations, report.step_mm, report.tolerance_mm})) {
      report.status = Status::interrupted;
      break;
    }
    accepted = positions;
    if (options.anderson > 0 && report.iterations < options.max_iterations) {
      positions = anderson.next(before, positions);
      poses = parts_->global.project(positions);
    }
  }
  report.estimated_error_mm = estimate.mm(report.step_mm);
  report.seconds = seconds_since(begin);
  return result;
}

}  // namespace softkin
