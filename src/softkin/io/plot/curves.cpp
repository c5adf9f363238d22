#include <softkin/io/plot/curves.hpp>

#include <algorithm>
#include <limits>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

bool changes(const StepCurve& curve) {
  return std::any_of(curve.values.begin(), curve.values.end(), [&](double v) { return v != curve.values.front(); });
}

bool is_monotonic(const std::vector<double>& values) {
  return std::is_sorted(values.begin(), values.end()) || std::is_sorted(values.rbegin(), values.rend());
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return name + " [" + unit + "]";
}

StepAxis along_command(const StepCurve& command) {
  StepAxis along;
  along.axis.label = with_unit(command.name, command.unit);
  along.values = command.values;
  along.command = true;
  return along;
}

PlotSeries series_of(const SpaceCurve& curve, int x, int y) {
  PlotSeries series;
  series.line = curve.line;
  series.marks = curve.marks;
  series.pairs = curve.pairs;
  series.pale = curve.pale;
  series.style = curve.style;
  series.width = curve.width;
  for (const Vec3& point : curve.points) {
    series.x.push_back(point[x]);
    series.y.push_back(point[y]);
  }
  return series;
}

constexpr int across[] = {1, 2, 0};  // of each projection, along what it is seen
constexpr int axes[][2] = {{0, 2}, {0, 1}, {1, 2}};

PlotPanel projection(const std::vector<SpaceCurve>& curves, int p, bool legend) {
  PlotPanel panel;
  panel.equal = true;
  panel.x.label = std::string(axis_names[axes[p][0]]) + " [mm]";
  panel.y.label = std::string(axis_names[axes[p][1]]) + " [mm]";
  for (const SpaceCurve& curve : curves) {
    panel.series.push_back(series_of(curve, axes[p][0], axes[p][1]));
    if (legend) panel.series.back().label = curve.name;
  }
  return panel;
}

}  // namespace

StepCurve command_curve(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  // what is done to the surroundings is no force that they answer with
  return {(drives(actuator) ? "" : "command ") + actuator.name, unit.empty() ? "-" : unit, {}};
}

StepAxis step_axis(const std::vector<std::optional<double>>& times, const std::vector<StepCurve>& commands) {
  StepAxis along;
  if (std::all_of(times.begin(), times.end(), [](const auto& time) { return time.has_value(); })) {
    along.axis.label = "time [s]";
    for (const auto& time : times) along.values.push_back(*time);
    return along;
  }
  if (std::count_if(commands.begin(), commands.end(), changes) == 1) {
    const StepCurve& command = *std::find_if(commands.begin(), commands.end(), changes);
    if (is_monotonic(command.values)) return along_command(command);
  }
  along.axis.label = "step";
  along.axis.whole = true;
  for (std::size_t i = 0; i < times.size(); ++i) along.values.push_back(static_cast<double>(i));
  return along;
}

std::vector<PlotPanel> curve_panels(const StepAxis& along, const std::vector<StepCurve>& curves,
                                    const std::string& what) {
  std::vector<PlotPanel> panels;
  for (const StepCurve& curve : curves) {
    const std::string label = with_unit(what, curve.unit);
    auto panel = std::find_if(panels.begin(), panels.end(), [&](const PlotPanel& p) { return p.y.label == label; });
    if (panel == panels.end()) {
      panels.emplace_back();
      panel = panels.end() - 1;
      panel->x = along.axis;
      panel->y.label = label;
    }
    PlotSeries series;
    series.label = curve.name;
    series.x = along.values;
    series.y = curve.values;
    panel->series.push_back(std::move(series));
  }
  return panels;
}

std::vector<PlotPanel> projections(const std::vector<SpaceCurve>& curves) {
  std::vector<PlotPanel> panels;
  for (int p = 0; p < 3; ++p) {
    panels.push_back(projection(curves, p, p == 0));
    panels.back().title = std::string("seen along ") + axis_names[across[p]];
  }
  return panels;
}

std::vector<PlotPanel> planar_or_projections(const std::vector<SpaceCurve>& curves) {
  constexpr double flat = 0.01;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const SpaceCurve& curve : curves)
    for (const Vec3& point : curve.points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  for (int p = 0; p < 3; ++p)
    if (high[across[p]] - low[across[p]] <= flat * (high - low).maxCoeff()) return {projection(curves, p, true)};
  return projections(curves);
}

}  // namespace softkin
