#include "plot_steps.hpp"

#include <algorithm>

namespace softkin::cli {

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
  for (const Vec3& point : curve.points) {
    series.x.push_back(point[x]);
    series.y.push_back(point[y]);
  }
  return series;
}

}  // namespace

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
  constexpr const char* names[] = {"x [mm]", "y [mm]", "z [mm]"};
  constexpr const char* titles[] = {"seen along y", "seen along z", "seen along x"};
  constexpr int axes[][2] = {{0, 2}, {0, 1}, {1, 2}};
  std::vector<PlotPanel> panels;
  for (int p = 0; p < 3; ++p) {
    PlotPanel panel;
    panel.title = titles[p];
    panel.equal = true;
    panel.x.label = names[axes[p][0]];
    panel.y.label = names[axes[p][1]];
    for (const SpaceCurve& curve : curves) {
      panel.series.push_back(series_of(curve, axes[p][0], axes[p][1]));
      if (p == 0) panel.series.back().label = curve.name;
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

}  // namespace softkin::cli
