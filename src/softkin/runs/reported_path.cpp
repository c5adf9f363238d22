#include <algorithm>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/runs/reported_path.hpp>

namespace softkin::runs {

namespace {

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
  for (const auto& [name, point] : json.at("markers").items())
    step.markers.emplace_back(name,
                              Vec3(point.at(0).get<double>(), point.at(1).get<double>(), point.at(2).get<double>()));
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

/// The value of that name in each step; what: "marker", of the message.
template <class Value>
std::vector<Value> values_of(const ReportedPath& path, std::vector<std::pair<std::string, Value>> ReportedStep::*of,
                             const std::string& what, const std::string& name, const char* none) {
  std::vector<Value> values;
  for (const ReportedStep& step : path.steps) {
    const auto found =
        std::find_if((step.*of).begin(), (step.*of).end(), [&](const auto& each) { return each.first == name; });
    if (found == (step.*of).end()) {
      std::vector<std::string> names;
      for (const auto& [each, value] : step.*of) names.push_back(each);
      throw InvalidInput({path.file},
                         "no " + what + " " + excerpt(name) + (names.empty() ? none : suggest_name(name, names)));
    }
    values.push_back(found->second);
  }
  return values;
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

std::string marker_of(const ReportedPath& path, const std::string& asked, const std::string& hint) {
  if (!asked.empty()) return asked;
  const auto& markers = path.steps.front().markers;
  if (markers.empty()) throw InvalidInput({path.file}, "the report has no markers" + hint);
  return markers.front().first;
}

std::vector<Vec3> places_of(const ReportedPath& path, const std::string& marker) {
  return values_of(path, &ReportedStep::markers, "marker", marker, "; the report has none");
}

std::vector<double> commands_of(const ReportedPath& path, const std::string& actuator) {
  return values_of(path, &ReportedStep::actuation, "actuator", actuator, "");
}

}  // namespace softkin::runs
