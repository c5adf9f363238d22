#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <softkin/io/table/measured_poses.hpp>
#include <softkin/kinematics/estimator.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/estimate_plan.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "robot.hpp"
#include "solve.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

/// An estimate with its words and its shape.
struct Reported {
  Estimate estimate;
  std::vector<std::string> words, left_out;
  ShapePtr shape;  // null: none was found
};

/// An estimator with the robot that it is of; for one thread at a time.
class RobotEstimator {
 public:
  RobotEstimator(RobotPtr robot, const std::vector<std::string>& unknowns, const std::vector<std::string>& columns,
                 const VectorIn& deviations, const EstimatorOptions& options)
      : robot_(std::move(robot)), options_(options) {
    std::vector<EstimatedUnknown> all;
    for (const std::string& text : unknowns) all.push_back(parse_unknown("unknown", text));
    columns_ = reading_columns(robot_->model(), columns);
    estimator_.emplace(robot_->model(), all, columns_, vector_of(deviations), options);
  }

  Reported update(const VectorIn& commands, const VectorIn& values, double elapsed_s) {
    const Actuation requested = vector_of(commands);
    const Eigen::VectorXd read = vector_of(values);
    return watched(std::nullopt, [&](const ProgressCallback& progress) {
      Reported reported{estimator_->update(requested, read, elapsed_s, progress), {}, {}, {}};
      if (reported.estimate.status == Status::interrupted || reported.estimate.numbers.empty()) return reported;
      reported.words = estimate_words(reported.estimate, estimator_->groups());
      for (const std::size_t g : reported.estimate.left_out) reported.left_out.push_back(estimator_->groups()[g].name);
      Equilibrium found{reported.estimate.state, reported.estimate.actuation, {}};
      found.report.status = reported.estimate.status;
      reported.shape = std::make_shared<Shape>(robot_, std::move(found), options_.statics);
      return reported;
    });
  }

  /// deviations: of each kind of reading, in its unit; 0: none of the kind
  std::vector<PlannedReading> plan(const std::vector<const Reported*>& reported, const VectorIn& deviations,
                                   int count) const {
    PlanOptions options{runs::marker_vertices(robot_->model()), {}, columns_, count};
    const Eigen::VectorXd given = vector_of(deviations);
    for (std::size_t k = 0; k < readings; ++k) options.deviations[k] = given[k];
    std::vector<PlanBasis> estimates;
    for (const Reported* each : reported) estimates.emplace_back(each->estimate);
    return plan_readings(robot_->model(), estimates, options);
  }

  void forget() { estimator_->forget(); }
  [[nodiscard]] std::vector<std::string> reported_commands() const {
    std::vector<std::string> names;
    for (const Index a : estimator_->reported_actuators()) names.push_back(robot_->model().actuators[a].name);
    return names;
  }

 private:
  RobotPtr robot_;
  EstimatorOptions options_;
  std::vector<PoseColumn> columns_;
  std::optional<Estimator> estimator_;
};

TableOut matrix_out(const Eigen::MatrixXd& matrix) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
  return table_of<double>(rows.data(), rows.rows(), rows.cols());
}

/// Of every vertex, along each axis [mm].
TableOut vertex_deviations(const Reported& reported, Index vertices) {
  Eigen::MatrixXd deviations(vertices, 3);
  for (Index v = 0; v < vertices; ++v) deviations.row(v) = reported.estimate.vertex_deviation(v).transpose();
  return matrix_out(deviations);
}

}  // namespace

void bind_estimate(nb::module_& module) {
  nb::class_<EstimatedNumber>(module, "ToldNumber", "A number estimated from readings, with its standard deviation.")
      .def_ro("name", &EstimatedNumber::name)
      .def_ro("unit", &EstimatedNumber::unit)
      .def_ro("value", &EstimatedNumber::value)
      .def_ro("deviation", &EstimatedNumber::deviation)
      .def_ro("known_mean", &EstimatedNumber::known_mean)
      .def_ro("known_deviation", &EstimatedNumber::known_deviation)
      .def_ro("at_bound", &EstimatedNumber::at_bound);
  nb::class_<EstimatedPlace>(module, "ToldPlace", "Where a force was estimated to act.")
      .def_ro("force", &EstimatedPlace::force)
      .def_prop_ro(
          "at_rest", [](const EstimatedPlace& p) { return vector_out(p.at_rest); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "present", [](const EstimatedPlace& p) { return vector_out(p.present); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "covariance", [](const EstimatedPlace& p) { return matrix_out(p.covariance); }, nb::rv_policy::automatic);
  nb::class_<Reported>(module, "Told", "What was estimated from readings.")
      .def_prop_ro("status", [](const Reported& t) { return std::string(name_of(t.estimate.status)); })
      .def_prop_ro("remark", [](const Reported& t) { return t.estimate.remark; })
      .def_prop_ro("numbers", [](const Reported& t) { return t.estimate.numbers; })
      .def_prop_ro("places", [](const Reported& t) { return t.estimate.places; })
      .def_prop_ro(
          "covariance", [](const Reported& t) { return matrix_out(t.estimate.covariance); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "computed", [](const Reported& t) { return vector_out(t.estimate.computed); }, nb::rv_policy::automatic)
      .def_prop_ro("chi_square", [](const Reported& t) { return t.estimate.chi_square; })
      .def_prop_ro("freedoms", [](const Reported& t) { return t.estimate.freedoms; })
      .def_prop_ro("misfit", [](const Reported& t) { return t.estimate.misfit(); })
      .def_prop_ro("seconds", [](const Reported& t) { return t.estimate.seconds; })
      .def_prop_ro("equilibria", [](const Reported& t) { return t.estimate.equilibria; })
      .def_ro("words", &Reported::words)
      .def_ro("left_out", &Reported::left_out)
      .def_ro("shape", &Reported::shape)
      .def("vertex_deviations", &vertex_deviations, nb::arg("vertices"));
  nb::class_<PlannedReading>(module, "PlannedReading", "A reading that would add information.")
      .def_ro("name", &PlannedReading::name)
      .def_ro("vertex", &PlannedReading::vertex)
      .def_prop_ro(
          "at_rest", [](const PlannedReading& p) { return vector_out(p.at_rest); }, nb::rv_policy::automatic)
      .def_ro("bits", &PlannedReading::bits)
      .def_prop_ro(
          "numbers", [](const PlannedReading& p) { return vector_out(p.numbers); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "places", [](const PlannedReading& p) { return vector_out(p.places); }, nb::rv_policy::automatic);
  nb::class_<RobotEstimator>(module, "Estimator", "Estimates the forces on a robot from its readings.")
      .def(
          "__init__",
          [](RobotEstimator* self, const RobotPtr& robot, const std::vector<std::string>& unknowns,
             const std::vector<std::string>& columns, const VectorIn& deviations, double fade_s, bool leave_out,
             const StaticsOptions& solver) {
            EstimatorOptions options;
            options.statics = solver;
            options.fade_s = fade_s;
            options.leave_out = leave_out;
            new (self) RobotEstimator(robot, unknowns, columns, deviations, options);
          },
          nb::arg("robot"), nb::arg("unknowns"), nb::arg("columns"), nb::arg("deviations"), nb::arg("fade_s"),
          nb::arg("leave_out"), nb::arg("solver"))
      .def("update", &RobotEstimator::update, nb::arg("commands"), nb::arg("values"), nb::arg("elapsed_s"))
      .def("plan", &RobotEstimator::plan, nb::arg("told"), nb::arg("deviations"), nb::arg("count"))
      .def("forget", &RobotEstimator::forget)
      .def_prop_ro("told_commands", &RobotEstimator::reported_commands);
}

}  // namespace softkin::python
