#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/plot/curves.hpp>
#include <softkin/runs/file_labels.hpp>
#include <softkin/runs/report_comparison.hpp>
#include <softkin/runs/turns.hpp>

namespace softkin::runs {

namespace {

/// Returns the load of each actuator in a report's step.
std::vector<std::pair<std::string, double>> loads_of(const Json& actuators) {
  std::vector<std::pair<std::string, double>> loads;
  for (const auto& [name, actuator] : actuators.items())
    for (const auto& [key, unit] : {std::pair{"pressure_kPa", "kPa"}, std::pair{"tension_N", "N"},
                                    std::pair{"voltage_kV", "kV"}, std::pair{"charge_nC", "nC"}})
      if (actuator.contains(key)) loads.emplace_back(name + " [" + unit + "]", actuator.at(key).template get<double>());
  return loads;
}

/// "air volume [-]": what an actuator that is commanded by a load comes to, over that at rest.
std::vector<std::pair<std::string, double>> ratios_of(const Json& actuators,
                                                      const std::map<std::string, std::string>& measures) {
  std::vector<std::pair<std::string, double>> ratios;
  for (const auto& [name, measure] : measures)
    if (actuators.contains(name))
      ratios.emplace_back(name + " " + measure + " [-]", actuators.at(name).at("achieved").get<double>());
  return ratios;
}

ReportedStep step_of(const Json& json, const std::map<std::string, std::string>& measures) {
  ReportedStep step;
  for (const auto& [name, value] : json.at("actuation").items()) step.actuation.emplace_back(name, value.get<double>());
  for (const auto& [name, point] : json.at("markers").items())
    step.markers.emplace_back(name,
                              Vec3(point.at(0).get<double>(), point.at(1).get<double>(), point.at(2).get<double>()));
  step.loads = loads_of(json.at("actuators"));
  step.ratios = ratios_of(json.at("actuators"), measures);
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

/// "volume", "length" or "area" of the actuators that are commanded by a load.
std::map<std::string, std::string> measures_of(const Json& report) {
  std::map<std::string, std::string> measures;
  if (!report.contains("actuators")) return measures;
  for (const auto& [name, actuator] : report.at("actuators").items())
    for (const auto& [control, measure] :
         {std::pair{"pressure", "volume"}, std::pair{"tension", "length"}, std::pair{"voltage", "area"}})
      if (actuator.at("control").template get<std::string>() == control) measures[name] = measure;
  return measures;
}

ReportedPath path_of(const std::string& file, const Json& json) {
  ReportedPath path{file,
                    json.at("formulation").get<std::string>() + ", " + json.at("solver").at("name").get<std::string>(),
                    {},
                    units_of(json)};
  const std::map<std::string, std::string> measures = measures_of(json);
  double elapsed = 0;
  for (const Json& step : json.at("steps")) {
    elapsed += step.at("seconds").get<double>();
    path.steps.push_back(step_of(step, measures));
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

std::string requested_text(const ReportedStep& step) {
  std::string text;
  for (const auto& [name, value] : step.actuation)
    text += (text.empty() ? "" : ", ") + name + " = " + number(value, 12);
  return text.empty() ? "nothing" : text;
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
      refuse("step " + std::to_string(i) + " asks for " + requested_text(second.steps[i]) + ", but in " + first.file +
             " for " + requested_text(first.steps[i]));
}

std::vector<double> distances_of(const ReportedPath& path, const ReportedPath& from, const std::string& marker) {
  const std::vector<Vec3> here = places_of(path, marker), there = places_of(from, marker);
  std::vector<double> distances;
  for (std::size_t i = 0; i < here.size(); ++i) distances.push_back((here[i] - there[i]).norm());
  return distances;
}

std::vector<double> turns_of(const ReportedPath& path, const std::string& from, const std::string& to) {
  const std::vector<Vec3> firsts = places_of(path, from), lasts = places_of(path, to);
  const Vec3 start = lasts[0] - firsts[0];
  if (!(start.norm() > 0))
    throw InvalidInput({path.file}, "markers '" + from + "' and '" + to + "' are at one place in the first step");
  TurnMeter meter(start);
  std::vector<double> turns;
  for (std::size_t i = 0; i < firsts.size(); ++i) turns.push_back(meter.next(lasts[i] - firsts[i]));
  return turns;
}

bool same_names(const std::vector<std::pair<std::string, double>>& a,
                const std::vector<std::pair<std::string, double>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.first == y.first; });
}

/// "converged" where all did, else who did not: "fine: limit".
std::string status_of(const ReportComparison& of, std::size_t step) {
  std::string text;
  for (std::size_t p = 0; p < of.paths.size(); ++p)
    if (const std::string& status = of.paths[p].steps[step].status; status != "converged")
      text += (text.empty() ? "" : ", ") + of.labels[p] + ": " + status;
  return text.empty() ? "converged" : text;
}

StepAxis axis_of(const ReportedPath& path) {
  std::vector<std::optional<double>> times;
  std::vector<StepCurve> commands;
  for (const auto& [name, value] : path.steps.front().actuation) {
    const auto unit = path.units.find(name);
    commands.push_back({name, unit == path.units.end() ? "-" : unit->second, {}});
  }
  for (const ReportedStep& step : path.steps) {
    times.push_back(step.time);
    for (std::size_t a = 0; a < step.actuation.size(); ++a) commands[a].values.push_back(step.actuation[a].second);
  }
  return step_axis(times, commands);
}

using NamedValues = std::vector<std::pair<std::string, double>>;

/// Is "air", in its unit, what is commanded anyway?
bool is_command(const ReportedPath& path, const std::string& name, const std::string& unit) {
  const auto command = path.units.find(name);
  return command != path.units.end() && command->second == unit;
}

/// The values that each step has of a kind, such as "air [kPa]", named after the report; commands are left out.
void add_curves(const ReportedPath& path, const std::string& report, NamedValues ReportedStep::*of,
                std::vector<StepCurve>& curves) {
  const NamedValues& named = path.steps.front().*of;
  for (std::size_t n = 0; n < named.size(); ++n) {
    const std::string& title = named[n].first;
    const std::size_t bracket = title.rfind(" [");
    const std::string name = title.substr(0, bracket), unit = title.substr(bracket + 2, title.size() - bracket - 3);
    if (is_command(path, name, unit)) continue;
    curves.push_back({report + ": " + name, unit, {}});
    for (const ReportedStep& step : path.steps) curves.back().values.push_back((step.*of).at(n).second);
  }
}

Column fixed(const std::string& title, int decimals) {
  return {.title = title, .digits = decimals, .form = Column::Form::decimals};
}

}  // namespace

ReportedPath read_reported_path(const std::string& file) {
  try {
    ReportedPath path = path_of(file, parse_json(read_file(file)));
    if (path.steps.empty()) throw InvalidInput({file}, "the report has no steps");
    for (std::size_t i = 1; i < path.steps.size(); ++i)
      if (!same_names(path.steps[i].actuation, path.steps[0].actuation) ||
          !same_names(path.steps[i].loads, path.steps[0].loads) ||
          !same_names(path.steps[i].ratios, path.steps[0].ratios))
        throw InvalidInput({file}, "step " + std::to_string(i) + " has other actuators than step 0; it is damaged: " +
                                       "make it again with softkin fk --report");
    return path;
  } catch (const Json::exception&) {
    throw InvalidInput({file}, "this is not a report of softkin fk, or a number that it needs is not known");
  }
}

std::string marker_of(const ReportedPath& path, const std::string& requested, const std::string& hint) {
  if (!requested.empty()) return requested;
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

ReportComparison compare_reports(const std::vector<std::string>& files, const std::string& marker,
                                 const std::vector<std::string>& turn, const std::vector<double>& poses) {
  ReportComparison result;
  for (const std::string& file : files) {
    result.paths.push_back(read_reported_path(file));
    check_same_steps(result.paths.front(), result.paths.back());
  }
  result.marker = marker_of(result.paths.front(), marker, ", so no distance is known");
  result.poses = poses;
  result.labels = file_labels(files);
  for (const ReportedPath& path : result.paths) {
    result.distances.push_back(distances_of(path, result.paths.front(), result.marker));
    if (!turn.empty()) result.turns.push_back(turns_of(path, turn[0], turn[1]));
  }
  return result;
}

std::optional<double> ReportComparison::time_to(std::size_t path, double pose) const {
  for (std::size_t i = 0; i < turns[path].size(); ++i)
    if (turns[path][i] >= pose && paths[path].steps[i].status == "converged") return paths[path].steps[i].elapsed;
  return std::nullopt;
}

Table ReportComparison::steps() const {
  Table table{{{.title = "step"}}};
  const auto add = [&table](const Column& column) { table.columns.push_back(column); };
  for (const auto& [name, value] : paths.front().steps.front().actuation) add({.title = name});
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const std::string of = labels[p] + ": ";
    if (!turns.empty()) add(fixed(of + "turn [deg]", 1));
    for (const auto& [name, load] : paths[p].steps.front().loads) add(fixed(of + name, 2));
    for (const auto& [name, ratio] : paths[p].steps.front().ratios) add(fixed(of + name, 4));
    if (p > 0) add(fixed(of + marker + " off by [mm]", 2));
  }
  add({.title = "status"});
  for (std::size_t i = 0; i < paths.front().steps.size(); ++i) {
    Row row{static_cast<std::int64_t>(i)};
    for (const auto& [name, value] : paths.front().steps[i].actuation) row.emplace_back(value);
    for (std::size_t p = 0; p < paths.size(); ++p) {
      if (!turns.empty()) row.emplace_back(turns[p][i]);
      for (const auto& [name, load] : paths[p].steps[i].loads) row.emplace_back(load);
      for (const auto& [name, ratio] : paths[p].steps[i].ratios) row.emplace_back(ratio);
      if (p > 0) row.emplace_back(distances[p][i]);
    }
    row.emplace_back(status_of(*this, i));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table ReportComparison::times() const {
  Table table{{Column{}, {.title = poses.empty() ? "time of:" : "time to a turn of:"}}};
  for (const double pose : poses) table.columns.push_back({.title = number(pose) + " deg"});
  table.columns.push_back({.title = "all steps"});
  for (std::size_t p = 0; p < paths.size(); ++p) {
    Row row{labels[p], paths[p].method};
    for (const double pose : poses) {
      const std::optional<double> time = time_to(p, pose);
      row.emplace_back(time ? decimal(*time, 2) + " s" : "not reached");
    }
    row.emplace_back(decimal(paths[p].steps.back().elapsed, 2) + " s");
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string ReportComparison::json() const {
  Json reports = Json::array();
  for (std::size_t p = 0; p < paths.size(); ++p) {
    Json report{{"file", paths[p].file}, {"method", paths[p].method}, {"seconds", paths[p].steps.back().elapsed}};
    if (!turns.empty()) report["turn_deg"] = turns[p];
    report["distance_mm"] = distances[p];
    Json elapsed = Json::array(), reached = Json::array();
    for (const ReportedStep& step : paths[p].steps) elapsed.push_back(step.elapsed);
    for (const double pose : poses) {
      const std::optional<double> time = time_to(p, pose);
      reached.push_back({{"turn_deg", pose}, {"seconds", time ? Json(*time) : Json()}});
    }
    report["elapsed_s"] = elapsed;
    report["poses"] = reached;
    reports.push_back(report);
  }
  return json_text({{"marker", marker}, {"reports", reports}});
}

Plot ReportComparison::plot() const {
  const StepAxis along = axis_of(paths.front());
  std::vector<StepCurve> turned, off, loads, ratios;
  std::vector<SpaceCurve> routes;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    if (!turns.empty()) turned.push_back({labels[p], "degrees", turns[p]});
    if (p > 0) off.push_back({labels[p], "mm", distances[p]});
    add_curves(paths[p], labels[p], &ReportedStep::loads, loads);
    add_curves(paths[p], labels[p], &ReportedStep::ratios, ratios);
    routes.push_back({labels[p], places_of(paths[p], marker), true, true});
  }
  Plot plot;
  plot.title = marker + ": differences from " + paths.front().file;
  const auto add = [&](const std::vector<StepCurve>& curves, const std::string& what) {
    if (!curves.empty()) plot.rows.push_back(curve_panels(along, curves, what));
  };
  add(turned, "turn");
  add(off, marker + " off by");
  // a distance has no curve of the first report: the same report looks the same in every panel
  for (std::size_t i = 0; i < plot.rows.back()[0].series.size(); ++i)
    plot.rows.back()[0].series[i].style = static_cast<int>(i) + 1;
  add(loads, "load");
  add(ratios, "over that at rest");
  plot.rows.push_back(projections(routes));
  return plot;
}

}  // namespace softkin::runs
