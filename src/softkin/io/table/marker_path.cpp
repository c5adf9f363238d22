#include <algorithm>
#include <cstdio>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/marker_path.hpp>

namespace softkin {

namespace {

constexpr const char* time_column = "t_s";

/// What a column holds; no marker: the time.
struct Column {
  std::optional<Index> marker;
  int axis = 0;
};

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

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
  PathColumns(const std::string& file, const CsvTable& table, const Model& model, const std::string& marker)
      : file_(file), line_(table.header_line), model_(model), default_(marker) {
    for (const Marker& each : model.markers) names_.push_back(each.name);
    for (const std::string& name : table.columns) columns_.push_back(column(name));
  }

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }

  /// Markers and axes in the order of their columns.
  [[nodiscard]] MarkerPath path() const {
    MarkerPath path;
    for (const Column& column : columns_) {
      if (!column.marker) continue;
      const std::size_t at = place(path, *column.marker);
      if (at == path.markers.size()) {
        path.markers.push_back(*column.marker);
        path.axes.push_back({false, false, false});
      }
      bool& counts = path.axes[at][static_cast<std::size_t>(column.axis)];
      if (counts)
        fail("two columns are the " + std::string(axis_names[column.axis]) + " of marker '" +
             names_[static_cast<std::size_t>(*column.marker)] + "'");
      counts = true;
    }
    if (path.markers.empty()) fail("no column is a coordinate: x_mm, y_mm, z_mm, or tip_x_mm with a marker's name");
    return path;
  }

  static std::size_t place(const MarkerPath& path, Index marker) {
    return static_cast<std::size_t>(std::find(path.markers.begin(), path.markers.end(), marker) - path.markers.begin());
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput({file_, line_}, message); }

  [[nodiscard]] Column column(const std::string& name) const {
    const auto refuse = [&](const std::string& why) { fail("column " + excerpt(name) + ": " + why); };
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
      fail("column " + excerpt(column) + ": " +
           (names_.empty() ? "the scene has no markers"
                           : "the scene has several markers; which one is meant? Name it in the column, as '" +
                                 names_.front() + "_" + column + "', or by --marker"));
    const std::string& wanted = !named.empty() ? named : !default_.empty() ? default_ : names_.front();
    const auto found = std::find(names_.begin(), names_.end(), wanted);
    if (found == names_.end())
      fail("column " + excerpt(column) + ": no marker " + excerpt(wanted) +
           (names_.empty() ? "; the scene has none" : suggest_name(wanted, names_)));
    return static_cast<Index>(found - names_.begin());
  }

  const std::string& file_;
  std::size_t line_;
  const Model& model_;
  const std::string& default_;
  std::vector<std::string> names_;
  std::vector<Column> columns_;
};

Waypoint waypoint_of(const std::vector<Column>& columns, const MarkerPath& path, const std::vector<double>& row) {
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
  const Vec3 rest = model.markers[static_cast<std::size_t>(path.markers[m])].point.at(model.rest);
  Vec3 away = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (path.axes[m][static_cast<std::size_t>(axis)]) away[axis] = scale * waypoint.targets[m][axis] - rest[axis];
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

}  // namespace

MarkerPath read_marker_path(const std::filesystem::path& path, const Model& model, const std::string& marker) {
  const std::string file = path.string();
  const CsvTable table = read_csv(path);
  const PathColumns columns(file, table, model, marker);
  MarkerPath result = columns.path();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    Waypoint waypoint = waypoint_of(columns.columns(), result, table.rows[r]);
    waypoint.line = table.lines[r];
    if (waypoint.time && r > 0 && *waypoint.time <= *result.waypoints.back().time)
      throw InvalidInput({file, waypoint.line}, std::string("column '") + time_column + "': times must ascend, but " +
                                                    number_text(*waypoint.time) + " s follows " +
                                                    number_text(*result.waypoints.back().time) + " s");
    result.waypoints.push_back(std::move(waypoint));
  }
  return result;
}

std::vector<std::string> doubts_about(const Model& model, const MarkerPath& path) {
  constexpr double large = 100, metre = 1000;
  std::vector<std::string> doubts;
  const Distances given = distances_from_rest(model, path, 1), metres = distances_from_rest(model, path, metre);
  const std::string robot = "the robot is " + number_text(model.diagonal_mm) + " mm across";
  if (given.greatest > large * model.diagonal_mm)
    doubts.push_back("the path leads " + number_text(given.greatest) + " mm away from the markers at rest, but " +
                     robot + ": are its coordinates in another unit than mm?");
  else if (metres.greatest < given.least)
    doubts.push_back("the path stays " + number_text(given.least) +
                     " mm away from the markers at rest, but would be near "
                     "them if its coordinates were in metres: are they? They are taken as mm, and " +
                     robot);
  return doubts;
}

}  // namespace softkin
