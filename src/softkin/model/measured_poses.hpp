#pragma once

#include <array>
#include <softkin/model/equilibrium.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A kind of reading, and its unit: coordinates of markers; pressures and tensions of actuators; lengths of cables and
/// volumes of chambers whose loads are commanded; reactions of supports on the robot; lengths of curves on the body,
/// angles between its sections and the components of directions of these, as sensors measure them.
enum class Reading { coordinate, pressure, tension, length, volume, force, angle, direction };
/// The number of kinds, and the name and unit of each, by Reading; "": none.
constexpr int readings = 8;
constexpr std::array<const char*, readings> reading_names{"coordinate", "pressure", "tension", "length",
                                                          "volume",     "force",    "angle",   "direction"};
constexpr std::array<const char*, readings> reading_units{"mm", "kPa", "N", "mm", "mm^3", "N", "deg", ""};
/// Returns " in mm"; "" for a reading without unit.
[[nodiscard]] inline std::string in_unit(Reading kind) {
  const char* unit = reading_units[static_cast<std::size_t>(kind)];
  return *unit == 0 ? "" : std::string(" in ") + unit;
}

/// The meaning of a column of measured poses.
struct PoseColumn {
  std::string name;                    // as in the file
  Index marker = -1;                   // of the model; -1: none
  int axis = -1;                       // of it, of the support's force or of a direction
  Index actuator = -1;                 // of the model; -1: none
  Reading kind = Reading::coordinate;  // and with it the unit
  Index support = -1;                  // of the model; -1: none
  Index sensor = -1;                   // the same
};

/// Points that a camera detected, without a marker assigned to each.
struct UnnamedDots {
  std::vector<std::string> names{};  // as in the file: dot1
  std::vector<int> axes{};           // measured for each of them, ascending
  Eigen::MatrixXd places{};          // [mm], poses by the axes of the first dot, of the second, ...; NaN: not measured
};

/// The outer outline of a robot in a camera's view along z of the measuring frame.
struct PictureOutlines {
  std::string file{};                                  // empty: there are none
  std::vector<std::vector<Eigen::Vector2d>> points{};  // per pose: x and y one after another along it [mm]; empty: none
};

/// Measured poses of a real robot: its commands and readings.
struct MeasuredPoses {
  std::string file;                 // for messages
  std::vector<PoseColumn> columns;  // readings, as they stand in the file
  std::vector<Actuation> commands;  // per pose, all in the model's order
  std::vector<Index> commanded{};   // actuators that the file has commands of
  std::vector<double> times{};      // per pose [s], ascending; empty: the file has none
  std::vector<std::size_t> lines;   // of the file, per pose
  Eigen::MatrixXd values;           // poses by columns; NaN: not read
  UnnamedDots dots{};               // that have no name; none: no columns
  std::vector<Index> pictures{};    // per pose: the number of the one that shows it, 0: none; empty: no such column
  PictureOutlines outlines{};       // none: not given
};

}  // namespace softkin
