#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/inverse_text.hpp>
#include <utility>

namespace softkin::runs {

namespace {

constexpr int value_decimals = 4, length_decimals = 3, direction_decimals = 5;

std::string load_text(const Model& model, const Actuator& actuator, const ActuatorRecord& record) {
  if (model.formulation != Formulation::physical || multiplier_key(actuator).empty()) return "-";
  if (record.slack) return "slack";
  if (!std::isfinite(record.multiplier)) return "unknown";
  return decimal(record.multiplier, value_decimals) + " " + multiplier_unit(actuator);
}

/// "50.0000 kPa": what the actuator's curve gives for the command.
std::string curve_input_text(const Actuator& actuator, const ActuatorRecord& record) {
  if (!actuator.curve) return "-";
  return record.by_curve ? decimal(*record.by_curve, value_decimals) + unit_of_input(actuator.curve->input) : "outside";
}

std::string coordinates_text(const Vec3& point, int decimals) {
  return decimal(point.x(), decimals) + " " + decimal(point.y(), decimals) + " " + decimal(point.z(), decimals);
}

/// "any" where a component does not count.
std::string counted_text(const Vec3& vector, const std::array<bool, 3>& axes, int decimals) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis)
    text += (axis > 0 ? " " : "") + (axes[axis] ? decimal(vector[axis], decimals) : std::string("any"));
  return text;
}

std::string requested_text(const Goal& goal) {
  if (const auto* position = std::get_if<PositionGoal>(&goal.what))
    return counted_text(position->target, position->axes, length_decimals) + " mm";
  if (const auto* force = std::get_if<ForceGoal>(&goal.what))
    return counted_text(force->force, force->axes, value_decimals) + " N";
  if (const auto* plane = std::get_if<PlaneGoal>(&goal.what))
    return "plane at " + coordinates_text(plane->point, length_decimals) + " mm across " +
           coordinates_text(plane->normal.stableNormalized(), direction_decimals);
  const auto& direction = std::get<DirectionGoal>(goal.what);
  return "towards " + coordinates_text(direction.direction.stableNormalized(), direction_decimals);
}

std::string found_text(const Model& model, const Goal& goal, const Points& positions, const StepRecord& step) {
  const Vec3 found = found_of(model, goal, positions, step);
  if (std::holds_alternative<DirectionGoal>(goal.what)) return coordinates_text(found, direction_decimals);
  if (std::holds_alternative<ForceGoal>(goal.what)) return coordinates_text(found, value_decimals) + " N";
  return coordinates_text(found, length_decimals) + " mm";
}

}  // namespace

InverseTables inverse_tables(const Model& model, const std::vector<NamedGoal>& goals, const InverseResult& found,
                             const StepRecord& step) {
  constexpr auto decimals = Column::Form::decimals;
  Table actuators{{{.title = "actuator", .left = true},
                   {.title = "command", .digits = value_decimals, .form = decimals},
                   {.left = true},
                   {.title = "range"},
                   {.title = "achieved [-]", .digits = value_decimals, .form = decimals},
                   {.title = "load"}}};
  const bool curves = std::any_of(model.actuators.begin(), model.actuators.end(),
                                  [](const Actuator& actuator) { return actuator.curve.has_value(); });
  if (curves) actuators.columns.push_back({.title = "by curve"});
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const ActuatorRecord& record = step.actuators[a];
    actuators.rows.push_back({actuator.name, record.requested, bracketed_unit(actuator),
                              number(actuator.low) + " to " + number(actuator.high),
                              has_measure(actuator) ? Cell(record.achieved) : Cell("-"),
                              load_text(model, actuator, record)});
    if (curves) actuators.rows.back().emplace_back(curve_input_text(actuator, record));
  }
  Table reached{{{.title = "marker", .left = true},
                 {.title = "asked"},
                 {.title = "found"},
                 {.title = "error", .unit = "mm", .digits = 2}}};
  Table exerted = reached;
  exerted.columns.front().title = "force on";
  exerted.columns.back().unit = "N";
  for (std::size_t i = 0; i < goals.size(); ++i) {
    (std::holds_alternative<ForceGoal>(goals[i].goal.what) ? exerted : reached)
        .rows.push_back({goals[i].name, requested_text(goals[i].goal),
                         found_text(model, goals[i].goal, found.equilibrium.state.positions, step),
                         own_error(goals[i].goal, found.errors_mm[i])});
  }
  return {std::move(actuators), std::move(reached), std::move(exerted)};
}

std::string inverse_summary(const InverseResult& found, const Misses& misses) {
  const auto count = [](int n) { return static_cast<std::size_t>(std::max(0, n)); };
  return "error at most " + misses_text(misses, 2) + "; " + counted(count(found.iterations), "iteration") + ", " +
         counted(count(found.equilibria), "equilibrium", "equilibria") + ", " + decimal(found.seconds, 2) + " s";
}

}  // namespace softkin::runs
