#include <cstdio>
#include <memory>
#include <softkin/calibration/actuator_report.hpp>
#include <softkin/calibration/relaxation_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/io/table/measurements.hpp>

#include "command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

CLI::Validator positive_number() {
  return must_be("a finite number above 0", [](const std::string& text) {
    double value = 0;
    return parse_real(text, value) && value > 0;
  });
}

/// What the user asks of `softkin calibrate pressure`. An empty text: not given.
struct PressureOptions {
  std::vector<std::string> tests;
  std::string scale;   // absolute or gauge
  SolveOptions robot;  // scene alone
  std::string actuator;
  std::string chamber, tube, syringe;  // volumes with their unit
  std::optional<double> atmosphere_kPa;
  std::string output, table, plot;
  bool predict = false, json = false, may_replace = false;
  int threads = 0;
};

/// Writes the curve and its plot where the options request them.
void write_curve(const std::string& file, const std::string& plot, const calibration::FittedCurve& fitted,
                 const std::string& made_by, const std::string& title) {
  if (!file.empty()) write_file(file, actuator_curve_text(fitted.curve, "made by softkin calibrate " + made_by));
  if (!plot.empty()) write_svg(plot, calibration::curve_plot(fitted, title));
}

/// Where the curve is, if anywhere, and how it is used.
std::string use_text(const std::string& file, const std::string& actuator, const ActuatorCurve& curve) {
  if (file.empty()) return "";
  return "curve: " + file + " (name it in the scene: curve: FILE; then --set " + actuator + "=" +
         number(0.5 * curve.loading.ratio.x().back(), 2) + (curve.input == CurveInput::voltage ? "kV)\n" : "kPa)\n");
}

/// The volumes as the options have them, a chamber's that is not given from the mesh; returns them in words.
std::string read_setup(const PressureOptions& options, const std::string& actuator, double mesh_mm3,
                       calibration::SyringeSetup& setup) {
  setup.atmosphere_kPa = options.atmosphere_kPa.value_or(setup.atmosphere_kPa);
  setup.syringe_mm3 = read_volume("--syringe-volume", options.syringe);
  setup.tube_mm3 = options.tube.empty() ? 0 : read_volume("--tube-volume", options.tube);
  const bool given = !options.chamber.empty();
  if (!given && options.robot.scene.empty())
    throw InvalidInput(
        "the chamber's volume at rest is not known: give --scene SCENE, whose mesh has it, or --chamber-volume");
  setup.chamber_mm3 = given ? read_volume("--chamber-volume", options.chamber) : mesh_mm3;
  return "chamber " + number(setup.chamber_mm3) + " mm^3 at rest" +
         (given ? "" : " (actuator " + actuator + " of " + options.robot.scene + ")") + ", tube " +
         number(setup.tube_mm3) + " mm^3" + (options.tube.empty() ? " (default)" : "") + ", syringe " +
         number(setup.syringe_mm3) + " mm^3\natmosphere " + number(setup.atmosphere_kPa) + " kPa" +
         (options.atmosphere_kPa ? "" : " (default, as in the paper's Eq. (19))") + "\n";
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

int calibrate_pressure(const PressureOptions& options) {
  check(options);
  std::vector<fs::path> inputs(options.tests.begin(), options.tests.end());
  std::optional<RobotSpec> spec;
  std::string actuator = "air";
  double mesh_mm3 = 0;
  std::size_t chamber = 0;
  if (!options.robot.scene.empty()) {
    inputs.emplace_back(options.robot.scene);
    spec = requested_spec(options.robot, inputs);
    chamber = calibration::tested_chamber(*spec, options.actuator);
    actuator = spec->actuators[chamber].name;
    mesh_mm3 = compile(*spec).actuators[chamber].rest_measure;
  }
  const std::vector<Output> outputs =
      requested_outputs({{"--output", options.output}, {"--table", options.table}, {"--plot", options.plot}});
  check_outputs(outputs, inputs, options.may_replace);
  calibration::SyringeTask task{options.tests, {}, {}};
  std::string head = read_setup(options, actuator, mesh_mm3, task.setup);
  if (!options.scale.empty()) task.scale = options.scale == "absolute" ? PressureScale::absolute : PressureScale::gauge;
  const calibration::SyringeResults results =
      calibration::evaluate(task, options.output.empty() ? "of the test" : options.output);
  head += results.head;
  const ActuatorCurve& curve = results.fitted.curve;
  const OutputFolders folders(outputs);
  std::optional<calibration::PressureComparison> physics;
  if (options.predict) {
    ProgressLine line;
    line.show(-1, "solving the physical formulation");
    catch_interrupt();
    physics = calibration::compare_with_physics(*spec, chamber, curve, options.threads,
                                                [](const Progress&) { return !interrupted(); });
  }
  write_curve(options.output, options.plot, results.fitted, "pressure from:\n" + head, "volume ratio by Eq. (19)");
  if (!options.table.empty()) write_file(options.table, calibration::syringe_table(task.setup, results.samples).csv());
  print(options.json
            ? calibration::pressure_json(options.tests, task.setup, results.fitted, physics ? &*physics : nullptr)
            : head + calibration::quality_text(results.fitted) + "\n" + calibration::curve_text(curve) + "\n" +
                  (physics ? calibration::comparison_text(*physics, curve, *spec) : "") +
                  use_text(options.output, actuator, curve) +
                  written_text({{"rows", options.table}, {"plot", options.plot}}));
  if (!physics || physics->is_complete()) return done;
  std::fprintf(stderr, "softkin: the physical formulation has no equilibrium at some of the ratios\n");
  return not_converged;
}

void add_options(CLI::App& command, PressureOptions& options) {
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
  add_value(command, "-o,--output", options.output, "F.yaml", "The curve, for key 'curve' of the scene's actuator");
  add_value(command, "--table", options.table, "F.csv", "Volume ratio of every row");
  add_value(command, "--plot", options.plot, "F.svg", "Rows and both branches");
  command.add_flag("--predict", options.predict,
                   "With --scene: the pressures of the physical formulation beside\nthe measured ones, and the factor "
                   "of Young's modulus between them");
  add_value(command, "--threads", options.threads, "N", "Of --predict; 0: as many as the machine has (default)",
            CLI::Range(0, 512).description(""));
  add_overwriting(command, options.may_replace);
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

struct DeaOptions : calibration::DeaTask {
  std::string output, plot;
  bool json = false, may_replace = false;
};

int calibrate_dea(const DeaOptions& options) {
  check_extension("--output", options.output, {{".yaml", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  const std::vector<Output> outputs = requested_outputs({{"--output", options.output}, {"--plot", options.plot}});
  check_outputs(outputs, {options.tests.begin(), options.tests.end()}, options.may_replace);
  const std::string name = options.output.empty() ? "of the elastomer" : options.output;
  const auto [fitted, head, computed] = calibration::evaluate(options, name);
  const OutputFolders folders(outputs);
  write_curve(options.output, options.plot, fitted, "dea from:\n" + head, "area ratio by voltage");
  print(options.json ? calibration::dea_json(options.tests, fitted, computed ? &*computed : nullptr)
                     : head + (computed ? "" : calibration::quality_text(fitted)) + "\n" +
                           calibration::curve_text(fitted.curve) + (options.output.empty() ? "" : "\n") +
                           use_text(options.output, "skin", fitted.curve) + written_text({{"plot", options.plot}}));
  return done;
}

void add_options(CLI::App& command, DeaOptions& options) {
  add_value(command, "TESTS", options.tests, "F.csv",
            "Measured: columns voltage_kv or voltage_v; area_ratio, or stretch\n(of lengths, alike in both "
            "directions); and if you like run, t_s");
  add_value(command, "--law", options.law, "NAME",
            "In place of TESTS, from the equations of state of an\nelastomer: neo-hookean or gent",
            CLI::IsMember({"neo-hookean", "gent"}).description(""));
  add_value(command, "--loading", options.loading, "HOW",
            "Constant forces at its edges: equal-biaxial (both\ndirections alike, default), uniaxial (one "
            "direction alone) or\nconstrained (one direction; stiff fibres keep the stretch across)",
            CLI::IsMember({"equal-biaxial", "uniaxial", "constrained"}).description(""));
  const auto add = [&](const char* name, std::optional<double>& value, const char* what, const char* unit) {
    add_value(command, name, value, unit, what, positive_number());
  };
  add("--shear-modulus", options.shear_modulus_MPa, "mu at small strain, a third of Young's modulus [MPa]", "MPA");
  add("--permittivity", options.permittivity, "Relative to vacuum", "NUMBER");
  add("--thickness", options.thickness_mm, "Before any stretch [mm]", "MM");
  add("--prestretch", options.prestretch, "Length without voltage over that without forces (default: 1)", "RATIO");
  add("--prestretch-across", options.prestretch_across, "constrained: the stretch that the fibres keep", "RATIO");
  add("--stretch-limit", options.stretch_limit, "gent: J_lim, limit of l1^2 + l2^2 + l3^2 - 3", "NUMBER");
  add("--breakdown-field", options.breakdown_kV_mm, "True field at which the curve ends at the latest [kV/mm]",
      "KV_MM");
  add_value(command, "-o,--output", options.output, "F.yaml", "The curve, for key 'curve' of the scene's actuator");
  add_value(command, "--plot", options.plot, "F.svg", "Rows and branches");
  add_overwriting(command, options.may_replace);
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void check(const DeaOptions& options) {
  if (options.tests.empty() == options.law.empty())
    throw CLI::ValidationError("TESTS", "give either measured tests or --law");
  if (options.law.empty() &&
      (options.permittivity || options.thickness_mm || options.shear_modulus_MPa || options.prestretch ||
       options.prestretch_across || options.stretch_limit || options.breakdown_kV_mm || !options.loading.empty()))
    throw CLI::ValidationError("TESTS", "a measured curve takes no properties of the elastomer");
  if (options.law == "neo-hookean" && options.stretch_limit)
    throw CLI::ValidationError("--stretch-limit", "belongs to --law gent");
  if (options.prestretch_across && options.loading != "constrained")
    throw CLI::ValidationError("--prestretch-across", "belongs to --loading constrained");
}

struct RelaxationOptions : calibration::RelaxationTask {
  std::string held, output, plot, residuals;
  bool json = false, may_replace = false;
};

int calibrate_relaxation(const RelaxationOptions& options) {
  if (options.tests.empty() && options.creep.empty()) throw CLI::RequiredError("TESTS or --creep");
  check_extension("--output", options.output, {{".yaml", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  check_extension("--residuals", options.residuals, {{".csv", ""}});
  std::vector<fs::path> inputs(options.tests.begin(), options.tests.end());
  inputs.insert(inputs.end(), options.creep.begin(), options.creep.end());
  const std::vector<Output> outputs =
      requested_outputs({{"--output", options.output}, {"--plot", options.plot}, {"--residuals", options.residuals}});
  check_outputs(outputs, inputs, options.may_replace);
  calibration::RelaxationTask task = options;
  task.constants = calibration::read_constants("--constants", options.held);
  const calibration::RelaxationResults results = calibration::evaluate(task);
  const OutputFolders folders(outputs);
  if (!options.output.empty()) write_file(options.output, relaxation_fragment(task, results));
  if (!options.plot.empty()) write_svg(options.plot, relaxation_plot(task, results));
  if (!options.residuals.empty()) write_file(options.residuals, relaxation_table(results).csv());
  print(options.json ? relaxation_json(task, results)
                     : relaxation_text(task, results) + written_text({{"materials", options.output},
                                                                      {"plot", options.plot},
                                                                      {"residuals", options.residuals}}));
  return done;
}

void add_options(CLI::App& command, RelaxationOptions& options) {
  add_value(command, "TESTS", options.tests, "F.csv",
            "Relaxation and cycles, the stretch imposed: columns t_s; strain,\nstrain_percent, stretch or length_mm; "
            "stress_mpa, stress_kpa or\nforce_n, nominal; and if you like run");
  add_repeated(command, "--creep", options.creep, "F.csv", "Creep, the stress imposed: the same columns; repeatable");
  add_value(command, "--law", options.law, "NAME",
            "Of what does not relax: neo-hookean (default), mooney-rivlin,\nyeoh or gent");
  add_value(command, "--constants", options.held, "LIST",
            "Of the law, not to be fitted: c10=0.4,c01=1.9 [MPa];\ngent: shear_modulus=0.02,jm=90 [MPa, -]");
  add_value(command, "--branches", options.branches, "N", "So many (default: as few as the tests carry)",
            integer_from(0, 12));
  add_value(command, "--length", options.size.length_mm, "MM", "Of the specimen at rest [mm], for length_mm",
            positive_number());
  add_value(command, "--area", options.size.area_mm2, "MM2", "Of its cross-section at rest [mm^2], for force_n",
            positive_number());
  add_value(command, "--poisson-ratio", options.poisson_ratio, "NU", "Of the scene, 0 < NU < 0.5 (default: 0.49)",
            CLI::Range(1e-6, 0.499999).description(""));
  add_value(command, "--region", options.region, "NAME", "Of the material in the scene (default: body)");
  add_value(command, "-o,--output", options.output, "F.yaml", "The material, to paste into a scene; printed too");
  add_value(command, "--plot", options.plot, "F.svg", "Measured and fitted");
  add_value(command, "--residuals", options.residuals, "F.csv", "Measured, fitted and their difference, a row each");
  add_overwriting(command, options.may_replace);
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void add_calibrate_dea(CLI::App& calibrate, Run& run) {
  const auto options = std::make_shared<DeaOptions>();
  CLI::App& command =
      *calibrate.add_subcommand("dea", "Area ratio of a dielectric elastomer by its voltage, measured or computed");
  add_options(command, *options);
  command.footer(
      "Area ratios are over the area without voltage. Exit code: 0 done, 2 bad usage or bad input.\nExample:\n"
      "  softkin calibrate dea --law gent --shear-modulus 0.07 --permittivity 4.4 --thickness 0.5 \\\n"
      "      --prestretch 2.5 --stretch-limit 120 -o skin.yaml");
  command.callback([&run, options] {
    check(*options);
    run = [options] { return calibrate_dea(*options); };
  });
}

}  // namespace

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App& calibrate = *app.add_subcommand("calibrate", "Parameters of the model from measurements");
  calibrate.require_subcommand(0, 1);  // "1" would hide the name of one that does not exist
  calibrate.callback([&calibrate] {
    if (calibrate.get_subcommands().empty())
      throw CLI::RequiredError("a subcommand of calibrate (material, robot, relaxation, pressure, dea)");
  });
  calibrate.footer("Example:\n  softkin calibrate material specimens.csv");
  add_calibrate_material(calibrate, run);
  add_calibrate_robot(calibrate, run);
  add_command<RelaxationOptions>(
      calibrate, run, "relaxation",
      "Viscosity from relaxation, creep and cycles of a strip: a law and Maxwell branches",
      "Before its first row a run is at rest, and has been for long. Exit code: 0 done, 2 bad usage or bad input.\n"
      "Example:\n  softkin calibrate relaxation cycles.csv --law gent -o material.yaml --plot fit.svg",
      add_options, calibrate_relaxation);
  add_command<PressureOptions>(
      calibrate, run, "pressure",
      "Volume ratio of a chamber by its pressure, from a syringe test (Fang et al. 2020, Eq. (19))",
      "Rows are in the order of time; where the syringe turns, loading becomes unloading. Exit code: 0 done, 1 the\n"
      "physical formulation has no equilibrium at some ratio, 2 bad usage or bad input.\nExample:\n"
      "  softkin calibrate pressure syringe.csv --scene finger.yaml --syringe-volume 60mL \\\n"
      "      --tube-volume 1.2mL -o air.yaml",
      add_options, calibrate_pressure);
  add_calibrate_dea(calibrate, run);
}

}  // namespace softkin::cli
