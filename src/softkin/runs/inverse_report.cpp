#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/inverse_report.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/report_head.hpp>

namespace softkin::runs {

namespace {

Json vector_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Json asked_json(const Goal& goal) {
  if (const auto* position = std::get_if<PositionGoal>(&goal.what)) {
    Json target = Json::array();
    for (int axis = 0; axis < 3; ++axis)
      target.push_back(position->axes[static_cast<std::size_t>(axis)] ? Json(position->target[axis]) : Json());
    return {{"kind", "target"}, {"target_mm", target}};
  }
  if (const auto* plane = std::get_if<PlaneGoal>(&goal.what))
    return {{"kind", "plane"}, {"point_mm", vector_json(plane->point)}, {"normal", vector_json(plane->normal)}};
  const auto& direction = std::get<DirectionGoal>(goal.what);
  return {{"kind", "direction"}, {"direction", vector_json(direction.direction)}, {"lever_mm", direction.lever_mm}};
}

Json goals_json(const Model& model, const std::vector<NamedGoal>& goals, const InverseResult& found) {
  Json all = Json::array();
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const Goal& goal = goals[i].goal;
    Json json = {{"of", goals[i].name}};
    json.update(asked_json(goal));
    const bool direction = std::holds_alternative<DirectionGoal>(goal.what);
    json[direction ? "found" : "found_mm"] = vector_json(place_of(model, goal, found.equilibrium.state.positions));
    json["weight"] = goal.weight;
    json["error_mm"] = found.errors_mm[static_cast<Index>(i)];
    all.push_back(json);
  }
  return all;
}

std::string unit_of(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return unit.empty() ? "unit of ratio" : unit;
}

/// Of every marker and every pressure and tension, by the command of every actuator, each with its unit.
Json jacobian_json(const Model& model, const Sensitivity& sensitivity) {
  Json json = {{"unit", Json::object()}, {"markers", Json::object()}};
  std::vector<Index> markers;
  for (std::size_t p = 0; p < model.markers.size(); ++p) markers.push_back(static_cast<Index>(p));
  const Eigen::MatrixXd slopes = jacobian(model, sensitivity, markers);
  for (const Actuator& actuator : model.actuators) json["unit"][actuator.name] = "mm per " + unit_of(actuator);
  for (std::size_t p = 0; p < markers.size(); ++p)
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      json["markers"][model.markers[p].name][model.actuators[a].name] =
          vector_json(slopes.block<3, 1>(3 * static_cast<Index>(p), static_cast<Index>(a)));
  if (model.formulation != Formulation::physical) return json;
  for (std::size_t i = 0; i < model.actuators.size(); ++i) {
    const std::string key = multiplier_key(model.actuators[i]);
    if (key.empty()) continue;
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      json[key][model.actuators[i].name][model.actuators[a].name] =
          sensitivity.multipliers(static_cast<Index>(i), static_cast<Index>(a));
  }
  return json;
}

/// Every equilibrium of the search.
Json history_json(const std::vector<InverseTrial>& history) {
  Json json = {{"error_mm", Json::array()}, {"iterations", Json::array()}};
  for (const InverseTrial& record : history) {
    json["error_mm"].push_back(std::isfinite(record.error_mm) ? Json(record.error_mm) : Json());
    json["iterations"].push_back(record.iterations);
  }
  return json;
}

Json inverse_json(const Model& model, const InverseOptions& options, const std::vector<NamedGoal>& goals,
                  const InverseResult& found) {
  const bool newton = options.method == InverseMethod::newton;
  Json json = {{"method", name_of(options.method)},
               {"tolerance_mm", options.tolerance_mm},
               {"status", name_of(found.status)},
               {"reached", found.status == InverseStatus::reached},
               {"remark", found.remark},
               {"error_mm", found.errors_mm.maxCoeff()},
               {"goals", goals_json(model, goals, found)},
               {"at_end_of_range", Json::object()},
               {"iterations", found.iterations},
               {"equilibria", found.equilibria},
               {"seconds", found.seconds}};
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (found.active[a] != 0) json["at_end_of_range"][model.actuators[a].name] = found.active[a] < 0 ? "low" : "high";
  if (newton && found.status != InverseStatus::reached) json["slope_mm_per_range"] = found.slope;
  if (newton && found.sensitivity.regular) json["jacobian"] = jacobian_json(model, found.sensitivity);
  json["history"] = history_json(found.history);
  return json;
}

}  // namespace

Vec3 place_of(const Model& model, const Goal& goal, const Points& positions) {
  const auto at = [&](Index marker) { return model.markers[static_cast<std::size_t>(marker)].point.at(positions); };
  if (const auto* position = std::get_if<PositionGoal>(&goal.what)) return at(position->marker);
  if (const auto* plane = std::get_if<PlaneGoal>(&goal.what)) return at(plane->marker);
  const auto& direction = std::get<DirectionGoal>(goal.what);
  return (at(direction.to) - at(direction.from)).stableNormalized();
}

InverseRecord inverse_record(const Model& model, const InverseResult& found, const ElementDeformation& deformation) {
  InverseRecord record;
  static_cast<StepRecord&>(record) = step_record(model, found.equilibrium, deformation);
  record.seconds = found.seconds;
  record.error_mm = found.errors_mm.maxCoeff();
  return record;
}

RecordLog inverse_report(const Model& model, const std::string& scene, const std::filesystem::path& file,
                         const InverseOptions& options, const std::vector<NamedGoal>& goals, const InverseResult& found,
                         const InverseRecord& record) {
  Json head = Json::parse(report_head(model, scene, options.statics));
  head["ik"] = inverse_json(model, options, goals, found);
  Json step = to_json(model, record);
  step["error_mm"] = record.error_mm;
  RecordLog log(model, {file}, line_of(head), {});
  log.add(line_of(step), record.seconds);
  return log;
}

}  // namespace softkin::runs
