#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <softkin/core/text.hpp>
#include <softkin/io/plot/curves.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/plots.hpp>
#include <utility>

namespace softkin::runs {

namespace {

constexpr std::size_t max_markers = 12;  // with panels of their own

/// Of every actuator over the steps. Records: a range of records, or of references to them.
template <class Records>
std::vector<StepCurve> command_curves(const Model& model, const Records& records) {
  std::vector<StepCurve> curves;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    curves.push_back(command_curve(model.actuators[a]));
    for (const StepRecord& record : records) curves.back().values.push_back(record.actuation[a]);
  }
  return curves;
}

template <class Records>
StepAxis step_axis_of(const Records& records, const std::vector<StepCurve>& commands) {
  std::vector<std::optional<double>> times;
  for (const StepRecord& record : records) times.push_back(record.time_s);
  return step_axis(times, commands);
}

/// "volume ratio" and so on of the actuators that are commanded by a load, whose plot over itself would be useless.
template <class Records>
std::vector<PlotPanel> measure_panels(const Model& model, const StepAxis& along, const Records& records) {
  std::vector<PlotPanel> panels;
  for (const char* measure : {"volume", "length", "area"}) {
    std::vector<StepCurve> curves;
    for (std::size_t a = 0; a < model.actuators.size(); ++a) {
      const Actuator& actuator = model.actuators[a];
      if (!answers_with_measure(actuator) || std::string(measure_name(actuator)) != measure) continue;
      curves.push_back({actuator.name, flat_at_rest(actuator) ? "mL" : "-", {}});
      for (const StepRecord& record : records) curves.back().values.push_back(record.actuators[a].achieved);
    }
    for (PlotPanel& panel : curve_panels(along, curves, std::string(measure) + " ratio"))
      panels.push_back(std::move(panel));
  }
  return panels;
}

template <class Records>
StepCurve line_curve(const Model& model, const MarkerLine& line, const Records& records) {
  const auto name = [&](Index m) { return model.markers[m].name; };
  StepCurve curve{name(line.from) + " to " + name(line.to), "deg", {}};
  TurnMeter meter(line.at_rest(model));
  for (const StepRecord& record : records) curve.values.push_back(meter.next(line.in(record.markers)));
  return curve;
}

bool is_known(const StepRecord& step) {
  for (const Vec3& point : step.markers)
    if (!point.allFinite()) return false;
  for (const ActuatorRecord& actuator : step.actuators)
    if (!std::isfinite(actuator.multiplier) || !std::isfinite(actuator.achieved)) return false;
  return true;
}

class Steps {
 public:
  Steps(const Model& model, const std::vector<StepRecord>& steps) : model_(model) {
    for (const StepRecord& step : steps)
      if (is_known(step)) steps_.emplace_back(step);
    along_ = step_axis_of(steps_, commands());
  }

  [[nodiscard]] const StepAxis& along() const { return along_; }

  [[nodiscard]] std::vector<StepCurve> commands() const { return command_curves(model_, steps_); }

  /// Pressures, tensions or voltages, by the report's key.
  [[nodiscard]] std::vector<StepCurve> loads(const std::string& key, const std::string& unit) const {
    std::vector<StepCurve> curves;
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      if (model_.formulation != Formulation::physical || multiplier_key(model_.actuators[a]) != key || steps_.empty())
        continue;
      if (!answers_with_load(model_.actuators[a])) continue;
      curves.push_back({model_.actuators[a].name, unit, {}});
      for (const StepRecord& step : steps_) curves.back().values.push_back(step.actuators[a].multiplier);
    }
    return curves;
  }

  [[nodiscard]] std::vector<PlotPanel> measures() const {
    return steps_.empty() ? std::vector<PlotPanel>() : measure_panels(model_, along_, steps_);
  }

  /// Of the first so many markers, where they have an orientation, and of the line between two.
  [[nodiscard]] std::vector<StepCurve> turns(const std::optional<MarkerLine>& line, std::size_t markers) const {
    std::vector<StepCurve> curves;
    if (steps_.empty()) return curves;
    const std::vector<bool> oriented = oriented_markers(model_);
    for (std::size_t m = 0; m < markers; ++m) {
      const auto knows = [m](const StepRecord& step) {
        return m < step.marker_turns.size() && std::isfinite(step.marker_turns[m]);
      };
      if (!oriented[m] || !std::all_of(steps_.begin(), steps_.end(), knows)) continue;
      curves.push_back({model_.markers[m].name, "deg", {}});
      for (const StepRecord& step : steps_) curves.back().values.push_back(step.marker_turns[m]);
    }
    if (line) curves.push_back(line_curve(model_, *line, steps_));
    return curves;
  }

  /// The force of all contacts on each body.
  [[nodiscard]] std::vector<StepCurve> contacts() const {
    std::vector<StepCurve> curves;
    const auto knows = [](const StepRecord& step) { return step.forces.contacts.has_value(); };
    if (steps_.empty() || !std::all_of(steps_.begin(), steps_.end(), knows)) return curves;
    for (const FreeBody& body : model_.bodies) {
      curves.push_back({"on " + body.name, "N", {}});
      for (const StepRecord& step : steps_)
        curves.back().values.push_back(normal_force_on(model_, body.name, *step.forces.contacts));
    }
    return curves;
  }

  [[nodiscard]] SpaceCurve route(std::size_t marker) const {
    SpaceCurve curve{model_.markers[marker].name, {}, true, true};
    for (const StepRecord& step : steps_) curve.points.push_back(step.markers[marker]);
    return curve;
  }

  [[nodiscard]] PlotPanel marker_panel(std::size_t marker) const {
    const SpaceCurve curve = route(marker);
    std::vector<StepCurve> coordinates{{"x", "mm", {}}, {"y", "mm", {}}, {"z", "mm", {}}};
    for (const Vec3& point : curve.points)
      for (int axis = 0; axis < 3; ++axis) coordinates[axis].values.push_back(point[axis]);
    PlotPanel panel = curve_panels(along_, coordinates, "position").front();
    panel.title = model_.markers[marker].name;
    if (PlotSeries failed = unconverged(curve); !failed.x.empty()) panel.series.push_back(std::move(failed));
    return panel;
  }

 private:
  [[nodiscard]] PlotSeries unconverged(const SpaceCurve& curve) const {
    PlotSeries series;
    series.label = "not converged";
    series.line = false;
    series.style = 4;  // black crosses
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (steps_[i].get().status == Status::converged) continue;
      for (const double x : curve.points[i]) {
        series.x.push_back(along_.values[i]);
        series.y.push_back(x);
      }
    }
    return series;
  }

  const Model& model_;
  std::vector<std::reference_wrapper<const StepRecord>> steps_;
  StepAxis along_;
};

constexpr double min_error = 1e-9;  // [mm], as small as a logarithmic axis is to show

class PathPlot {
 public:
  PathPlot(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done, double tolerance_mm)
      : model_(model), path_(path), done_(done), tolerance_mm_(tolerance_mm) {
    along_ = step_axis_of(done, {});
    if (along_.axis.whole) along_.axis.label = "waypoint";
  }

  [[nodiscard]] const Vec3& place(std::size_t i, std::size_t m) const { return done_[i].markers[path_.markers[m]]; }

  /// A coordinate that does not count is where the marker came to.
  [[nodiscard]] Vec3 target(std::size_t i, std::size_t m) const {
    Vec3 point = place(i, m);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (path_.axes[m][axis]) point[axis] = path_.waypoints[i].targets[m][axis];
    return point;
  }

  [[nodiscard]] std::vector<SpaceCurve> curves() const {
    std::vector<SpaceCurve> curves;
    for (std::size_t m = 0; m < path_.markers.size(); ++m) {
      const std::string of = path_.markers.size() == 1 ? "" : model_.markers[path_.markers[m]].name + ": ";
      SpaceCurve targets{of + "target", {}, true, false}, reached{of + "reached", {}, true, true};
      SpaceCurve missed{of + "not reached", {}, false, true}, gaps{"", {}, true, false};
      targets.pale = true;
      targets.width = 4;
      gaps.pairs = true;
      gaps.width = 1;
      for (std::size_t i = 0; i < done_.size(); ++i) {
        targets.points.push_back(target(i, m));
        reached.points.push_back(place(i, m));
        if (done_[i].is_reached()) continue;
        missed.points.push_back(target(i, m));
        gaps.points.push_back(target(i, m));
        gaps.points.push_back(place(i, m));
      }
      curves.insert(curves.end(), {targets, reached});
      if (!missed.points.empty()) curves.insert(curves.end(), {missed, gaps});
    }
    style(curves);
    return curves;
  }

  [[nodiscard]] PlotPanel error_panel() const {
    PlotPanel panel;
    panel.x = along_.axis;
    panel.y.label = "error [mm]";
    panel.y.logarithmic = true;
    PlotSeries error, tolerance;
    error.label = "error";
    error.x = along_.values;
    for (const WaypointRecord& each : done_) error.y.push_back(std::max(each.error_mm, min_error));
    tolerance.label = "tolerance " + number(tolerance_mm_) + " mm";
    tolerance.x = {along_.values.front(), along_.values.back()};
    tolerance.y = {std::max(tolerance_mm_, min_error), std::max(tolerance_mm_, min_error)};
    tolerance.marks = false;
    tolerance.style = 4;
    panel.series = {error, tolerance};
    return panel;
  }

  [[nodiscard]] std::vector<PlotPanel> command_panels() const {
    return curve_panels(along_, command_curves(model_, done_), "command");
  }
  [[nodiscard]] std::vector<PlotPanel> measures() const { return measure_panels(model_, along_, done_); }
  [[nodiscard]] std::vector<PlotPanel> turn_panels(const MarkerLine& line) const {
    return curve_panels(along_, {line_curve(model_, line, done_)}, "turn");
  }

 private:
  /// Each marker has its own colour for what was reached; what was missed is crossed.
  static void style(std::vector<SpaceCurve>& curves) {
    int color = 0;
    for (SpaceCurve& curve : curves) {
      if (curve.line && curve.marks) curve.style = color++ % 4;
      if (!curve.line || curve.pairs) curve.style = 4;
    }
  }

  const Model& model_;
  const MarkerPath& path_;
  const std::vector<WaypointRecord>& done_;
  double tolerance_mm_;
  StepAxis along_;
};

/// Drawn along the steps in a panel of its own.
PlotPanel panel_of(const StepAxis& along, const std::string& label) {
  PlotPanel panel;
  panel.x = along.axis;
  panel.y.label = label;
  return panel;
}

PlotSeries series_of(const StepAxis& along, const std::string& label, const std::vector<WalkRecord>& steps,
                     double WalkStep::*value) {
  PlotSeries series;
  series.label = label;
  series.x = along.values;
  for (const WalkRecord& step : steps) series.y.push_back(step.walk.*value);
  return series;
}

}  // namespace

namespace {

std::string file_name(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

}  // namespace

std::string plot_title(const Model& model, const std::string& scene, const std::string& by) {
  return (by.empty() ? "" : file_name(by) + " by ") + file_name(scene) + ": " + formulation_name(model.formulation);
}

Plot plot_of_steps(const Model& model, const std::vector<StepRecord>& steps, const std::string& title,
                   const std::optional<MarkerLine>& line) {
  const Steps path(model, steps);
  Plot plot;
  plot.title = title;
  if (model.markers.size() > max_markers)
    plot.title +=
        " (the first " + std::to_string(max_markers) + " of " + std::to_string(model.markers.size()) + " markers)";
  const auto add = [&plot](std::vector<PlotPanel> row) {
    if (!row.empty()) plot.rows.push_back(std::move(row));
  };
  if (!path.along().command) add(curve_panels(path.along(), path.commands(), "command"));
  std::vector<SpaceCurve> routes;
  std::vector<PlotPanel> row;
  for (std::size_t m = 0; m < std::min(model.markers.size(), max_markers); ++m) {
    routes.push_back(path.route(m));
    row.push_back(path.marker_panel(m));
    if (row.size() == 2) add(std::exchange(row, {}));
  }
  add(std::move(row));
  add(curve_panels(path.along(), path.turns(line, routes.size()), "turn"));
  add(path.measures());
  std::vector<PlotPanel> loads = curve_panels(path.along(), path.loads("pressure_kPa", "kPa"), "gauge pressure");
  for (PlotPanel& panel : curve_panels(path.along(), path.loads("tension_N", "N"), "tension"))
    loads.push_back(std::move(panel));
  for (PlotPanel& panel : curve_panels(path.along(), path.loads("voltage_kV", "kV"), "voltage"))
    loads.push_back(std::move(panel));
  add(std::move(loads));
  add(curve_panels(path.along(), path.contacts(), "contact force"));
  if (!routes.empty()) add(projections(routes));
  if (plot.rows.empty()) add({PlotPanel{}});
  return plot;
}

Plot plot_of_path(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done,
                  double tolerance_mm, const std::string& title, const std::optional<MarkerLine>& line) {
  const PathPlot parts(model, path, done, tolerance_mm);
  Plot plot;
  plot.title = title;
  std::vector<PlotPanel> views = planar_or_projections(parts.curves());
  std::vector<PlotPanel> commands = parts.command_panels();
  if (views.size() == 1) {
    views.push_back(parts.error_panel());
    plot.rows = {std::move(views), std::move(commands)};
  } else {
    plot.rows = {std::move(views), {parts.error_panel()}, std::move(commands)};
  }
  if (std::vector<PlotPanel> measures = parts.measures(); !measures.empty()) plot.rows.push_back(std::move(measures));
  if (line) plot.rows.push_back(parts.turn_panels(*line));
  plot.panel_height = 260;
  return plot;
}

Plot plot_of_search(const InverseResult& found, double tolerance_mm, const std::string& scene, const Misses& misses) {
  constexpr double least = 1e-9;  // [mm], as small as a logarithmic axis is to show
  PlotSeries each{"each equilibrium", {}, {}, false}, best{"least so far", {}, {}, true, false};
  PlotSeries limit{"tolerance", {}, {tolerance_mm, tolerance_mm}, true, false};
  double lowest = HUGE_VAL;
  for (std::size_t i = 0; i < found.history.size(); ++i) {
    const double error = found.history[i].error_mm;
    if (!std::isfinite(error)) continue;
    lowest = std::min(lowest, error);
    for (PlotSeries* series : {&each, &best}) series->x.push_back(static_cast<double>(i + 1));
    each.y.push_back(std::max(error, least));
    best.y.push_back(std::max(lowest, least));
  }
  if (each.x.empty()) {  // reached at the start
    each.x = {1};
    each.y = {std::max(found.errors_mm.maxCoeff(), least)};
    best = {};
  }
  limit.x = {1, each.x.back()};
  PlotPanel panel;
  panel.x.label = "equilibria";
  panel.x.whole = true;
  panel.y.label = misses.N ? "largest error [mm; of forces as much at their tolerance]" : "largest error [mm]";
  panel.y.logarithmic = true;
  panel.series = {each, limit};
  if (!best.x.empty()) panel.series.insert(panel.series.begin() + 1, best);
  Plot plot;
  plot.title = file_name(scene) + ": " + name_of(found.status) + ", " + misses_text(misses, 2) + " off";
  plot.rows = {{panel}};
  return plot;
}

Plot plot_of_walk(const Model& model, const std::vector<WalkRecord>& steps, const std::string& title) {
  const StepAxis along = step_axis_of(steps, {});

  PlotPanel feet = panel_of(along, "place [mm]");
  feet.series = {series_of(along, foot_name(model, 0), steps, &WalkStep::rear_mm),
                 series_of(along, foot_name(model, 1), steps, &WalkStep::front_mm)};
  Plot plot;
  plot.title = title;
  plot.rows = {{std::move(feet)}, curve_panels(along, command_curves(model, steps), "command")};
  if (model.formulation == Formulation::physical) {
    PlotPanel friction = panel_of(along, "friction [N]");
    friction.series = {series_of(along, "", steps, &WalkStep::friction_N)};
    plot.rows.push_back({std::move(friction)});
  }
  return plot;
}

}  // namespace softkin::runs
