#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/measured_poses.hpp>
#include <softkin/model/names.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin {

namespace {

/// The name of a dot: "dot" and a number.
bool names_dot(const std::string& name) {
  return name.size() > 3 && name.starts_with("dot") && name[3] != '0' &&
         name.find_first_not_of("0123456789", 3) == std::string::npos;
}

/// The columns of dots that are not named.
class DotColumns {
 public:
  DotColumns(const CsvTable& table, const Model& model) : table_(table) {
    any_marker_ = !model.markers.empty();
    for (const Marker& marker : model.markers) of_markers_ = of_markers_ || names_dot(marker.name);
  }

  /// Is it one of them, where no marker is called like a dot?
  [[nodiscard]] bool take(std::size_t at) {
    const std::string& column = table_.columns[at];
    for (int axis = 0; axis < 3 && !of_markers_; ++axis) {
      const std::string end = std::string("_") + axis_names[axis] + "_mm";
      if (!column.ends_with(end) || !names_dot(column.substr(0, column.size() - end.size()))) continue;
      if (!any_marker_)
        table_.fail_header("column " + excerpt(column) + ": dots are matched to the scene's markers, and it has none");
      add(column.substr(0, column.size() - end.size()), axis, at);
      return true;
    }
    return false;
  }

  [[nodiscard]] bool any() const { return !names_.empty(); }

  [[nodiscard]] UnnamedDots dots() const {
    UnnamedDots dots;
    for (int axis = 0; axis < 3; ++axis)
      if (std::any_of(at_.begin(), at_.end(), [&](const auto& dot) { return dot[axis].has_value(); }))
        dots.axes.push_back(axis);
    dots.names = names_;
    dots.places.resize(table_.rows.size(), names_.size() * dots.axes.size());
    Index c = 0;
    for (std::size_t d = 0; d < names_.size(); ++d) {
      for (const int axis : dots.axes) {
        if (!at_[d][axis])
          table_.fail_header("column '" + name_of(d, axis) + "' is missing: all dots have the same coordinates");
        for (std::size_t row = 0; row < table_.rows.size(); ++row)
          dots.places(row, c) = table_.rows[row][*at_[d][axis]];
        ++c;
      }
      check(d, dots);
    }
    return dots;
  }

 private:
  void add(const std::string& name, int axis, std::size_t at) {
    const auto known = std::find(names_.begin(), names_.end(), name);
    const std::size_t d = known - names_.begin();
    if (known == names_.end()) {
      names_.push_back(name);
      at_.emplace_back();
    }
    at_[d][axis] = at;
  }

  [[nodiscard]] std::string name_of(std::size_t dot, int axis) const {
    return names_[dot] + "_" + axis_names[axis] + "_mm";
  }

  /// A dot is seen whole or not at all.
  void check(std::size_t dot, const UnnamedDots& dots) const {
    for (std::size_t row = 0; row < table_.rows.size(); ++row) {
      const auto empty = [&](int axis) { return std::isnan(table_.rows[row][*at_[dot][axis]]); };
      const auto gap = std::find_if(dots.axes.begin(), dots.axes.end(), empty);
      if (gap != dots.axes.end() && !std::all_of(dots.axes.begin(), dots.axes.end(), empty))
        table_.fail(row, "column '" + name_of(dot, *gap) + "' is empty: a dot is seen whole or not at all");
    }
  }

  const CsvTable& table_;
  bool any_marker_ = false, of_markers_ = false;
  std::vector<std::string> names_;
  std::vector<std::array<std::optional<std::size_t>, 3>> at_;  // column of the table, per dot and axis
};

class Columns {
 public:
  /// seen  may it have what a camera saw without names: dots, and the numbers of pictures?
  Columns(const CsvTable& table, const Model& model, bool seen = false)
      : table_(table), model_(model), dots_(table, model) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (seen && dots_.take(c)) continue;
      if (seen && table.columns[c] == picture_column && !actuator_of_column(model, table.columns[c])) {
        picture_ = c;
        continue;
      }
      if (const auto read = reading(table.columns[c])) {
        readings_.push_back(*read);
        at_.push_back(c);
      } else {
        commands_.push_back(c);
      }
    }
    if (readings_.empty() && !dots_.any() && !picture_)
      table.fail_header(
          "no column is a reading: a coordinate such as tip_x_mm, a pressure or volume such as air_pressure_kPa or "
          "air_volume_mm3, a tension or length such as tendon_tension_N or tendon_length_mm, a support's force such as "
          "base_force_x_N, a sensor's length, angle or direction such as strain_length_mm, bend_angle_deg or "
          "imu_direction_x");
  }

  [[nodiscard]] MeasuredPoses poses() const {
    MeasuredPoses poses;
    poses.file = table_.file;
    poses.columns = readings_;
    poses.lines = table_.lines;
    add_commands(poses);
    poses.values.resize(table_.rows.size(), at_.size());
    for (std::size_t row = 0; row < table_.rows.size(); ++row)
      for (std::size_t c = 0; c < at_.size(); ++c) poses.values(row, c) = table_.rows[row][at_[c]];
    poses.dots = dots_.dots();
    const auto any_read = [](const Eigen::MatrixXd& values) { return (values.array() == values.array()).any(); };
    if (picture_) add_pictures(poses);
    const bool any_picture =
        std::any_of(poses.pictures.begin(), poses.pictures.end(), [](Index number) { return number > 0; });
    if (!any_read(poses.values) && !any_read(poses.dots.places) && !any_picture)
      table_.fail_header("every reading is missing");
    return poses;
  }

  [[nodiscard]] std::vector<PoseColumn> readings_alone() const {
    for (const std::size_t c : commands_)
      table_.fail_header("column " + excerpt(table_.columns[c]) + " is no reading" +
                         (actuator_of_column(model_, table_.columns[c]) ? ", but a command" : ""));
    return readings_;
  }

 private:
  void add_commands(MeasuredPoses& poses) const {
    for (const std::size_t c : commands_)
      if (const auto a = actuator_of_column(model_, table_.columns[c])) poses.commanded.push_back(*a);
    if (commands_.empty()) return poses.commands.resize(table_.rows.size(), model_.rest_actuation());
    if (poses.commanded.empty() && commands_.size() == 1 && table_.columns[commands_[0]] == time_column) {
      poses.commands.resize(table_.rows.size(), model_.rest_actuation());
      for (std::size_t row = 0; row < table_.rows.size(); ++row) {
        poses.times.push_back(table_.rows[row][commands_[0]]);
        if (!std::isfinite(poses.times[row]) || (row > 0 && !(poses.times[row] > poses.times[row - 1])))
          table_.fail(row, std::string(time_column) + " must increase from row to row");
      }
      return;
    }
    for (const ActuationStep& step : actuation_steps(model_, commands(), Settings(model_.actuators.size()))) {
      poses.commands.push_back(step.actuation);
      if (step.time) poses.times.push_back(*step.time);
    }
  }

  void add_pictures(MeasuredPoses& poses) const {
    for (std::size_t row = 0; row < table_.rows.size(); ++row) {
      const double number = table_.rows[row][*picture_];
      if (!std::isnan(number) && !(number >= 1 && number <= max_pictures && number == std::floor(number)))
        table_.fail(row, std::string("column '") + picture_column + "': expected the number of a picture, 1 or more");
      poses.pictures.push_back(std::isnan(number) ? 0 : static_cast<Index>(number));
    }
  }

  /// A table of the commands alone.
  [[nodiscard]] CsvTable commands() const {
    CsvTable some = table_;
    some.columns.clear();
    for (auto& row : some.rows) row.clear();
    for (const std::size_t c : commands_) {
      some.columns.push_back(table_.columns[c]);
      for (std::size_t row = 0; row < table_.rows.size(); ++row) {
        if (std::isnan(table_.rows[row][c]))
          table_.fail(row, "column " + excerpt(table_.columns[c]) + ": a command is missing");
        some.rows[row].push_back(table_.rows[row][c]);
      }
    }
    return some;
  }

  [[nodiscard]] std::optional<PoseColumn> reading(const std::string& column) const {
    constexpr const char* axes[3] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const std::string end = std::string(axes[axis]) + "_mm";
      if (column == end && model_.markers.size() == 1) return PoseColumn{column, 0, axis};
      if (!column.ends_with("_" + end)) continue;
      const std::string name = column.substr(0, column.size() - end.size() - 1);
      for (std::size_t m = 0; m < model_.markers.size(); ++m)
        if (model_.markers[m].name == name) return PoseColumn{column, static_cast<Index>(m), axis};
      std::vector<std::string> names;
      for (const Marker& marker : model_.markers) names.push_back(marker.name);
      table_.fail_header("column " + excerpt(column) + ": no marker " + excerpt(name) +
                         (names.empty() ? "; the scene has none" : suggest_name(name, names)));
    }
    for (std::size_t a = 0; a < model_.actuators.size(); ++a)
      if (const auto read = reading_of(column, a)) return read;
    for (std::size_t s = 0; s < model_.sensors.size(); ++s) {
      const Sensor& sensor = *model_.sensors[s];
      for (int axis = 0; sensor.kind == SensorKind::direction && axis < 3; ++axis)
        if (column == sensor.name + "_direction_" + axes[axis])
          return PoseColumn{column, -1, axis, -1, Reading::direction, -1, static_cast<Index>(s)};
      const bool length = sensor.kind == SensorKind::length;
      if (sensor.kind == SensorKind::direction || column != sensor.name + (length ? "_length_mm" : "_angle_deg"))
        continue;
      return PoseColumn{column, -1, -1, -1, length ? Reading::length : Reading::angle, -1, static_cast<Index>(s)};
    }
    return force_of(column);
  }

  /// What a support exerts: base_force_x_N.
  [[nodiscard]] std::optional<PoseColumn> force_of(const std::string& column) const {
    for (std::size_t s = 0; s < model_.held.supports.size(); ++s)
      for (int axis = 0; axis < 3; ++axis)
        if (column == model_.held.supports[s].name + "_force_" + "xyz"[axis] + "_N")
          return PoseColumn{column, -1, axis, -1, Reading::force, static_cast<Index>(s)};
    return std::nullopt;
  }

  /// With what an actuator answers: a load, or where that is commanded a length or volume.
  [[nodiscard]] std::optional<PoseColumn> reading_of(const std::string& column, Index a) const {
    const Actuator& actuator = model_.actuators[a];
    const bool cable = actuator.is<CableDrive>();
    if (!cable && !actuator.is<ChamberDrive>()) return std::nullopt;
    const bool load = column == actuator.name + (cable ? "_tension_N" : "_pressure_kPa");
    if (!load && column != actuator.name + (cable ? "_length_mm" : "_volume_mm3")) return std::nullopt;
    if (actuator.control == (load ? Control::load : Control::ratio))
      table_.fail_header("column " + excerpt(column) + ": " + actuator.name +
                         " is commanded by that, so it is no reading; its command is column '" +
                         command_column(actuator) + "'");
    const Reading kind =
        load ? (cable ? Reading::tension : Reading::pressure) : (cable ? Reading::length : Reading::volume);
    return PoseColumn{column, -1, -1, a, kind};
  }

  const CsvTable& table_;
  const Model& model_;
  DotColumns dots_;
  std::vector<PoseColumn> readings_;
  std::vector<std::size_t> at_, commands_;
  std::optional<std::size_t> picture_;
};

}  // namespace

std::vector<PoseColumn> reading_columns(const Model& model, const std::vector<std::string>& names) {
  CsvTable table;
  table.file = "readings";
  table.columns = names;
  return Columns(table, model).readings_alone();
}

std::vector<PoseColumn> possible_readings(const Model& model) {
  std::vector<std::string> names;
  const auto along_axes = [&](const std::string& begin, const std::string& end) {
    for (const char* axis : axis_names) names.push_back(begin + axis + end);
  };
  for (const Marker& marker : model.markers) along_axes(marker.name + "_", "_mm");
  for (const Actuator& actuator : model.actuators) {
    const bool air = actuator.is<ChamberDrive>();
    if (!air && !actuator.is<CableDrive>()) continue;
    if (actuator.control != Control::load) names.push_back(actuator.name + (air ? "_pressure_kPa" : "_tension_N"));
    if (actuator.control != Control::ratio) names.push_back(actuator.name + (air ? "_volume_mm3" : "_length_mm"));
  }
  for (const auto& sensor : model.sensors)
    if (sensor->kind == SensorKind::direction)
      along_axes(sensor->name + "_direction_", "");
    else
      names.push_back(sensor->name + (sensor->kind == SensorKind::length ? "_length_mm" : "_angle_deg"));
  for (const Support& support : model.held.supports) along_axes(support.name + "_force_", "_N");
  return reading_columns(model, names);
}

MeasuredPoses read_measured_poses(const std::filesystem::path& file, const Model& model, bool seen) {
  const CsvTable table = read_csv_with_gaps(file);
  return Columns(table, model, seen).poses();
}

}  // namespace softkin
