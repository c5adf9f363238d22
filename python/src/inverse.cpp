#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/runs/plots.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/workspace_file.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "pickles.hpp"
#include "solve.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

using Three = std::array<double, 3>;

/// The requested goals, by name.
struct Goals {
  RobotPtr robot;
  std::vector<runs::NamedGoal> named;

  [[nodiscard]] std::vector<Goal> plain() const {
    std::vector<Goal> goals;
    for (const runs::NamedGoal& goal : named) goals.push_back(goal.goal);
    return goals;
  }
};

/// What inverse kinematics came to.
struct Answer : std::enable_shared_from_this<Answer> {
  RobotPtr robot;
  Goals goals;
  InverseOptions options;
  InverseResult found;
  ShapePtr shape;

  [[nodiscard]] bool has_shape() const { return found.errors_mm.size() > 0; }
  /// "4.2 mm and 0.3 N"; empty without a shape.
  [[nodiscard]] std::string off() const {
    return has_shape() ? runs::misses_text(runs::misses_of(goals.plain(), found), 3) : "";
  }
  /// Of the goals of places [mm], or of those of forces [N].
  [[nodiscard]] Eigen::VectorXd errors(bool of_forces) const {
    std::vector<double> errors;
    for (std::size_t i = 0; has_shape() && i < goals.named.size(); ++i) {
      const auto* force = std::get_if<ForceGoal>(&goals.named[i].goal.what);
      if ((force != nullptr) != of_forces) continue;
      errors.push_back(found.errors_mm[i] / (force != nullptr ? force->mm_per_N : 1));
    }
    return Eigen::Map<Eigen::VectorXd>(errors.data(), errors.size());
  }
};

InverseOptions options_of(const std::string& method, std::optional<double> tolerance_mm, int max_equilibria,
                          int descents, int other_starts, const StaticsOptions& statics) {
  if (method != "newton" && method != "gradient")
    throw InvalidInput("method must be 'newton' or 'gradient', not '" + method + "'");
  InverseOptions options = usual_options(method == "gradient" ? InverseMethod::gradient : InverseMethod::newton);
  options.tolerance_mm = tolerance_mm.value_or(options.tolerance_mm);
  options.max_equilibria = max_equilibria;
  options.max_iterations = descents;
  options.other_starts = other_starts;
  options.statics = statics;
  return options;
}

/// Without a session by statics of its own, as the command does it.
std::shared_ptr<Answer> inverse(const Goals& goals, const SessionPtr& session, const std::optional<VectorIn>& from,
                                const ShapePtr& start, const std::shared_ptr<Answer>& last,
                                const std::optional<VectorIn>& preferred, std::vector<bool> free,
                                InverseOptions options, const ProgressFunction& progress) {
  const RobotPtr& robot = goals.robot;
  if (start && start->robot() != robot) throw InvalidInput("start is a shape of another robot");
  options.free = std::move(free);
  if (preferred) options.preferred = vector_of(*preferred);
  const auto work = [robot, session, start, last, options, plain = goals.plain(),
                     begin =
                         from ? vector_of(*from) : robot->model().rest_actuation()](const ProgressCallback& callback) {
    const bool own = !session || session->polishes;
    const SessionPtr with =
        own ? std::make_shared<Session>(robot, session ? session->map : nullptr, session != nullptr) : session;
    InverseOptions known = options;
    known.statics = remembering(with->statics, start ? start->found().state : State(), known.statics);
    const bool timed = with->statics.viscous() && std::isfinite(options.statics.elapsed_s);
    if (last && last->found.sensitivity.regular && !timed) known.start_sensitivity = &last->found.sensitivity;
    return start ? solve_inverse(with->statics, plain, start->found(), known, callback)
                 : solve_inverse_from(with->statics, plain, begin, known, callback);
  };
  auto answer = std::make_shared<Answer>();
  answer->found = watched_solve(*robot, progress, work);
  answer->robot = robot;
  answer->goals = goals;
  options.statics.history = answer->found.equilibrium.state.history;
  answer->shape = std::make_shared<Shape>(robot, answer->found.equilibrium, options.statics);
  answer->options = std::move(options);
  return answer;
}

std::string report_of(const Answer& answer) {
  if (!answer.has_shape()) throw InvalidInput("there is no report: " + answer.found.remark);
  const Model& model = answer.robot->model();
  const runs::InverseRecord record =
      runs::inverse_record(model, answer.goals.plain(), answer.found, answer.shape->deformation());
  const runs::RecordLog log =
      runs::inverse_report(model, model.name, {}, {answer.options, answer.goals.named, answer.found, record});
  std::string text;
  log.report([&](std::string_view piece) { text += piece; });
  return text;
}

/// From marker to marker at rest [mm], the default lever of a direction.
double distance_at_rest(const Model& model, Index from, Index to) {
  const auto at = [&](Index marker) { return model.markers[marker].at(model.rest); };
  return (at(to) - at(from)).norm();
}

void bind_goals(nb::module_& module) {
  nb::class_<Goals>(module, "Goals", "What inverse kinematics is to reach.")
      .def(
          "__init__",
          [](Goals* self, RobotPtr robot) {
            new (self) Goals{std::move(robot), {}};
          },
          nb::arg("robot"))
      .def(
          "position",
          [](Goals& goals, const std::string& marker, const Three& target, const std::array<bool, 3>& axes,
             double weight) {
            goals.named.push_back({marker, {PositionGoal{goals.robot->marker(marker), vec3_of(target), axes}, weight}});
          },
          nb::arg("marker"), nb::arg("target"), nb::arg("axes"), nb::arg("weight"))
      .def(
          "plane",
          [](Goals& goals, const std::string& marker, const Three& point, const Three& normal, double weight) {
            goals.named.push_back(
                {marker, {PlaneGoal{goals.robot->marker(marker), vec3_of(point), vec3_of(normal)}, weight}});
          },
          nb::arg("marker"), nb::arg("point"), nb::arg("normal"), nb::arg("weight"))
      .def(
          "direction",
          [](Goals& goals, const std::string& from, const std::string& to, const Three& direction,
             std::optional<double> lever_mm, double weight) {
            const Index first = goals.robot->marker(from), second = goals.robot->marker(to);
            const double lever = lever_mm ? *lever_mm : distance_at_rest(goals.robot->model(), first, second);
            goals.named.push_back({from + ":" + to, {DirectionGoal{first, second, vec3_of(direction), lever}, weight}});
          },
          nb::arg("first"), nb::arg("second"), nb::arg("direction"), nb::arg("lever_mm").none(), nb::arg("weight"))
      .def(
          "press",
          [](Goals& goals, const std::string& name, const Three& force, const std::array<bool, 3>& axes,
             double tolerance_mm, std::optional<double> tolerance_N, double weight) {
            ForceGoal goal = force_on(goals.robot->model(), name);
            goal.force = vec3_of(force);
            goal.axes = axes;
            goal.mm_per_N = usual_mm_per_N(goal, tolerance_mm, tolerance_N);
            goals.named.push_back({name, {goal, weight}});
          },
          nb::arg("name"), nb::arg("force"), nb::arg("axes"), nb::arg("tolerance_mm"), nb::arg("tolerance_N").none(),
          nb::arg("weight"))
      .def(
          "check",
          [](const Goals& goals) {
            check_goals(goals.robot->model(), goals.plain());
            return doubts_about(goals.robot->model(), goals.plain());
          },
          "What looks wrong about them, a sentence each.")
      .def(
          "nearest_sample",
          [](const Goals& goals, const std::string& workspace) {
            return vector_out(runs::nearest_actuation(goals.robot->model(), workspace, goals.plain()));
          },
          nb::arg("workspace"));
}

}  // namespace

void bind_inverse(nb::module_& module) {
  bind_goals(module);
  nb::class_<InverseOptions>(module, "InverseOptions", "How inverse kinematics is solved.")
      .def(
          "__init__",
          [](InverseOptions* self, const std::string& method, std::optional<double> tolerance_mm, int max_equilibria,
             int descents, int other_starts, const StaticsOptions& statics) {
            new (self)
                InverseOptions(options_of(method, tolerance_mm, max_equilibria, descents, other_starts, statics));
          },
          nb::arg("method"), nb::arg("tolerance_mm").none(), nb::arg("max_equilibria"), nb::arg("descents"),
          nb::arg("other_starts"), nb::arg("statics"))
      .def_ro("tolerance_mm", &InverseOptions::tolerance_mm);
  nb::class_<Answer>(module, "Answer", "What inverse kinematics came to.")
      .def_prop_ro("shape", [](const Answer& a) { return a.shape; })
      .def_prop_ro("has_shape", &Answer::has_shape)
      .def_prop_ro("status", [](const Answer& a) { return name_of(a.found.status); })
      .def_prop_ro("reached", [](const Answer& a) { return a.found.status == InverseStatus::reached; })
      .def_prop_ro(
          "errors_mm", [](const Answer& a) { return vector_out(a.errors(false)); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "errors_N", [](const Answer& a) { return vector_out(a.errors(true)); }, nb::rv_policy::automatic)
      .def_prop_ro("off", &Answer::off)
      .def_prop_ro(
          "at_end", [](const Answer& a) { return a.found.active; },
          "Per actuator: -1 at the low end of its range, 1 at the high end, else 0.")
      .def_prop_ro("slope_mm", [](const Answer& a) { return a.found.slope; })
      .def_prop_ro("iterations", [](const Answer& a) { return a.found.iterations; })
      .def_prop_ro("equilibria", [](const Answer& a) { return a.found.equilibria; })
      .def_prop_ro("remark", [](const Answer& a) { return a.found.remark; })
      .def_prop_ro("seconds", [](const Answer& a) { return a.found.seconds; })
      .def("pickled",
           [](const Answer& a) {
             Writer writer;
             writer(a.goals.named, a.options, a.found);
             return nb::bytes(writer.bytes().data(), writer.bytes().size());
           })
      .def_static(
          "unpickled",
          [](RobotPtr robot, nb::bytes bytes) {
            auto answer = std::make_shared<Answer>();
            Reader reader({bytes.c_str(), bytes.size()});
            reader(answer->goals.named, answer->options, answer->found);
            reader.finish();
            answer->goals.robot = answer->robot = robot;
            answer->shape =
                std::make_shared<Shape>(std::move(robot), answer->found.equilibrium, answer->options.statics);
            return answer;
          },
          nb::arg("robot"), nb::arg("bytes"))
      .def(
          "png",
          [](const Answer& a, const std::vector<double>& view, const std::string& title) {
            return picture_of(*a.shape, view, title, a.goals.plain());
          },
          nb::arg("view"), nb::arg("title"))
      .def(
          "save_plot",
          [](const Answer& a, const std::string& path) {
            write_svg(path, runs::plot_of_search(a.found, a.options.tolerance_mm, a.robot->model().name,
                                                 runs::misses_of(a.goals.plain(), a.found)));
          },
          nb::arg("path"))
      .def("report", [](const Answer& a) {
        const nb::gil_scoped_release released;
        return report_of(a);
      });
  module.def("inverse", &inverse, nb::arg("goals"), nb::arg("session").none(), nb::arg("start_actuation").none(),
             nb::arg("start").none(), nb::arg("last").none(), nb::arg("preferred").none(), nb::arg("free"),
             nb::arg("options"), nb::arg("progress").none());
}

}  // namespace softkin::python
