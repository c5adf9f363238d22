#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>
#include <softkin/calibration/specimen_report.hpp>
#include <softkin/calibration/tensile_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/measurements.hpp>
#include <softkin/io/table/tensile_file.hpp>
#include <softkin/model/names.hpp>

#include "command.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

/// The options of `softkin calibrate material`. An empty text: not given.
struct MaterialOptions {
  calibration::SpecimenTask task;
  calibration::TensileTask tensile;
  std::vector<std::string> tensile_files;
  TensileLayout layout;
  std::string branch, zero;
  bool true_measures = false;
  std::string fragment, plot, residuals;  // outputs
  std::string formulation;                // empty: both
  std::string law;                        // empty: neo-hookean, or with --tensile the one that fits
  std::string grip = "clamped";
  std::vector<std::string> regions{"A", "B"};
  bool json = false, resume = false, may_replace = false, allow_unstable = false;
  std::set<std::string> given;  // options that the user gave

  [[nodiscard]] std::vector<Output> outputs() const {
    return requested_outputs({{"--output", fragment}, {"--plot", plot}, {"--residuals", residuals}});
  }
  /// " (default)" where the option was not given.
  [[nodiscard]] std::string unless_given(const std::string& option) const {
    return given.contains(option) ? "" : " (default)";
  }
};

/// A finite number, low < x < high, or also equal to them where closed.
CLI::Validator real_number(double low, double high, bool low_too = false, bool high_too = false) {
  const std::string below = high < 1e9 ? (high_too ? " and at most " : " and less than ") + number(high) : "";
  return must_be((low_too ? "a number at least " : "a number greater than ") + number(low) + below,
                 [=](const std::string& text) {
                   double value = 0;
                   return parse_real(text, value) && (value > low || (low_too && value == low)) &&
                          (value < high || (high_too && value == high));
                 });
}

void add_inputs(CLI::App& command, MaterialOptions& options) {
  add_value(
      command, "SPECIMENS", options.task.file, "F.csv",
      "Stretched bars of two materials, a row each: l_mm, l1_mm, dl_mm,\ndl1_mm; force_n and area_mm2 where measured");
  add_value(command, "--tensile", options.tensile_files, "F.csv...",
            "In place of SPECIMENS: the tensile test of one material, columns\nstrain or strain_percent, and "
            "stress_mpa, both nominal; or the file\nof a testing machine. Several: their fits side by side")
      ->expected(1, 1000);
  add_value(command, "--twist", options.task.twist_file, "F.csv",
            "With SPECIMENS, to validate: l_mm, l1_mm, twist_deg of the free\nend; interface_deg where measured");
}

void add_outputs(CLI::App& command, MaterialOptions& options) {
  add_value(command, "-o,--output", options.fragment, "F.yaml",
            "The materials, to paste into a scene; printed in any case");
  add_value(command, "--plot", options.plot, "F.svg", "Measured and fitted");
  add_value(command, "--residuals", options.residuals, "F.csv", "Measured, fitted and their difference, a row each");
  add_overwriting(command, options.may_replace);
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
  command.add_flag("--resume", options.resume,
                   "Go on where the same command was interrupted or killed; needs\n--output");
}

void add_set_up(CLI::App& command, MaterialOptions& options) {
  calibration::SpecimenOptions& s = options.task.options;
  add_value(command, "--formulation", options.formulation, "NAME",
            "physical: E_A / E_B; target-shape: R_omega (Fang et al. 2020);\ndefault: both",
            one_of({"physical", "target-shape"}));
  add_value(command, "--width", s.width_mm, "MM", "Of the specimens' cross-section [mm] (default: 20)",
            real_number(0, 1e9));
  add_value(command, "--height", s.height_mm, "MM", "Of the specimens' cross-section [mm] (default: 10)",
            real_number(0, 1e9));
  add_value(command, "--grip", options.grip, "NAME",
            "clamped (default): the ends keep their cross-section; sliding:\nthey are free to contract",
            one_of({"clamped", "sliding"}));
  add_value(command, "--poisson-ratio", s.poisson_ratio, "NU",
            "Of the physical materials, -1 < NU < 0.5 (default: 0.45)", real_number(-1, 0.5));
  add_value(command, "--stiffer", s.stiffer_shape_ratio, "R",
            "R_omega of the stiffer material, 0 < R <= 1 (default: 1);\n(1 - 2 NU) / (1 + NU) has its Poisson's ratio",
            real_number(0, 1, false, true));
  add_value(command, "--cells", s.cells, "N",
            "Of the simulated specimens' mesh, across their height\n(default: 3 physical, 4 target-shape)",
            CLI::Range(1, 40).description(""));
  add_value(command, "--modulus-b", options.task.modulus_b, "MPA",
            "Young's modulus of B, where no force was measured [MPa]", real_number(0, 1e9));
  add_value(command, "--try", options.task.tried, "RATIO",
            "Look at this R_omega A / R_omega B too, found elsewhere; repeatable", real_number(1e-4, 1e4, true, true))
      ->expected(1)
      ->take_all();
  add_value(command, "--regions", options.regions, "A B", "Names of A and B in the scene (default: A B)")->expected(2);
  add_value(command, "--threads", s.statics.threads, "N", "0: as many as the machine has (default)",
            CLI::Range(0, 512).description(""));
}

void add_tensile(CLI::App& command, MaterialOptions& options) {
  add_value(
      command, "--law", options.law, "NAME",
      "Of the simulated specimens: neo-hookean (default), corotational,\nst-venant-kirchhoff; with --tensile, of "
      "the scene: linear,\nneo-hookean, mooney-rivlin, yeoh, gent, ogden-1, ogden-2, ogden-3,\nogden: the first of "
      "these "
      "three that fits (default: the first law\nthat is off by 1 % of the largest stress at most (rms), else\nthe "
      "best)");
  add_value(command, "--linear-tolerance", options.tensile.tolerance_percent, "PERCENT",
            "--tensile: the linear range ends where a stress is off the line\nthrough the origin by more than this "
            "fraction of the line's stress\nat the end [%] (default: 5)",
            real_number(0, 100));
  add_value(command, "--up-to", options.tensile.max_strain, "STRAIN",
            "--tensile: strain up to which laws are fitted [-] (default: all)", real_number(0, 15));
  command.add_flag(
      "--allow-unstable", options.allow_unstable,
      "--tensile: fit mooney-rivlin and yeoh without the condition that\nthey are stable up to the largest "
      "strain that is fitted");
  add_value(command, "--strain-column", options.layout.strain_column, "NAME",
            "--tensile: the column of the strain, stretch or elongation, where\nits name does not show it");
  add_value(command, "--stress-column", options.layout.stress_column, "NAME",
            "--tensile: the column of the stress or force");
  add_value(command, "--strain-unit", options.layout.strain_unit, "UNIT",
            "--tensile: of that column, where its name does not state it:\n-, %; of an elongation mm, cm, m, um, in");
  add_value(command, "--stress-unit", options.layout.stress_unit, "UNIT",
            "--tensile: of that column: MPa, kPa, Pa, GPa, N/mm2, psi, ksi, bar;\nof a force N, kN, mN, lbf, gf, kgf");
  command.add_flag("--true-measures", options.true_measures,
                   "--tensile: the columns that are named hold true strain and true\nstress, not nominal ones");
  add_value(command, "--length", options.layout.length_mm, "MM",
            "--tensile: of the specimen between the gauge marks at rest, for\nelongations [mm]", real_number(0, 1e9));
  add_value(command, "--area", options.layout.area_mm2, "MM2",
            "--tensile: of the specimen's cross-section at rest, for forces\n[mm^2]", real_number(0, 1e9));
  add_value(
      command, "--branch", options.branch, "NAME",
      "--tensile: of cyclic tests: envelope (default): rows whose strain\nexceeds all before; first: the loading of "
      "the first cycle; last: that\nof the last one",
      one_of({"envelope", "first", "last"}));
  add_value(
      command, "--zero", options.zero, "NAME",
      "--tensile: where the strain is 0: file (default): as the file has it;\nfirst: at the first row, whose stress "
      "is taken off; toe: where the\nline through the beginning has no stress, which takes out slack and\npreload",
      one_of({"file", "first", "toe"}));
  add_value(command, "--region", options.tensile.region, "NAME",
            "--tensile: name of the material's region in the scene (default: body)");
}

void must_end_in(const std::string& option, const std::string& file, const std::string& extension) {
  if (!file.empty() && lower_extension(file) != extension)
    throw CLI::ValidationError(option, "must end in " + extension);
}

void check_law(const MaterialOptions& options, const std::vector<std::string>& known) {
  if (options.law.empty() || std::find(known.begin(), known.end(), options.law) != known.end()) return;
  throw CLI::ValidationError("--law",
                             "'" + options.law + "' is none of those that " +
                                 (options.tensile.file.empty() ? "take E and nu" : "a tensile test is fitted by") +
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
  if (!options.tensile_files.empty()) options.tensile.file = options.tensile_files.front();
  if (options.task.file.empty() == options.tensile.file.empty())
    throw CLI::ValidationError("SPECIMENS, --tensile", "give one of the two");
  must_end_in("--output", options.fragment, ".yaml");
  must_end_in("--plot", options.plot, ".svg");
  must_end_in("--residuals", options.residuals, ".csv");
  check_names(options.regions, "--regions");
  check_names({options.tensile.region}, "--region");
  if (options.resume && options.fragment.empty())
    throw CLI::ValidationError("--resume", "needs the --output of the run that was interrupted");
  if (!options.tensile.file.empty()) {
    std::vector<std::string> laws{"linear", "ogden"};
    for (const calibration::LawChoice& each : calibration::fitted_laws()) laws.push_back(each.name());
    check_law(options, laws);
    if (options.tensile_files.size() > 1)
      check_belonging(options, {"--output", "--plot", "--residuals"}, "is of one test: give one file to --tensile");
    return check_belonging(options,
                           {"--twist", "--formulation", "--width", "--height", "--grip", "--stiffer", "--cells",
                            "--modulus-b", "--try", "--regions", "--threads", "--resume"},
                           "is of specimens of two materials: it does not go with --tensile");
  }
  check_law(options, {"neo-hookean", "corotational", "st-venant-kirchhoff"});
  check_belonging(
      options,
      {"--linear-tolerance", "--up-to", "--region", "--allow-unstable", "--strain-column", "--stress-column",
       "--strain-unit", "--stress-unit", "--true-measures", "--length", "--area", "--branch", "--zero"},
      "needs --tensile");
  if (options.formulation == "physical")
    check_belonging(options, {"--stiffer", "--try"}, "is of target shapes: it does not go with --formulation physical");
  if (options.regions[0] == options.regions[1]) throw CLI::ValidationError("--regions", "the two are one");
}

/// The tasks as the options have them.
void take(MaterialOptions& options) {
  calibration::SpecimenTask& task = options.task;
  task.options.grip = options.grip == "sliding" ? calibration::Grip::sliding : calibration::Grip::clamped;
  for (const Law law : {Law::corotational, Law::st_venant_kirchhoff})
    if (options.law == law_name(law)) task.options.law = law;
  task.physical = options.formulation != "target-shape";
  task.target_shape = options.formulation != "physical";
  task.regions = {options.regions[0], options.regions[1]};
  task.set_up = set_up_lines(task, [&](const std::string& option) { return options.unless_given(option); });
  options.tensile.law = options.law;
  options.tensile.stable = !options.allow_unstable;
  TensileLayout& layout = options.layout;
  layout.true_strain = layout.true_stress = options.true_measures;
  layout.branch = options.branch == "first"  ? TensileBranch::first
                  : options.branch == "last" ? TensileBranch::last
                                             : TensileBranch::envelope;
  layout.zero = options.zero == "first" ? TensileZero::first
                : options.zero == "toe" ? TensileZero::toe
                                        : TensileZero::file;
  options.tensile.poisson_ratio = task.options.poisson_ratio;
}

void check_forces(const MaterialOptions& options, const std::vector<StretchedSpecimen>& specimens) {
  const bool any_force =
      std::any_of(specimens.begin(), specimens.end(), [](const auto& s) { return s.force_n.has_value(); });
  calibration::check_modulus_b(options.task, specimens);
  if (!options.task.target_shape && !options.fragment.empty() && !any_force && !options.task.modulus_b)
    throw InvalidInput("--output " + options.fragment + ": materials of the physical formulation need a modulus; " +
                       options.task.file + " has no column force_n: add it, or give --modulus-b");
}

void write(const MaterialOptions& options, const std::string& fragment, const Plot& plot, const Table& residuals) {
  if (!options.fragment.empty()) write_file(options.fragment, fragment);
  if (!options.plot.empty()) write_svg(options.plot, plot);
  if (!options.residuals.empty()) write_file(options.residuals, residuals.csv());
}

std::string files_text(const MaterialOptions& options) {
  return written_text({{"materials", options.fragment}, {"plot", options.plot}, {"residuals", options.residuals}});
}

int calibrate_specimens(const MaterialOptions& options) {
  calibration::SpecimenTask task = options.task;
  std::vector<StretchedSpecimen> specimens = read_stretched_specimens(task.file);
  std::vector<TwistedSpecimen> twists;
  std::vector<std::filesystem::path> inputs{task.file};
  if (!task.twist_file.empty()) {
    twists = read_twisted_specimens(task.twist_file);
    inputs.emplace_back(task.twist_file);
  }
  check_forces(options, specimens);
  check_outputs(options.outputs(), inputs, options.may_replace);
  const OutputFolders folders(options.outputs());
  if (const std::string doubt = calibration::doubt_about_areas(task, specimens); !doubt.empty())
    std::fprintf(stderr, "softkin: %s\n", doubt.c_str());
  const std::string journal = options.fragment.empty() ? "" : options.fragment + ".run";
  calibration::TestLog log(journal, tests_set_up(task, specimens, twists), options.resume);
  const std::size_t all = number_of_tests(task, specimens.size(), twists.size());
  if (options.resume && !options.json) print(resumed_text(log.size(), all, "simulated test") + "\n");
  catch_interrupt();
  task.options.log = &log;
  task.options.go_on = [] { return !interrupted(); };
  ProgressLine line;
  const calibration::SpecimenResults results =
      calibration::evaluate(task, std::move(specimens), std::move(twists),
                            [&](const std::string& what, double fraction) { line.show(fraction, what); });
  line.clear();
  if (results.interrupted) return report_stopped({log.size(), all, "simulated test", journal, !journal.empty()});
  const std::string failure = calibration::failure(task, results);
  if (failure.empty())
    write(options, specimens_fragment(task, results), specimens_plot(task, results), residual_table(results));
  print(options.json ? specimens_json(task, results)
                     : specimens_text(task, results) + (failure.empty() ? files_text(options) : ""));
  log.remove();
  if (failure.empty()) return done;
  std::fprintf(stderr, "softkin: %s%s\n", failure.c_str(), options.outputs().empty() ? "" : "; no file was written");
  return not_converged;
}

/// The test; files of testing machines, and any that options of the layout are given for, by their layout.
TensileCurve read_test(const MaterialOptions& options, const std::string& file) {
  const bool by_layout = std::any_of(options.given.begin(), options.given.end(), [](const std::string& option) {
    return option == "--strain-column" || option == "--stress-column" || option == "--strain-unit" ||
           option == "--stress-unit" || option == "--length" || option == "--area" || option == "--branch" ||
           option == "--zero";
  });
  return by_layout ? read_tensile_file(file, options.layout) : read_tensile_curve(file);
}

/// Several tests side by side.
int compare_tensile(const MaterialOptions& options) {
  std::vector<std::pair<calibration::TensileTask, calibration::TensileResults>> tests;
  catch_interrupt();
  ProgressLine line;
  for (const std::string& file : options.tensile_files) {
    if (interrupted()) break;
    line.show(static_cast<double>(tests.size()) / static_cast<double>(options.tensile_files.size()), file);
    calibration::TensileTask task = options.tensile;
    task.file = file;
    tests.emplace_back(task, calibration::evaluate(task, read_test(options, file)));
  }
  line.clear();
  print(options.json ? calibration::tensile_comparison_json(tests) : calibration::tensile_comparison(tests));
  return interrupted() ? not_converged : done;
}

int calibrate_tensile(const MaterialOptions& options) {
  if (options.tensile_files.size() > 1) return compare_tensile(options);
  const calibration::TensileTask& task = options.tensile;
  TensileCurve curve = read_test(options, task.file);
  check_outputs(options.outputs(), {task.file}, options.may_replace);
  const calibration::TensileResults results = calibration::evaluate(task, std::move(curve));
  const OutputFolders folders(options.outputs());
  write(options, tensile_fragment(task, results), tensile_plot(task, results), residual_table(results));
  const std::vector<double>& strain = results.curve.strain;
  print(options.json
            ? tensile_json(task, results)
            : task.file + ": " + counted(strain.size(), "point") + " up to a strain of " + number(strain.back(), 4) +
                  "; Poisson's ratio " + number(task.poisson_ratio) + options.unless_given("--poisson-ratio") +
                  ", tolerance " + number(task.tolerance_percent) + " %" + options.unless_given("--linear-tolerance") +
                  ", laws up to a strain of " + number(task.max_strain > 0 ? task.max_strain : strain.back(), 4) +
                  options.unless_given("--up-to") + "\n\n" + tensile_text(task, results) + files_text(options));
  return done;
}

}  // namespace

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
    take(*options);
    run = [options] {
      return options->tensile.file.empty() ? calibrate_specimens(*options) : calibrate_tensile(*options);
    };
  });
}

}  // namespace softkin::cli
