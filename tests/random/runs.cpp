#include "random/runs.hpp"

#include <chrono>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/model/families.hpp>
#include <softkin/model/names.hpp>

#include "random/confirm.hpp"
#include "random/generator.hpp"

namespace softkin::random_robots {

namespace {

/// One run of twenty is done again.
constexpr std::uint64_t repeat_every = 20;

Outcome outcome_of(Status status) {
  switch (status) {
    case Status::converged:
      return Outcome::converged;
    case Status::limit:
      return Outcome::limit;
    case Status::interrupted:
      return Outcome::interrupted;
    default:
      return Outcome::not_converged;
  }
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

Equilibrium solve(const Statics& statics, const RandomCase& robot, const Actuation& command, const State& start,
                  int threads, bool trace = false) {
  StaticsOptions options = robot.options;
  options.threads = threads;
  options.trace = trace;
  int calls = 0;
  const ProgressCallback stop = [&](const Progress&) { return ++calls < robot.interrupt_after; };
  return statics.solve(command, start, options, robot.interrupt_after > 0 ? stop : ProgressCallback());
}

bool same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && (a.array() == b.array()).all();
}

/// The same again with a new object, on one thread and on two.
void repeat(const Model& model, const RandomCase& robot, const Actuation& command, const State& start,
            const Equilibrium& found, std::vector<std::string>& faults) {
  for (const int threads : {1, 2}) {
    const Equilibrium again = solve(Statics(model), robot, command, start, threads);
    const bool equal = again.state.positions == found.state.positions && again.report.status == found.report.status &&
                       again.report.iterations == found.report.iterations &&
                       same(again.state.multipliers, found.state.multipliers);
    if (!equal)
      faults.push_back("not the same again with " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"));
  }
}

void describe(const RandomCase& robot, const Model& model) {
  std::printf("%s, %s: %zu tetrahedra%s, %zu prisms, %td vertices, diagonal %g mm\n",
              model.formulation == Formulation::physical ? "physical" : "target-shape",
              robot.sensible ? "sensible" : joined(robot.features, ", ").c_str(), model.elements.tetrahedra.size(),
              model.elements.edge_nodes.empty() ? "" : " of order 2", model.elements.prisms.size(),
              static_cast<std::ptrdiff_t>(model.rest.rows()), model.diagonal_mm);
  for (const Material& m : model.elements.materials)
    std::printf(
        "  material %s: law %d, mu %g, lambda %g, c10 %g, c01 %g, c20 %g, c30 %g, bulk %g MPa, R_omega %g, weight %g\n",
        m.region.c_str(), static_cast<int>(m.elastic.law), m.elastic.mu, m.elastic.lambda, m.elastic.c10, m.elastic.c01,
        m.elastic.c20, m.elastic.c30, m.elastic.bulk, m.shape_ratio, m.weight);
  for (const Material& m : model.elements.materials)
    if (m.families)
      std::printf("  material %s: %zu families of fibres\n", m.region.c_str(), m.families->families.size());
  for (const Actuator& a : model.actuators)
    std::printf("  actuator %s: %s, %s, %g to %g, measure at rest %g\n", a.name.c_str(), kind_name(a),
                a.control == Control::load ? "load"
                : filling_of(a)            ? "filling"
                                           : "ratio",
                a.low, a.high, a.rest_measure);
  for (const RigidRegion& r : model.rigid) std::printf("  rigid: %zu vertices\n", r.vertices.size());
  if (model.loads.dead.rows() > 0) std::printf("  dead load: %g N\n", model.loads.dead.rowwise().norm().sum());
  for (const std::string& note : model.notes) std::printf("  note: %s\n", note.c_str());
}

void print_result(const Actuation& command, const Equilibrium& found, const Confirmation& confirmed) {
  const SolveReport& report = found.report;
  std::printf("command");
  for (const double value : command) std::printf(" %.12g", value);
  std::printf(": %s, reached %g, %d iterations, %d equilibria, step %g of %g mm; %s\n",
              name_of(outcome_of(report.status)), report.reached, report.iterations, report.continuation_steps,
              report.step_mm, report.tolerance_mm, report.remark.c_str());
  std::printf("  residual ratio %g, constraint error %g, step ratio %g, %ld inverted%s%s%s\n", confirmed.residual_ratio,
              confirmed.constraint_error, confirmed.step_ratio, confirmed.inverted,
              confirmed.is_equilibrium ? "" : ", no equilibrium to confirm", confirmed.blurred ? ", blurred" : "",
              confirmed.undecided ? ", undecided" : "");
  for (const std::string& fault : confirmed.faults) std::printf("  FAULT: %s\n", fault.c_str());
}

void take(const Confirmation& from, const Equilibrium& found, RunResult& run) {
  run.confirmed = run.confirmed || from.is_equilibrium;
  run.residual_ratio = std::max(run.residual_ratio, from.residual_ratio);
  run.constraint_error = std::max(run.constraint_error, from.constraint_error);
  run.step_ratio = std::max(run.step_ratio, from.step_ratio);
  run.blurred = run.blurred || from.blurred;
  run.undecided = run.undecided || from.undecided;
  run.inverted = run.inverted || from.inverted > 0;
  run.unstable = run.unstable || found.report.physical.unstable_modes > 0;
}

Effort effort_of(const SolveReport& report, bool physical) {
  Effort effort{{report.iterations, report.factorisations, report.projections, report.continuation_steps, 0}};
  effort.end = physical ? "physical, " : "target shapes, ";
  effort.end += std::string(name_of(outcome_of(report.status))) + ": " + report.remark;
  for (const TracedStep& step : report.trace)
    if (!step.taken) {
      ++effort.of.back();
      ++effort.rejections[step.why];
    }
  return effort;
}

void print_result(const SolveReport& report) {
  for (const TracedStep& step : report.trace)
    std::printf("  %s%s%.5g to %.5g, a step of %.3g: %d iterations, %d factorisations, %d projections%s%s\n",
                step.along.c_str(), step.along.empty() ? "" : " ", step.from, step.to, step.length, step.iterations,
                step.factorisations, step.projections, step.taken ? ", taken" : "",
                step.why.empty() ? "" : (": " + step.why).c_str());
}

void solve_all(const RandomCase& robot, bool verbose, bool trace, RunResult& run, std::vector<std::string>& faults) {
  const Model model = compile(robot.spec);
  if (verbose) describe(robot, model);
  const Statics statics(model);
  const State begun = long_rest(model, robot.options);
  State start = statics.rest();
  for (const Actuation& command : robot.commands) {
    const Equilibrium found = solve(statics, robot, command, start, 1, trace || verbose);
    if (found.report.solver == "newton") run.efforts.push_back(effort_of(found.report, run.physical));
    const Confirmation confirmed = confirm(model, command, found, begun);
    if (verbose) {
      print_result(found.report);
      print_result(command, found, confirmed);
    }
    take(confirmed, found, run);
    run.outcome = outcome_of(found.report.status);
    faults.insert(faults.end(), confirmed.faults.begin(), confirmed.faults.end());
    if (robot.seed % repeat_every == 0 && &command == &robot.commands.front())
      repeat(model, robot, command, start, found, faults);
    if (!faults.empty()) return;
    start = robot.forgets ? State{found.state.positions} : found.state;
  }
}

/// A refusal is one sentence for the user.
std::string fault_of_message(const std::string& message) {
  if (message.empty()) return "an empty message";
  if (message.find('\n') != std::string::npos) return "a message of several lines: " + message;
  if (message.find("internal") != std::string::npos) return "a message about the program: " + message;
  return "";
}

}  // namespace

const char* name_of(Outcome outcome) {
  static const char* const names[outcomes] = {"converged",   "limit",   "not converged",
                                              "interrupted", "refused", "failed"};
  return names[static_cast<int>(outcome)];
}

RunResult run_seed(std::uint64_t seed, bool verbose, bool trace) {
  const auto begin = std::chrono::steady_clock::now();
  const RandomCase robot = make_case(seed);
  RunResult run;
  run.seed = seed;
  run.sensible = robot.sensible;
  run.physical = robot.spec.formulation == Formulation::physical;
  run.features = joined(robot.features, " + ");
  std::vector<std::string> faults;
  try {
    solve_all(robot, verbose, trace, run, faults);
  } catch (const InvalidInput& refusal) {
    run.outcome = Outcome::refused;
    run.message = refusal.what();
    if (verbose) std::printf("refused: %s\n", refusal.what());
    if (const std::string fault = fault_of_message(run.message); !fault.empty()) faults.push_back(fault);
  } catch (const std::exception& other) {
    faults.push_back(std::string("an exception that is no refusal: ") + other.what());
  }
  if (!faults.empty()) {
    run.outcome = Outcome::failed;
    run.message = joined(faults, "; ");
  }
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return run;
}

}  // namespace softkin::random_robots
