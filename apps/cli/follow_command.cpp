#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/marker_path.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/follow_run.hpp>
#include <softkin/runs/page.hpp>
#include <softkin/runs/run_tables.hpp>
#include <softkin/runs/workspace_file.hpp>

#include "command.hpp"
#include "map_use.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;
using runs::WaypointRecord;

namespace {

/// What the user asks of `softkin follow`. An empty file name: not given.
struct FollowOptions : SolveOptions, MethodOptions, RunOptions, MapUse {
  std::string path, folder, marker, workspace, plot_file;
  std::vector<std::string> turn;  // two markers
  double max_step_mm = 0;         // 0: as given
  std::optional<Index> samples;   // of a grid, nearest

  [[nodiscard]] runs::FollowFolder files() const { return runs::FollowFolder(folder, plot_file); }
  [[nodiscard]] std::vector<Output> outputs(std::size_t waypoints) const {
    const runs::FollowFolder all = files();
    std::vector<Output> outputs;
    outputs.push_back({.option = "--output", .file = all.commands(), .is_own = [all](const fs::path&) {
                         return all.has_written_commands();
                       }});
    for (const fs::path& file : {all.errors(), all.run().report}) outputs.push_back({"--output", file});
    outputs.push_back({"--output", all.run().shapes, waypoints});
    outputs.push_back({plot_file.empty() ? "--output" : "--plot", all.plot()});
    if (!page.empty()) outputs.push_back({"--html", page});
    return outputs;
  }
  [[nodiscard]] bool nearest() const { return method == "nearest"; }
  [[nodiscard]] TrajectoryOptions trajectory() const {
    TrajectoryOptions result;
    result.inverse = by_method();
    result.inverse.statics = statics();
    return result;
  }
};

void add_options(CLI::App& command, FollowOptions& options) {
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
  add_value(command, "--marker", options.marker, "NAME", "Whose x_mm, y_mm, z_mm are (default: the scene's only one)");
  add_value(command, "--max-step", options.max_step_mm, "MM",
            "Insert waypoints on the straight lines between those given,\nso that no step is longer [mm]",
            positive_length());
  add_method(command, options, "Distance from a waypoint at which it is reached",
             {{"nearest",
               "without inverse kinematics, the commands of the nearest\nsample of a workspace, as Section "
               "V-B of the same paper compares with"}});
  add_value(command, "--descents", options.descents, "N",
            "gradient: iterations of Algorithm 2 for a waypoint, i_max\n(default: " +
                std::to_string(InverseOptions().max_iterations) + ")",
            integer_from(1, 1'000'000'000));
  add_value(
      command, "--workspace", options.workspace, "F.csv",
      "Of softkin workspace: the first waypoint is sought from its\nnearest sample (default: from rest); nearest: "
      "its samples");
  add_value(command, "--samples", options.samples, "N",
            "nearest: so many samples of a grid over the ranges, or those of the\nfull grid next to it, as softkin "
            "workspace makes; they are solved\nfor first",
            integer_from(1, 1'000'000'000));
  add_value(command, "--plot", options.plot_file, "F.svg", "The plot, instead of path.svg in the folder");
  add_turn(command, options.turn);
  add_map_use(command, options);
  add_force(command, options);
  add_solver(command, options);
  add_run(command, options, "Go on where the same command was interrupted", "Print the report instead of the table");
}

void check_usage(const FollowOptions& options) {
  if (options.folder.empty()) throw InvalidInput("--output: the name of the folder is empty");
  check_extension("--plot", options.plot_file, {{".svg", ""}});
  check_method(options);
  if (options.samples && !options.nearest()) throw InvalidInput("--samples are those of --method nearest");
  if (options.nearest() && options.samples.has_value() == !options.workspace.empty())
    throw InvalidInput("--method nearest takes the samples of one of --workspace F.csv and --samples N");
  check_solver(options);
}

/// Known samples, or how many are to be made.
NearestOf nearest_of(const Model& model, const FollowOptions& options) {
  if (!options.samples) return runs::samples_of(model, options.workspace);
  return full_grid(model, *options.samples);
}

class ShownTrajectory {
 public:
  ShownTrajectory(const Model& model, const FollowOptions& options, double reach_mm, runs::FollowRun& follow,
                  runs::RunPage& page, const std::optional<runs::MarkerLine>& line)
      : model_(model),
        options_(options),
        reach_mm_(reach_mm),
        follow_(follow),
        run_(follow.run()),
        page_(page),
        turn_(model, line),
        table_(runs::table_of_waypoints(model, run_.size(), line)) {}

  int show() {
    if (options_.resume) resume_run(run_, options_.outputs(run_.size()), "waypoint", options_.json);
    turn_.catch_up(run_);
    const runs::Advance end = advance_run(
        run_, table_, "waypoint", options_.json,
        [](RunProgress& line, const Progress& p) {
          std::string text = counted(static_cast<std::size_t>(std::max(0, p.iteration)), "equilibrium", "equilibria");
          if (std::isfinite(p.step_mm)) text += ", " + number(p.step_mm, 2) + " mm off";
          line.show(text);
        },
        [&] { return runs::row_of(model_, run_.done() - 1, run_.last(), turn_.next(run_.last())); });
    follow_.finish();
    page_.write();
    if (options_.json) show_report(run_);
    if (end != runs::Advance::made)
      return report_stopped(stopped_of(run_, "waypoint", options_.folder, options_.files().run().shapes));
    return describe(follow_.records());
  }

 private:
  void say(const std::string& line) const {
    if (!options_.json) print(line + "\n");
  }

  [[nodiscard]] int describe(const std::vector<WaypointRecord>& done) const {
    say(summary_of(done, reach_mm_, options_.nearest()));
    if (options_.nearest()) say(runs::jumps_of(done));
    OverlapTally overlaps(model_);
    for (std::size_t i = 0; i < done.size(); ++i) overlaps.add(i, done[i]);
    if (const std::string text = overlaps.text("waypoint"); !text.empty()) say(text);
    const runs::FollowFolder files = options_.files();
    say("commands: " + files.commands().string() + "; plot: " + files.plot().string() +
        "; shapes: " + files.run().shapes.string() + " (open it in ParaView)");
    if (!options_.page.empty()) say(page_.reported());
    std::vector<std::size_t> unstable;
    for (std::size_t i = 0; i < done.size(); ++i)
      if (done[i].physical.unstable_modes > 0) unstable.push_back(i);
    if (!unstable.empty()) say(unstable_text("waypoint", unstable));
    const std::string missed = missed_text(done, options_.nearest());
    if (missed.empty()) return cli::done;
    std::fprintf(stderr, "softkin: %s\n", missed.c_str());
    return not_converged;
  }

  const Model& model_;
  const FollowOptions& options_;
  double reach_mm_;
  runs::FollowRun& follow_;
  runs::Run<WaypointRecord>& run_;
  runs::RunPage& page_;
  LineTurn turn_;
  Table table_;
};

int run_follow(const FollowOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.scene, options.path};
  if (!options.workspace.empty()) inputs.emplace_back(options.workspace);
  check_map_use(options, options, inputs);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = requested_robot(options, inputs);
  MarkerPath path = read_marker_path(options.path, model, options.marker);
  if (path.waypoints.front().time) check_times(model, options.path, options, options);
  const std::vector<std::string> doubts = doubts_about(model, path);
  const std::optional<runs::MarkerLine> line_turned = runs::read_marker_line(model, options.turn);
  if (options.max_step_mm > 0) path = densified(path, options.max_step_mm);
  std::vector<Output> outputs = options.outputs(path.waypoints.size());
  if (options.resume)  // the commands of a run that was killed are older than its journal
    for (const fs::path& file : {options.files().run().report, options.files().commands()})
      leave_to_resume(outputs, file);
  check_outputs(outputs, inputs, options.may_replace);
  TrajectoryOptions trajectory = options.trajectory();
  if (options.nearest())
    trajectory.nearest = nearest_of(model, options);
  else if (!options.workspace.empty())
    trajectory.start = runs::nearest_actuation(model, options.workspace, goals_of(path, path.waypoints.front()));
  line.show(-1, "assembling");
  const runs::Answers answers(model, options.map, options.polish);
  line.clear();
  catch_interrupt();
  const OutputFolders folders(outputs);
  for (const std::string& doubt : doubts)
    std::fprintf(stderr, "softkin: warning: %s: %s\n", options.path.c_str(), doubt.c_str());
  if (!options.json) print(head_text(model, options, answers));
  runs::FollowRun follow(answers.statics(), {options.scene, options.path, std::move(path), answers.map(), line_turned},
                         trajectory, options.files());
  runs::RunPage page(options.page, model, runs::kept_command());
  page.bend_by(answers.map_data());
  page.watch(follow.run(), &answers.statics());
  return ShownTrajectory(model, options, trajectory.inverse.tolerance_mm, follow, page, line_turned).show();
}

}  // namespace

void add_follow(CLI::App& app, Run& run) {
  add_command(
      app, run, "follow", "Trajectories: the actuation that leads markers along a path",
      "A waypoint out of reach ends at the nearest point that the ranges allow. Exit code: 0 all waypoints reached,\n"
      "1 some were not, or interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin follow examples/three_tendon_finger/three_tendon_finger.yaml \\\n"
      "      examples/three_tendon_finger/letter_l.csv -o out/letter_l",
      add_options, run_follow);
}

}  // namespace softkin::cli
