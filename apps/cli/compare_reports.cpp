#include "compare_reports.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>

#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

Vec3 point_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// What the robot answers with, beside the actuators that are asked for it.
std::vector<std::pair<std::string, double>> loads_of(const Json& actuators) {
  std::vector<std::pair<std::string, double>> loads;
  for (const auto& [name, actuator] : actuators.items())
    for (const auto& [key, unit] : {std::pair{"pressure_kPa", "kPa"}, std::pair{"tension_N", "N"}})
      if (actuator.contains(key)) loads.emplace_back(name + " [" + unit + "]", actuator.at(key).template get<double>());
  return loads;
}

ReportedStep step_of(const Json& json) {
  ReportedStep step;
  for (const auto& [name, value] : json.at("actuation").items()) step.actuation.emplace_back(name, value.get<double>());
  for (const auto& [name, point] : json.at("markers").items()) step.markers.emplace_back(name, point_of(point));
  step.loads = loads_of(json.at("actuators"));
  if (json.contains("time_s")) step.time = json.at("time_s").get<double>();
  step.status = json.at("status").get<std::string>();
  return step;
}

std::map<std::string, std::string> units_of(const Json& report) {
  std::map<std::string, std::string> units;
  if (!report.contains("actuators")) return units;
  for (const auto& [name, actuator] : report.at("actuators").items()) {
    const std::string unit = actuator.at("unit").template get<std::string>();
    units[name] = unit == "ratio to rest" ? "-" : unit;
  }
  return units;
}

ReportedPath path_of(const std::string& file, const Json& json) {
  ReportedPath path{file,
                    json.at("formulation").get<std::string>() + ", " + json.at("solver").at("name").get<std::string>(),
                    {},
                    units_of(json)};
  double elapsed = 0;
  for (const Json& step : json.at("steps")) {
    elapsed += step.at("seconds").get<double>();
    path.steps.push_back(step_of(step));
    path.steps.back().elapsed = elapsed;
  }
  return path;
}

std::string asked_text(const ReportedStep& step) {
  std::string text;
  for (const auto& [name, value] : step.actuation)
    text += (text.empty() ? "" : ", ") + name + " = " + number(value, 12);
  return text.empty() ? "nothing" : text;
}

}  // namespace

ReportedPath read_reported_path(const std::string& file) {
  try {
    ReportedPath path = path_of(file, Json::parse(read_file(file)));
    if (path.steps.empty()) throw InvalidInput({file}, "the report has no steps");
    return path;
  } catch (const Json::exception&) {
    throw InvalidInput({file}, "this is not a report of softkin fk, or a number that it needs is not known");
  }
}

void check_same_steps(const ReportedPath& first, const ReportedPath& second) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput({second.file}, why + "; reports are compared step by step, so they need the same path");
  };
  if (second.steps.size() != first.steps.size())
    refuse("it has " + counted(second.steps.size(), "step") + ", but " + first.file + " has " +
           std::to_string(first.steps.size()));
  for (std::size_t i = 0; i < first.steps.size(); ++i)
    if (second.steps[i].actuation != first.steps[i].actuation)
      refuse("step " + std::to_string(i) + " asks for " + asked_text(second.steps[i]) + ", but in " + first.file +
             " for " + asked_text(first.steps[i]));
}

std::vector<Vec3> places_of(const ReportedPath& path, const std::string& marker) {
  std::vector<Vec3> places;
  for (const ReportedStep& step : path.steps) {
    const auto found =
        std::find_if(step.markers.begin(), step.markers.end(), [&](const auto& each) { return each.first == marker; });
    if (found == step.markers.end()) {
      std::vector<std::string> names;
      for (const auto& [name, point] : step.markers) names.push_back(name);
      throw InvalidInput({path.file}, "no marker " + excerpt(marker) +
                                          (names.empty() ? "; the report has none" : suggest_name(marker, names)));
    }
    places.push_back(found->second);
  }
  return places;
}

std::vector<double> turns_of(const ReportedPath& path, const std::string& from, const std::string& to) {
  const std::vector<Vec3> begins = places_of(path, from), ends = places_of(path, to);
  const Vec3 start = ends[0] - begins[0];
  if (!(start.norm() > 0))
    throw InvalidInput({path.file}, "markers '" + from + "' and '" + to + "' are at one place in the first step");
  constexpr double rounding = 1e-9;  // below it the axis of a turn is noise
  Vec3 axis = Vec3::Zero();
  std::vector<double> turns;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const Vec3 line = ends[i] - begins[i], turned = start.cross(line);
    if (axis.isZero() && turned.norm() > rounding * start.norm() * line.norm()) axis = turned.normalized();
    double turn = degrees * std::atan2(axis.dot(turned), start.dot(line));
    const double before = turns.empty() ? 0 : turns.back();
    turn += 360 * std::round((before - turn) / 360);
    turns.push_back(turn);
  }
  return turns;
}

}  // namespace softkin::cli
