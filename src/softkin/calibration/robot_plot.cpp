#include <cmath>
#include <softkin/calibration/robot_outlines_report.hpp>
#include <softkin/core/error.hpp>

namespace softkin::calibration {

namespace {

/// Measured and computed markers seen along an axis: where a camera saw dots without names, each marker's apart, and
/// those that are none. Empty: no marker was measured along both axes.
std::vector<PlotSeries> seen_along(const RobotFitReport& r, int across, int up) {
  const auto points = [](const std::string& label) {
    PlotSeries series;
    series.label = label;
    series.line = false;
    return series;
  };
  const auto add = [&](PlotSeries& series, const Vec3& point) {
    series.x.push_back(point[across]);
    series.y.push_back(point[up]);
  };
  PlotSeries computed = points("computed"), apart, none = points("no marker");
  apart.marks = false;
  apart.pairs = apart.pale = apart.line = true;
  std::vector<PlotSeries> measured;
  if (!has_dots(r)) measured.push_back(points("measured"));
  for (const Index m : markers_of(r)) {
    if (has_dots(r)) measured.push_back(points(marker_name(r, m)));
    for (Index pose = 0; pose < std::ssize(r.poses.commands); ++pose) {
      const auto& [there, here] = places_of(r, pose, m);
      if (!std::isfinite(there[across] + there[up] + here[across] + here[up])) continue;
      add(measured.back(), there);
      add(computed, here);
      add(apart, there);
      add(apart, here);
    }
  }
  for (Index pose = 0; pose < std::ssize(r.poses.commands); ++pose)
    for (std::size_t d = 0; d < r.poses.dots.names.size(); ++d) {
      const Vec3 place = dot_place(r, pose, d);
      const bool is_none = r.fit.dots[pose][d].marker < 0;
      if (is_none && std::isfinite(place[across] + place[up])) add(none, place);
    }
  if (computed.x.empty()) return {};
  std::vector<PlotSeries> all{apart};
  all.insert(all.end(), measured.begin(), measured.end());
  all.push_back(computed);
  if (!none.x.empty()) all.push_back(none);
  std::erase_if(all, [](const PlotSeries& series) { return series.x.empty(); });
  return all;
}

}  // namespace

Plot robot_fit_plot(const RobotFitReport& r) {
  if (markers_of(r).empty() && !has_outlines(r))
    throw InvalidInput("a plot shows markers and outlines, and none was measured");
  Plot plot;
  plot.title = !has_outlines(r)        ? "measured and computed markers"
               : markers_of(r).empty() ? "measured and computed outlines"
                                       : "measured and computed markers and outlines";
  plot.panel_height = 320;
  plot.rows.emplace_back();
  for (const auto& [across, up] : {std::pair{0, 2}, std::pair{1, 2}, std::pair{0, 1}}) {
    constexpr const char* names[3] = {"x [mm]", "y [mm]", "z [mm]"};
    PlotPanel panel = panel_of("", names[across], names[up]);
    panel.equal = true;
    if (across + up == 1) panel.series = outline_series(r);
    const std::vector<PlotSeries> markers = seen_along(r, across, up);
    panel.series.insert(panel.series.end(), markers.begin(), markers.end());
    if (!panel.series.empty()) plot.rows.back().push_back(std::move(panel));
  }
  if (plot.rows.back().empty())
    throw InvalidInput("no marker was measured along two axes in any pose: nothing to plot");
  return plot;
}

}  // namespace softkin::calibration
