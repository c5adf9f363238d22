#include <algorithm>
#include <map>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/track_file.hpp>

namespace softkin {

namespace {

constexpr const char* length_units[] = {"mm", "cm", "m", "um", "in", "px"};
constexpr const char* wrong_times[] = {"t", "time", "t_ms", "t_us", "t_min", "t_h", "time_s", "time_ms", "t_sec"};

/// Column of each coordinate of a marker.
using Coordinates = std::array<std::optional<std::size_t>, 3>;

class TrackColumns {
 public:
  TrackColumns(std::string file, const CsvTable& table) : file_(std::move(file)), table_(table) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) add(c);
  }

  [[nodiscard]] const Coordinates& of(const std::string& asked) const {
    std::vector<std::string> names;
    for (const auto& [name, coordinates] : markers_) names.push_back(name);
    if (markers_.empty()) fail("no column is a coordinate: x_mm, y_mm, z_mm, or tip_x_mm of a marker 'tip'");
    std::string marker = asked;
    if (asked.empty() && !markers_.contains("")) {
      if (markers_.size() > 1) fail("it has several markers; say which one by --marker" + suggest_name("", names));
      marker = names.front();
    }
    // a file of x_mm, y_mm, z_mm alone is that of whatever marker is asked for
    const auto found = markers_.size() == 1 && markers_.contains("") ? markers_.begin() : markers_.find(marker);
    if (found == markers_.end()) fail("no marker " + excerpt(marker) + suggest_name(marker, names));
    if (std::count_if(found->second.begin(), found->second.end(), [](const auto& c) { return c.has_value(); }) < 2)
      fail("a track needs at least two coordinates, such as x_mm and y_mm");
    return found->second;
  }

  [[nodiscard]] std::optional<std::size_t> parameter(const std::string& asked) const {
    const std::string name = asked.empty() ? "t_s" : asked;
    const auto found = std::find(table_.columns.begin(), table_.columns.end(), name);
    if (found != table_.columns.end()) return static_cast<std::size_t>(found - table_.columns.begin());
    if (!asked.empty()) fail("no column " + excerpt(asked) + suggest_name(asked, table_.columns));
    return std::nullopt;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput({file_, table_.header_line}, message); }

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
      fail("column " + excerpt(name) + ": a time is in s, in column t_s");
    if (take_axis(name, marker, axis))
      fail("column " + excerpt(name) + ": its unit is missing: write '" + name + "_mm'");
    const std::size_t underscore = name.rfind('_');
    if (underscore == std::string::npos || !take_axis(name.substr(0, underscore), marker, axis)) return;
    const std::string unit = name.substr(underscore + 1);
    if (unit != "mm") {
      if (std::find(std::begin(length_units), std::end(length_units), unit) == std::end(length_units)) return;
      fail("column " + excerpt(name) + ": coordinates are in mm, not in " + unit);
    }
    markers_[marker][axis] = column;
  }

  std::string file_;
  const CsvTable& table_;
  std::map<std::string, Coordinates> markers_;
};

}  // namespace

Track read_track(const std::filesystem::path& path, const std::string& marker, const std::string& parameter) {
  const CsvTable table = read_csv(path);
  const TrackColumns columns(path.string(), table);
  const Coordinates& coordinates = columns.of(marker);
  const std::optional<std::size_t> along = columns.parameter(parameter);
  Track track{path.string(), {}, {false, false, false}, {}, false};
  for (std::size_t axis = 0; axis < 3; ++axis) track.axes[axis] = coordinates[axis].has_value();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    Vec3 point = Vec3::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (coordinates[axis]) point[static_cast<Index>(axis)] = table.rows[r][*coordinates[axis]];
    track.points.push_back(point);
    if (!along) continue;
    track.parameter.push_back(table.rows[r][*along]);
    if (r > 0 && !(track.parameter[r] > track.parameter[r - 1]))
      throw InvalidInput({path.string(), table.lines[r]},
                         "column '" + table.columns[*along] + "' must ascend from row to row");
  }
  return track;
}

}  // namespace softkin
