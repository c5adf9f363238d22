#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <softkin/calibration/path_comparison.hpp>
#include <softkin/calibration/report_parts.hpp>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plot/curves.hpp>
#include <softkin/runs/file_labels.hpp>

namespace softkin::calibration {

namespace {

constexpr double negligible = 1e-9;  // relative, of places and starts

Vec3 masked(const Vec3& point, const std::array<bool, 3>& axes) {
  Vec3 result = point;
  for (std::size_t a = 0; a < 3; ++a)
    if (!axes[a]) result[a] = 0;
  return result;
}

/// Fractions of the length, from 0 to 1.
std::vector<double> fractions_of(const Track& track, const std::array<bool, 3>& axes) {
  std::vector<double> fractions{0};
  for (std::size_t i = 1; i < track.points.size(); ++i)
    fractions.push_back(fractions.back() + masked(track.points[i] - track.points[i - 1], axes).norm());
  if (!(fractions.back() > 0))
    throw InvalidInput({track.name}, "the track has no length, so it has no arc to compare by");
  for (double& fraction : fractions) fraction /= fractions.back();
  fractions.back() = 1;
  return fractions;
}

std::vector<double> places_of(const Track& track, Resampling by, const std::array<bool, 3>& axes) {
  if (by == Resampling::arc) return fractions_of(track, axes);
  if (by == Resampling::parameter) {
    if (track.parameter.empty()) throw InvalidInput({track.name}, "the track has no times (column t_s) to compare by");
    return track.parameter;
  }
  std::vector<double> rows(track.points.size());
  std::iota(rows.begin(), rows.end(), 0.0);
  return rows;
}

/// The point at a place, straight between its neighbours; none outside. places do not descend.
std::optional<Vec3> point_at(const Track& track, const std::vector<double>& places, double place) {
  const double slack = negligible * std::max(std::abs(places.front()), std::abs(places.back()));
  if (place < places.front() - slack || place > places.back() + slack) return std::nullopt;
  const auto above = std::lower_bound(places.begin(), places.end(), place);
  if (above == places.begin()) return track.points.front();
  if (above == places.end()) return track.points.back();
  const std::size_t i = above - places.begin();
  const double fraction = (place - places[i - 1]) / (places[i] - places[i - 1]);
  return track.points[i - 1] + fraction * (track.points[i] - track.points[i - 1]);
}

/// Moves the other points onto the reference's.
void align(PathComparison& comparison) {
  const auto count = static_cast<double>(comparison.waypoints.size());
  Vec3 mean_reference = Vec3::Zero(), mean_other = Vec3::Zero();
  for (const WaypointError& each : comparison.waypoints) {
    mean_reference += each.reference / count;
    mean_other += each.other / count;
  }
  Mat3 covariance = Mat3::Zero();
  for (const WaypointError& each : comparison.waypoints)
    covariance += (each.reference - mean_reference) * (each.other - mean_other).transpose();
  // axes that are not compared stay as they are: their singular value is above all others
  const double scale = 1 + covariance.cwiseAbs().sum();
  for (std::size_t a = 0; a < 3; ++a)
    if (!comparison.axes[a]) covariance(a, a) = 10 * scale;
  const NearestRotation nearest = nearest_rotation(covariance);
  comparison.rotation = nearest.rotation;
  comparison.translation = mean_reference - comparison.rotation * mean_other;
  comparison.aligned = true;
  // determined where all directions but one are spanned; an axis that is not compared counts as spanned
  comparison.unique = nearest.values[1] > negligible * (scale - 1);
  for (WaypointError& each : comparison.waypoints)
    each.other = masked(comparison.rotation * each.other + comparison.translation, comparison.axes);
}

void judge(PathComparison& comparison) {
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < comparison.waypoints.size(); ++i) {
    WaypointError& each = comparison.waypoints[i];
    each.error_mm = (each.other - each.reference).norm();
    sum += each.error_mm;
    squares += each.error_mm * each.error_mm;
    if (each.error_mm > comparison.largest_mm) {
      comparison.largest_mm = each.error_mm;
      comparison.worst = i;
    }
  }
  const auto count = static_cast<double>(comparison.waypoints.size());
  comparison.mean_mm = sum / count;
  comparison.rms_mm = std::sqrt(squares / count);
}

Vec3 point_of_sweep(const SingleSweep& sweep, double command) {
  if (command == sweep.commands.front()) return sweep.points.front();
  for (std::size_t i = 0; i + 1 < sweep.commands.size(); ++i) {
    const double a = sweep.commands[i], b = sweep.commands[i + 1];
    if (a == b || command < std::min(a, b) || command > std::max(a, b)) continue;
    return sweep.points[i] + (command - a) / (b - a) * (sweep.points[i + 1] - sweep.points[i]);
  }
  const auto [low, high] = std::minmax_element(sweep.commands.begin(), sweep.commands.end());
  throw InvalidInput({sweep.name}, "the command " + number(command) + " is outside this sweep, " + number(*low) +
                                       " to " + number(*high));
}

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
std::vector<PlotPanel> views(const std::vector<PathComparison>& comparisons, const std::vector<SpaceCurve>& paths) {
  std::array<bool, 3> axes{true, true, true};
  for (const PathComparison& each : comparisons)
    for (std::size_t a = 0; a < 3; ++a) axes[a] = axes[a] && each.axes[a];
  std::vector<PlotPanel> panels = projections(paths);
  if (axes[0] && axes[1] && axes[2]) return panels;
  const std::size_t only = !axes[1] ? 0 : !axes[2] ? 1 : 2;  // seen along y, z and x
  PlotPanel panel = panels[only];
  for (std::size_t s = 0; s < panel.series.size(); ++s) panel.series[s].label = paths[s].name;
  return {panel};
}

std::string place_text(const Track& track, std::size_t waypoint) {
  std::string text;
  for (std::size_t a = 0; a < 3; ++a)
    text +=
        (a > 0 ? " " : "") + (track.axes[a] ? decimal(track.points[waypoint][a], length_decimals) : std::string("-"));
  return text;
}

/// How far off the waypoint is.
Cell error_at(const PathComparison& comparison, std::size_t waypoint) {
  for (const WaypointError& each : comparison.waypoints)
    if (each.waypoint == waypoint) return each.error_mm;
  return "-";
}

}  // namespace

Resampling natural_resampling(const Track& reference, const Track& other) {
  if (!reference.parameter.empty() && !other.parameter.empty()) return Resampling::parameter;
  return reference.points.size() == other.points.size() ? Resampling::waypoint : Resampling::arc;
}

PathComparison compare_paths(const Track& reference, const Track& other, Resampling by, bool aligned) {
  PathComparison comparison;
  comparison.by = by;
  for (std::size_t a = 0; a < 3; ++a) comparison.axes[a] = reference.axes[a] && other.axes[a];
  if (std::count(comparison.axes.begin(), comparison.axes.end(), true) == 0)
    throw InvalidInput({other.name}, "the track has no axis in common with " + reference.name);
  for (const Track* track : {&reference, &other})
    if (track->points.empty()) throw InvalidInput({track->name}, "the track has no point");
  if (by == Resampling::waypoint && reference.points.size() != other.points.size())
    throw InvalidInput({other.name}, "the track has " + std::to_string(other.points.size()) + " waypoints, " +
                                         reference.name + " has " + std::to_string(reference.points.size()) +
                                         ": compare them by time or by arc");
  const std::vector<double> places = places_of(reference, by, comparison.axes);
  const std::vector<double> others = places_of(other, by, comparison.axes);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::optional<Vec3> point = point_at(other, others, places[i]);
    if (!point) {
      ++comparison.left_out;
      continue;
    }
    comparison.waypoints.push_back(
        {i, places[i], masked(reference.points[i], comparison.axes), masked(*point, comparison.axes), 0});
  }
  if (comparison.waypoints.empty())
    throw InvalidInput({other.name}, "no waypoint of " + reference.name + " lies within its range, " +
                                         number(others.front()) + " to " + number(others.back()));
  if (aligned) align(comparison);
  judge(comparison);
  return comparison;
}

Vec3 superposed(const std::vector<SingleSweep>& sweeps, const std::vector<double>& commands) {
  if (sweeps.empty() || sweeps.size() != commands.size()) throw InvalidInput("a sum needs a command for each sweep");
  const Vec3 start = sweeps.front().points.at(0);
  Vec3 sum = start;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    const SingleSweep& sweep = sweeps[s];
    if ((sweep.points.at(0) - start).norm() > 1e-3)
      throw InvalidInput({sweep.name}, "the sweep starts " + number((sweep.points[0] - start).norm()) +
                                           " mm away from where " + sweeps.front().name + " starts");
    sum += point_of_sweep(sweep, commands[s]) - sweep.points[0];
  }
  return sum;
}

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

std::vector<std::string> PathReport::labels() const {
  std::vector<std::string> files, tails;
  for (const Track& track : tracks) {
    files.push_back(track.name);
    tails.push_back(track.marker.empty() ? "" : "@" + track.marker);
  }
  return runs::file_labels(files, tails);
}

std::vector<std::string> PathReport::heads() const {
  std::vector<std::string> lines{"1: " + tracks[0].name + ", " + counted(tracks[0].points.size(), "waypoint")};
  for (std::size_t c = 0; c < comparisons.size(); ++c) {
    const PathComparison& each = comparisons[c];
    std::string text = std::to_string(c + 2) + ": " + tracks[c + 1].name + ", " +
                       counted(tracks[c + 1].points.size(), "point") + "; compared by ";
    if (each.by == Resampling::waypoint) text += "waypoint (row by row)";
    if (each.by == Resampling::arc) text += "arc length (equal fractions of each track's length)";
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
  const std::vector<std::string> names = labels();
  Table table{{{.title = "waypoint"}, {.title = "x, y, z [mm]"}}};
  for (std::size_t c = 0; c < comparisons.size(); ++c)
    table.columns.push_back(decimals(names[c + 1] + ": off by", "mm", length_decimals));
  const std::size_t count = tracks[0].points.size();
  for (std::size_t k = 0; k < std::min(most, count); ++k) {
    const std::size_t w = count <= most ? k : k * (count - 1) / (most - 1);
    Row row{count_cell(w), place_text(tracks[0], w)};
    for (const PathComparison& each : comparisons) row.push_back(error_at(each, w));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table PathReport::summary() const {
  const std::vector<std::string> names = labels();
  Table table{{Column{},
               decimals("largest", "mm", length_decimals),
               {.title = "at waypoint"},
               decimals("mean", "mm", length_decimals),
               decimals("rms", "mm", length_decimals)}};
  for (std::size_t c = 0; c < comparisons.size(); ++c) {
    const PathComparison& each = comparisons[c];
    table.rows.push_back(
        {names[c + 1], each.largest_mm, count_cell(each.waypoints[each.worst].waypoint), each.mean_mm, each.rms_mm});
  }
  return table;
}

Table PathReport::errors() const {
  Table table{{{"track"}, {"waypoint"}, {"place"}}};
  for (const char* of : {"reference", "other"})
    for (const char* axis : axis_names) table.columns.push_back({std::string(of) + "_" + axis + "_mm"});
  table.columns.push_back({"error_mm"});
  table.columns.push_back({"file"});
  for (std::size_t c = 0; c < comparisons.size(); ++c)
    for (const WaypointError& each : comparisons[c].waypoints) {
      Row row{count_cell(c + 2), count_cell(each.waypoint), each.place};
      for (const Vec3& point : {each.reference, each.other}) row.insert(row.end(), point.begin(), point.end());
      row.emplace_back(each.error_mm);
      row.emplace_back(tracks[c + 1].name);
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
  const std::string place = by == Resampling::waypoint ? "waypoint"
                            : by == Resampling::arc    ? "fraction of length [-]"
                            : parameter.empty()        ? "time [s]"
                                                       : parameter;
  PlotPanel panel = panel_of("", place, "error [mm]");
  panel.y.low = 0;
  const std::vector<std::string> names = labels();
  std::vector<SpaceCurve> paths{{names[0], tracks[0].points, true, true}};
  for (std::size_t c = 0; c < comparisons.size(); ++c) {
    const std::string& label = names[c + 1];
    PlotSeries series{.label = label, .x = {}, .y = {}, .style = static_cast<int>(c) + 1};
    paths.push_back({label, {}, true, true});
    for (const WaypointError& each : comparisons[c].waypoints) {
      series.x.push_back(each.place);
      series.y.push_back(each.error_mm);
      paths.back().points.push_back(each.other);
    }
    panel.series.push_back(series);
  }
  if (comparisons.front().largest_mm == 0) panel.y.high = 1;
  return {.title = "distance from " + tracks[0].name, .rows = {{panel}, views(comparisons, paths)}};
}

}  // namespace softkin::calibration
