#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <softkin/statics/statics.hpp>

#include "command.hpp"
#include "curve_settings.hpp"
#include "fk_options.hpp"
#include "fk_robot.hpp"
#include "fk_run.hpp"
#include "fk_steps.hpp"
#include "fk_table.hpp"
#include "mesh_text.hpp"
#include "output_files.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

int run_fk(const FkOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.scene};
  if (!options.path.empty()) inputs.emplace_back(options.path);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = asked_robot(options, inputs);
  const std::vector<Step> steps = asked_steps(model, options);
  const std::vector<Output> outputs = options.outputs(steps.size());
  check_outputs(outputs, inputs);
  line.show(-1, "assembling");
  const Statics statics(model);
  line.clear();
  catch_interrupt();
  const OutputFolders folders(outputs);
  if (!options.json)
    print(options.scene + ": " + summary(model, options.solver_name) + "\n" + curve_remarks(model, options.settings));
  return run_steps(model, statics, options, steps);
}

}  // namespace

void add_fk(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("fk", "Forward kinematics: the shape under given actuation");
  const auto options = std::make_shared<FkOptions>();
  add_options(*command, *options);
  command->footer(
      "Lengths are in mm, pressures in kPa (gauge), forces in N. Exit code: 0 done, 1 not converged, a limit or\n"
      "interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin fk examples/pneumatic_finger/pneumatic_finger.yaml --set air=1.5 -o finger.vtu");
  command->callback([options, &run] { run = [options] { return run_fk(*options); }; });
}

}  // namespace softkin::cli
