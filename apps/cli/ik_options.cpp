#include "ik_options.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>

#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr int most = 1'000'000;

void add_goals(CLI::App& command, IkOptions& options) {
  add_repeated(command, "--target", options.targets, "M=P",
               "MARKER=X,Y,Z: where a marker is to be [mm]; a coordinate left\nempty does not count (tip=,,40); "
               "repeatable, as the three below");
  add_repeated(command, "--plane", options.planes, "M=P/N",
               "MARKER=PX,PY,PZ/NX,NY,NZ: a plane for a marker to be in, by a\npoint [mm] and its normal");
  add_repeated(command, "--direction", options.directions, "A:B=D",
               "FROM:TO=X,Y,Z: where the line from one marker to another is to\npoint; its error is that of its unit "
               "vector times --lever");
  add_repeated(command, "--press", options.presses, "N=F",
               "NAME=FX,FY,FZ: the force that the robot is to exert on a support,\nan obstacle or a body [N]; a "
               "component left empty does not\ncount (floor=,,-2); physical");
  add_value(command, "--lever", options.lever_mm, "MM",
            "How far away a wrong direction counts [mm] (default: as far as\nits markers are apart at rest)",
            positive_length());
  add_repeated(command, "--weight", options.weights, "M=W",
               "MARKER=W, FROM:TO=W or NAME=W: weight in the sum of squares of\nwhat is asked of them (default: 1); "
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
  add_value(command, "--tolerance-force", options.tolerance_force_N, "N",
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

using Coordinates = std::array<std::optional<double>, 3>;

/// "1,2,3"; where empty coordinates are allowed "1,,3" too.
bool parse_coordinates(const std::string& text, bool empty_too, Coordinates& found) {
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos) return false;
    const std::string part = text.substr(begin, end - begin);
    double value = 0;
    if (!part.empty() || !empty_too) {
      if (!parse_real(part, value)) return false;
      found[static_cast<std::size_t>(axis)] = value;
    }
    begin = end + 1;
  }
  return true;
}

Vec3 point_of(const Coordinates& coordinates) {
  return {coordinates[0].value_or(0), coordinates[1].value_or(0), coordinates[2].value_or(0)};
}

Vec3 at_rest(const Model& model, Index marker) {
  return model.markers[static_cast<std::size_t>(marker)].at(model.rest);
}

/// One argument of an option: NAME=VALUE.
class Argument {
 public:
  Argument(const Model& model, std::string option, const std::string& text, const std::string& form)
      : model_(model), option_(std::move(option)), text_(text), form_(form) {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) refuse("expected " + form_);
    name_ = text.substr(0, equals);
    value_ = text.substr(equals + 1);
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput(option_ + " " + excerpt(text_) + ": " + why);
  }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& value() const { return value_; }

  [[nodiscard]] Index marker(const std::string& name) const {
    std::vector<std::string> names;
    for (const Marker& marker : model_.markers) names.push_back(marker.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<Index>(found - names.begin());
    refuse("no marker " + excerpt(name) + (names.empty() ? "; the scene has none" : suggest_name(name, names)));
  }

  [[nodiscard]] Coordinates coordinates(const std::string& text, bool empty_too = false) const {
    Coordinates found;
    if (!parse_coordinates(text, empty_too, found))
      refuse("expected three finite numbers in " + form_ + ", not " + excerpt(text));
    return found;
  }

  [[nodiscard]] Vec3 direction(const std::string& text) const {
    const Vec3 found = point_of(coordinates(text));
    if (!(found.stableNorm() > 0)) refuse("the direction " + excerpt(text) + " is zero");
    return found;
  }

 private:
  const Model& model_;
  std::string option_, text_, form_, name_, value_;
};

runs::NamedGoal target_of(const Model& model, const std::string& text) {
  const Argument argument(model, "--target", text, "MARKER=X,Y,Z in mm, for example tip=100,0,50 or tip=,,50");
  PositionGoal goal;
  goal.marker = argument.marker(argument.name());
  const Coordinates coordinates = argument.coordinates(argument.value(), true);
  goal.target = point_of(coordinates);
  for (std::size_t axis = 0; axis < 3; ++axis) goal.axes[axis] = coordinates[axis].has_value();
  if (goal.axes == std::array<bool, 3>{}) argument.refuse("no coordinate of it is given");
  return {argument.name(), {goal}};
}

runs::NamedGoal plane_of(const Model& model, const std::string& text) {
  const Argument argument(model, "--plane", text, "MARKER=PX,PY,PZ/NX,NY,NZ, for example tip=0,0,50/0,0,1");
  const std::size_t slash = argument.value().find('/');
  if (slash == std::string::npos)
    argument.refuse("expected a point in mm and a normal, PX,PY,PZ/NX,NY,NZ, not " + excerpt(argument.value()));
  PlaneGoal goal;
  goal.marker = argument.marker(argument.name());
  goal.point = point_of(argument.coordinates(argument.value().substr(0, slash)));
  goal.normal = argument.direction(argument.value().substr(slash + 1));
  return {argument.name(), {goal}};
}

runs::NamedGoal direction_of(const Model& model, const std::string& text, std::optional<double> lever_mm) {
  const Argument argument(model, "--direction", text, "FROM:TO=X,Y,Z, for example base:tip=0,0,1");
  const std::size_t colon = argument.name().find(':');
  if (colon == std::string::npos) argument.refuse("expected two markers, FROM:TO=X,Y,Z");
  DirectionGoal goal;
  goal.from = argument.marker(argument.name().substr(0, colon));
  goal.to = argument.marker(argument.name().substr(colon + 1));
  goal.direction = argument.direction(argument.value());
  const double apart = (at_rest(model, goal.to) - at_rest(model, goal.from)).norm();
  if (!(apart > 0)) argument.refuse("these markers are in one place at rest");
  goal.lever_mm = lever_mm.value_or(apart);
  return {argument.name(), {goal}};
}

runs::NamedGoal press_of(const Model& model, const std::string& text, double tolerance_mm,
                         std::optional<double> tolerance_N) {
  const Argument argument(model, "--press", text, "NAME=FX,FY,FZ in N, for example floor=0,0,-2 or floor=,,-2");
  const std::vector<std::string> names = names_of_pressed(model);
  if (std::find(names.begin(), names.end(), argument.name()) == names.end())
    argument.refuse("no support, obstacle or body " + excerpt(argument.name()) +
                    (names.empty() ? "; the scene has none" : suggest_name(argument.name(), names)));
  ForceGoal goal = force_on(model, argument.name());
  const Coordinates components = argument.coordinates(argument.value(), true);
  goal.force = point_of(components);
  for (std::size_t axis = 0; axis < 3; ++axis) goal.axes[axis] = components[axis].has_value();
  if (goal.axes == std::array<bool, 3>{}) argument.refuse("no component of it is given");
  goal.mm_per_N = usual_mm_per_N(goal, tolerance_mm, tolerance_N);
  return {argument.name(), {goal}};
}

void set_weight(const Model& model, const std::string& text, std::vector<runs::NamedGoal>& goals) {
  const Argument argument(model, "--weight", text, "GOAL=WEIGHT, for example tip=2 or base:tip=0.5");
  double weight = 0;
  if (!parse_real(argument.value(), weight) || !(weight > 0))
    argument.refuse("the weight must be a finite number > 0, not " + excerpt(argument.value()));
  bool any = false;
  std::vector<std::string> names;
  for (runs::NamedGoal& goal : goals) {
    names.push_back(goal.name);
    if (goal.name != argument.name()) continue;
    goal.goal.weight = weight;
    any = true;
  }
  if (!any) argument.refuse("nothing is asked of " + excerpt(argument.name()) + suggest_name(argument.name(), names));
}

}  // namespace

std::vector<Output> IkOptions::outputs() const {
  return asked_outputs({{"--output", output}, {"--report", report}, {"--image", show.image}, {"--plot", show.plot}});
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
  if (options.targets.empty() && options.planes.empty() && options.directions.empty() && options.presses.empty())
    throw InvalidInput("nothing to reach: ik needs a --target MARKER=X,Y,Z, a --plane, a --direction or a --press");
  if (!options.presses.empty() && !options.map.empty())
    throw InvalidInput("--press is solved for: a map tells no forces, so it does not go with --map");
  if (options.tolerance_force_N && options.presses.empty())
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
  if (options.lever_mm && options.directions.empty())
    throw InvalidInput("--lever is the lever of a direction: it needs --direction");
  check_extension("--output", options.output, {{".vtu", ""}});
  check_extension("--report", options.report, {{".json", ""}});
  check_extension("--image", options.show.image, {{".png", ""}});
  check_extension("--plot", options.show.plot, {{".svg", ""}});
  check_view(options.show);
  check_solver(options);
}

std::vector<runs::NamedGoal> asked_goals(const Model& model, const IkOptions& options) {
  std::vector<runs::NamedGoal> goals;
  for (const std::string& text : options.targets) goals.push_back(target_of(model, text));
  for (const std::string& text : options.planes) goals.push_back(plane_of(model, text));
  for (const std::string& text : options.directions) goals.push_back(direction_of(model, text, options.lever_mm));
  const double tolerance_mm = options.inverse().tolerance_mm;
  for (const std::string& text : options.presses)
    goals.push_back(press_of(model, text, tolerance_mm, options.tolerance_force_N));
  for (const std::string& text : options.weights) set_weight(model, text, goals);
  std::vector<Goal> plain;
  for (const runs::NamedGoal& goal : goals) plain.push_back(goal.goal);
  check_goals(model, plain);
  return goals;
}

}  // namespace softkin::cli
