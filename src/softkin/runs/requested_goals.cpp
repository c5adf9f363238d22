#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/runs/requested_goals.hpp>

namespace softkin::runs {

namespace {

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
      found[axis] = value;
    }
    begin = end + 1;
  }
  return true;
}

Vec3 or_zero(const Coordinates& coordinates) {
  return {coordinates[0].value_or(0), coordinates[1].value_or(0), coordinates[2].value_or(0)};
}

Vec3 at_rest(const Model& model, Index marker) {
  return model.markers[marker].at(model.rest);
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
    if (found != names.end()) return found - names.begin();
    refuse("no marker " + excerpt(name) + (names.empty() ? "; the scene has none" : suggest_name(name, names)));
  }

  [[nodiscard]] Coordinates coordinates(const std::string& text, bool empty_too = false) const {
    Coordinates found;
    if (!parse_coordinates(text, empty_too, found))
      refuse("expected three finite numbers in " + form_ + ", not " + excerpt(text));
    return found;
  }

  [[nodiscard]] Vec3 direction(const std::string& text) const {
    const Vec3 found = or_zero(coordinates(text));
    if (!(found.stableNorm() > 0)) refuse("the direction " + excerpt(text) + " is zero");
    return found;
  }

 private:
  const Model& model_;
  std::string option_, text_, form_, name_, value_;
};

NamedGoal target_of(const Model& model, const std::string& before, const std::string& text) {
  const Argument argument(model, before + "target", text, "MARKER=X,Y,Z in mm, for example tip=100,0,50 or tip=,,50");
  PositionGoal goal;
  goal.marker = argument.marker(argument.name());
  const Coordinates coordinates = argument.coordinates(argument.value(), true);
  goal.target = or_zero(coordinates);
  for (std::size_t axis = 0; axis < 3; ++axis) goal.axes[axis] = coordinates[axis].has_value();
  if (goal.axes == std::array<bool, 3>{}) argument.refuse("no coordinate of it is given");
  return {argument.name(), {goal}};
}

NamedGoal plane_of(const Model& model, const std::string& before, const std::string& text) {
  const Argument argument(model, before + "plane", text, "MARKER=PX,PY,PZ/NX,NY,NZ, for example tip=0,0,50/0,0,1");
  const std::size_t slash = argument.value().find('/');
  if (slash == std::string::npos)
    argument.refuse("expected a point in mm and a normal, PX,PY,PZ/NX,NY,NZ, not " + excerpt(argument.value()));
  PlaneGoal goal;
  goal.marker = argument.marker(argument.name());
  goal.point = or_zero(argument.coordinates(argument.value().substr(0, slash)));
  goal.normal = argument.direction(argument.value().substr(slash + 1));
  return {argument.name(), {goal}};
}

NamedGoal direction_of(const Model& model, const std::string& before, const std::string& text,
                       std::optional<double> lever_mm) {
  const Argument argument(model, before + "direction", text, "FROM:TO=X,Y,Z, for example base:tip=0,0,1");
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

NamedGoal press_of(const Model& model, const std::string& before, const std::string& text, double tolerance_mm,
                   std::optional<double> tolerance_N) {
  const Argument argument(model, before + "press", text, "NAME=FX,FY,FZ in N, for example floor=0,0,-2 or floor=,,-2");
  const std::vector<std::string> names = names_of_pressed(model);
  if (std::find(names.begin(), names.end(), argument.name()) == names.end())
    argument.refuse("no support, obstacle or body " + excerpt(argument.name()) +
                    (names.empty() ? "; the scene has none" : suggest_name(argument.name(), names)));
  ForceGoal goal = force_on(model, argument.name());
  const Coordinates components = argument.coordinates(argument.value(), true);
  goal.force = or_zero(components);
  for (std::size_t axis = 0; axis < 3; ++axis) goal.axes[axis] = components[axis].has_value();
  if (goal.axes == std::array<bool, 3>{}) argument.refuse("no component of it is given");
  goal.mm_per_N = usual_mm_per_N(goal, tolerance_mm, tolerance_N);
  return {argument.name(), {goal}};
}

void set_weight(const Model& model, const std::string& before, const std::string& text, std::vector<NamedGoal>& goals) {
  const Argument argument(model, before + "weight", text, "GOAL=WEIGHT, for example tip=2 or base:tip=0.5");
  double weight = 0;
  if (!parse_real(argument.value(), weight) || !(weight > 0))
    argument.refuse("the weight must be a finite number > 0, not " + excerpt(argument.value()));
  bool any = false;
  std::vector<std::string> names;
  for (NamedGoal& goal : goals) {
    names.push_back(goal.name);
    if (goal.name != argument.name()) continue;
    goal.goal.weight = weight;
    any = true;
  }
  if (!any)
    argument.refuse("nothing is requested of " + excerpt(argument.name()) + suggest_name(argument.name(), names));
}

}  // namespace

std::vector<NamedGoal> requested_goals(const Model& model, const GoalTexts& texts) {
  std::vector<NamedGoal> goals;
  for (const std::string& text : texts.targets) goals.push_back(target_of(model, texts.before_name, text));
  for (const std::string& text : texts.planes) goals.push_back(plane_of(model, texts.before_name, text));
  for (const std::string& text : texts.directions)
    goals.push_back(direction_of(model, texts.before_name, text, texts.lever_mm));
  for (const std::string& text : texts.presses)
    goals.push_back(press_of(model, texts.before_name, text, texts.tolerance_mm, texts.tolerance_force_N));
  for (const std::string& text : texts.weights) set_weight(model, texts.before_name, text, goals);
  std::vector<Goal> plain;
  for (const NamedGoal& goal : goals) plain.push_back(goal.goal);
  check_goals(model, plain);
  return goals;
}

}  // namespace softkin::runs
