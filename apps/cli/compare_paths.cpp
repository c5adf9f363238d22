#include "compare_paths.hpp"

#include <algorithm>
#include <softkin/io/file.hpp>
#include <softkin/io/plot/svg_plot.hpp>

#include <softkin/io/plot/curves.hpp>
#include "command.hpp"
#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

calibration::Resampling resampling_of(const PathCompareOptions& options, const Track& reference, const Track& other) {
  if (options.by.empty()) return calibration::natural_resampling(reference, other);
  if (options.by == "waypoint") return calibration::Resampling::waypoint;
  return options.by == "arc" ? calibration::Resampling::arc : calibration::Resampling::parameter;
}

bool is_named(const std::string& by) {
  return !by.empty() && by != "waypoint" && by != "time" && by != "arc";
}

std::string place_name(const PathCompareOptions& options, calibration::Resampling by) {
  if (by == calibration::Resampling::waypoint) return "waypoint";
  if (by == calibration::Resampling::arc) return "share of length [-]";
  return is_named(options.by) ? options.by : "time [s]";
}

std::string axes_text(const calibration::PathComparison& comparison) {
  std::string text;
  for (std::size_t a = 0; a < 3; ++a)
    if (comparison.axes[a]) text += axis_names[a];
  return text;
}

class PathReport {
 public:
  PathReport(const PathCompareOptions& options, std::vector<Track> tracks)
      : options_(options), tracks_(std::move(tracks)) {
    for (std::size_t t = 1; t < tracks_.size(); ++t) {
      const bool same_frame = tracks_[0].robot_frame && tracks_[t].robot_frame;  // nothing to align
      const calibration::Resampling by = resampling_of(options, tracks_[0], tracks_[t]);
      comparisons_.push_back(calibration::compare_paths(tracks_[0], tracks_[t], by, options.align && !same_frame));
    }
  }

  [[nodiscard]] std::string text() const {
    std::string text = "1: " + tracks_[0].name + ", " + counted(tracks_[0].points.size(), "waypoint") + "\n";
    for (std::size_t c = 0; c < comparisons_.size(); ++c) text += head(c);
    std::vector<std::vector<std::string>> rows{{"", "largest [mm]", "at waypoint", "mean [mm]", "rms [mm]"}};
    for (std::size_t c = 0; c < comparisons_.size(); ++c) {
      const calibration::PathComparison& each = comparisons_[c];
      rows.push_back({std::to_string(c + 2), decimal(each.largest_mm, 3),
                      std::to_string(each.waypoints[each.worst].waypoint), decimal(each.mean_mm, 3),
                      decimal(each.rms_mm, 3)});
    }
    const std::vector<std::vector<std::string>> waypoints = waypoint_rows();
    text += joined(aligned(waypoints, std::string(waypoints.front().size(), 'r')), "");
    if (const std::size_t all = tracks_[0].points.size(); waypoints.size() - 1 < all)
      text += std::to_string(waypoints.size() - 1) + " of " + counted(all, "waypoint") + " shown; all: -o F.csv\n";
    return text + "\n" + joined(aligned(rows, "rrrrr"), "");
  }

  [[nodiscard]] Json json() const {
    Json json{{"reference", tracks_[0].name}, {"tracks", Json::array()}};
    for (std::size_t c = 0; c < comparisons_.size(); ++c) {
      const calibration::PathComparison& each = comparisons_[c];
      Json track{{"file", tracks_[c + 1].name},
                 {"by", by_name(each.by)},
                 {"axes", axes_text(each)},
                 {"aligned", each.aligned},
                 {"left_out", each.left_out},
                 {"largest_mm", each.largest_mm},
                 {"worst_waypoint", each.waypoints[each.worst].waypoint},
                 {"mean_mm", each.mean_mm},
                 {"rms_mm", each.rms_mm},
                 {"waypoint", Json::array()},
                 {"error_mm", Json::array()}};
      for (const calibration::WaypointError& waypoint : each.waypoints) {
        track["waypoint"].push_back(waypoint.waypoint);
        track["error_mm"].push_back(waypoint.error_mm);
      }
      if (each.aligned) add_alignment(each, track);
      json["tracks"].push_back(track);
    }
    return json;
  }

  [[nodiscard]] std::string csv() const {
    std::string text = "track,waypoint,place";
    for (const char* of : {"reference", "other"})
      for (const char* axis : axis_names) text += std::string(",") + of + "_" + axis + "_mm";
    text += ",error_mm\n";
    for (std::size_t c = 0; c < comparisons_.size(); ++c)
      for (const calibration::WaypointError& each : comparisons_[c].waypoints) {
        text += std::to_string(c + 2) + "," + std::to_string(each.waypoint) + "," + exact(each.place);
        for (const Vec3& point : {each.reference, each.other})
          for (const double x : point) text += "," + exact(x);
        text += "," + exact(each.error_mm) + "\n";
      }
    return text;
  }

  [[nodiscard]] Plot plot() const {
    Plot plot;
    plot.title = "distance from " + tracks_[0].name;
    PlotPanel errors;
    errors.x.label = place_name(options_, comparisons_.front().by);
    errors.y.label = "error [mm]";
    errors.y.low = 0;
    std::vector<SpaceCurve> ways{{"1: " + tracks_[0].name, tracks_[0].points, true, true}};
    for (std::size_t c = 0; c < comparisons_.size(); ++c) {
      PlotSeries series;
      series.label = std::to_string(c + 2) + ": " + tracks_[c + 1].name;
      series.style = static_cast<int>(c) + 1;
      for (const calibration::WaypointError& each : comparisons_[c].waypoints) {
        series.x.push_back(each.place);
        series.y.push_back(each.error_mm);
      }
      errors.series.push_back(series);
      ways.push_back({series.label, {}, true, true});
      for (const calibration::WaypointError& each : comparisons_[c].waypoints) ways.back().points.push_back(each.other);
    }
    if (comparisons_.front().largest_mm == 0) errors.y.high = 1;
    plot.rows = {{errors}, views(ways)};
    return plot;
  }

 private:
  static const char* by_name(calibration::Resampling by) {
    return by == calibration::Resampling::waypoint ? "waypoint"
           : by == calibration::Resampling::arc    ? "arc"
                                                   : "parameter";
  }

  /// All three views, or the only one that two axes have.
  [[nodiscard]] std::vector<PlotPanel> views(const std::vector<SpaceCurve>& ways) const {
    std::array<bool, 3> axes{true, true, true};
    for (const calibration::PathComparison& each : comparisons_)
      for (std::size_t a = 0; a < 3; ++a) axes[a] = axes[a] && each.axes[a];
    std::vector<PlotPanel> panels = projections(ways);
    if (axes[0] && axes[1] && axes[2]) return panels;
    const std::size_t only = !axes[1] ? 0 : !axes[2] ? 1 : 2;  // seen along y, z and x
    PlotPanel panel = panels[only];
    for (std::size_t s = 0; s < panel.series.size(); ++s) panel.series[s].label = ways[s].name;
    return {panel};
  }

  [[nodiscard]] std::string head(std::size_t c) const {
    const calibration::PathComparison& each = comparisons_[c];
    std::string text = std::to_string(c + 2) + ": " + tracks_[c + 1].name + ", " +
                       counted(tracks_[c + 1].points.size(), "point") + "; compared by ";
    if (each.by == calibration::Resampling::waypoint) text += "waypoint (row by row)";
    if (each.by == calibration::Resampling::arc) text += "arc length (equal shares of each track's length)";
    if (each.by == calibration::Resampling::parameter)
      text += (is_named(options_.by) ? options_.by : "time") + std::string(", straight between its points");
    text += ", along " + axes_text(each);
    if (each.left_out > 0)
      text += "; " + counted(each.left_out, "waypoint") + " of the reference outside its range left out";
    if (each.aligned) text += "; aligned: " + alignment_text(each);
    return text + "\n";
  }

  static std::string alignment_text(const calibration::PathComparison& each) {
    const double angle = std::acos(std::clamp((each.rotation.trace() - 1) / 2, -1.0, 1.0)) * 57.29577951308232;
    std::string moved;  // to a micrometre, as all lengths here
    for (const double x : each.translation) moved += (moved.empty() ? "" : ", ") + decimal(x, 3);
    return "turned by " + number(angle, 4) + " degrees, then moved by (" + moved + ") mm" +
           (each.unique ? "" : " (the points lie on a line: other rotations fit as well)");
  }

  static void add_alignment(const calibration::PathComparison& each, Json& track) {
    track["rotation"] = Json::array();
    for (Index row = 0; row < 3; ++row)
      track["rotation"].push_back({each.rotation(row, 0), each.rotation(row, 1), each.rotation(row, 2)});
    track["translation_mm"] = {each.translation.x(), each.translation.y(), each.translation.z()};
    track["alignment_unique"] = each.unique;
  }

  /// The reference's waypoints, and how far off each track is; long tables have twenty even rows.
  [[nodiscard]] std::vector<std::vector<std::string>> waypoint_rows() const {
    constexpr std::size_t most = 20;
    std::vector<std::vector<std::string>> rows{{"waypoint", "x, y, z [mm]"}};
    for (std::size_t c = 0; c < comparisons_.size(); ++c) rows[0].push_back(std::to_string(c + 2) + ": off by [mm]");
    const std::size_t count = tracks_[0].points.size();
    for (std::size_t k = 0; k < std::min(most, count); ++k) {
      const std::size_t w = count <= most ? k : k * (count - 1) / (most - 1);
      const Vec3& p = tracks_[0].points[w];
      std::string place;
      for (std::size_t a = 0; a < 3; ++a)
        place += (a > 0 ? " " : "") + (tracks_[0].axes[a] ? decimal(p[static_cast<Index>(a)], 3) : std::string("-"));
      rows.push_back({std::to_string(w), place});
      for (const calibration::PathComparison& each : comparisons_) {
        const auto found = std::find_if(each.waypoints.begin(), each.waypoints.end(),
                                        [&](const calibration::WaypointError& e) { return e.waypoint == w; });
        rows.back().push_back(found == each.waypoints.end() ? "-" : decimal(found->error_mm, 3));
      }
    }
    return rows;
  }

  const PathCompareOptions& options_;
  std::vector<Track> tracks_;
  std::vector<calibration::PathComparison> comparisons_;
};

}  // namespace

std::vector<Output> PathCompareOptions::outputs() const {
  std::vector<Output> outputs;
  for (const auto& [option, file] : {std::pair{"--output", output}, {"--plot", plot}})
    if (!file.empty()) outputs.push_back({option, file, 0});
  return outputs;
}

std::vector<fs::path> PathCompareOptions::inputs() const {
  std::vector<fs::path> inputs(sum.begin(), sum.end());
  for (const std::string& file : files) {
    inputs.emplace_back(file);
    inputs.emplace_back(file.substr(0, file.rfind('@')));
  }
  return inputs;
}

int compare_tracks(const PathCompareOptions& options) {
  check_outputs(options.outputs(), options.inputs());
  const PathReport report(options, tracks_of(options));
  const OutputFolders folders(options.outputs());
  if (!options.output.empty()) write_file(options.output, report.csv());
  if (!options.plot.empty()) write_svg(options.plot, report.plot());
  if (options.json) {
    print(report.json());
    return done;
  }
  std::string text = report.text();
  if (!options.output.empty()) text += "errors: " + options.output + "\n";
  if (!options.plot.empty()) text += "plot: " + options.plot + "\n";
  print(text);
  return done;
}

}  // namespace softkin::cli
