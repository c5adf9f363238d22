#include <algorithm>
#include <cstdio>
#include <memory>
#include <softkin/calibration/actuator_tasks.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/io/table/measurements.hpp>

#include "calibrate_command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// What the user asks of `softkin calibrate pressure`. An empty text: not given.
struct PressureOptions {
  std::vector<std::string> tests;
  std::string scale;   // absolute or gauge
  SolveOptions robot;  // scene alone
  std::string actuator;
  std::string chamber, tube, syringe;  // volumes with their unit
  std::optional<double> atmosphere_kPa;
  std::string output, table, plot;
  bool predict = false, json = false;
  int threads = 0;
};

/// The chamber that was tested.
std::size_t chamber_of(const RobotSpec& spec, const std::string& asked) {
  std::vector<std::string> names;
  std::size_t chamber = 0;
  for (std::size_t a = 0; a < spec.actuators.size(); ++a) {
    if (spec.actuators[a].kind != ActuatorKind::pneumatic) continue;
    names.push_back(spec.actuators[a].name);
    if (names.back() == asked || asked.empty()) chamber = a;
  }
  if (names.empty()) throw InvalidInput({spec.name}, "the scene has no pneumatic actuator");
  if (asked.empty() && names.size() > 1)
    throw InvalidInput(
        {spec.name},
        "the scene has several pneumatic actuators: say by --actuator which one was tested" + suggest_name("", names));
  if (!asked.empty() && std::find(names.begin(), names.end(), asked) == names.end())
    throw InvalidInput("--actuator " + excerpt(asked) + ": no such pneumatic actuator" + suggest_name(asked, names));
  return chamber;
}

class PressureRun {
 public:
  explicit PressureRun(const PressureOptions& options)
      : options_(options), inputs_(options.tests.begin(), options.tests.end()) {
    if (!options.robot.scene.empty()) read_robot();
    outputs_ = asked_outputs({{"--output", options.output}, {"--table", options.table}, {"--plot", options.plot}});
    check_outputs(outputs_, inputs_);
    read_setup();
    std::optional<PressureScale> scale;
    if (!options.scale.empty()) scale = options.scale == "absolute" ? PressureScale::absolute : PressureScale::gauge;
    results_ =
        calibration::evaluate({options.tests, scale, setup_}, options.output.empty() ? "of the test" : options.output);
    head_ += results_->head;
  }

  int run() {
    const OutputFolders folders(outputs_);
    std::optional<calibration::PressureComparison> physics;
    if (options_.predict) {
      ProgressLine line;
      line.show(-1, "solving the physical formulation");
      catch_interrupt();
      physics = calibration::compare_with_physics(*spec_, actuator_, results_->fitted.curve, options_.threads,
                                                  [](const Progress&) { return !interrupted(); });
    }
    write();
    print(options_.json
              ? calibration::pressure_json(options_.tests, setup_, results_->fitted, physics ? &*physics : nullptr)
              : text(physics));
    if (!physics || physics->is_complete()) return done;
    std::fprintf(stderr, "softkin: the physical formulation has no equilibrium at some of the ratios\n");
    return not_converged;
  }

 private:
  void say(const std::string& line) { head_ += line + "\n"; }

  void read_robot() {
    inputs_.emplace_back(options_.robot.scene);
    spec_ = asked_spec(options_.robot, inputs_);
    const std::size_t chamber = chamber_of(*spec_, options_.actuator);
    actuator_ = spec_->actuators[chamber].name;
    volume_mm3_ = compile(*spec_).actuators[chamber].rest_measure;
  }

  void read_setup() {
    setup_.atmosphere_kPa = options_.atmosphere_kPa.value_or(setup_.atmosphere_kPa);
    setup_.syringe_mm3 = read_volume("--syringe-volume", options_.syringe);
    setup_.tube_mm3 = options_.tube.empty() ? 0 : read_volume("--tube-volume", options_.tube);
    const bool given = !options_.chamber.empty();
    if (!given && !spec_)
      throw InvalidInput(
          "the chamber's volume at rest is not known: give --scene SCENE, whose mesh has it, or --chamber-volume");
    setup_.chamber_mm3 = given ? read_volume("--chamber-volume", options_.chamber) : volume_mm3_;
    say("chamber " + number(setup_.chamber_mm3) + " mm^3 at rest" +
        (given ? "" : " (actuator " + actuator_ + " of " + options_.robot.scene + ")") + ", tube " +
        number(setup_.tube_mm3) + " mm^3" + (options_.tube.empty() ? " (default)" : "") + ", syringe " +
        number(setup_.syringe_mm3) + " mm^3");
    say("atmosphere " + number(setup_.atmosphere_kPa) + " kPa" +
        (options_.atmosphere_kPa ? "" : " (default, as in the paper's Eq. (19))"));
  }

  [[nodiscard]] std::string text(const std::optional<calibration::PressureComparison>& physics) const {
    const ActuatorCurve& curve = results_->fitted.curve;
    std::string text =
        head_ + calibration::quality_text(results_->fitted) + "\n" + calibration::curve_text(curve) + "\n";
    if (physics) text += calibration::comparison_text(*physics, curve, *spec_);
    if (!options_.output.empty())
      text += "curve: " + options_.output + " (name it in the scene: curve: FILE; then --set " +
              (spec_ ? actuator_ : "air") + "=" + number(0.5 * curve.loading.ratio.x().back(), 2) + "kPa)\n";
    return text + written_text({{"rows", options_.table}, {"plot", options_.plot}});
  }

  void write() const {
    if (!options_.output.empty())
      write_file(options_.output,
                 actuator_curve_text(results_->fitted.curve, "made by softkin calibrate pressure from:\n" + head_));
    if (!options_.table.empty())
      write_file(options_.table, calibration::syringe_table(setup_, results_->samples).csv());
    if (!options_.plot.empty())
      write_svg(options_.plot, calibration::curve_plot(results_->fitted, "volume ratio by Eq. (19)"));
  }

  const PressureOptions& options_;
  std::vector<fs::path> inputs_;
  std::vector<Output> outputs_;
  std::optional<RobotSpec> spec_;
  std::string actuator_;
  double volume_mm3_ = 0;
  calibration::SyringeSetup setup_;
  std::optional<calibration::SyringeResults> results_;
  std::string head_;
};

void add_test(CLI::App& command, PressureOptions& options) {
  add_value(command, "TESTS", options.tests, "F.csv",
            "Syringe tests: columns p_abs_kpa or p_gauge_kpa (p_kpa with\n--pressure), dv_sy_mm3 or dv_sy_ml (air "
            "pushed out of the syringe\nsince the start), and if you like run and t_s")
      ->required();
  add_value(command, "--pressure", options.scale, "SCALE", "Of column p_kpa: absolute (above vacuum) or gauge",
            one_of({"absolute", "gauge"}));
  add_value(command, "--scene", options.robot.scene, "SCENE",
            "The robot; its mesh gives the chamber's volume at rest, V_c0");
  add_value(command, "--actuator", options.actuator, "NAME",
            "With --scene: the chamber that was tested (default: the only one)");
  add_value(command, "--chamber-volume", options.chamber, "VOLUME",
            "V_c0, in place of that of the mesh, with its unit: 21mL");
  add_value(command, "--syringe-volume", options.syringe, "VOLUME",
            "V_sy0, air in the syringe at the start: 60mL, 60000mm3")
      ->required();
  add_value(command, "--tube-volume", options.tube, "VOLUME", "V_t, air in tubes and sensor (default: 0)");
  add_value(command, "--atmosphere", options.atmosphere_kPa, "KPA",
            "Pressure of the air around, absolute [kPa] (default: 100, as in\nthe paper)", positive_number());
}

void add_results(CLI::App& command, PressureOptions& options) {
  add_value(command, "-o,--output", options.output, "F.yaml", "The curve, for key 'curve' of the scene's actuator");
  add_value(command, "--table", options.table, "F.csv", "Volume ratio of every row");
  add_value(command, "--plot", options.plot, "F.svg", "Rows and both branches");
  command.add_flag("--predict", options.predict,
                   "With --scene: the pressures of the physical formulation beside\nthe measured ones, and the factor "
                   "of Young's modulus between them");
  add_value(command, "--threads", options.threads, "N", "Of --predict; 0: as many as the machine has (default)",
            CLI::Range(0, 512).description(""));
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void check(const PressureOptions& options) {
  check_extension("--output", options.output, {{".yaml", ""}});
  check_extension("--table", options.table, {{".csv", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  if (options.predict && options.robot.scene.empty())
    throw CLI::ValidationError("--predict", "give --scene too, whose robot is to be predicted");
  if (!options.actuator.empty() && options.robot.scene.empty())
    throw CLI::ValidationError("--actuator", "give --scene too, whose actuator it is");
}

}  // namespace

void add_calibrate_pressure(CLI::App& calibrate, Run& run) {
  const auto options = std::make_shared<PressureOptions>();
  CLI::App& command = *calibrate.add_subcommand(
      "pressure", "Volume ratio of a chamber by its pressure, from a syringe test (Fang et al. 2020, Eq. (19))");
  add_test(command, *options);
  add_results(command, *options);
  command.footer(
      "Rows are in the order of time; where the syringe turns, loading becomes unloading. Exit code: 0 done, 1 the\n"
      "physical formulation has no equilibrium at some ratio, 2 bad usage or bad input.\nExample:\n"
      "  softkin calibrate pressure syringe.csv --scene finger.yaml --syringe-volume 60mL --tube-volume 1.2mL -o "
      "air.yaml");
  command.callback([&run, options] {
    run = [options] {
      check(*options);
      return PressureRun(*options).run();
    };
  });
}

}  // namespace softkin::cli
