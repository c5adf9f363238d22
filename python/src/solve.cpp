#include "solve.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/runs/shape_files.hpp>
#include <softkin/runs/solver_options_file.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "watch.hpp"

namespace softkin::python {

StaticsOptions remembering(const Statics& statics, const State& start, StaticsOptions options) {
  if (std::isinf(options.elapsed_s)) return options;
  if (!statics.viscous()) throw InvalidInput("elapsed_s is for viscous materials, and this robot has none");
  if (start.actuation.size() > 0) options.history = statics.flow(start).history;
  return options;
}

namespace {

ShapePtr solve(const RobotPtr& robot, const SessionPtr& session, const VectorIn& actuation, const ShapePtr& start,
               const std::optional<PointsIn>& positions, const std::optional<std::string>& file, StaticsOptions options,
               const ProgressFunction& progress) {
  if (start && start->robot() != robot) throw InvalidInput("start is a shape of another robot");
  State from = file        ? runs::read_state(*file, robot->model())
               : positions ? State{points_of(*positions)}
               : start     ? State()
                           : robot->statics().rest();
  options.reuse_factor = keeps(session.get());
  const auto work = [robot, session, start, options, from = std::move(from),
                     requested = vector_of(actuation)](const ProgressCallback& callback) {
    const State& begin = start ? start->found().state : from;
    const Statics& statics = statics_of(*robot, session.get());
    return statics.solve(requested, begin, remembering(statics, begin, options), callback);
  };
  Equilibrium found = watched_solve(*robot, progress, work);
  options.history = found.state.history;
  // the report contains the options that the user can set
  options.reuse_factor = true;
  options.deadline = {};
  return std::make_shared<Shape>(robot, std::move(found), options);
}

/// Returns the tuned constants with these changes: "group.name" and value.
SolverOptions options_of(const std::vector<std::pair<std::string, double>>& changes) {
  SolverOptions options;
  for (const auto& [key, value] : changes) {
    const std::size_t dot = key.find('.');
    set_option(options, key.substr(0, dot), dot == std::string::npos ? "" : key.substr(dot + 1), value);
  }
  return options;
}

/// Returns the options of a file that differ from their defaults: "group.name" and value.
std::vector<std::pair<std::string, double>> read_options(const std::string& file) {
  std::vector<std::pair<std::string, double>> changes;
  for (const OptionValue& option : changed_options(runs::read_solver_options(file)))
    changes.emplace_back(option.group + "." + option.field.name, option.value);
  return changes;
}

TableOut jacobian_of(const Shape& shape, const Session* session, const std::vector<Index>& markers) {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> slopes;
  {
    const nb::gil_scoped_release released;
    StaticsOptions options = shape.options();
    options.reuse_factor = session != nullptr;
    const Sensitivity sensitivity = statics_of(*shape.robot(), session).sensitivity(shape.found().state, options);
    if (!sensitivity.regular)
      throw InvalidInput("the shape stands at a limit of existence or a branch, where it has no Jacobian");
    slopes = jacobian(shape.model(), shape.positions(), sensitivity, markers);
  }
  return table_of<double>(slopes.data(), slopes.rows(), slopes.cols());
}

}  // namespace

void bind_solve(nb::module_& module) {
  nb::class_<StaticsOptions>(module, "SolveOptions", "How equilibria are solved.")
      .def(
          "__init__",
          [](StaticsOptions* self, const std::string& solver, double tolerance_mm, std::optional<int> max_iterations,
             int anderson, int threads, bool stable, bool as_published,
             const std::vector<std::pair<std::string, double>>& tuned) {
            if (solver != "newton" && solver != "local-global")
              throw InvalidInput("solver must be 'newton' or 'local-global', not '" + solver + "'");
            if (max_iterations && *max_iterations < 1)
              throw InvalidInput("max_iterations must be at least 1, not " + std::to_string(*max_iterations));
            const SolverOptions tuning = options_of(tuned);
            auto* options = new (self) StaticsOptions();
            options->tuning = tuning;
            options->solver = solver == "newton" ? Solver::newton : Solver::local_global;
            options->step_tolerance_mm = tolerance_mm;
            options->max_iterations = max_iterations.value_or(0);
            options->anderson = anderson;
            options->threads = threads;
            options->stable = stable;
            options->as_published = as_published;
          },
          nb::arg("solver"), nb::arg("tolerance_mm"), nb::arg("max_iterations").none(), nb::arg("anderson"),
          nb::arg("threads"), nb::arg("stable"), nb::arg("as_published"), nb::arg("options"))
      .def_ro("as_published", &StaticsOptions::as_published)
      .def(
          "of_call",
          [](StaticsOptions options, std::optional<double> elapsed_s, std::optional<double> beyond,
             std::optional<double> budget_s) {
            if (elapsed_s) options.elapsed_s = *elapsed_s;
            if (beyond) options.beyond = *beyond;
            if (budget_s) options.deadline = Deadline(*budget_s);
            return options;
          },
          nb::arg("elapsed_s").none(), nb::arg("beyond").none(), nb::arg("budget_s").none(),
          "The same, with the options of one call, which ends budget_s from now.")
      .def_prop_ro(
          "for_the_solver",
          [](const StaticsOptions& options) {
            const StaticsOptions usual;
            return options.solver != usual.solver || options.step_tolerance_mm != usual.step_tolerance_mm ||
                   options.max_iterations != usual.max_iterations || options.stable || options.beyond > 0 ||
                   options.as_published || options.elapsed_s != usual.elapsed_s || options.tuning != usual.tuning;
          },
          "Does a request need the solver?");
  module.def("read_solver_options", &read_options, nb::arg("file"), "Pairs of group.name and value.");
  module.def("solve", &solve, nb::arg("robot"), nb::arg("session").none(), nb::arg("actuation"),
             nb::arg("start").none(), nb::arg("positions").none(), nb::arg("file").none(), nb::arg("options"),
             nb::arg("progress").none());
  module.def("jacobian", &jacobian_of, nb::arg("shape"), nb::arg("session").none(), nb::arg("markers"),
             "3p x m [mm per unit of command].");
}

}  // namespace softkin::python
