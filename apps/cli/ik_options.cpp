#include "ik_options.hpp"

#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>

#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr int most = 1'000'000;

void add_goals(CLI::App& command, IkOptions& options) {
  add_repeated(command, "--target", options.goals.targets, "M=P",
               "MARKER=X,Y,Z: where a marker is to be [mm]; a coordinate left\nempty does not count (tip=,,40); "
               "repeatable, as the three below");
  add_repeated(command, "--plane", options.goals.planes, "M=P/N",
               "MARKER=PX,PY,PZ/NX,NY,NZ: a plane for a marker to be in, by a\npoint [mm] and its normal");
  add_repeated(command, "--direction", options.goals.directions, "A:B=D",
               "FROM:TO=X,Y,Z: where the line from one marker to another is to\npoint; its error is that of its unit "
               "vector times --lever");
  add_repeated(command, "--press", options.goals.presses, "N=F",
               "NAME=FX,FY,FZ: the force that the robot is to exert on a support,\nan obstacle or a body [N]; a "
               "component left empty does not\ncount (floor=,,-2); physical");
  add_value(command, "--lever", options.goals.lever_mm, "MM",
            "How far away a wrong direction counts [mm] (default: as far as\nits markers are apart at rest)",
            positive_length());
  add_repeated(command, "--weight", options.goals.weights, "M=W",
               "MARKER=W, FROM:TO=W or NAME=W: weight in the sum of squares of\ntheir targets (default: 1); "
               "repeatable");
}

void add_start(CLI::App& command, IkOptions& options) {
  add_repeated(command, "--start", options.start, "A=V",
               "ACTUATOR=VALUE: where the search begins (default: rest);\nrepeatable, as the two below; or F.vtu, a "
               "shape that softkin\nwrote");
  add_repeated(command, "--prefer", options.prefer, "A=V",
               "ACTUATOR=VALUE: where several actuations reach the goals, the one\nnearest to this (default: to the "
               "start)");
  add_repeated(command, "--fix", options.fix, "A=V", "ACTUATOR=VALUE: this actuator does not change");
  add_value(command, "--workspace", options.workspace, "F.csv",
            "Of softkin workspace: begins at its sample nearest to the goals");
}

void add_search(CLI::App& command, IkOptions& options) {
  const InverseOptions defaults;
  add_method(command, options, "Error of every goal at which they are reached");
  add_value(command, "--tolerance-force", options.goals.tolerance_force_N, "N",
            "Error of a --press at which it is reached [N] (default: 0.001 of\nthe force)", positive_force());
  add_value(command, "--max-equilibria", options.max_equilibria, "N",
            "newton: give up after so many (default: " + std::to_string(defaults.max_equilibria) + ")",
            integer_from(1, most));
  add_value(command, "--other-starts", options.other_starts, "N",
            "newton: places from where it is tried again before goals are\ncalled out of reach (default: " +
                std::to_string(defaults.other_starts) + ")",
            integer_from(0, 1000));
  add_value(command, "--descents", options.descents, "N",
            "gradient: iterations of Algorithm 2, i_max (default: " + std::to_string(defaults.max_iterations) + ")",
            integer_from(1, most));
}

void add_files(CLI::App& command, IkOptions& options) {
  add_value(command, "-o,--output", options.output, "F.vtu", "The shape");
  add_value(command, "--report", options.report, "F.json", "All numbers, with the Jacobian and the strain histogram");
  add_value(command, "--image", options.show.image, "F.png", "Picture of the shape");
  add_view(command, options.show);
  add_value(command, "--plot", options.show.plot, "F.svg", "The error over the equilibria of the search");
  add_overwriting(command, options.may_replace);
}

}  // namespace

std::vector<Output> IkOptions::outputs() const {
  return requested_outputs(
      {{"--output", output}, {"--report", report}, {"--image", show.image}, {"--plot", show.plot}});
}

std::string IkOptions::start_file() const {
  for (const std::string& each : start)
    if (each.find('=') == std::string::npos && lower_extension(each) == ".vtu") return each;
  return "";
}

InverseOptions IkOptions::inverse() const {
  InverseOptions result = by_method();
  result.max_equilibria = max_equilibria;
  result.other_starts = other_starts;
  result.statics = statics();
  return result;
}

void add_options(CLI::App& command, IkOptions& options) {
  add_scene(command, options);
  add_goals(command, options);
  add_start(command, options);
  add_search(command, options);
  add_files(command, options);
  add_map_use(command, options);
  add_force(command, options);
  add_solver(command, options);
  command.add_flag("--json", options.json, "Print the report instead of the table");
}

void check_usage(const IkOptions& options) {
  if (!options.goals.any())
    throw InvalidInput("nothing to reach: ik needs a --target MARKER=X,Y,Z, a --plane, a --direction or a --press");
  if (!options.goals.presses.empty() && !options.map.empty())
    throw InvalidInput("--press is solved for: a map has no forces, so it does not go with --map");
  if (options.goals.tolerance_force_N && options.goals.presses.empty())
    throw InvalidInput("--tolerance-force is that of a force: it needs --press");
  if (!options.workspace.empty() && !options.start.empty())
    throw InvalidInput("--workspace chooses the start: it does not go with --start");
  if (!options.start_file().empty()) {
    if (options.start.size() > 1)
      throw InvalidInput("--start " + options.start_file() +
                         " is a shape with all its commands: it goes with no other --start");
    if (!options.fix.empty())
      throw InvalidInput("--fix sets a command at the start, and --start " + options.start_file() +
                         " has it already: leave one out");
    if (!options.map.empty())
      throw InvalidInput("--start " + options.start_file() + " is for the solver: it does not go with --map");
  }
  check_method(options);
  if (options.goals.lever_mm && options.goals.directions.empty())
    throw InvalidInput("--lever is the lever of a direction: it needs --direction");
  check_extension("--output", options.output, {{".vtu", ""}});
  check_extension("--report", options.report, {{".json", ""}});
  check_extension("--image", options.show.image, {{".png", ""}});
  check_extension("--plot", options.show.plot, {{".svg", ""}});
  check_view(options.show);
  check_solver(options);
}

std::vector<runs::NamedGoal> requested_goals(const Model& model, const IkOptions& options) {
  runs::GoalTexts texts = options.goals;
  texts.tolerance_mm = options.inverse().tolerance_mm;
  texts.before_name = "--";
  return runs::requested_goals(model, texts);
}

}  // namespace softkin::cli
