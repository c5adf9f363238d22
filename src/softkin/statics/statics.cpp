#include <omp.h>
#include <chrono>
#include <cmath>
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

void check(const Model& model, const Actuation& actuation, const State& start, const StaticsOptions& options) {
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
  if (start.positions.rows() != model.rest.rows())
    throw InvalidInput("the start has " + std::to_string(start.positions.rows()) + " vertices, the robot " +
                       std::to_string(model.rest.rows()));
  if (!start.positions.allFinite()) throw InvalidInput("the start holds a coordinate that is not finite");
  if (!(options.step_tolerance_mm >= 0) || options.max_iterations < 1 || options.anderson < 0 ||
      options.anderson > 20 || options.threads < 0)
    throw InvalidInput(
        "solver options out of range: tolerance >= 0 mm, iterations >= 1, anderson 0 to 20, threads >= 0");
}

/// Ratio of the last steps, over ten iterations where there are as many.
double contraction_of(const std::vector<double>& steps) {
  if (steps.size() < 2) return 0;
  const std::size_t span = std::min<std::size_t>(10, steps.size() - 1);
  const double before = steps[steps.size() - 1 - span];
  return before > 0 ? std::pow(steps.back() / before, 1.0 / static_cast<double>(span)) : 0;
}

}  // namespace

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
  return {parts_->model.rest};
}

Equilibrium Statics::solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                           const ProgressCallback& progress) const {
  const auto begin = std::chrono::steady_clock::now();
  const Model& model = parts_->model;
  check(model, actuation, start, options);
  const int threads = options.threads > 0 ? options.threads : omp_get_num_procs();
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
  std::vector<double> steps;
  Points before;
  while (report.iterations < options.max_iterations) {
    report.energy = parts_->system.local_step(actuation, positions, scratch, threads);
    report.gradient_norm = 2 * parts_->global.free_norm(scratch.residual, poses);
    before = positions;
    parts_->global.step(scratch.residual, positions, poses, threads);
    report.step_mm = (positions - before).rowwise().norm().maxCoeff();
    if (!std::isfinite(report.step_mm)) {
      positions = before;
      break;
    }
    ++report.iterations;
    steps.push_back(report.step_mm);
    if (options.keep_history) report.history.push_back({report.energy, report.step_mm, report.gradient_norm});
    if (report.step_mm < report.tolerance_mm) {
      report.status = Status::converged;
      break;
    }
    if (progress && !progress({report.iterations, report.step_mm, report.tolerance_mm})) {
      report.status = Status::interrupted;
      break;
    }
    if (options.anderson > 0) {
      positions = anderson.next(before, positions);
      poses = parts_->global.project(positions);
    }
  }
  report.contraction = contraction_of(steps);
  report.estimated_error_mm = report.contraction < 1 ? report.step_mm * report.contraction / (1 - report.contraction)
                                                     : report.step_mm * static_cast<double>(steps.size());
  report.seconds = seconds_since(begin);
  return result;
}

}  // namespace softkin
