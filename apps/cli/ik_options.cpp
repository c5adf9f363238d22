#include "ik_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/scanner.hpp>

namespace softkin::cli {

namespace {

constexpr int most = 1'000'000;

CLI::Option* add_repeated(CLI::App& command, const std::string& name, std::vector<std::string>& values,
                          const std::string& help, const std::string& type) {
  return command.add_option(name, values, help)->type_name(type)->expected(1)->take_all();
}

void add_goals(CLI::App& command, IkOptions& options) {
  add_repeated(command, "--target", options.targets,
               "MARKER=X,Y,Z: where a marker is to be [mm]; a coordinate left\nempty does not count (tip=,,40); "
               "repeatable, as the two below",
               "M=P");
  add_repeated(command, "--plane", options.planes,
               "MARKER=PX,PY,PZ/NX,NY,NZ: a plane for a marker to be in, by a\npoint [mm] and its normal", "M=P/N");
  add_repeated(command, "--direction", options.directions,
               "FROM:TO=X,Y,Z: where the line from one marker to another is to\npoint; its error is that of its unit "
               "vector times --lever",
               "A:B=D");
  command
      .add_option("--lever", options.lever_mm,
                  "How far away a wrong direction counts [mm] (default: as far as\nits markers are apart at rest)")
      ->type_name("MM")
      ->check(positive_length());
  add_repeated(command, "--weight", options.weights,
               "MARKER=W or FROM:TO=W: weight in the sum of squares of what is\nasked of them (default: 1); "
               "repeatable",
               "M=W");
}

void add_start(CLI::App& command, IkOptions& options) {
  add_repeated(command, "--start", options.start,
               "ACTUATOR=VALUE: where the search begins (default: rest);\nrepeatable, as the two below", "A=V");
  add_repeated(command, "--prefer", options.prefer,
               "ACTUATOR=VALUE: where several actuations reach the goals, the one\nnearest to this (default: to the "
               "start)",
               "A=V");
  add_repeated(command, "--fix", options.fix, "ACTUATOR=VALUE: this actuator does not change", "A=V");
  command
      .add_option("--workspace", options.workspace, "Of softkin workspace: begins at its sample nearest to the goals")
      ->type_name("F.csv");
}

void add_search(CLI::App& command, IkOptions& options) {
  const InverseOptions defaults;
  add_method(command, options, "Error of every goal at which they are reached");
  command
      .add_option("--max-equilibria", options.max_equilibria,
                  "newton: give up after so many (default: " + std::to_string(defaults.max_equilibria) + ")")
      ->type_name("N")
      ->check(integer_from(1, most));
  command
      .add_option("--other-starts", options.other_starts,
                  "newton: places from where it is tried again before goals are\ncalled out of reach (default: " +
                      std::to_string(defaults.other_starts) + ")")
      ->type_name("N")
      ->check(integer_from(0, 1000));
  command
      .add_option(
          "--descents", options.descents,
          "gradient: iterations of Algorithm 2, i_max (default: " + std::to_string(defaults.max_iterations) + ")")
      ->type_name("N")
      ->check(integer_from(1, most));
}

void add_files(CLI::App& command, IkOptions& options) {
  command.add_option("-o,--output", options.output, "The shape")->type_name("F.vtu");
  command.add_option("--report", options.report, "All numbers, with the Jacobian and the strain histogram")
      ->type_name("F.json");
  command.add_option("--image", options.show.image, "Picture of the shape")->type_name("F.png");
  add_view(command, options.show);
  command.add_option("--plot", options.show.plot, "The error over the equilibria of the search")->type_name("F.svg");
}

}  // namespace

std::vector<Output> IkOptions::outputs() const {
  return asked_outputs({{"--output", output}, {"--report", report}, {"--image", show.image}, {"--plot", show.plot}});
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
  add_force(command, options);
  add_solver(command, options, "--solver-tolerance");
  command.add_flag("--json", options.json, "Print the report instead of the table");
}

void check_usage(const IkOptions& options) {
  if (options.targets.empty() && options.planes.empty() && options.directions.empty())
    throw InvalidInput("nothing to reach: ik needs a --target MARKER=X,Y,Z, a --plane or a --direction");
  if (!options.workspace.empty() && !options.start.empty())
    throw InvalidInput("--workspace chooses the start: it does not go with --start");
  check_method(options);
  if (options.lever_mm && options.directions.empty())
    throw InvalidInput("--lever is the lever of a direction: it needs --direction");
  check_extension("--output", options.output, {{".vtu", ""}});
  check_extension("--image", options.show.image, {{".png", ""}});
  check_extension("--plot", options.show.plot, {{".svg", ""}});
  check_view(options.show);
  check_solver(options);
}

}  // namespace softkin::cli
