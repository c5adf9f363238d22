#include <memory>
#include <softkin/calibration/actuator_tasks.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>

#include "calibrate_command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

struct DeaOptions : calibration::DeaTask {
  std::string output, plot;
  bool json = false;
};

int calibrate_dea(const DeaOptions& options) {
  check_extension("--output", options.output, {{".yaml", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  const std::vector<Output> outputs = asked_outputs({{"--output", options.output}, {"--plot", options.plot}});
  check_outputs(outputs, {options.tests.begin(), options.tests.end()});
  const std::string name = options.output.empty() ? "of the elastomer" : options.output;
  const auto [fitted, head, computed] = calibration::evaluate(options, name);
  const OutputFolders folders(outputs);
  if (!options.output.empty())
    write_file(options.output, actuator_curve_text(fitted.curve, "made by softkin calibrate dea from:\n" + head));
  if (!options.plot.empty()) write_svg(options.plot, calibration::curve_plot(fitted, "area ratio by voltage"));
  if (options.json) {
    print(calibration::dea_json(options.tests, fitted, computed ? &*computed : nullptr));
    return done;
  }
  std::string text =
      head + (computed ? "" : calibration::quality_text(fitted)) + "\n" + calibration::curve_text(fitted.curve);
  if (!options.output.empty())
    text += "\ncurve: " + options.output + " (name it in the scene: curve: FILE; then --set skin=" +
            number(0.5 * fitted.curve.loading.ratio.x().back(), 2) + "kV)\n";
  print(text + written_text({{"plot", options.plot}}));
  return done;
}

void add_options(CLI::App& command, DeaOptions& options) {
  command
      .add_option("TESTS", options.tests,
                  "Measured: columns voltage_kv or voltage_v; area_ratio, or stretch\n(of lengths, alike in both "
                  "directions); and if you like run, t_s")
      ->type_name("F.csv");
  command
      .add_option("--law", options.law,
                  "In place of TESTS, from the equations of state of an\nequal-biaxial elastomer: neo-hookean or gent")
      ->type_name("NAME")
      ->check(CLI::IsMember({"neo-hookean", "gent"}).description(""));
  const auto add = [&](const char* name, std::optional<double>& value, const char* what, const char* unit) {
    command.add_option(name, value, what)->type_name(unit)->check(positive_number());
  };
  add("--shear-modulus", options.shear_modulus_MPa, "mu at small strain, a third of Young's modulus [MPa]", "MPA");
  add("--permittivity", options.permittivity, "Relative to vacuum", "NUMBER");
  add("--thickness", options.thickness_mm, "Before any stretch [mm]", "MM");
  add("--prestretch", options.prestretch, "Length without voltage over that without forces (default: 1)", "RATIO");
  add("--stretch-limit", options.stretch_limit, "gent: J_lim, limit of l1^2 + l2^2 + l3^2 - 3", "NUMBER");
  add("--breakdown-field", options.breakdown_kV_mm, "True field at which the curve ends at the latest [kV/mm]",
      "KV_MM");
  command.add_option("-o,--output", options.output, "The curve, for key 'curve' of the scene's actuator")
      ->type_name("F.yaml");
  command.add_option("--plot", options.plot, "Rows and branches")->type_name("F.svg");
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void check(const DeaOptions& options) {
  if (options.tests.empty() == options.law.empty())
    throw CLI::ValidationError("TESTS", "give either measured tests or --law");
  if (options.law.empty() && (options.permittivity || options.thickness_mm || options.shear_modulus_MPa ||
                              options.prestretch || options.stretch_limit || options.breakdown_kV_mm))
    throw CLI::ValidationError("TESTS", "a measured curve takes no properties of the elastomer");
  if (options.law == "neo-hookean" && options.stretch_limit)
    throw CLI::ValidationError("--stretch-limit", "belongs to --law gent");
}

}  // namespace

void add_calibrate_dea(CLI::App& calibrate, Run& run) {
  const auto options = std::make_shared<DeaOptions>();
  CLI::App& command =
      *calibrate.add_subcommand("dea", "Area ratio of a dielectric elastomer by its voltage, measured or computed");
  add_options(command, *options);
  command.footer(
      "Area ratios are over the area without voltage. Exit code: 0 done, 2 bad usage or bad input.\nExample:\n"
      "  softkin calibrate dea --law gent --shear-modulus 0.07 --permittivity 4.4 --thickness 0.5 --prestretch 2.5 \\\n"
      "      --stretch-limit 120 -o skin.yaml");
  command.callback([&run, options] {
    check(*options);
    run = [options] { return calibrate_dea(*options); };
  });
}

}  // namespace softkin::cli
