#include "follow_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/text_mesh_tools.hpp>

namespace softkin::cli {

namespace {

void add_path(CLI::App& command, FollowOptions& options) {
  add_scene(command, options);
  command
      .add_option("PATH", options.path,
                  "Where a marker is to go: columns x_mm, y_mm, z_mm, or\ntip_x_mm, tip_y_mm, ... of several markers, "
                  "and t_s; a coordinate\nwithout a column does not count")
      ->type_name("F.csv")
      ->required();
  command
      .add_option("-o,--output", options.folder,
                  "Folder for commands.csv (for fk --path), errors.csv, path.pvd\nwith the shapes, path.svg and "
                  "report.json")
      ->type_name("DIR")
      ->required();
  command.add_option("--marker", options.marker, "Whose x_mm, y_mm, z_mm are (default: the scene's only one)")
      ->type_name("NAME");
  command
      .add_option("--max-step", options.max_step_mm,
                  "Insert waypoints on the straight lines between those given,\nso that no step is longer [mm]")
      ->type_name("MM")
      ->check(positive_length());
}

void add_search(CLI::App& command, FollowOptions& options) {
  add_method(command, options, "Distance from a waypoint at which it is reached");
  command
      .add_option("--descents", options.descents,
                  "gradient: iterations of Algorithm 2 for a waypoint, i_max\n(default: " +
                      std::to_string(InverseOptions().max_iterations) + ")")
      ->type_name("N")
      ->check(integer_from(1, 1'000'000'000));
}

}  // namespace

std::vector<Output> FollowOptions::outputs(std::size_t waypoints) const {
  std::vector<Output> outputs;
  for (const auto& name : {commands(), errors(), report()}) outputs.push_back({"--output", name});
  outputs.push_back({"--output", shapes(), waypoints});
  outputs.push_back({plot_file.empty() ? "--output" : "--plot", plot()});
  return outputs;
}

TrajectoryOptions FollowOptions::trajectory() const {
  TrajectoryOptions result;
  result.inverse = by_method();
  result.inverse.statics = statics();
  return result;
}

void add_options(CLI::App& command, FollowOptions& options) {
  add_path(command, options);
  add_search(command, options);
  command
      .add_option("--workspace", options.workspace,
                  "Of softkin workspace: the first waypoint is sought from its\nnearest sample (default: from rest)")
      ->type_name("F.csv");
  command.add_option("--plot", options.plot_file, "The plot, instead of path.svg in the folder")->type_name("F.svg");
  add_force(command, options);
  add_solver(command, options, "--solver-tolerance");
  command.add_flag("--resume", options.resume, "Go on where the same command was interrupted");
  command.add_flag("--json", options.json, "Print the report instead of the table");
}

void check_usage(const FollowOptions& options) {
  if (options.folder.empty()) throw InvalidInput("--output: the name of the folder is empty");
  if (!options.plot_file.empty() && lower_extension(options.plot_file) != ".svg")
    throw InvalidInput("--plot " + options.plot_file + ": must end in .svg");
  check_method(options);
  check_solver(options);
}

}  // namespace softkin::cli
