#include "plot_fk.hpp"

#include <algorithm>
#include <utility>

#include "fk_units.hpp"
#include "mesh_text.hpp"
#include "plot_steps.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t most_markers = 12;  // with panels of their own

bool is_known(const Json& step) {
  for (const auto& [name, point] : step.at("markers").items())
    for (const Json& x : point)
      if (x.is_null()) return false;
  for (const auto& [name, actuator] : step.at("actuators").items())
    for (const char* key : {"pressure_kPa", "tension_N"})
      if (actuator.contains(key) && actuator.at(key).is_null()) return false;
  return true;
}

class Steps {
 public:
  Steps(const Model& model, const Json& steps) : model_(model) {
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (is_known(steps[i])) steps_.push_back(&steps[i]);
    std::vector<std::optional<double>> times;
    for (const Json* step : steps_)
      times.push_back(step->contains("time_s") ? std::optional(step->at("time_s").get<double>()) : std::nullopt);
    along_ = step_axis(times, commands());
  }

  [[nodiscard]] const StepAxis& along() const { return along_; }

  [[nodiscard]] std::vector<StepCurve> commands() const {
    std::vector<StepCurve> curves;
    for (const Actuator& actuator : model_.actuators) {
      const std::string unit = command_unit(actuator);
      curves.push_back({actuator.name, unit.empty() ? "-" : unit, {}});
      for (const Json* step : steps_) curves.back().values.push_back(step->at("actuation").at(actuator.name));
    }
    return curves;
  }

  /// Pressures or tensions, by the report's key.
  [[nodiscard]] std::vector<StepCurve> loads(const std::string& key, const std::string& unit) const {
    std::vector<StepCurve> curves;
    for (const Actuator& actuator : model_.actuators) {
      if (steps_.empty() || !steps_.front()->at("actuators").at(actuator.name).contains(key)) continue;
      curves.push_back({actuator.name, unit, {}});
      for (const Json* step : steps_) curves.back().values.push_back(step->at("actuators").at(actuator.name).at(key));
    }
    return curves;
  }

  [[nodiscard]] SpaceCurve way(const std::string& marker) const {
    SpaceCurve curve{marker, {}, true, true};
    for (const Json* step : steps_) {
      const Json& p = step->at("markers").at(marker);
      curve.points.emplace_back(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
    }
    return curve;
  }

  [[nodiscard]] PlotPanel marker_panel(const std::string& marker) const {
    const SpaceCurve curve = way(marker);
    std::vector<StepCurve> coordinates{{"x", "mm", {}}, {"y", "mm", {}}, {"z", "mm", {}}};
    for (const Vec3& point : curve.points)
      for (int axis = 0; axis < 3; ++axis) coordinates[static_cast<std::size_t>(axis)].values.push_back(point[axis]);
    PlotPanel panel = curve_panels(along_, coordinates, "position").front();
    panel.title = marker;
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
      if (steps_[i]->at("status").get<std::string>() == "converged") continue;
      for (const double x : curve.points[i]) {
        series.x.push_back(along_.values[i]);
        series.y.push_back(x);
      }
    }
    return series;
  }

  const Model& model_;
  std::vector<const Json*> steps_;
  StepAxis along_;
};

}  // namespace

Plot plot_of_steps(const Model& model, const Json& steps, const std::string& title) {
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
    ways.push_back(path.way(model.markers[m].name));
    row.push_back(path.marker_panel(model.markers[m].name));
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

}  // namespace softkin::cli
