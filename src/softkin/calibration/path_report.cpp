#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/calibration/path_report.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plot/curves.hpp>

namespace softkin::calibration {

namespace {

constexpr int length_decimals = 3;  // to a micrometre

Resampling resampling_of(const std::string& by, const Track& reference, const Track& other) {
  if (by.empty()) return natural_resampling(reference, other);
  return by == "waypoint" ? Resampling::waypoint : by == "arc" ? Resampling::arc : Resampling::parameter;
}

const char* name_of(Resampling by) {
  return by == Resampling::waypoint ? "waypoint" : by == Resampling::arc ? "arc" : "parameter";
}

std::string axes_text(const PathComparison& comparison) {
  std::string text;
  for (std::size_t a = 0; a < 3; ++a)
    if (comparison.axes[a]) text += axis_names[a];
  return text;
}

std::string alignment_text(const PathComparison& each) {
  const double angle = std::acos(std::clamp((each.rotation.trace() - 1) / 2, -1.0, 1.0)) * 57.29577951308232;
  std::string moved;
  for (const double x : each.translation) moved += (moved.empty() ? "" : ", ") + decimal(x, length_decimals);
  return "turned by " + number(angle, 4) + " degrees, then moved by (" + moved + ") mm" +
         (each.unique ? "" : " (the points lie on a line: other rotations fit as well)");
}

Json comparison_json(const PathComparison& each, const Track& track) {
  Json json{{"file", track.name},
            {"by", name_of(each.by)},
            {"axes", axes_text(each)},
            {"aligned", each.aligned},
            {"left_out", each.left_out},
            {"largest_mm", each.largest_mm},
            {"worst_waypoint", each.waypoints[each.worst].waypoint},
            {"mean_mm", each.mean_mm},
            {"rms_mm", each.rms_mm},
            {"waypoint", Json::array()},
            {"error_mm", Json::array()}};
  for (const WaypointError& waypoint : each.waypoints) {
    json["waypoint"].push_back(waypoint.waypoint);
    json["error_mm"].push_back(waypoint.error_mm);
  }
  if (!each.aligned) return json;
  for (Index row = 0; row < 3; ++row) json["rotation"].push_back(json_of(Vec3(each.rotation.row(row))));
  json["translation_mm"] = json_of(each.translation);
  json["alignment_unique"] = each.unique;
  return json;
}

/// All three views, or the only one that two axes have.
std::vector<PlotPanel> views(const std::vector<PathComparison>& comparisons, const std::vector<SpaceCurve>& ways) {
  std::array<bool, 3> axes{true, true, true};
  for (const PathComparison& each : comparisons)
    for (std::size_t a = 0; a < 3; ++a) axes[a] = axes[a] && each.axes[a];
  std::vector<PlotPanel> panels = projections(ways);
  if (axes[0] && axes[1] && axes[2]) return panels;
  const std::size_t only = !axes[1] ? 0 : !axes[2] ? 1 : 2;  // seen along y, z and x
  PlotPanel panel = panels[only];
  for (std::size_t s = 0; s < panel.series.size(); ++s) panel.series[s].label = ways[s].name;
  return {panel};
}

Column length(const std::string& title) {
  return {.title = title, .digits = length_decimals, .form = Column::Form::decimals};
}

std::string place_text(const Track& track, std::size_t waypoint) {
  std::string text;
  for (std::size_t a = 0; a < 3; ++a)
    text +=
        (a > 0 ? " " : "") +
        (track.axes[a] ? decimal(track.points[waypoint][static_cast<Index>(a)], length_decimals) : std::string("-"));
  return text;
}

/// How far off the waypoint is.
Cell error_at(const PathComparison& comparison, std::size_t waypoint) {
  const auto found = std::find_if(comparison.waypoints.begin(), comparison.waypoints.end(),
                                  [&](const WaypointError& each) { return each.waypoint == waypoint; });
  return found == comparison.waypoints.end() ? Cell("-") : Cell(found->error_mm);
}

}  // namespace

PathReport path_report(std::vector<Track> tracks, const std::string& by, bool align) {
  PathReport report{std::move(tracks), {}, by == "waypoint" || by == "arc" || by == "time" ? "" : by};
  const Track& reference = report.tracks.front();
  for (std::size_t t = 1; t < report.tracks.size(); ++t) {
    const Track& track = report.tracks[t];
    const bool same_frame = reference.robot_frame && track.robot_frame;  // nothing to align
    report.comparisons.push_back(
        compare_paths(reference, track, resampling_of(by, reference, track), align && !same_frame));
  }
  return report;
}

std::vector<std::string> PathReport::heads() const {
  std::vector<std::string> lines{"1: " + tracks[0].name + ", " + counted(tracks[0].points.size(), "waypoint")};
  for (std::size_t c = 0; c < comparisons.size(); ++c) {
    const PathComparison& each = comparisons[c];
    std::string text = std::to_string(c + 2) + ": " + tracks[c + 1].name + ", " +
                       counted(tracks[c + 1].points.size(), "point") + "; compared by ";
    if (each.by == Resampling::waypoint) text += "waypoint (row by row)";
    if (each.by == Resampling::arc) text += "arc length (equal shares of each track's length)";
    if (each.by == Resampling::parameter)
      text += (parameter.empty() ? "time" : parameter) + ", straight between its points";
    text += ", along " + axes_text(each);
    if (each.left_out > 0)
      text += "; " + counted(each.left_out, "waypoint") + " of the reference outside its range left out";
    if (each.aligned) text += "; aligned: " + alignment_text(each);
    lines.push_back(text);
  }
  return lines;
}

Table PathReport::waypoints() const {
  constexpr std::size_t most = 20;
  Table table{{{.title = "waypoint"}, {.title = "x, y, z [mm]"}}};
  for (std::size_t c = 0; c < comparisons.size(); ++c)
    table.columns.push_back(length(std::to_string(c + 2) + ": off by [mm]"));
  const std::size_t count = tracks[0].points.size();
  for (std::size_t k = 0; k < std::min(most, count); ++k) {
    const std::size_t w = count <= most ? k : k * (count - 1) / (most - 1);
    Row row{static_cast<std::int64_t>(w), place_text(tracks[0], w)};
    for (const PathComparison& each : comparisons) row.push_back(error_at(each, w));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table PathReport::summary() const {
  Table table{{Column{}, length("largest [mm]"), {.title = "at waypoint"}, length("mean [mm]"), length("rms [mm]")}};
  for (std::size_t c = 0; c < comparisons.size(); ++c) {
    const PathComparison& each = comparisons[c];
    table.rows.push_back({static_cast<std::int64_t>(c + 2), each.largest_mm,
                          static_cast<std::int64_t>(each.waypoints[each.worst].waypoint), each.mean_mm, each.rms_mm});
  }
  return table;
}

Table PathReport::errors() const {
  Table table{{{"track"}, {"waypoint"}, {"place"}}};
  for (const char* of : {"reference", "other"})
    for (const char* axis : axis_names) table.columns.push_back({std::string(of) + "_" + axis + "_mm"});
  table.columns.push_back({"error_mm"});
  for (std::size_t c = 0; c < comparisons.size(); ++c)
    for (const WaypointError& each : comparisons[c].waypoints) {
      Row row{static_cast<std::int64_t>(c + 2), static_cast<std::int64_t>(each.waypoint), each.place};
      for (const Vec3& point : {each.reference, each.other}) row.insert(row.end(), point.begin(), point.end());
      row.emplace_back(each.error_mm);
      table.rows.push_back(std::move(row));
    }
  return table;
}

std::string PathReport::json() const {
  Json json{{"reference", tracks[0].name}, {"tracks", Json::array()}};
  for (std::size_t c = 0; c < comparisons.size(); ++c)
    json["tracks"].push_back(comparison_json(comparisons[c], tracks[c + 1]));
  return json_text(json);
}

Plot PathReport::plot() const {
  const Resampling by = comparisons.front().by;
  Plot plot;
  plot.title = "distance from " + tracks[0].name;
  PlotPanel panel;
  panel.x.label = by == Resampling::waypoint ? "waypoint"
                  : by == Resampling::arc    ? "share of length [-]"
                  : parameter.empty()        ? "time [s]"
                                             : parameter;
  panel.y.label = "error [mm]";
  panel.y.low = 0;
  std::vector<SpaceCurve> ways{{"1: " + tracks[0].name, tracks[0].points, true, true}};
  for (std::size_t c = 0; c < comparisons.size(); ++c) {
    PlotSeries series;
    series.label = std::to_string(c + 2) + ": " + tracks[c + 1].name;
    series.style = static_cast<int>(c) + 1;
    ways.push_back({series.label, {}, true, true});
    for (const WaypointError& each : comparisons[c].waypoints) {
      series.x.push_back(each.place);
      series.y.push_back(each.error_mm);
      ways.back().points.push_back(each.other);
    }
    panel.series.push_back(series);
  }
  if (comparisons.front().largest_mm == 0) panel.y.high = 1;
  plot.rows = {{panel}, views(comparisons, ways)};
  return plot;
}

}  // namespace softkin::calibration
