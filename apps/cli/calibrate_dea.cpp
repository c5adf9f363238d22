#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cmath>
#include <memory>
#include <softkin/calibration/curve_report.hpp>
#include <softkin/calibration/voltage.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/io/table/actuator_tests.hpp>

#include "calibrate_command.hpp"
#include "printing.hpp"
#include "solve_options.hpp"

namespace softkin::cli {

namespace {

constexpr int curve_points = 65;
constexpr double rest_remark = 1e-3;  // from 1, beyond which the table's area ratio without voltage is told

struct DeaOptions {
  std::vector<std::string> tests;
  std::string law;
  std::optional<double> permittivity, thickness_mm, shear_modulus_MPa, prestretch, stretch_limit, breakdown_kV_mm;
  std::string output, plot;
  bool json = false;
};

/// A curve and what is told of it.
struct DeaResult {
  calibration::FittedCurve fitted;
  std::string head;
  std::optional<calibration::DielectricCurve> computed{};
};

DeaResult measured(const DeaOptions& options, const std::string& name) {
  std::vector<VoltageRun> runs;
  std::string head;
  for (const std::string& file : options.tests) {
    const std::vector<VoltageRun> more = read_voltage_runs(file);
    std::size_t rows = 0;
    for (const VoltageRun& run : more) rows += run.rows.size();
    head += file + ": " + counted(more.size(), "run") + ", " + counted(rows, "row") + "\n";
    runs.insert(runs.end(), more.begin(), more.end());
  }
  calibration::VoltageSamples samples = calibration::voltage_samples(runs);
  for (std::size_t r = 0; r < runs.size(); ++r)
    if (std::abs(samples.rest_ratios[r] - 1) > rest_remark)
      head += runs[r].file + ", " + runs[r].name + ": area ratio without voltage " + number(samples.rest_ratios[r], 5) +
              "; the others are taken over it\n";
  return {calibration::fitted_curve(name, CurveInput::voltage, 100, std::move(samples.samples)), head};
}

calibration::Dielectric elastomer_of(const DeaOptions& options) {
  calibration::Dielectric d;
  d.law = options.law == "gent" ? calibration::DielectricLaw::gent : calibration::DielectricLaw::neo_hookean;
  const auto need = [&](const std::optional<double>& value, const char* option) {
    if (!value) throw InvalidInput("--law " + options.law + " needs " + option);
    return *value;
  };
  d.shear_modulus_MPa = need(options.shear_modulus_MPa, "--shear-modulus");
  d.relative_permittivity = need(options.permittivity, "--permittivity");
  d.thickness_mm = need(options.thickness_mm, "--thickness");
  d.prestretch = options.prestretch.value_or(1);
  if (d.law == calibration::DielectricLaw::gent) d.stretch_limit = need(options.stretch_limit, "--stretch-limit");
  return d;
}

std::string elastomer_text(const DeaOptions& options, const calibration::Dielectric& d) {
  std::string text = options.law + " elastomer in equal-biaxial tension: shear modulus " + number(d.shear_modulus_MPa) +
                     " MPa, relative permittivity " + number(d.relative_permittivity) + ", " + number(d.thickness_mm) +
                     " mm thick before any stretch, prestretch " + number(d.prestretch) +
                     (options.prestretch ? "" : " (default)");
  if (d.law == calibration::DielectricLaw::gent) text += ", J_lim " + number(d.stretch_limit);
  return text + "; constant forces at its edge\n";
}

std::string pull_in_text(const calibration::Dielectric& d, const calibration::PullIn& pull_in) {
  return "pull-in at " + number(pull_in.voltage_kV, 5) + " kV: stretch " + number(pull_in.stretch, 5) +
         " (area ratio " + number(std::pow(pull_in.stretch / d.prestretch, 2), 5) +
         " to that without voltage), field " + number(pull_in.field_kV_mm, 4) +
         " kV/mm; beyond it no equilibrium follows\n";
}

DeaResult computed(const DeaOptions& options, const std::string& name) {
  const calibration::Dielectric d = elastomer_of(options);
  const calibration::DielectricCurve curve =
      calibration::dielectric_curve(d, curve_points, options.breakdown_kV_mm.value_or(0));
  std::string head = elastomer_text(options, d);
  head += curve.pull_in ? pull_in_text(d, *curve.pull_in)
                        : "no pull-in: the voltage rises up to 95 % of the limit of the chains\n";
  if (curve.broken_down)
    head += "breakdown field of " + number(*options.breakdown_kV_mm) + " kV/mm reached at " +
            number(curve.voltages.back(), 5) + " kV, " + (curve.pull_in ? "before pull-in" : "and") +
            ": the curve ends there\n";
  else
    head += "true field at the end of the curve: " + number(curve.end_field_kV_mm, 4) + " kV/mm" +
            (options.breakdown_kV_mm ? "" : " (no --breakdown-field given: not checked)") + "\n";
  const std::string end = curve.broken_down ? "breakdown" : curve.pull_in ? "pull-in" : "the limit of the chains";
  const CurveBranch branch{MonotoneCurve(curve.voltages, curve.area_ratios), {}};
  return {{{name, CurveInput::voltage, 100, end, branch, std::nullopt}}, head, curve};
}

int calibrate_dea(const DeaOptions& options) {
  check_extension("--output", options.output, {{".yaml", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  const std::vector<Output> outputs = asked_outputs({{"--output", options.output}, {"--plot", options.plot}});
  check_outputs(outputs, {options.tests.begin(), options.tests.end()});
  const std::string name = options.output.empty() ? "of the elastomer" : options.output;
  const auto [fitted, head, computed_curve] = options.tests.empty() ? computed(options, name) : measured(options, name);
  const OutputFolders folders(outputs);
  if (!options.output.empty())
    write_file(options.output, actuator_curve_text(fitted.curve, "made by softkin calibrate dea from:\n" + head));
  if (!options.plot.empty()) write_svg(options.plot, calibration::curve_plot(fitted, "area ratio by voltage"));
  if (options.json) {
    print(calibration::dea_json(options.tests, fitted, computed_curve ? &*computed_curve : nullptr));
    return done;
  }
  std::string text =
      head + (computed_curve ? "" : calibration::quality_text(fitted)) + "\n" + calibration::curve_text(fitted.curve);
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
