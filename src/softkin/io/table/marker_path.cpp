#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/marker_path.hpp>

namespace softkin {

namespace {

/// What a column holds; no marker: the time.
struct TargetColumn {
  std::optional<Index> marker;
  int axis = 0;
};

/// "tip_x_mm" as "tip", 0 and "mm"; "x" as "", 0 and "".
struct ColumnName {
  std::string marker, unit;
  int axis = -1;  // no coordinate

  explicit ColumnName(const std::string& name) {
    for (int a = 0; a < 3; ++a)
      for (const bool with_unit : {false, true}) try_axis(name, a, with_unit);
  }

 private:
  void try_axis(const std::string& name, int a, bool with_unit) {
    const std::size_t underscore = with_unit ? name.rfind('_') : name.size();
    if (axis >= 0 || underscore == std::string::npos || underscore == 0) return;
    const std::string head = name.substr(0, underscore);
    if (head != axis_names[a] && !head.ends_with(std::string("_") + axis_names[a])) return;
    axis = a;
    marker = head.size() > 2 ? head.substr(0, head.size() - 2) : "";
    unit = with_unit ? name.substr(underscore + 1) : "";
  }
};

class PathColumns {
 public:
  PathColumns(const CsvTable& table, const Model& model, const std::string& marker) : table_(table), default_(marker) {
    for (const Marker& each : model.markers) names_.push_back(each.name);
    for (const std::string& name : table.columns) columns_.push_back(column(name));
  }

  [[nodiscard]] const std::vector<TargetColumn>& columns() const { return columns_; }

  /// Markers and axes in the order of their columns.
  [[nodiscard]] MarkerPath path() const {
    MarkerPath path;
    for (const TargetColumn& column : columns_) {
      if (!column.marker) continue;
      const std::size_t at = place(path, *column.marker);
      if (at == path.markers.size()) {
        path.markers.push_back(*column.marker);
        path.axes.push_back({false, false, false});
      }
      bool& counts = path.axes[at][column.axis];
      if (counts)
        table_.fail_header("two columns are the " + std::string(axis_names[column.axis]) + " of marker '" +
                           names_[*column.marker] + "'");
      counts = true;
    }
    if (path.markers.empty())
      table_.fail_header("no column is a coordinate: x_mm, y_mm, z_mm, or tip_x_mm with a marker's name");
    return path;
  }

  static std::size_t place(const MarkerPath& path, Index marker) {
    return std::find(path.markers.begin(), path.markers.end(), marker) - path.markers.begin();
  }

 private:
  [[nodiscard]] TargetColumn column(const std::string& name) const {
    const auto refuse = [&](const std::string& why) { table_.fail_header("column " + excerpt(name) + ": " + why); };
    if (name == time_column) return {};
    if (name == "t" || name == "time" || name.starts_with("t_") || name.starts_with("time_"))
      refuse("a time is in s, in column t_s");
    const ColumnName parts(name);
    if (parts.axis < 0) refuse("expected t_s, x_mm, y_mm, z_mm, or MARKER_x_mm and so on");
    const std::string right = (parts.marker.empty() ? "" : parts.marker + "_") + axis_names[parts.axis] + "_mm";
    if (parts.unit.empty()) refuse("its unit is missing: write mm, as '" + right + "'");
    if (parts.unit != "mm")
      refuse("lengths are in mm, not in " + excerpt(parts.unit) + ": convert it to '" + right + "'");
    return {marker_of(name, parts.marker), parts.axis};
  }

  [[nodiscard]] Index marker_of(const std::string& column, const std::string& named) const {
    if (named.empty() && default_.empty() && names_.size() != 1)
      table_.fail_header("column " + excerpt(column) + ": " +
                         (names_.empty()
                              ? "the scene has no markers"
                              : "the scene has several markers; which one is meant? Name it in the column, as '" +
                                    names_.front() + "_" + column + "', or say whose all are (marker)"));
    const std::string& wanted = !named.empty() ? named : !default_.empty() ? default_ : names_.front();
    const auto found = std::find(names_.begin(), names_.end(), wanted);
    if (found == names_.end())
      table_.fail_header("column " + excerpt(column) + ": no marker " + excerpt(wanted) +
                         (names_.empty() ? "; the scene has none" : suggest_name(wanted, names_)));
    return found - names_.begin();
  }

  const CsvTable& table_;
  const std::string& default_;
  std::vector<std::string> names_;
  std::vector<TargetColumn> columns_;
};

Waypoint waypoint_of(const std::vector<TargetColumn>& columns, const MarkerPath& path, const std::vector<double>& row) {
  Waypoint waypoint;
  waypoint.targets.assign(path.markers.size(), Vec3::Zero());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].marker)
      waypoint.targets[PathColumns::place(path, *columns[c].marker)][columns[c].axis] = row[c];
    else
      waypoint.time = row[c];
  }
  return waypoint;
}

/// Distance of a marker at rest from a target, along the axes that count [mm]; scale: of the target.
double distance_from_rest(const Model& model, const MarkerPath& path, const Waypoint& waypoint, std::size_t m,
                          double scale) {
  const Vec3 rest = model.markers[path.markers[m]].at(model.rest);
  Vec3 away = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (path.axes[m][axis]) away[axis] = scale * waypoint.targets[m][axis] - rest[axis];
  return away.norm();
}

struct Distances {
  double least = std::numeric_limits<double>::infinity(), greatest = 0;  // [mm]
};

Distances distances_from_rest(const Model& model, const MarkerPath& path, double scale) {
  Distances all;
  for (const Waypoint& waypoint : path.waypoints)
    for (std::size_t m = 0; m < path.markers.size(); ++m) {
      const double distance = distance_from_rest(model, path, waypoint, m, scale);
      all.least = std::min(all.least, distance);
      all.greatest = std::max(all.greatest, distance);
    }
  return all;
}

constexpr const char* length_units[] = {"mm", "cm", "m", "um", "in", "px"};
constexpr const char* wrong_times[] = {"t", "time", "t_ms", "t_us", "t_min", "t_h", "time_s", "time_ms", "t_sec"};

/// Column of each coordinate of a marker.
using Coordinates = std::array<std::optional<std::size_t>, 3>;

class TrackColumns {
 public:
  explicit TrackColumns(const CsvTable& table) : table_(table) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) add(c);
  }

  [[nodiscard]] const Coordinates& of(const std::string& requested) const {
    std::vector<std::string> names;
    for (const auto& [name, coordinates] : markers_) names.push_back(name);
    if (markers_.empty())
      table_.fail_header("no column is a coordinate: x_mm, y_mm, z_mm, or tip_x_mm of a marker 'tip'");
    std::string marker = requested;
    if (requested.empty() && !markers_.contains("")) {
      if (markers_.size() > 1)
        table_.fail_header("it has several markers; say which one is meant (marker)" + suggest_name("", names));
      marker = names.front();
    }
    // a file of x_mm, y_mm, z_mm alone is that of any requested marker
    const auto found = markers_.size() == 1 && markers_.contains("") ? markers_.begin() : markers_.find(marker);
    if (found == markers_.end()) table_.fail_header("no marker " + excerpt(marker) + suggest_name(marker, names));
    if (std::count_if(found->second.begin(), found->second.end(), [](const auto& c) { return c.has_value(); }) < 2)
      table_.fail_header("a track needs at least two coordinates, such as x_mm and y_mm");
    return found->second;
  }

  [[nodiscard]] std::optional<std::size_t> parameter(const std::string& requested) const {
    const auto found = table_.find(requested.empty() ? time_column : requested);
    if (!found && !requested.empty())
      table_.fail_header("no column " + excerpt(requested) + suggest_name(requested, table_.columns));
    return found;
  }

 private:
  /// Does a name end in a coordinate? Then marker and axis.
  static bool take_axis(const std::string& name, std::string& marker, std::size_t& axis) {
    for (axis = 0; axis < 3; ++axis) {
      if (name == axis_names[axis])
        marker = "";
      else if (name.ends_with(std::string("_") + axis_names[axis]))
        marker = name.substr(0, name.size() - 2);
      else
        continue;
      return true;
    }
    return false;
  }

  void add(std::size_t column) {
    const std::string& name = table_.columns[column];
    std::string marker;
    std::size_t axis = 0;
    if (std::find(std::begin(wrong_times), std::end(wrong_times), name) != std::end(wrong_times))
      table_.fail_header("column " + excerpt(name) + ": a time is in s, in column t_s");
    if (take_axis(name, marker, axis))
      table_.fail_header("column " + excerpt(name) + ": its unit is missing: write '" + name + "_mm'");
    const std::size_t underscore = name.rfind('_');
    if (underscore == std::string::npos || !take_axis(name.substr(0, underscore), marker, axis)) return;
    const std::string unit = name.substr(underscore + 1);
    if (unit != "mm") {
      if (std::find(std::begin(length_units), std::end(length_units), unit) == std::end(length_units)) return;
      table_.fail_header("column " + excerpt(name) + ": coordinates are in mm, not in " + unit);
    }
    markers_[marker][axis] = column;
  }

  const CsvTable& table_;
  std::map<std::string, Coordinates> markers_;
};

}  // namespace

MarkerPath read_marker_path(const std::filesystem::path& path, const Model& model, const std::string& marker) {
  const CsvTable table = read_csv(path);
  const PathColumns columns(table, model, marker);
  MarkerPath result = columns.path();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    Waypoint waypoint = waypoint_of(columns.columns(), result, table.rows[r]);
    waypoint.line = table.lines[r];
    if (waypoint.time && r > 0 && *waypoint.time <= *result.waypoints.back().time)
      table.fail(r, std::string("column '") + time_column + "': times must ascend, but " + number(*waypoint.time) +
                        " s follows " + number(*result.waypoints.back().time) + " s");
    result.waypoints.push_back(std::move(waypoint));
  }
  return result;
}

std::vector<std::string> doubts_about(const Model& model, const MarkerPath& path) {
  constexpr double large = 100, metre = 1000;
  std::vector<std::string> doubts;
  const Distances given = distances_from_rest(model, path, 1), metres = distances_from_rest(model, path, metre);
  const std::string robot = "the robot is " + number(model.diagonal_mm) + " mm across";
  if (given.greatest > large * model.diagonal_mm)
    doubts.push_back("the path leads " + number(given.greatest) + " mm away from the markers at rest, but " + robot +
                     ": are its coordinates in another unit than mm?");
  else if (metres.greatest < given.least)
    doubts.push_back("the path stays " + number(given.least) +
                     " mm away from the markers at rest, but would be near "
                     "them if its coordinates were in metres: are they? They are taken as mm, and " +
                     robot);
  return doubts;
}

Track read_track(const std::filesystem::path& path, const std::string& marker, const std::string& parameter) {
  const CsvTable table = read_csv(path);
  const TrackColumns columns(table);
  const Coordinates& coordinates = columns.of(marker);
  const std::optional<std::size_t> along = columns.parameter(parameter);
  Track track{path.string(), {}, {false, false, false}, {}, false};
  for (std::size_t axis = 0; axis < 3; ++axis) track.axes[axis] = coordinates[axis].has_value();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    Vec3 point = Vec3::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (coordinates[axis]) point[axis] = table.rows[r][*coordinates[axis]];
    track.points.push_back(point);
    if (!along) continue;
    track.parameter.push_back(table.rows[r][*along]);
    if (r > 0 && !(track.parameter[r] > track.parameter[r - 1]))
      table.fail(r, "column '" + table.columns[*along] + "' must ascend from row to row");
  }
  return track;
}

}  // namespace softkin
