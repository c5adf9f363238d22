#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/kinematics/grasp.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/records.hpp>
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
  std::optional<double> most_N;
  ShowOptions show;
  bool json = false;

  [[nodiscard]] std::vector<Output> outputs() const {
    return asked_outputs({{"--table", table}, {"--output", output}, {"--image", show.image}});
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
  add_value(command, "--most", options.most_N, "N", "No larger pull is tried [N]", positive_force());
  add_value(command, "--table", options.table, "F.csv", "The pulls as a table");
  add_value(command, "-o,--output", options.output, "F.vtu", "The grasp, before it is pulled");
  add_value(command, "--image", options.show.image, "F.png", "Picture of the grasp");
  add_force(command, options);
  add_view(command, options.show);
  add_solver(command, options);
  command.add_flag("--json", options.json, "Print the pulls as JSON instead of the table");
}

/// "-x" or "1,0,-1".
Vec3 direction_of(const std::string& text) {
  const bool minus = text.starts_with('-');
  const std::string axis = text.substr(minus ? 1 : 0);
  const std::size_t named = axis.size() == 1 ? std::string("xyz").find(axis) : std::string::npos;
  if (named != std::string::npos) return (minus ? -1 : 1) * Vec3::Unit(static_cast<Index>(named));
  Vec3 direction;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &direction[0], &direction[1], &direction[2], &rest) != 3 ||
      !direction.allFinite() || direction.norm() == 0)
    throw InvalidInput("--pull must be x, -x, y, -y, z, -z or DX,DY,DZ that are not all 0, not " + excerpt(text));
  return direction.normalized();
}

void check_usage(const GraspOptions& options) {
  check_extension("--table", options.table, {{".csv", ""}});
  check_extension("--output", options.output, {{".vtu", "the grasp"}});
  check_extension("--image", options.show.image, {{".png", ""}});
  check_view(options.show);
  check_solver(options);
}

Index body_of(const Model& model, const std::string& name) {
  std::vector<std::string> names;
  for (const FreeBody& body : model.bodies) names.push_back(body.name);
  if (names.empty()) throw InvalidInput({model.name}, "the scene has no body to grasp: give it 'bodies'");
  if (name.empty()) {
    if (names.size() == 1) return 0;
    throw InvalidInput("--body: the scene has " + std::to_string(names.size()) + " bodies, " + names[0] + ", " +
                       names[1] + (names.size() > 2 ? ", ..." : "") + ": say which one is pulled");
  }
  for (std::size_t b = 0; b < names.size(); ++b)
    if (names[b] == name) return static_cast<Index>(b);
  throw InvalidInput("--body: the scene has no body " + excerpt(name) + suggest_name(name, names));
}

Table table_of_pulls() {
  Table table;
  table.columns = {{.key = "direction", .title = "pull along", .width = 18, .left = true},
                   {.key = "force_N", .title = "largest", .unit = "N", .digits = 4},
                   {.key = "moved_mm", .title = "moved", .unit = "mm", .digits = 3},
                   {.key = "normal_N", .title = "pressed", .unit = "N", .digits = 4},
                   {.key = "slipping", .title = "slips", .unit = "-", .digits = 3},
                   {.key = "end", .title = "then", .left = true}};
  return table;
}

class GraspRun {
 public:
  GraspRun(const Model& model, const Statics& statics, const GraspOptions& options)
      : model_(model), statics_(statics), options_(options), body_(body_of(model, options.body)) {}

  int run(const std::vector<ActuationStep>& closing) {
    Equilibrium at;
    at.state = statics_.rest();
    for (std::size_t i = 0; i < closing.size(); ++i)
      if (!solved(closing[i].actuation, at, "closing, step " + std::to_string(i))) return failed(at, "closing");
    const Actuation closed = at.state.actuation;
    if (!solved(pulled(model_, closed, body_, Vec3::UnitX(), 0), at, "releasing '" + name() + "'"))
      return failed(at, "'" + name() + "' is not held when it is released");
    write(at.state);
    return pull(at.state);
  }

 private:
  [[nodiscard]] const std::string& name() const { return model_.bodies[static_cast<std::size_t>(body_)].name; }

  ProgressCallback shown(const std::string& what) {
    return [this, what](const Progress& p) {
      line_.show(-1, what + ": " + EquilibriumProgress::text(p));
      return !interrupted();
    };
  }

  bool solved(const Actuation& actuation, Equilibrium& at, const std::string& what) {
    at = statics_.solve(actuation, at.state, options_.statics(), shown(what));
    line_.clear();
    return at.report.status == Status::converged;
  }

  int failed(const Equilibrium& at, const std::string& what) const {
    const bool stopped = at.report.status == Status::interrupted;
    std::fprintf(stderr, "softkin: %s\n", stopped ? "interrupted" : (what + ": " + at.report.remark).c_str());
    return not_converged;
  }

  void write(const State& grasp) const {
    if (!options_.output.empty())
      runs::write_shape(options_.output, model_, grasp.positions, statics_.measured(grasp), true);
    if (!options_.show.image.empty())
      runs::write_image(options_.show.image, model_, grasp.positions, options_.show.view, "'" + name() + "', grasped");
  }

  /// Normal force on the body and the share of it that slips.
  [[nodiscard]] std::pair<double, std::optional<double>> pressed(const State& at) const {
    const std::optional<ContactForces> contacts = statics_.measured(at).contacts;
    double normal = 0, slipping = 0;
    bool rubs = false;
    for (const PairForces& pair : contacts ? contacts->pairs : std::vector<PairForces>()) {
      const auto is_body = [&](Index part) {
        return model_.contact.parts[static_cast<std::size_t>(part)].name == name();
      };
      if (!is_body(pair.a) && !is_body(pair.b)) continue;
      normal += pair.normal_N;
      rubs = rubs || pair.slipping;
      slipping += pair.slipping.value_or(0) * pair.normal_N;
    }
    return {normal, rubs && normal > 0 ? std::optional(slipping / normal) : std::nullopt};
  }

  Row row_of(const std::string& direction, const Pull& pull) const {
    const auto [normal, slipping] = pressed(pull.last.state);
    Row row{direction, pull.force_N, pull.moved_mm, normal};
    row.emplace_back(slipping ? Cell(*slipping) : Cell());
    const std::string reason = pull.status == Status::limit ? pull.last.report.remark : "";
    row.emplace_back(pull.status == Status::converged ? "holds more"
                     : pull.status == Status::limit
                         ? (reason.find("slips") != std::string::npos ? "slips" : "gives way")
                         : name_of(pull.status));
    return row;
  }

  int pull(const State& grasp) {
    Table table = table_of_pulls();
    if (!options_.json) print(table.header() + "\n");
    bool stopped = false, lost = false;
    const double most = options_.most_N.value_or(most_pull(model_, body_));
    for (const std::string& text :
         options_.pulls.empty() ? std::vector<std::string>{"x", "-x", "y", "-y", "z", "-z"} : options_.pulls) {
      const Pull found = largest_pull(model_, statics_, grasp, body_, direction_of(text), most, options_.statics(),
                                      shown("pulling along " + text));
      line_.clear();
      stopped = found.status == Status::interrupted;
      if (stopped) break;
      lost = lost || found.status == Status::not_converged;
      table.rows.push_back(row_of(text, found));
      if (!options_.json) print(table.line(table.rows.back()) + "\n");
    }
    if (!options_.table.empty()) write_file(options_.table, table.csv());
    if (options_.json) print(table.json() + "\n");
    if (!options_.json)
      for (const Output& output : options_.outputs())
        print(output.option.substr(2) + ": " + output.file.string() + "\n");
    if (stopped) std::fprintf(stderr, "softkin: interrupted after %zu pulls\n", table.rows.size());
    return stopped || lost ? not_converged : done;
  }

  const Model& model_;
  const Statics& statics_;
  const GraspOptions& options_;
  Index body_;
  ProgressLine line_;
};

int run_grasp(const GraspOptions& options) {
  check_usage(options);
  for (const std::string& pull : options.pulls) (void)direction_of(pull);
  std::vector<fs::path> inputs{options.scene};
  if (!options.path.empty()) inputs.emplace_back(options.path);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = asked_robot(options, inputs);
  (void)body_of(model, options.body);
  const Settings settings = read_settings(model, "--set", options.settings);
  const std::vector<ActuationStep> closing =
      options.path.empty() ? std::vector<ActuationStep>{{with_settings(model.rest_actuation(), settings)}}
                           : read_actuation_path(model, options.path, settings);
  check_outputs(options.outputs(), inputs);
  line.show(-1, "assembling");
  const Statics statics(model);
  line.clear();
  catch_interrupt();
  const OutputFolders folders(options.outputs());
  if (!options.json) print(options.scene + ": " + summary(model, options.solver_name) + "\n");
  return GraspRun(model, statics, options).run(closing);
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
