#include <algorithm>
#include <array>
#include <softkin/core/text.hpp>
#include <softkin/io/plot/curves.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/plots.hpp>
#include <utility>

namespace softkin::runs {

namespace {

constexpr double least_error = 1e-9;  // [mm], as small as a logarithmic axis is to show

class PathPlot {
 public:
  PathPlot(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done, double tolerance_mm)
      : model_(model), path_(path), done_(done), tolerance_mm_(tolerance_mm) {
    std::vector<std::optional<double>> times;
    for (std::size_t i = 0; i < done.size(); ++i) times.push_back(path.waypoints[i].time);
    along_ = step_axis(times, {});
    if (along_.axis.whole) along_.axis.label = "waypoint";
  }

  [[nodiscard]] const Vec3& place(std::size_t i, std::size_t m) const {
    return done_[i].markers[static_cast<std::size_t>(path_.markers[m])];
  }

  /// A coordinate that does not count is where the marker came to.
  [[nodiscard]] Vec3 target(std::size_t i, std::size_t m) const {
    Vec3 point = place(i, m);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (path_.axes[m][axis])
        point[static_cast<Index>(axis)] = path_.waypoints[i].targets[m][static_cast<Index>(axis)];
    return point;
  }

  [[nodiscard]] std::vector<SpaceCurve> curves() const {
    std::vector<SpaceCurve> curves;
    for (std::size_t m = 0; m < path_.markers.size(); ++m) {
      const std::string of =
          path_.markers.size() == 1 ? "" : model_.markers[static_cast<std::size_t>(path_.markers[m])].name + ": ";
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
    for (const WaypointRecord& each : done_) error.y.push_back(std::max(each.error_mm, least_error));
    tolerance.label = "tolerance " + number(tolerance_mm_) + " mm";
    tolerance.x = {along_.values.front(), along_.values.back()};
    tolerance.y = {std::max(tolerance_mm_, least_error), std::max(tolerance_mm_, least_error)};
    tolerance.marks = false;
    tolerance.style = 4;
    panel.series = {error, tolerance};
    return panel;
  }

  [[nodiscard]] std::vector<PlotPanel> command_panels() const {
    std::vector<StepCurve> commands;
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      commands.push_back(command_curve(model_.actuators[a]));
      for (const WaypointRecord& each : done_) commands.back().values.push_back(each.actuation[static_cast<Index>(a)]);
    }
    return curve_panels(along_, commands, "command");
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

}  // namespace

Plot plot_of_path(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done,
                  double tolerance_mm, const std::string& title) {
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
  plot.panel_height = 260;
  return plot;
}

}  // namespace softkin::runs
