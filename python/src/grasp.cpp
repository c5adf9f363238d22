#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <softkin/io/table/settings.hpp>
#include <softkin/kinematics/grasp.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/run_tables.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "pickles.hpp"
#include "solve.hpp"
#include "steps.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

/// A closed gripper, and how far its body was pulled.
struct GraspOut {
  RobotPtr robot;
  StaticsOptions options;
  Index body = 0;
  Grasp grasp;
  std::vector<Pull> pulls;

  [[nodiscard]] ShapePtr shape_of(const Equilibrium& at) const { return std::make_shared<Shape>(robot, at, options); }
};

/// The request of a grasp.
struct Requested {
  Index body = 0;
  std::vector<Actuation> closing;
  std::vector<PullDirection> directions;
  std::optional<double> max_N;
  StaticsOptions options;
};

Requested requested_of(const Robot& robot, const NamedSteps& closing, const std::string& body,
                       const std::vector<std::string>& directions, std::optional<double> max_N,
                       const StaticsOptions& options) {
  Requested requested{read_body(robot.model(), "body", body), {}, {}, max_N, options};
  for (const ActuationStep& step : closing.steps) requested.closing.push_back(step.actuation);
  for (const std::string& each : directions) requested.directions.push_back({each, read_direction("directions", each)});
  return requested;
}

/// By statics of its own, as the command does it.
std::shared_ptr<GraspOut> grasp(const RobotPtr& robot, const NamedSteps& closing, const std::string& body,
                                const std::vector<std::string>& directions, std::optional<double> max_N,
                                const StaticsOptions& options, const ProgressFunction& progress) {
  const auto work = [robot, requested = requested_of(*robot, closing, body, directions, max_N, options)](
                        const ProgressCallback& callback) {
    const Model& model = robot->model();
    const Statics statics(model);
    const GraspProgress reported = [&callback](const std::string&, const Progress& p) { return callback(p); };
    auto out = std::make_shared<GraspOut>();
    out->body = requested.body;
    out->grasp = close_around(statics, requested.closing, requested.body, requested.options, reported);
    for (const PullDirection& direction : requested.directions) {
      if (!out->grasp.held || (!out->pulls.empty() && out->pulls.back().status == Status::interrupted)) break;
      out->pulls.push_back(largest_pull(statics, out->grasp.last.state, {requested.body, direction, requested.max_N},
                                        requested.options, reported));
    }
    return out;
  };
  std::shared_ptr<GraspOut> out = watched_solve(*robot, progress, work);
  out->robot = robot;
  out->options = options;
  return out;
}

/// A pull: name and direction; force [N], move [mm], normal force [N]; slipping fraction; outcome; status; shape.
using PullOut = std::tuple<std::string, std::array<double, 3>, std::array<double, 3>, std::optional<double>,
                           std::string, std::string, ShapePtr>;

std::vector<PullOut> pulls_of(const GraspOut& out) {
  std::vector<PullOut> all;
  for (const Pull& pull : out.pulls)
    all.emplace_back(pull.direction.name, array_of(pull.direction.along),
                     std::array{pull.force_N, pull.moved_mm, pull.pressed.normal_N}, pull.pressed.slipping,
                     what_then(pull), name_of(pull.status), out.shape_of(pull.last));
  return all;
}

Table grasp_table(const GraspOut& out) {
  Table table = runs::table_of_pulls();
  for (const Pull& pull : out.pulls) table.rows.push_back(runs::row_of(pull));
  return table;
}

std::shared_ptr<GraspOut> unpickled_grasp(RobotPtr robot, const nb::bytes& bytes) {
  auto out = std::make_shared<GraspOut>();
  Reader reader({bytes.c_str(), bytes.size()});
  reader(out->options, out->body, out->grasp, out->pulls);
  reader.finish();
  if (out->body < 0 || out->body >= std::ssize(robot->model().bodies))
    throw InvalidInput("the pickle is of a grasp of another robot");
  out->robot = std::move(robot);
  return out;
}

}  // namespace

void bind_grasp(nb::module_& module) {
  nb::class_<GraspOut>(module, "Grasp", "A closed gripper, and how far its body was pulled.")
      .def_prop_ro("body", [](const GraspOut& g) { return g.robot->model().bodies[g.body].name; })
      .def_prop_ro("held", [](const GraspOut& g) { return g.grasp.held; })
      .def_prop_ro("remark", [](const GraspOut& g) { return g.grasp.remark; })
      .def_prop_ro("shape", [](const GraspOut& g) { return g.shape_of(g.grasp.last); })
      .def("pulls", &pulls_of,
           "Name, direction, (force [N], move [mm], normal force [N]), slipping fraction, what then, status, shape.")
      .def("table", &grasp_table)
      .def("pickled",
           [](const GraspOut& g) {
             Writer writer;
             writer(g.options, g.body, g.grasp, g.pulls);
             return nb::bytes(writer.bytes().data(), writer.bytes().size());
           })
      .def_static("unpickled", &unpickled_grasp, nb::arg("robot"), nb::arg("bytes"));
  module.def("grasp", &grasp, nb::arg("robot"), nb::arg("closing"), nb::arg("body"), nb::arg("directions"),
             nb::arg("most_N").none(), nb::arg("options"), nb::arg("progress").none());
}

}  // namespace softkin::python
