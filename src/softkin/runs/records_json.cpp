#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/chamber_json.hpp>
#include <softkin/runs/layer_json.hpp>
#include <softkin/runs/physical_json.hpp>
#include <softkin/runs/record_log.hpp>
#include <softkin/runs/records_json.hpp>
#include <stdexcept>

namespace softkin::runs {

namespace {

constexpr std::array<Status, 4> statuses{Status::converged, Status::not_converged, Status::interrupted, Status::limit};
constexpr std::array<InverseStatus, 4> ends{InverseStatus::reached, InverseStatus::unreachable,
                                            InverseStatus::not_converged, InverseStatus::interrupted};
constexpr const char* sliding_names[] = {"none", "rear", "front", "both"};  // of Sliding

/// The value of that name. Throws std::out_of_range where there is none
template <class Value, std::size_t N>
Value named(const std::array<Value, N>& values, const std::string& name) {
  for (const Value value : values)
    if (name == name_of(value)) return value;
  throw std::out_of_range("no such status: " + name);
}

Json strain_json(const StrainHistogram& histogram) {
  Json json = {{"least", histogram.least},
               {"greatest", histogram.greatest},
               {"magnitude_percentile_95", histogram.percentile_95},
               {"bin_edges", histogram.edges},
               {"volume_shares", histogram.fractions},
               {"beyond_linear_range", Json::array()}};
  for (const auto& beyond : histogram.beyond)
    json["beyond_linear_range"].push_back(
        {{"region", beyond.region}, {"linear_range", beyond.linear_range}, {"volume_share", beyond.fraction}});
  return json;
}

StrainHistogram strain_of(const Json& json) {
  StrainHistogram strain;
  strain.least = json.at("least").get<double>();
  strain.greatest = json.at("greatest").get<double>();
  strain.percentile_95 = json.at("magnitude_percentile_95").get<double>();
  strain.edges = json.at("bin_edges").get<std::vector<double>>();
  strain.fractions = json.at("volume_shares").get<std::vector<double>>();
  for (const Json& beyond : json.at("beyond_linear_range"))
    strain.beyond.push_back({beyond.at("region").get<std::string>(), beyond.at("linear_range").get<double>(),
                             beyond.at("volume_share").get<double>()});
  return strain;
}

Json overlap_json(const SelfOverlap& overlap) {
  return {{"points", overlap.points},
          {"deepest_mm", overlap.deepest_mm},
          {"where_mm", overlap.points > 0 ? json_of(overlap.where) : Json()}};
}

SelfOverlap overlap_of(const Json& json) {
  SelfOverlap overlap{json.at("points").get<std::size_t>(), json.at("deepest_mm").get<double>()};
  if (overlap.points > 0) overlap.where = point_of(json.at("where_mm"));
  return overlap;
}

/// As many digits as a curve needs.
Json rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return known(std::strtod(text, nullptr));
}

/// Every iteration up to 100, then ever sparser: a curve stays a curve and a report stays small.
Json history_json(const StepRecord& record) {
  const bool all = record.history_iterations.empty();
  Json json = {
      {"iteration", Json::array()}, {"energy", Json::array()}, {"step_mm", Json::array()}, {"residual", Json::array()}};
  for (std::size_t i = 0; i < record.history.size(); i += all ? std::max<std::size_t>(1, i / 50) : 1) {
    json["iteration"].push_back(all ? static_cast<int>(i) + 1 : record.history_iterations[i]);
    json["energy"].push_back(rounded(record.history[i].energy));
    json["step_mm"].push_back(rounded(record.history[i].step_mm));
    json["residual"].push_back(rounded(record.history[i].gradient_norm));
  }
  return json;
}

void read_history(const Json& json, StepRecord& record) {
  record.history_iterations = json.at("iteration").get<std::vector<int>>();
  for (std::size_t i = 0; i < record.history_iterations.size(); ++i)
    record.history.push_back({number_or_nan(json.at("energy").at(i)), number_or_nan(json.at("step_mm").at(i)),
                              number_or_nan(json.at("residual").at(i))});
}

Json actuator_json(const Model& model, const Actuator& actuator, const ActuatorRecord& record) {
  Json json = {{"requested", record.requested}, {"achieved", known(record.achieved)}};
  if (actuator.curve) json[curve_key(*actuator.curve)] = record.by_curve ? known(*record.by_curve) : Json();
  const std::string key = multiplier_key(actuator);
  if (model.formulation != Formulation::physical || key.empty()) return json;
  json[key] = known(record.multiplier);
  if (actuator.is<CableDrive>()) json["slack"] = record.slack;
  if (record.tendon) {
    json["end_tension_N"] = known(record.tendon->end_N);
    json["sticking"] = known(record.tendon->sticks);
  }
  if (under_voltage(actuator)) json.update(layer_json(record.layer));
  if (actuator.is<ChamberDrive>()) json.update(chamber_json(actuator, record));
  return json;
}

ActuatorRecord actuator_of(const Model& model, const Actuator& actuator, const Json& json) {
  ActuatorRecord record{json.at("requested").get<double>(), number_or_nan(json.at("achieved"))};
  if (actuator.curve)
    if (const Json& input = json.at(curve_key(*actuator.curve)); !input.is_null())
      record.by_curve = input.get<double>();
  const std::string key = multiplier_key(actuator);
  if (model.formulation != Formulation::physical || key.empty()) return record;
  record.multiplier = number_or_nan(json.at(key));
  if (actuator.is<CableDrive>()) record.slack = json.at("slack").get<bool>();
  if (json.contains("end_tension_N"))
    record.tendon = {number_or_nan(json.at("end_tension_N")), number_or_nan(json.at("sticking"))};
  if (under_voltage(actuator)) record.layer = layer_of(json);
  read_chamber(actuator, json, record);
  return record;
}

Json by_actuator(const Model& model, const Actuation& values) {
  Json json = Json::object();
  for (std::size_t a = 0; a < model.actuators.size(); ++a) json[model.actuators[a].name] = values[a];
  return json;
}

Actuation by_actuator(const Model& model, const Json& json) {
  Actuation values(model.actuators.size());
  if (json.size() != model.actuators.size()) throw OtherActuators();
  for (std::size_t a = 0; a < model.actuators.size(); ++a) values[a] = json.at(model.actuators[a].name).get<double>();
  return values;
}

/// What the end of a record has where its shape is in a file.
void add_shape(const StepRecord& record, Json& json) {
  if (record.shape.empty()) return;
  json["shape"] = record.shape;
  json["shape_fingerprint"] = record.shape_fingerprint;
}

/// Numbers of a record in the order of the report: visit(key, number) of each.
template <class Record, class Visit>
void counts_and_measures(Record& record, const Visit& visit) {
  visit("iterations", record.iterations);
  visit("factorisations", record.factorisations);
  visit("factorisations_in_double", record.factorisations_in_double);
  visit("projections", record.projections);
  visit("shifts", record.shifts);
  visit("continuation_steps", record.continuation_steps);
  visit("residual", record.gradient_norm);
  visit("step_mm", record.step_mm);
  visit("tolerance_mm", record.tolerance_mm);
  visit("estimated_error_mm", record.estimated_error_mm);
  visit("seconds", record.seconds);
  visit("energy", record.energy);
  visit("inverted_elements", record.inverted_elements);
  visit("largest_displacement_mm", record.largest_displacement_mm);
}

/// Of the markers that have an orientation.
Json turns_json(const Model& model, const StepRecord& record) {
  Json turns = Json::object();
  for (std::size_t m = 0; m < record.marker_turns.size(); ++m)
    if (std::isfinite(record.marker_turns[m])) turns[model.markers[m].name] = record.marker_turns[m];
  return turns;
}

std::vector<double> marker_turns_of(const Model& model, const Json& step) {
  std::vector<double> turns(model.markers.size(), std::numeric_limits<double>::quiet_NaN());
  if (!step.contains("marker_turns_deg")) return turns;
  const Json& json = step.at("marker_turns_deg");
  for (std::size_t m = 0; m < turns.size(); ++m)
    if (json.contains(model.markers[m].name)) turns[m] = json.at(model.markers[m].name).get<double>();
  return turns;
}

/// All of a step but its shape.
Json step_json(const Model& model, const StepRecord& record) {
  Json step = {{"actuation", by_actuator(model, record.actuation)},
               {"status", name_of(record.status)},
               {"reached", record.reached_fraction ? Json(*record.reached_fraction) : Json()},
               {"remark", record.remark},
               {"shape_actuation", Json()}};
  counts_and_measures(record, [&step](const char* key, const auto& value) { write_number(value, step[key]); });
  step["markers"] = Json::object();
  step["actuators"] = Json::object();
  if (record.shape_actuation) step["shape_actuation"] = by_actuator(model, *record.shape_actuation);
  for (std::size_t m = 0; m < model.markers.size(); ++m)
    step["markers"][model.markers[m].name] = json_of(record.markers[m]);
  if (Json turns = turns_json(model, record); !turns.empty()) step["marker_turns_deg"] = std::move(turns);
  if (model.formulation == Formulation::physical) step.update(physical_json(model, record));
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    step["actuators"][model.actuators[a].name] = actuator_json(model, model.actuators[a], record.actuators[a]);
  step["self_overlap"] = overlap_json(record.self_overlap);
  step["strain"] = strain_json(record.strain);
  step["history"] = history_json(record);
  if (record.time_s) step["time_s"] = *record.time_s;
  if (record.viscous_loss_mJ) step["viscous_loss_mJ"] = *record.viscous_loss_mJ;
  return step;
}

const std::string& marker_name(const Model& model, const MarkerPath& path, std::size_t m) {
  return model.markers[path.markers[m]].name;
}

}  // namespace

double number_or_nan(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Vec3 point_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Status status_of(const std::string& name) {
  return named(statuses, name);
}

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json known(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

void write_number(double value, Json& json) {
  json = known(value);
}

void write_number(int value, Json& json) {
  json = value;
}

void write_number(std::size_t value, Json& json) {
  json = value;
}

void read_number(const Json& json, double& value) {
  value = number_or_nan(json);
}

void read_number(const Json& json, int& value) {
  value = json.get<int>();
}

void read_number(const Json& json, std::size_t& value) {
  value = json.get<std::size_t>();
}

Json to_json(const Model& model, const StepRecord& record) {
  Json json = step_json(model, record);
  add_shape(record, json);
  return json;
}

Json to_json(const Model& model, const MarkerPath& path, const WaypointRecord& record) {
  Json step = step_json(model, record);
  Json& json = step["waypoint"];
  json = {{"inserted", record.requested.inserted}, {"targets", Json::object()}};
  if (record.requested.time) json["time_s"] = *record.requested.time;
  for (std::size_t m = 0; m < path.markers.size(); ++m) {
    Json& target = json["targets"][marker_name(model, path, m)] = Json::array();
    for (std::size_t axis = 0; axis < 3; ++axis)
      target.push_back(path.axes[m][axis] ? Json(record.requested.targets[m][axis]) : Json());
  }
  json["status"] = name_of(record.end);
  json["reached"] = record.is_reached();
  json["error_mm"] = record.error_mm;
  json["equilibria"] = record.equilibria;
  json["command_change"] = record.command_change;
  json["step_mm"] = record.step_mm;
  json["remark"] = record.search_remark;
  add_shape(record, step);
  return step;
}

Json to_json(const Model& model, const WalkRecord& record) {
  Json step = step_json(model, record);
  Json& json = step["walk"];
  json = {{"cycle", record.cycle}, {"sliding", sliding_names[static_cast<std::size_t>(record.walk.sliding)]}};
  if (model.formulation == Formulation::physical) json["friction_N"] = record.walk.friction_N;
  json["feet_mm"] = {{foot_name(model, 0), record.walk.rear_mm}, {foot_name(model, 1), record.walk.front_mm}};
  json["travel_mm"] = record.walk.travel_mm;
  json["shift_mm"] = record.walk.shift_mm;
  json["equilibria"] = record.walk.equilibria;
  add_shape(record, step);
  return step;
}

void from_json(const Model& model, const Json& json, StepRecord& record) {
  record.actuation = by_actuator(model, json.at("actuation"));
  record.status = status_of(json.at("status").get<std::string>());
  if (const Json& reached = json.at("reached"); !reached.is_null()) record.reached_fraction = reached.get<double>();
  record.remark = json.at("remark").get<std::string>();
  if (const Json& shape = json.at("shape_actuation"); !shape.is_null())
    record.shape_actuation = by_actuator(model, shape);
  if (model.formulation == Formulation::physical) read_physical(model, json, record);
  counts_and_measures(record, [&json](const char* key, auto& value) { read_number(json.at(key), value); });
  for (const Marker& marker : model.markers) record.markers.push_back(point_of(json.at("markers").at(marker.name)));
  record.marker_turns = marker_turns_of(model, json);
  for (const Actuator& actuator : model.actuators)
    record.actuators.push_back(actuator_of(model, actuator, json.at("actuators").at(actuator.name)));
  record.self_overlap = overlap_of(json.at("self_overlap"));
  record.strain = strain_of(json.at("strain"));
  read_history(json.at("history"), record);
  if (json.contains("time_s")) record.time_s = json.at("time_s").get<double>();
  if (json.contains("viscous_loss_mJ")) record.viscous_loss_mJ = json.at("viscous_loss_mJ").get<double>();
  if (!json.contains("shape")) return;
  record.shape = json.at("shape").get<std::string>();
  record.shape_fingerprint = json.at("shape_fingerprint").get<std::string>();
}

void from_json(const Model& model, const MarkerPath& path, const Json& step, WaypointRecord& record) {
  from_json(model, step, static_cast<StepRecord&>(record));
  const Json& json = step.at("waypoint");
  record.requested.inserted = json.at("inserted").get<bool>();
  if (json.contains("time_s")) record.requested.time = json.at("time_s").get<double>();
  if (json.at("targets").size() != path.markers.size()) throw std::out_of_range("other markers");
  for (std::size_t m = 0; m < path.markers.size(); ++m) {
    const Json& target = json.at("targets").at(marker_name(model, path, m));
    Vec3 point = Vec3::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (target.at(axis).is_null() == path.axes[m][axis]) throw std::out_of_range("other axes");
      if (path.axes[m][axis]) point[axis] = target.at(axis).get<double>();
    }
    record.requested.targets.push_back(point);
  }
  record.end = named(ends, json.at("status").get<std::string>());
  record.error_mm = json.at("error_mm").get<double>();
  record.equilibria = json.at("equilibria").get<int>();
  record.command_change = json.at("command_change").get<double>();
  record.step_mm = json.at("step_mm").get<double>();
  record.search_remark = json.at("remark").get<std::string>();
}

void from_json(const Model& model, const Json& step, WalkRecord& record) {
  from_json(model, step, static_cast<StepRecord&>(record));
  const Json& json = step.at("walk");
  record.cycle = json.at("cycle").get<std::size_t>();
  const auto name = std::find(std::begin(sliding_names), std::end(sliding_names), json.at("sliding"));
  if (name == std::end(sliding_names)) throw std::out_of_range("no such sliding");
  record.walk.sliding = static_cast<Sliding>(name - std::begin(sliding_names));
  if (model.formulation == Formulation::physical) record.walk.friction_N = json.at("friction_N").get<double>();
  record.walk.rear_mm = json.at("feet_mm").at(foot_name(model, 0)).get<double>();
  record.walk.front_mm = json.at("feet_mm").at(foot_name(model, 1)).get<double>();
  record.walk.travel_mm = json.at("travel_mm").get<double>();
  record.walk.shift_mm = json.at("shift_mm").get<double>();
  record.walk.equilibria = json.at("equilibria").get<int>();
}

}  // namespace softkin::runs
