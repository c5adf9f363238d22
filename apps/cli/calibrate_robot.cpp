#include <cstdio>
#include <memory>
#include <softkin/calibration/robot_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/measured_outlines.hpp>
#include <softkin/io/table/measured_poses.hpp>

#include "command.hpp"
#include "estimate_options.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

struct RobotOptions {
  SolveOptions robot;
  std::string poses, outlines, report, table, plot, loss = "squares";
  std::vector<std::string> numbers, given;
  std::array<std::optional<double>, readings> deviations{};
  std::optional<double> match_within_mm, outline_within_mm;
  std::optional<int> outline_points;
  int keep = 0;
  bool ordered = false;
  bool json = false, resume = false, may_replace = false;

  [[nodiscard]] std::vector<Output> outputs() const {
    return requested_outputs({{"--report", report}, {"--table", table}, {"--plot", plot}});
  }
};

calibration::RobotFitOptions fit_options(const RobotOptions& options, std::size_t poses) {
  calibration::RobotFitOptions fit;
  fit.solver = options.robot.statics();
  fit.threads = options.robot.threads;
  for (std::size_t i = 0; i < std::size(calibration::loss_names); ++i)
    if (options.loss == calibration::loss_names[i]) fit.loss = static_cast<calibration::Loss>(i);
  for (std::size_t k = 0; k < readings; ++k) fit.deviations[k] = options.deviations[k].value_or(0);
  fit.kept = calibration::kept_aside("--keep", options.keep, poses);
  fit.ordered = options.ordered;
  fit.match_within_mm = options.match_within_mm.value_or(0);
  fit.outlines.points = options.outline_points.value_or(fit.outlines.points);
  fit.outlines.within_mm = options.outline_within_mm;
  return fit;
}

MeasuredPoses read_poses(const RobotOptions& options, const Model& model) {
  MeasuredPoses poses = read_measured_poses(options.poses, model, true);
  if (!options.outlines.empty()) add_outlines(poses, options.outlines);
  return poses;
}

void check_options(const RobotOptions& options) {
  check_extension("--report", options.report, {{".json", ""}});
  check_extension("--table", options.table, {{".csv", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  check_solver(options.robot);
  if (options.resume && options.report.empty())
    throw CLI::ValidationError("--resume", "give --report too, where the fit stopped");
  if (!options.outlines.empty()) return;
  if (options.outline_points) throw CLI::ValidationError("--outline-points", "give --outlines too, which are thinned");
  if (options.outline_within_mm)
    throw CLI::ValidationError("--outline-within", "give --outlines too, which are matched");
}

int calibrate_robot(const RobotOptions& options) {
  check_options(options);
  std::vector<fs::path> inputs{options.robot.scene, options.poses};
  if (!options.outlines.empty()) inputs.emplace_back(options.outlines);
  std::vector<calibration::FittedNumber> numbers = calibration::parse_fitted_numbers("--fit", options.numbers);
  if (options.resume) calibration::begin_where_fit_ended(options.report, numbers);
  const calibration::NumberedRobot robot(options.robot, numbers, inputs,
                                         calibration::parse_given_numbers("--given", options.given));
  std::vector<Output> outputs = options.outputs();
  if (options.resume) leave_to_resume(outputs, options.report);
  check_outputs(outputs, inputs, options.may_replace);
  const Model model = robot.model(robot.start());
  const MeasuredPoses poses = read_poses(options, model);
  const calibration::RobotFitOptions fit = fit_options(options, poses.commands.size());
  const OutputFolders folders(outputs);
  ProgressLine line;
  catch_interrupt();
  const auto progress = [&](const calibration::FitProgress& p) {
    line.show(-1, (p.iteration > 0 ? "iteration " + std::to_string(p.iteration) + ", " : "") + "pose " +
                      std::to_string(p.poses_done) + " of " + std::to_string(p.poses) +
                      (p.rms_mm > 0 ? ", off by " + number(p.rms_mm, 3) + " mm" : ""));
    return !interrupted();
  };
  const calibration::RobotFit found = numbers.empty()
                                          ? calibration::predict_poses(robot, poses, robot.start(), fit, progress)
                                          : calibration::fit_robot(robot, poses, fit, progress);
  line.clear();
  if (found.computed.equilibria.empty()) {
    std::fprintf(stderr, "softkin: %s before the poses were solved once; nothing was written\n", why_stopped().c_str());
    return not_converged;
  }
  const calibration::RobotFitReport report{robot, poses, fit, found, model};
  if (!options.report.empty()) write_file(options.report, robot_fit_json(report));
  if (!options.table.empty()) write_file(options.table, robot_fit_table(report).csv());
  if (!options.plot.empty()) write_svg(options.plot, robot_fit_plot(report));
  print(options.json
            ? robot_fit_json(report)
            : robot_fit_text(report) +
                  written_text({{"report", options.report}, {"readings", options.table}, {"plot", options.plot}}));
  if (found.status == Status::interrupted) return not_converged;
  return found.status == Status::converged ? done : not_converged;
}

void add_outline_options(CLI::App& command, RobotOptions& options) {
  add_value(command, "--outlines", options.outlines, "F.csv",
            "Outlines of the robot in pictures, by softkin measure --outline;\nthe column picture of POSES says of "
            "which pose each is");
  add_value(command, "--outline-points", options.outline_points, "N",
            "To which each outline is thinned, evenly along it; each point\ncounts as a coordinate (default: 40)",
            CLI::Range(1, 100000).description(""));
  add_value(command, "--outline-within", options.outline_within_mm, "MM",
            "Farther from the robot's outline a point does not count\n(default: 5 % of the robot's diagonal)",
            positive("a number > 0 in mm"));
  add_repeated(
      command, "--given", options.given, "NAME=VALUE",
      "A number of the measuring frame that is known and not fitted:\nbase.x, base.rx, ..., camera.x, ... [mm, "
      "degrees], such as\ncamera.rx=-90 where the pictures show the robot's x and z;\nrepeatable");
}

void add_options(CLI::App& command, RobotOptions& options) {
  add_scene(command, options.robot);
  add_force(command, options.robot);
  add_value(command, "POSES", options.poses, "F.csv",
            "Measured poses, a row each: commands as in a path (air,\ntendon_N), then tip_x_mm, tip_y_mm, ... of "
            "markers, and\nair_pressure_kPa, tendon_tension_N of measured reactions; empty cells\nwere not measured")
      ->required();
  add_repeated(command, "--fit", options.numbers, "NUMBER",
               "NAME, NAME=START, NAME=START,LOW,HIGH or NAME=MEAN+-DEVIATION\n(known before); repeatable. NAME is a "
               "path as of --change\n(materials.body.youngs_modulus, actuators.t1.factor), or base.x,\nbase.rx, ...: "
               "where the robot stands in the measuring frame\n[mm, degrees]; camera.x, ...: the same, gravity turns "
               "along.\nWithout: the poses are predicted with the scene as it is");
  add_value(command, "--loss", options.loss, "NAME",
            "What a reading counts that is far off: squares (default),\nhuber or cauchy, which wrong readings hardly "
            "move",
            one_of({"squares", "huber", "cauchy"}));
  add_deviations(command, options.deviations, " (default: by what is left)");
  add_value(command, "--match-within", options.match_within_mm, "MM",
            "Match dots without names (dot1_x_mm, ...) to the markers that\nthey are, within this distance",
            positive("a number > 0 in mm"));
  add_outline_options(command, options);
  add_value(command, "--keep", options.keep, "N", "Poses kept out of the fit and predicted, spread evenly",
            CLI::Range(0, 100000).description(""));
  command.add_flag("--ordered", options.ordered,
                   "The poses were taken in this order: with friction or backlash\neach starts from the one "
                   "before, the first\nfrom rest; else each from rest");
  add_value(command, "--report", options.report, "F.json", "All estimates, as JSON");
  add_value(command, "--table", options.table, "F.csv", "Every reading, measured and computed");
  add_value(command, "--plot", options.plot, "F.svg", "Measured and computed markers and outlines");
  command.add_flag("--resume", options.resume, "Begin where the fit of --report ended");
  add_solver(command, options.robot);
  add_overwriting(command, options.may_replace);
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

}  // namespace

void add_calibrate_robot(CLI::App& calibrate, Run& run) {
  add_command<RobotOptions>(
      calibrate, run, "robot",
      "Numbers of a robot from its measured poses: moduli, density, what of a command acts, where it stands",
      "Levenberg's and Marquardt's method through equilibria, physical formulation. Exit code: 0 done, 1 not\n"
      "converged, a pose without equilibrium, or interrupted (what was found by then is written), 2 bad usage or bad\n"
      "input.\nExample:\n  softkin calibrate robot arm.yaml poses.csv --fit materials.body.youngs_modulus=0.4,0.1,1 "
      "\\\n"
      "      --fit actuators.t1.factor --plot fit.svg",
      add_options, calibrate_robot);
}

}  // namespace softkin::cli
