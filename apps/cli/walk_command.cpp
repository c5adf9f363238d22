#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <softkin/io/csv.hpp>

#include "command.hpp"
#include "fk_robot.hpp"
#include "fk_table.hpp"
#include "mesh_text.hpp"
#include "output_files.hpp"
#include "terminal.hpp"
#include "walk_options.hpp"
#include "walk_run.hpp"

namespace softkin::cli {

namespace {

int run_walk(const WalkOptions& options) {
  check_usage(options);
  std::vector<std::filesystem::path> inputs{options.scene, options.gait};
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = asked_robot(options, inputs);
  const std::vector<GaitStep> steps =
      repeated(model, options.gait, path_steps(model, options.gait, read_csv(options.gait)), options.cycles);
  const std::vector<Output> outputs = options.outputs(steps.size());
  check_outputs(outputs, inputs);
  line.show(-1, "assembling");
  Walker walker(model, options.statics());
  line.clear();
  catch_interrupt();
  const OutputFolders folders(outputs);
  if (!options.json) print(options.scene + ": " + summary(model, options.solver_name) + "\n");
  return walk_steps(model, walker, options, steps);
}

}  // namespace

void add_walk(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("walk", "Walking: a gait with feet that slide one way better than the other");
  const auto options = std::make_shared<WalkOptions>();
  add_options(*command, *options);
  command->footer(
      "The scene's key 'feet' says what stands on the floor (docs/walking.md). Exit code: 0 done, 1 an equilibrium "
      "did\n"
      "not converge, or interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin walk examples/dea_crawler/dea_crawler.yaml examples/dea_crawler/gait.csv -o out/walk");
  command->callback([options, &run] { run = [options] { return run_walk(*options); }; });
}

}  // namespace softkin::cli
