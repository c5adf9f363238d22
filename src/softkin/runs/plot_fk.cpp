#include <algorithm>
#include <cmath>
#include <softkin/io/plot/curves.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/plots.hpp>
#include <utility>

namespace softkin::runs {

namespace {

constexpr std::size_t most_markers = 12;  // with panels of their own

bool is_known(const StepRecord& step) {
  for (const Vec3& point : step.markers)
    if (!point.allFinite()) return false;
  for (const ActuatorRecord& actuator : step.actuators)
    if (!std::isfinite(actuator.multiplier)) return false;
  return true;
}

class Steps {
 public:
  Steps(const Model& model, const std::vector<StepRecord>& steps) : model_(model) {
    for (const StepRecord& step : steps)
      if (is_known(step)) steps_.push_back(&step);
    std::vector<std::optional<double>> times;
    for (const StepRecord* step : steps_) times.push_back(step->time_s);
    along_ = step_axis(times, commands());
  }

  [[nodiscard]] const StepAxis& along() const { return along_; }

  [[nodiscard]] std::vector<StepCurve> commands() const {
    std::vector<StepCurve> curves;
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      curves.push_back(command_curve(model_.actuators[a]));
      for (const StepRecord* step : steps_) curves.back().values.push_back(step->actuation[static_cast<Index>(a)]);
    }
    return curves;
  }

  /// Pressures or tensions, by the report's key.
  [[nodiscard]] std::vector<StepCurve> loads(const std::string& key, const std::string& unit) const {
    std::vector<StepCurve> curves;
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      if (model_.formulation != Formulation::physical || multiplier_key(model_.actuators[a]) != key || steps_.empty())
        continue;
      curves.push_back({model_.actuators[a].name, unit, {}});
      for (const StepRecord* step : steps_) curves.back().values.push_back(step->actuators[a].multiplier);
    }
    return curves;
  }

  [[nodiscard]] SpaceCurve way(std::size_t marker) const {
    SpaceCurve curve{model_.markers[marker].name, {}, true, true};
    for (const StepRecord* step : steps_) curve.points.push_back(step->markers[marker]);
    return curve;
  }

  [[nodiscard]] PlotPanel marker_panel(std::size_t marker) const {
    const SpaceCurve curve = way(marker);
    std::vector<StepCurve> coordinates{{"x", "mm", {}}, {"y", "mm", {}}, {"z", "mm", {}}};
    for (const Vec3& point : curve.points)
      for (int axis = 0; axis < 3; ++axis) coordinates[static_cast<std::size_t>(axis)].values.push_back(point[axis]);
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
      if (steps_[i]->status == Status::converged) continue;
      for (const double x : curve.points[i]) {
        series.x.push_back(along_.values[i]);
        series.y.push_back(x);
      }
    }
    return series;
  }

  const Model& model_;
  std::vector<const StepRecord*> steps_;
  StepAxis along_;
};

}  // namespace

Plot plot_of_steps(const Model& model, const std::vector<StepRecord>& steps, const std::string& title) {
  const Steps path(model, steps);
  Plot plot;
  plot.title = title;
  if (model.markers.size() > most_markers)
    plot.title +=
        " (the first " + std::to_string(most_markers) + " of " + std::to_string(model.markers.size()) + " markers)";
  const auto add = [&plot](std::vector<PlotPanel> row) {
    if (!row.empty()) plot.rows.push_back(std::move(row));
  };
  if (!path.along().command) add(curve_panels(path.along(), path.commands(), "command"));
  std::vector<SpaceCurve> ways;
  std::vector<PlotPanel> row;
  for (std::size_t m = 0; m < std::min(model.markers.size(), most_markers); ++m) {
    ways.push_back(path.way(m));
    row.push_back(path.marker_panel(m));
    if (row.size() == 2) add(std::exchange(row, {}));
  }
  add(std::move(row));
  std::vector<PlotPanel> loads = curve_panels(path.along(), path.loads("pressure_kPa", "kPa"), "gauge pressure");
  for (PlotPanel& panel : curve_panels(path.along(), path.loads("tension_N", "N"), "tension"))
    loads.push_back(std::move(panel));
  add(std::move(loads));
  if (!ways.empty()) add(projections(ways));
  if (plot.rows.empty()) add({PlotPanel{}});
  return plot;
}

}  // namespace softkin::runs
