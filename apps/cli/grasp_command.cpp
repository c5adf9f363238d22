#include <cstdio>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/kinematics/grasp.hpp>
#include <softkin/runs/run_tables.hpp>
#include <softkin/runs/shape_files.hpp>

#include "command.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// What the user asks of `softkin grasp`. An empty file name: not given.
struct GraspOptions : SolveOptions {
  std::string path, body, table, output;
  std::vector<std::string> settings, pulls;
  std::optional<double> max_N;
  ShowOptions show;
  bool json = false, may_replace = false;

  [[nodiscard]] std::vector<Output> outputs() const {
    return requested_outputs({{"--table", table}, {"--output", output}, {"--image", show.image}});
  }
};

void add_options(CLI::App& command, GraspOptions& options) {
  add_scene(command, options);
  add_value(
      command, "--path", options.path, "F.csv",
      "How the gripper closes, as for fk: a column per actuator, a\nrow per step; bodies are held where they are");
  add_repeated(command, "--set", options.settings, "A=V", "ACTUATOR=VALUE, as for fk; repeatable");
  add_value(command, "--body", options.body, "NAME", "Which body is released and pulled (default: the only one)");
  add_repeated(command, "--pull", options.pulls, "DIR",
               "Direction of a pull: x, -x, y, -y, z, -z or DX,DY,DZ;\nrepeatable (default: those six)");
  add_value(command, "--most", options.max_N, "N", "No larger pull is tried [N]", positive_force());
  add_value(command, "--table", options.table, "F.csv", "The pulls as a table");
  add_value(command, "-o,--output", options.output, "F.vtu", "The grasp, before it is pulled");
  add_value(command, "--image", options.show.image, "F.png", "Picture of the grasp");
  add_overwriting(command, options.may_replace);
  add_force(command, options);
  add_view(command, options.show);
  add_solver(command, options);
  command.add_flag("--json", options.json, "Print the pulls as JSON instead of the table");
}

std::vector<PullDirection> requested_directions(const GraspOptions& options) {
  if (options.pulls.empty()) return axes_to_pull_along();
  std::vector<PullDirection> directions;
  for (const std::string& pull : options.pulls) directions.push_back({pull, read_direction("--pull", pull)});
  return directions;
}

void check_usage(const GraspOptions& options) {
  check_extension("--table", options.table, {{".csv", ""}});
  check_extension("--output", options.output, {{".vtu", "the grasp"}});
  check_extension("--image", options.show.image, {{".png", ""}});
  check_view(options.show);
  check_solver(options);
}

class GraspRun {
 public:
  GraspRun(const Statics& statics, const GraspOptions& options, Index body)
      : model_(statics.model()), statics_(statics), options_(options), body_(body) {}

  int run(const std::vector<Actuation>& closing, const std::vector<PullDirection>& directions) {
    const auto stage = [&](const std::string& done, const Equilibrium& shape) { report_stage(done, shape); };
    const Grasp grasp = close_around(statics_, closing, body_, options_.statics(), shown(), stage);
    line_.clear();
    if (!grasp.held) {
      std::string text = grasp.last.report.stopped ? why_stopped() + ": " + grasp.remark : grasp.remark;
      if (!options_.output.empty()) text += "; the last good shape is in " + options_.output;
      write(grasp.last);
      std::fprintf(stderr, "softkin: %s\n", text.c_str());
      return not_converged;
    }
    write(grasp.last);
    return pull(grasp.last.state, directions);
  }

 private:
  GraspProgress shown() {
    return [this](const std::string& doing, const Progress& p) {
      line_.show(-1, doing + ": " + EquilibriumProgress::text(p));
      return !interrupted();
    };
  }

  /// What is there of a grasp, whatever becomes of the rest.
  void report_stage(const std::string& done, const Equilibrium& shape) {
    line_.clear();
    if (!options_.output.empty())
      runs::write_shape(options_.output, model_, shape.state, statics_.measured(shape.state), true);
    if (options_.json) return;
    const double normal_N = pressed(model_, body_, statics_.measured(shape.state)).normal_N;
    print(done + ": " + counted(static_cast<std::size_t>(shape.report.iterations), "iteration") + ", " +
          decimal(shape.report.seconds, 2) + " s; pressed with " + number(normal_N, 4) + " N\n");
  }

  void write(const Equilibrium& grasp) const {
    const std::string& name = model_.bodies[body_].name;
    const bool held = grasp.report.status == Status::converged;
    if (!options_.output.empty())
      runs::write_shape(options_.output, model_, grasp.state, statics_.measured(grasp.state), held);
    if (!options_.show.image.empty())
      runs::write_image(options_.show.image, model_, grasp.state.positions, options_.show.view,
                        "'" + name + (held ? "', grasped" : "', not grasped"));
  }

  int pull(const State& grasp, const std::vector<PullDirection>& directions) {
    Table table = runs::table_of_pulls();
    if (!options_.json) print(table.header() + "\n");
    bool stopped = false, lost = false;
    for (const PullDirection& direction : directions) {
      const Pull found = largest_pull(statics_, grasp, {body_, direction, options_.max_N}, options_.statics(), shown());
      line_.clear();
      stopped = found.last.report.stopped;
      lost = lost || found.status == Status::not_converged;
      table.rows.push_back(runs::row_of(found));
      if (!options_.json) print(table.line(table.rows.back()) + "\n");
      if (!options_.table.empty()) write_file(options_.table, table.csv());
      if (stopped) break;
    }
    finish(table);
    if (stopped)
      std::fprintf(stderr, "softkin: %s after %zu of %zu pulls\n", why_stopped().c_str(), table.rows.size() - 1,
                   directions.size());
    return stopped || lost ? not_converged : done;
  }

  void finish(const Table& table) const {
    if (options_.json) return print(table.json() + "\n");
    for (const Output& output : options_.outputs()) print(output.option.substr(2) + ": " + output.file.string() + "\n");
  }

  const Model& model_;
  const Statics& statics_;
  const GraspOptions& options_;
  Index body_;
  ProgressLine line_;
};

/// How the gripper closes.
std::vector<Actuation> requested_closing(const Model& model, const GraspOptions& options) {
  const Settings settings = read_settings(model, "--set", options.settings);
  if (options.path.empty()) return {with_settings(model.rest_actuation(), settings)};
  std::vector<Actuation> closing;
  for (ActuationStep& step : read_actuation_path(model, options.path, settings))
    closing.push_back(std::move(step.actuation));
  return closing;
}

int run_grasp(const GraspOptions& options) {
  check_usage(options);
  const std::vector<PullDirection> directions = requested_directions(options);
  std::vector<fs::path> inputs{options.scene};
  if (!options.path.empty()) inputs.emplace_back(options.path);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = requested_robot(options, inputs);
  const Index body = read_body(model, "--body", options.body);
  const std::vector<Actuation> closing = requested_closing(model, options);
  check_outputs(options.outputs(), inputs, options.may_replace);
  line.show(-1, "assembling");
  const Statics statics(model);
  line.clear();
  catch_interrupt();
  const OutputFolders folders(options.outputs());
  if (!options.json) print(options.scene + ": " + runs::model_summary(model, options.solver_name) + "\n");
  return GraspRun(statics, options, body).run(closing, directions);
}

}  // namespace

void add_grasp(CLI::App& app, Run& run) {
  add_command(app, run, "grasp", "Grasping: how far a body can be pulled out of a closed gripper",
              "Closes the gripper with the scene's bodies held, releases one, and pulls it until it slips or no "
              "equilibrium is\n"
              "left (docs/contact.md). Forces are in N. Exit code: 0 done, 1 an equilibrium was not found or "
              "interrupted, 2 bad\n"
              "usage or bad input.",
              add_options, run_grasp);
}

}  // namespace softkin::cli
