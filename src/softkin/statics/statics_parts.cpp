#include <algorithm>
#include <cmath>
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
    if (values->size() > 0 && values->size() != std::ssize(model.actuators))
      throw InvalidInput(std::string("the start's ") + name + " has " + std::to_string(values->size()) +
                         " values, the robot " + std::to_string(model.actuators.size()) + " actuators");
    if (!values->allFinite())
      throw InvalidInput(std::string("the start's ") + name + " holds a value that is not finite");
  }
  const auto lies_on_model = [&](const Anchor& anchor) {
    return anchor.vertex >= 0 && anchor.vertex < std::ssize(model.contact.area) && anchor.triangle >= 0 &&
           anchor.triangle < std::ssize(model.contact.triangles) && anchor.weights.allFinite();
  };
  const auto finite = [](double length) { return std::isfinite(length); };
  if (!start.eyelets.empty() && (start.eyelets.size() != physical::Tendons(model).remembered() ||
                                 !std::all_of(start.eyelets.begin(), start.eyelets.end(), finite)))
    throw InvalidInput("the start's cables have friction elsewhere than the robot's");
  if (!std::all_of(start.anchors.begin(), start.anchors.end(), lies_on_model))
    throw InvalidInput("the start's friction is of another robot");
  if (!(options.step_tolerance_mm >= 0) || options.max_iterations < 0 || options.anderson < 0 ||
      options.anderson > 20 || options.threads < 0)
    throw InvalidInput(
        "solver options out of range: tolerance >= 0 mm, iterations >= 0, anderson 0 to 20, threads >= 0");
  check_options(options.tuning);
  if (options.as_published && options.solver != Solver::local_global)
    throw InvalidInput("to stop as published is for solver local-global");
  if (options.as_published && model.markers.empty())
    throw InvalidInput("to stop as published watches the robot's markers, and it has none");
}

Lender::Lender(const Model& model) : worthwhile_(worthwhile_threads(model)) {}

TeamPool::Lent Lender::lend(const StaticsOptions& options) {
  if (options.threads > 0) return teams_.lend(options.threads);
  try {
    return teams_.lend(worthwhile_);
  } catch (const InvalidInput&) {  // the caller did not set this number; the result is the same
    worthwhile_ = 1;
    return teams_.lend(1);
  }
}

double step_tolerance_mm(const Model& model, const StaticsOptions& options) {
  return options.step_tolerance_mm > 0 ? options.step_tolerance_mm : 8e-8 * model.diagonal_mm;
}

void check_elapsed(double elapsed_s) {
  if (!(elapsed_s >= 0)) throw InvalidInput("the time of a step must be 0 s or more, not " + number(elapsed_s) + " s");
}

void Statics::Parts::check_actuation(const State& at, const StaticsOptions& options, const std::string& of) const {
  check_start(model, at, options);
  if (!at.knows(model.actuators.size())) throw InvalidInput(of + " needs the actuation of which it is the equilibrium");
  if (!std::isfinite(at.load_factor)) throw InvalidInput("the load factor at the shape is not finite");
}

void Statics::Parts::check_known(const State& at, const StaticsOptions& options, const std::string& of) const {
  check_actuation(at, options, of);
  if (solver->physical() && at.multipliers.size() != at.actuation.size())
    throw InvalidInput(of + " needs the tensions and pressures of its equilibrium");
}

const physical::Equilibria* Statics::Parts::equilibria() const {
  const PhysicalSolver* physical = solver->physical();
  return physical ? &physical->equilibria() : nullptr;
}

const physical::Equilibria& Statics::Parts::need_equilibria(const std::string& what) const {
  const physical::Equilibria* found = equilibria();
  if (!found) throw InvalidInput(what);
  return *found;
}

}  // namespace softkin
