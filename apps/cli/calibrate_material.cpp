#include "calibrate_material.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <memory>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/scanner.hpp>

#include "calibrate_command.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

using Shared = std::shared_ptr<MaterialOptions>;

/// A finite number, low < x < high, or also equal to them where closed.
CLI::Validator real_number(double low, double high, bool low_too = false, bool high_too = false) {
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0;
    const bool is = parse_real(text, value);
    if (is && (value > low || (low_too && value == low)) && (value < high || (high_too && value == high))) return "";
    const std::string above = (low_too ? "at least " : "greater than ") + number(low);
    return "must be a number " + above +
           (high < 1e9 ? (high_too ? " and at most " : " and less than ") + number(high) : "") + ", not " + text;
  };
  return CLI::Validator(check, "");
}

CLI::Validator positive() {
  return real_number(0, 1e9);
}

void add_inputs(CLI::App& command, MaterialOptions& options) {
  command
      .add_option(
          "SPECIMENS", options.specimens,
          "Stretched bars of two materials, a row each: l_mm, l1_mm, dl_mm,\ndl1_mm; force_n and area_mm2 where "
          "measured")
      ->type_name("F.csv");
  command
      .add_option("--tensile", options.tensile,
                  "In place of SPECIMENS: the tensile test of one material, columns\nstrain or strain_percent, and "
                  "stress_mpa; both nominal")
      ->type_name("F.csv");
  command
      .add_option("--twist", options.twist,
                  "With SPECIMENS, to validate: l_mm, l1_mm, twist_deg of the free\nend; interface_deg where measured")
      ->type_name("F.csv");
}

void add_outputs(CLI::App& command, MaterialOptions& options) {
  command.add_option("-o,--output", options.fragment, "The materials, to paste into a scene; printed in any case")
      ->type_name("F.yaml");
  command.add_option("--plot", options.plot, "Measured and fitted")->type_name("F.svg");
  command.add_option("--residuals", options.residuals, "Measured, fitted and their difference, a row each")
      ->type_name("F.csv");
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void add_set_up(CLI::App& command, MaterialOptions& options) {
  calibration::SpecimenOptions& s = options.specimen;
  command
      .add_option("--formulation", options.formulation,
                  "physical: E_A / E_B; target-shape: R_omega (Fang et al. 2020);\ndefault: both")
      ->type_name("NAME")
      ->check(CLI::IsMember({"physical", "target-shape"}).description(""));
  command.add_option("--width", s.width_mm, "Of the specimens' cross-section [mm] (default: 20)")
      ->type_name("MM")
      ->check(positive());
  command.add_option("--height", s.height_mm, "Of the specimens' cross-section [mm] (default: 10)")
      ->type_name("MM")
      ->check(positive());
  command
      .add_option("--grip", options.grip,
                  "clamped (default): the ends keep their cross-section; sliding:\nthey are free to contract")
      ->type_name("NAME")
      ->check(CLI::IsMember({"clamped", "sliding"}).description(""));
  command.add_option("--poisson-ratio", s.poisson_ratio, "Of the physical materials, -1 < NU < 0.5 (default: 0.45)")
      ->type_name("NU")
      ->check(real_number(-1, 0.5));
  command
      .add_option("--stiffer", s.stiffer_shape_ratio,
                  "R_omega of the stiffer material, 0 < R <= 1 (default: 1);\n(1 - 2 NU) / (1 + NU) has its Poisson's "
                  "ratio")
      ->type_name("R")
      ->check(real_number(0, 1, false, true));
  command
      .add_option("--cells", s.cells,
                  "Of the simulated specimens' mesh, across their height\n(default: 3 physical, 4 target-shape)")
      ->type_name("N")
      ->check(CLI::Range(1, 40).description(""));
  command.add_option("--modulus-b", options.modulus_b, "Young's modulus of B, where no force was measured [MPa]")
      ->type_name("MPA")
      ->check(positive());
  command.add_option("--try", options.tried, "Look at this R_omega A / R_omega B too, found elsewhere; repeatable")
      ->type_name("RATIO")
      ->expected(1)
      ->take_all()
      ->check(real_number(1e-4, 1e4, true, true));
  command.add_option("--regions", options.regions, "Names of A and B in the scene (default: A B)")
      ->type_name("A B")
      ->expected(2);
  command.add_option("--threads", s.statics.threads, "0: as many as the machine has (default)")
      ->type_name("N")
      ->check(CLI::Range(0, 512).description(""));
}

void add_tensile(CLI::App& command, MaterialOptions& options) {
  command
      .add_option(
          "--law", options.law,
          "Of the simulated specimens: neo-hookean (default), corotational,\nst-venant-kirchhoff; with --tensile, "
          "of the scene: linear,\nneo-hookean, mooney-rivlin, yeoh (default: the fewest constants\nthat are off "
          "by 1 % of the largest stress at most (rms), else\nthe best)")
      ->type_name("NAME");
  command
      .add_option(
          "--linear-tolerance", options.tolerance_percent,
          "--tensile: the linear range ends where a stress is off the line\nthrough the origin by more than this "
          "share of the line's stress\nat the end [%] (default: 5)")
      ->type_name("PERCENT")
      ->check(real_number(0, 100));
  command
      .add_option("--up-to", options.most_strain, "--tensile: strain up to which laws are fitted [-] (default: all)")
      ->type_name("STRAIN")
      ->check(real_number(0, 15));
  command
      .add_option("--region", options.region, "--tensile: name of the material's region in the scene (default: body)")
      ->type_name("NAME");
}

Law law_of(const std::string& name) {
  if (name == "corotational") return Law::corotational;
  if (name == "st-venant-kirchhoff") return Law::st_venant_kirchhoff;
  return Law::neo_hookean;
}

void check_extension(const std::string& option, const std::string& file, const std::string& extension) {
  if (!file.empty() && lower_extension(file) != extension)
    throw CLI::ValidationError(option, "must end in " + extension);
}

void check_law(const MaterialOptions& options, const std::vector<std::string>& known) {
  if (options.law.empty() || std::find(known.begin(), known.end(), options.law) != known.end()) return;
  throw CLI::ValidationError("--law", "'" + options.law + "' is none of those that " +
                                          (options.tensile.empty() ? "take E and nu" : "a tensile test is fitted by") +
                                          suggest_name(options.law, known));
}

void check_belonging(const MaterialOptions& options, const std::vector<std::string>& foreign, const char* why) {
  for (const std::string& option : foreign)
    if (options.given.contains(option)) throw CLI::ValidationError(option, why);
}

void check_names(const std::vector<std::string>& names, const char* option) {
  for (const std::string& name : names)
    if (name.empty() || name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.") !=
                            std::string::npos)
      throw CLI::ValidationError(option, "a region's name is made of letters, digits, '_', '-' and '.'");
}

void check(MaterialOptions& options) {
  if (options.specimens.empty() == options.tensile.empty())
    throw CLI::ValidationError("SPECIMENS, --tensile", "give one of the two");
  check_extension("--output", options.fragment, ".yaml");
  check_extension("--plot", options.plot, ".svg");
  check_extension("--residuals", options.residuals, ".csv");
  check_names(options.regions, "--regions");
  check_names({options.region}, "--region");
  if (!options.tensile.empty()) {
    check_law(options, {"linear", "neo-hookean", "mooney-rivlin", "yeoh"});
    return check_belonging(options,
                           {"--twist", "--formulation", "--width", "--height", "--grip", "--stiffer", "--cells",
                            "--modulus-b", "--try", "--regions", "--threads"},
                           "is of specimens of two materials: it does not go with --tensile");
  }
  check_law(options, {"neo-hookean", "corotational", "st-venant-kirchhoff"});
  check_belonging(options, {"--linear-tolerance", "--up-to", "--region"}, "needs --tensile");
  if (options.formulation == "physical")
    check_belonging(options, {"--stiffer", "--try"}, "is of target shapes: it does not go with --formulation physical");
  if (options.regions[0] == options.regions[1]) throw CLI::ValidationError("--regions", "the two are one");
  options.specimen.grip = options.grip == "sliding" ? calibration::Grip::sliding : calibration::Grip::clamped;
  options.specimen.law = law_of(options.law);
}

}  // namespace

std::vector<Output> MaterialOptions::outputs() const {
  std::vector<Output> all;
  const auto add = [&](const char* option, const std::string& file) {
    if (!file.empty()) all.push_back({option, file, 0});
  };
  add("--output", fragment);
  add("--plot", plot);
  add("--residuals", residuals);
  return all;
}

std::vector<std::filesystem::path> MaterialOptions::inputs() const {
  std::vector<std::filesystem::path> all;
  for (const std::string& file : {specimens, twist, tensile})
    if (!file.empty()) all.push_back(file);
  return all;
}

std::string MaterialOptions::unless_given(const std::string& option) const {
  return given.contains(option) ? "" : " (default)";
}

void add_calibrate_material(CLI::App& calibrate, Run& run) {
  const auto options = std::make_shared<MaterialOptions>();
  CLI::App& command = *calibrate.add_subcommand(
      "material", "R_omega and Young's moduli from stretched bars of two materials, or laws from a tensile test");
  add_inputs(command, *options);
  add_outputs(command, *options);
  add_set_up(command, *options);
  add_tensile(command, *options);
  command.footer(
      "A is the material at the fixed end, L1 the distance of the interface from it, dL the displacement of the free\n"
      "end, dL1 that of the interface. Exit code: 0 done, 1 a simulated test did not converge or no ratio fits, 2 bad\n"
      "usage or bad input.\n"
      "Examples:\n"
      "  softkin calibrate material specimens.csv --twist twist.csv --plot fit.svg\n"
      "  softkin calibrate material --tensile test.csv -o material.yaml");
  command.callback([&run, &command, options] {
    for (const CLI::Option* option : command.get_options())
      if (option->count() > 0) options->given.insert(option->get_name());
    check(*options);
    run = [options] { return options->tensile.empty() ? calibrate_specimens(*options) : calibrate_tensile(*options); };
  });
}

}  // namespace softkin::cli
