#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <softkin/calibration/robot_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/table/measured_outlines.hpp>
#include <softkin/io/table/measured_poses.hpp>

#include "bindings.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

/// Measured poses and the options of their fit, as the Python layer passes them.
struct PosesTask {
  std::string scene, poses, outlines, loss = "squares";  // outlines: empty: there are none
  std::vector<std::string> numbers, given, changes;
  std::vector<double> deviations;  // per kind of reading; 0: by what is left
  double match_within_mm = 0;
  int outline_points = calibration::OutlineOptions().points;
  std::optional<double> outline_within_mm;
  int keep = 0, threads = 0;
  bool ordered = false;
};

/// A fit with its report.
struct RobotCalibration {
  std::string text, json;
  Table readings;
  std::optional<Plot> plot;  // none: there is nothing to plot
  std::string no_plot{};     // why
};

calibration::RobotFitOptions options_of(const PosesTask& task, std::size_t poses) {
  calibration::RobotFitOptions options;
  for (std::size_t i = 0; i < std::size(calibration::loss_names); ++i)
    if (task.loss == calibration::loss_names[i]) options.loss = static_cast<calibration::Loss>(i);
  for (std::size_t k = 0; k < readings; ++k) options.deviations[k] = task.deviations.at(k);
  options.kept = calibration::kept_aside("keep", task.keep, poses);
  options.ordered = task.ordered;
  options.match_within_mm = task.match_within_mm;
  options.outlines.points = task.outline_points;
  options.outlines.within_mm = task.outline_within_mm;
  options.threads = task.threads;
  return options;
}

calibration::NumberedRobot robot_of(const PosesTask& task) {
  RequestedScene requested;
  requested.scene = task.scene;
  requested.changes = task.changes;
  std::vector<std::filesystem::path> inputs;
  return {requested, calibration::parse_fitted_numbers("fit", task.numbers), inputs,
          calibration::parse_given_numbers("given", task.given)};
}

RobotCalibration fit(const PosesTask& task,
                     const std::optional<nb::typed<nb::callable, nb::object(int, double)>>& on_progress) {
  std::optional<RobotCalibration> reported;
  Watch watch{std::nullopt};
  std::atomic<int> iteration = 0;
  std::atomic<double> rms_mm = 0;
  const auto work = [&] {
    const calibration::NumberedRobot robot = robot_of(task);
    const Model model = robot.model(robot.start());
    MeasuredPoses poses = read_measured_poses(task.poses, model, true);
    if (!task.outlines.empty()) add_outlines(poses, task.outlines);
    const calibration::RobotFitOptions options = options_of(task, poses.commands.size());
    const auto progress = [&](const calibration::FitProgress& p) {
      iteration = p.iteration;
      rms_mm = p.rms_mm;
      return watch.go_on();
    };
    const calibration::RobotFit found = robot.numbers().empty()
                                            ? calibration::predict_poses(robot, poses, robot.start(), options, progress)
                                            : calibration::fit_robot(robot, poses, options, progress);
    if (found.status == Status::interrupted) return;
    const calibration::RobotFitReport report{robot, poses, options, found, model};
    reported = RobotCalibration{robot_fit_text(report), robot_fit_json(report), robot_fit_table(report), {}};
    try {
      reported->plot = robot_fit_plot(report);
    } catch (const InvalidInput& error) {
      reported->no_plot = error.what();
    }
  };
  watch.watch(work, [&] {
    if (on_progress) (*on_progress)(iteration.load(), rms_mm.load());
  });
  return std::move(reported).value();
}

}  // namespace

void bind_calibrate_robot(nb::module_& module) {
  nb::class_<PosesTask>(module, "PosesTask", "Measured poses of a robot and what is fitted to them.")
      .def(nb::init<>())
      .def_rw("scene", &PosesTask::scene)
      .def_rw("poses", &PosesTask::poses)
      .def_rw("loss", &PosesTask::loss)
      .def_rw("outlines", &PosesTask::outlines)
      .def_rw("numbers", &PosesTask::numbers)
      .def_rw("given", &PosesTask::given)
      .def_rw("changes", &PosesTask::changes)
      .def_rw("deviations", &PosesTask::deviations)
      .def_rw("match_within_mm", &PosesTask::match_within_mm)
      .def_rw("outline_points", &PosesTask::outline_points)
      .def_rw("outline_within_mm", &PosesTask::outline_within_mm)
      .def_rw("keep", &PosesTask::keep)
      .def_rw("ordered", &PosesTask::ordered)
      .def_rw("threads", &PosesTask::threads);
  nb::class_<RobotCalibration>(module, "RobotCalibration", "Numbers of a robot and how they were found.")
      .def_ro("text", &RobotCalibration::text)
      .def_ro("json", &RobotCalibration::json)
      .def_ro("readings", &RobotCalibration::readings)
      .def(
          "save_plot",
          [](const RobotCalibration& c, const std::string& path) {
            if (!c.plot) throw InvalidInput(c.no_plot);
            write_svg(path, *c.plot);
          },
          nb::arg("path"));
  module.def("calibrate_robot", &fit, nb::arg("task"), nb::arg("progress").none());
}

}  // namespace softkin::python
