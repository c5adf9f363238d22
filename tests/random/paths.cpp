#include "random/paths.hpp"

#include <array>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <softkin/core/error.hpp>
#include <thread>
#include <vector>

#include "random/generator.hpp"

namespace softkin::random_robots {

namespace {

/// Ends farther apart than this fraction of the diagonal are two equilibria.
constexpr double same_end = 1e-3;

/// What a run came to.
struct End {
  Equilibrium last;
  bool snapped = false;
  int iterations = 0;
};

/// Is the robot's equilibrium a function of its loads? Friction and viscosity remember the path.
bool depends_on_loads_alone(const RobotSpec& spec, const Model& model) {
  if (model.contact.has_friction()) return false;
  for (const Actuator& actuator : model.actuators)
    if (const auto* cable = actuator.as<CableDrive>(); cable && (cable->friction > 0 || cable->sheath > 0))
      return false;
  for (const MaterialSpec& material : spec.materials)
    if (!material.viscosity.empty()) return false;
  return true;
}

/// The robot under a fraction of its dead loads and of the displacements of its supports.
Model loaded(Model model, double factor) {
  model.loads.dead *= factor;
  for (FollowingTraction& traction : model.loads.tractions) {
    traction.traction_MPa *= factor;
    traction.pressure_MPa *= factor;
    traction.deeper_MPa_mm *= factor;
  }
  for (RegionMoment& moment : model.loads.moments) moment.moment_Nmm *= factor;
  model.held.at = model.rest + factor * (model.held.at - model.rest);
  return model;
}

void add(Equilibrium found, End& end) {
  end.snapped = end.snapped || found.report.physical.snapped_mm > 0;
  end.iterations += found.report.iterations;
  end.last = std::move(found);
}

std::string described(const char* run, const End& end) {
  const SolveReport& report = end.last.report;
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%s: %s at %.4g, %d iterations, snapped %g mm, %d unstable modes; %s", run,
                report.status == Status::converged ? "converged"
                : report.status == Status::limit   ? "limit"
                                                   : "not converged",
                report.reached, end.iterations, report.physical.snapped_mm, report.physical.unstable_modes,
                report.remark.c_str());
  return text.data();
}

void print(const char* run, const SolveReport& report) {
  std::printf("%s\n", run);
  for (const TracedStep& step : report.trace)
    std::printf("  %s%s%.5g to %.5g: %d iterations, %d factorisations, predicted %.3g mm, corrected %.3g mm%s%s\n",
                step.along.c_str(), step.along.empty() ? "" : " ", step.from, step.to, step.iterations,
                step.factorisations, step.predicted_mm, step.corrected_mm, step.taken ? ", taken" : "",
                step.why.empty() ? "" : (": " + step.why).c_str());
}

/// Rows of the commands.
End along_commands(const Statics& statics, const Actuation& command, const StaticsOptions& options, int rows) {
  End end;
  State state = statics.rest();
  const Actuation rest = statics.model().rest_actuation();
  for (int row = 1; row <= rows; ++row) {
    const Actuation commands = row == rows ? command : rest + static_cast<double>(row) / rows * (command - rest);
    add(statics.solve(commands, state, options), end);
    if (end.last.report.status != Status::converged) break;
    state = end.last.state;
  }
  return end;
}

/// Solves in equal steps of the load factor of loads without a command.
End along_loads(const Model& model, const StaticsOptions& options, int rows) {
  End end;
  State state{model.rest, model.rest_actuation()};
  for (int row = 1; row <= rows; ++row) {
    const Model part = loaded(model, static_cast<double>(row) / rows);
    const Statics statics(part);
    if (row == 1) state = statics.rest();
    add(statics.solve(part.rest_actuation(), state, options), end);
    if (end.last.report.status != Status::converged) break;
    state = end.last.state;
  }
  return end;
}

PathRun compare(const RandomCase& robot, int rows, bool verbose) {
  PathRun run{.seed = robot.seed};
  if (robot.spec.formulation != Formulation::physical || robot.interrupt_after > 0 || robot.commands.empty())
    return run;
  const Model model = compile(robot.spec);
  const Actuation& command = robot.commands.front();
  const bool commands = command.size() > 0 && command != model.rest_actuation();
  const bool loads = model.loads.any() || model.held.at != model.rest;
  if ((!commands && !loads) || !depends_on_loads_alone(robot.spec, model)) return run;
  StaticsOptions options = robot.options;
  options.trace = verbose;
  options.keep_history = false;
  const Statics statics(model);
  End step;
  add(statics.solve(command, statics.rest(), options), step);
  run.step_converged = step.last.report.status == Status::converged;
  run.step_iterations = step.iterations;
  if (verbose) print("one step", step.last.report);
  const End path = commands ? along_commands(statics, command, options, rows) : along_loads(model, options, rows);
  run.path_converged = path.last.report.status == Status::converged;
  run.path_iterations = path.iterations;
  run.text = described("one step", step) + " | " + described("path", path);
  run.apart = (step.last.state.positions - path.last.state.positions).rowwise().norm().maxCoeff() / model.diagonal_mm;
  const auto reports = [](const End& end) { return end.snapped || end.last.report.status == Status::limit; };
  if (reports(step) || reports(path))
    run.comparison = PathComparison::reported;
  else if (!run.step_converged || !run.path_converged)
    run.comparison = PathComparison::unfinished;
  else
    run.comparison = run.apart <= same_end ? PathComparison::same : PathComparison::differs;
  return run;
}

const char* name_of(PathComparison comparison) {
  static const std::array<const char*, path_comparisons> names{"same", "differs", "reported", "unfinished", "none"};
  return names[static_cast<std::size_t>(comparison)];
}

}  // namespace

PathRun compare_path(std::uint64_t seed, int rows, bool verbose) {
  PathRun run{.seed = seed};
  try {
    run = compare(make_case(seed), rows, verbose);
  } catch (const InvalidInput& refusal) {
    run.text = refusal.what();
  }
  if (verbose)
    std::printf("seed %llu: %s, %.3g of the diagonal apart; %s\n", static_cast<unsigned long long>(seed),
                name_of(run.comparison), run.apart, run.text.c_str());
  return run;
}

int compare_paths(std::uint64_t first, std::uint64_t count, int rows, int threads) {
  std::mutex mutex;
  std::atomic<std::uint64_t> next{0};
  std::array<int, path_comparisons> counts{};
  int lost = 0, step_iterations = 0, path_iterations = 0;
  const auto work = [&] {
    for (std::uint64_t i; (i = next++) < count;) {
      const PathRun run = compare_path(first + i, rows, false);
      const std::lock_guard lock(mutex);
      ++counts[static_cast<std::size_t>(run.comparison)];
      lost += !run.step_converged && run.path_converged;
      step_iterations += run.step_iterations;
      path_iterations += run.path_iterations;
      if (!run.step_converged && run.path_converged)
        std::printf("only the path arrives  seed %llu: %s\n", static_cast<unsigned long long>(run.seed),
                    run.text.c_str());
      if (run.comparison == PathComparison::differs)
        std::printf("DIFFERS  seed %llu by %.3g of the diagonal: %s\n", static_cast<unsigned long long>(run.seed),
                    run.apart, run.text.c_str());
      std::fflush(stdout);
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
  std::printf("one step and a path of %d rows, %llu seeds:", rows, static_cast<unsigned long long>(count));
  for (int i = 0; i < path_comparisons; ++i)
    std::printf(" %d %s%s", counts[i], name_of(static_cast<PathComparison>(i)), i + 1 < path_comparisons ? "," : "\n");
  std::printf(
      "%d iterations in one step each, %d along the paths; %d answers that the path finds and one step does not\n",
      step_iterations, path_iterations, lost);
  return counts[static_cast<std::size_t>(PathComparison::differs)];
}

}  // namespace softkin::random_robots
