#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <memory>

#include "calibrate_command.hpp"
#include "calibrate_curve.hpp"
#include "calibrate_pressure.hpp"

namespace softkin::cli {

namespace {

void add_test(CLI::App& command, PressureOptions& options) {
  command
      .add_option("TESTS", options.tests,
                  "Syringe tests: columns p_abs_kpa or p_gauge_kpa (p_kpa with\n--pressure), dv_sy_mm3 or dv_sy_ml "
                  "(air pushed out of the syringe\nsince the start), and if you like run and t_s")
      ->type_name("F.csv")
      ->required();
  command.add_option("--pressure", options.scale, "Of column p_kpa: absolute (above vacuum) or gauge")
      ->type_name("SCALE")
      ->check(CLI::IsMember({"absolute", "gauge"}).description(""));
  command.add_option("--scene", options.scene, "The robot; its mesh gives the chamber's volume at rest, V_c0")
      ->type_name("SCENE");
  command
      .add_option("--actuator", options.actuator, "With --scene: the chamber that was tested (default: the only one)")
      ->type_name("NAME");
  command.add_option("--chamber-volume", options.chamber, "V_c0, in place of that of the mesh, with its unit: 21mL")
      ->type_name("VOLUME");
  command.add_option("--syringe-volume", options.syringe, "V_sy0, air in the syringe at the start: 60mL, 60000mm3")
      ->type_name("VOLUME")
      ->required();
  command.add_option("--tube-volume", options.tube, "V_t, air in tubes and sensor (default: 0)")->type_name("VOLUME");
  command
      .add_option("--atmosphere", options.atmosphere_kPa,
                  "Pressure of the air around, absolute [kPa] (default: 100, as in\nthe paper)")
      ->type_name("KPA")
      ->check(positive_number());
}

void add_results(CLI::App& command, PressureOptions& options) {
  command.add_option("-o,--output", options.output, "The curve, for key 'curve' of the scene's actuator")
      ->type_name("F.yaml");
  command.add_option("--table", options.table, "Volume ratio of every row")->type_name("F.csv");
  command.add_option("--plot", options.plot, "Rows and both branches")->type_name("F.svg");
  command.add_flag("--predict", options.predict,
                   "With --scene: the pressures of the physical formulation beside\nthe measured ones, and the factor "
                   "of Young's modulus between them");
  command.add_option("--threads", options.threads, "Of --predict; 0: as many as the machine has (default)")
      ->type_name("N")
      ->check(CLI::Range(0, 512).description(""));
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void check(const PressureOptions& options) {
  check_ending("--output", options.output, ".yaml");
  check_ending("--table", options.table, ".csv");
  check_ending("--plot", options.plot, ".svg");
  if (options.predict && options.scene.empty())
    throw CLI::ValidationError("--predict", "give --scene too, whose robot is to be predicted");
  if (!options.actuator.empty() && options.scene.empty())
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
      return calibrate_pressure(*options);
    };
  });
}

}  // namespace softkin::cli
