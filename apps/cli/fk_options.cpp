#include "fk_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/text_mesh_tools.hpp>

namespace softkin::cli {

namespace {

void add_files(CLI::App& command, FkOptions& options) {
  add_scene(command, options);
  command
      .add_option(
          "--path", options.path,
          "A column per actuator (air; with a load's unit if you like:\nair_kPa), a row per step, each step solved "
          "from the last; with a curve\nof the actuator also air_kPa (gauge), air_kPa_abs, skin_kV; a\ncolumn t_s is "
          "the time in the series [s]")
      ->type_name("F.csv");
  command.add_option("-o,--output", options.output, "F.vtu: the last shape; F.pvd: every step, as F_0000.vtu, ...")
      ->type_name("F");
  command.add_option("--report", options.report, "All numbers of all steps, with their strain histograms")
      ->type_name("F.json");
  command.add_option("--image", options.image, "Picture of the last shape")->type_name("F.png");
  command
      .add_option("--plot", options.plot,
                  "With --path: commands, markers, pressures and tensions over\nthe steps, and the markers' ways")
      ->type_name("F.svg");
}

}  // namespace

bool FkOptions::series() const {
  return lower_extension(output) == ".pvd";
}

std::vector<Output> FkOptions::outputs(std::size_t steps) const {
  std::vector<Output> outputs;
  const auto add = [&](const char* option, const std::string& file) {
    if (!file.empty()) outputs.push_back({option, file});
  };
  add("--output", output);
  if (series()) outputs.back().shapes = steps;
  add("--report", report);
  add("--image", image);
  add("--plot", plot);
  return outputs;
}

void add_options(CLI::App& command, FkOptions& options) {
  add_files(command, options);
  command
      .add_option("--set", options.settings,
                  "ACTUATOR=VALUE: length, area or volume over that at rest\n[-] (air=1.5), or its load where it is "
                  "controlled by that (air=50,\nair=50kPa, tendon=3N), or by its curve (air=50kPa, "
                  "air=150kPa_abs,\nair=50kPa:unloading, skin=2.5kV); repeatable; other actuators\nrest")
      ->type_name("A=V")
      ->expected(1)
      ->take_all();
  add_force(command, options);
  command
      .add_option("--view", options.view,
                  "Picture: direction X Y Z from the robot to the eye (default:\n-0.5 -1 0.45); 0 0 1 looks from above")
      ->type_name("NUMBER")
      ->expected(3)
      ->check(finite_number(true));
  add_solver(command, options, "--tolerance");
  command.add_flag("--resume", options.resume,
                   "Go on where the same command was interrupted; needs --path,\n--report and -o F.pvd");
  command.add_flag("--json", options.json, "Print the report instead of the table");
}

void check_usage(const FkOptions& options) {
  const std::string form = lower_extension(options.output);
  if (!options.output.empty() && form != ".vtu" && form != ".pvd")
    throw InvalidInput("--output " + options.output + ": must end in .vtu (the last shape) or .pvd (every step)");
  if (!options.image.empty() && lower_extension(options.image) != ".png")
    throw InvalidInput("--image " + options.image + ": must end in .png");
  if (!options.plot.empty() && lower_extension(options.plot) != ".svg")
    throw InvalidInput("--plot " + options.plot + ": must end in .svg");
  if (!options.plot.empty() && options.path.empty())
    throw InvalidInput("--plot draws the steps of a path: it needs --path F.csv");
  if (!options.view.empty() && options.image.empty())
    throw InvalidInput("--view is the view of the picture: it needs --image F.png");
  if (!options.view.empty() && std::hypot(options.view[0], options.view[1], options.view[2]) == 0)
    throw InvalidInput("--view 0 0 0: must be a direction, so not zero");
  check_solver(options);
  if (options.resume && (options.path.empty() || !options.series() || options.report.empty()))
    throw InvalidInput("--resume needs the --path, --report and --output F.pvd of the run that was interrupted");
}

}  // namespace softkin::cli
