#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <softkin/io/marker_path.hpp>

#include "command.hpp"
#include "fk_robot.hpp"
#include "fk_table.hpp"
#include "follow_options.hpp"
#include "follow_run.hpp"
#include "mesh_text.hpp"
#include "terminal.hpp"
#include "workspace_start.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

int run_follow(const FollowOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.scene, options.path};
  if (!options.workspace.empty()) inputs.emplace_back(options.workspace);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = asked_robot(options, inputs);
  MarkerPath path = read_marker_path(options.path, model, options.marker);
  const std::vector<std::string> doubts = doubts_about(model, path);
  if (options.max_step_mm > 0) path = densified(path, options.max_step_mm);
  const std::vector<Output> outputs = options.outputs(path.waypoints.size());
  check_outputs(outputs, inputs);
  TrajectoryOptions trajectory = options.trajectory();
  if (!options.workspace.empty())
    trajectory.start = nearest_actuation(model, options.workspace, goals_of(path, path.waypoints.front()));
  line.show(-1, "assembling");
  const Statics statics(model);
  line.clear();
  catch_interrupt();
  const OutputFolders folders(outputs);
  for (const std::string& doubt : doubts)
    std::fprintf(stderr, "softkin: warning: %s: %s\n", options.path.c_str(), doubt.c_str());
  if (!options.json) print(options.scene + ": " + summary(model, options.solver_name) + "\n");
  return run_path(model, statics, options, path, trajectory);
}

}  // namespace

void add_follow(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("follow", "Trajectories: the actuation that leads markers along a path");
  const auto options = std::make_shared<FollowOptions>();
  add_options(*command, *options);
  command->footer(
      "A waypoint out of reach ends at the nearest point that the ranges allow. Exit code: 0 all waypoints reached,\n"
      "1 some were not, or interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin follow examples/three_tendon_finger/three_tendon_finger.yaml \\\n"
      "      examples/three_tendon_finger/letter_l.csv -o out/letter_l");
  command->callback([options, &run] { run = [options] { return run_follow(*options); }; });
}

}  // namespace softkin::cli
