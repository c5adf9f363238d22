#include <softkin/io/plot/curves.hpp>
#include "compare_table.hpp"

namespace softkin::cli {

namespace {

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

/// "air [kPa]" as name and unit.
StepCurve named(const std::string& load, const std::string& report) {
  const std::size_t bracket = load.rfind(" [");
  return {report + load.substr(0, bracket), load.substr(bracket + 2, load.size() - bracket - 3), {}};
}

std::vector<StepCurve> loads_of(const ReportedPath& path, const std::string& report) {
  std::vector<StepCurve> curves;
  for (std::size_t l = 0; l < path.steps.front().loads.size(); ++l) {
    curves.push_back(named(path.steps.front().loads[l].first, report + ": "));
    for (const ReportedStep& step : path.steps) curves.back().values.push_back(step.loads.at(l).second);
  }
  return curves;
}

}  // namespace

Plot Comparison::plot() const {
  const StepAxis along = axis_of(paths_.front());
  std::vector<StepCurve> turns, distances, loads;
  std::vector<SpaceCurve> ways;
  for (std::size_t p = 0; p < paths_.size(); ++p) {
    const std::string name = std::to_string(p + 1);
    if (!turns_.empty()) turns.push_back({name + ": " + paths_[p].method, "degrees", turns_[p]});
    if (p > 0) distances.push_back({name + ": " + paths_[p].method, "mm", distances_[p]});
    for (StepCurve& load : loads_of(paths_[p], name)) loads.push_back(std::move(load));
    ways.push_back({name + ": " + paths_[p].method, places_of(paths_[p], marker_), true, true});
  }
  Plot plot;
  plot.title = marker_ + ": differences from " + paths_.front().file;
  const auto add = [&](const std::vector<StepCurve>& curves, const std::string& what) {
    if (!curves.empty()) plot.rows.push_back(curve_panels(along, curves, what));
  };
  add(turns, "turn");
  add(distances, marker_ + " off by");
  // a distance has no curve of the first report: the same report looks the same in every panel
  for (std::size_t i = 0; i < plot.rows.back()[0].series.size(); ++i)
    plot.rows.back()[0].series[i].style = static_cast<int>(i) + 1;
  add(loads, "load");
  plot.rows.push_back(projections(ways));
  return plot;
}

}  // namespace softkin::cli
