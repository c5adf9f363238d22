#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/statics/statics_parts.hpp>

namespace softkin {

namespace {

/// Waking a thread for every loop costs as much as some hundred elements.
int worthwhile_threads(const Model& model) {
  constexpr std::size_t elements_each = 1000;
  const std::size_t elements = model.elements.tetrahedra.size() + model.elements.prisms.size();
  return static_cast<int>(
      std::clamp<std::size_t>(elements / elements_each, 1, std::max(1u, std::thread::hardware_concurrency())));
}

}  // namespace

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

Statics::Parts::Parts(const Model& robot) : model(robot), worthwhile(worthwhile_threads(robot)) {}

void Statics::Parts::assemble(const Model& robot) {
  if (robot.formulation == Formulation::physical)
    physical.emplace(robot);
  else
    target_shape.emplace(robot);
}

TeamPool::Lent Statics::Parts::team(const StaticsOptions& options) {
  if (options.threads > 0) return teams.lend(options.threads);
  try {
    return teams.lend(worthwhile);
  } catch (const InvalidInput&) {  // nobody asked for so many; the result is the same
    worthwhile = 1;
    return teams.lend(1);
  }
}

void Statics::Parts::check_actuation(const State& at, const StaticsOptions& options, const std::string& of) const {
  check_start(model, at, options);
  if (!at.knows(static_cast<Index>(model.actuators.size())))
    throw InvalidInput(of + " needs the actuation of which it is the equilibrium");
  if (!std::isfinite(at.share)) throw InvalidInput("the share of the loads at the shape is not finite");
}

void Statics::Parts::check_known(const State& at, const StaticsOptions& options, const std::string& of) const {
  check_actuation(at, options, of);
  if (physical && at.multipliers.size() != at.actuation.size())
    throw InvalidInput(of + " needs the tensions and pressures of its equilibrium");
}

void Statics::Parts::check_history(const ViscousHistory* history, double elapsed_s) const {
  if (!(elapsed_s >= 0)) throw InvalidInput("the time of a step must be 0 s or more, not " + number(elapsed_s) + " s");
  if (history && (!physical || history->strains.size() != physical->system().remembered()))
    throw InvalidInput("the history of the material is of another robot");
}

physical::Equilibria::Options Statics::Parts::physical_options(const StaticsOptions& options) const {
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

Equilibrium Statics::Parts::long_rest(StaticsOptions options, const ProgressCallback& progress, Team& team) {
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

Equilibrium Statics::Parts::solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
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

void Statics::Parts::solve_target_shape(const Actuation& start, const StaticsOptions& options,
                                        const ProgressCallback& progress, Team& team, Equilibrium& result) {
  constexpr double most_turn = 10;  // at once [degrees]
  const TargetShape& parts = *target_shape;
  const Actuation asked = result.actuation;
  Actuation from = start.size() > 0 ? start : asked;
  for (Index a = 0; start.size() == 0 && a < asked.size(); ++a)
    if (model.actuators[a].is<TurnCommand>()) from[a] = parts.turning.angle(a, result.state.positions);
  const int steps = std::max(1, static_cast<int>(std::ceil(parts.turning.largest_turn(from, 1, asked, 1) / most_turn)));
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

}  // namespace softkin
