#pragma once

#include <softkin/model/measured_poses.hpp>
#include <softkin/model/sensor.hpp>

#include "statics/physical_samples.hpp"

namespace softkin::testing {

/// A finger of 60 mm that can be touched anywhere on its back, with four markers and what else can be read.
inline RobotSpec touched_finger() {
  RobotSpec spec = bending_finger();
  spec.actuators[0] = by_load(spec.actuators[0]);
  spec.loads.forces = {
      {"touch", {std::string("z_high"), {}}, {0, 0, 0}, std::array<Vec3, 2>{Vec3(-1, -1, -1), Vec3(1, 1, 1)}}};
  spec.markers = {{"a", {Vec3(20, 1, 15), {}}},
                  {"b", {Vec3(35, 11, 15), {}}},
                  {"c", {Vec3(50, 1, 15), {}}},
                  {"d", {Vec3(59, 11, 2), {}}}};
  SensorSpec strain{.name = "strain", .kind = SensorKind::length, .points = {{5, 6, 1}, {30, 6, 1}, {55, 6, 1}}};
  add_volume_region(spec.mesh, "first", [](const Vec3& p) { return p.x() < 15; });
  add_volume_region(spec.mesh, "last", [](const Vec3& p) { return p.x() > 45; });
  SensorSpec bend{
      .name = "bend", .kind = SensorKind::angle, .points = {}, .sections = {"first", "last"}, .axis = Vec3(0, 1, 0)};
  spec.sensors = {std::make_shared<const SensorSpec>(strain), std::make_shared<const SensorSpec>(bend)};
  return spec;
}

inline std::vector<PoseColumn> marker_columns(const Model& model) {
  std::vector<PoseColumn> columns;
  for (Index m = 0; m < std::ssize(model.markers); ++m)
    for (int axis = 0; axis < 3; ++axis)
      columns.push_back({model.markers[m].name + "_" + "xyz"[axis] + "_mm", m, axis});
  return columns;
}

/// Returns columns for the markers, both sensors, the chamber's volume and the support's reaction.
inline std::vector<PoseColumn> all_columns(const Model& model) {
  std::vector<PoseColumn> columns = marker_columns(model);
  columns.push_back({"strain_length_mm", -1, -1, -1, Reading::length, -1, 0});
  columns.push_back({"bend_angle_deg", -1, -1, -1, Reading::angle, -1, 1});
  columns.push_back({"air_volume_mm3", -1, -1, 0, Reading::volume});
  for (int axis = 0; axis < 3; ++axis) columns.push_back({"base_force", -1, axis, -1, Reading::force, 0});
  return columns;
}

inline StaticsOptions exactly() {
  StaticsOptions options;
  options.step_tolerance_mm = 1e-9;
  return options;
}

inline Actuation commands_of(const Model& model, double pressure) {
  Actuation commands = model.rest_actuation();
  commands[0] = pressure;
  return commands;
}

/// Compares a column of derivatives with differences, to a fraction of the largest derivative of readings of the same
/// kind.
inline void expect_slopes(const std::vector<PoseColumn>& columns, const Eigen::MatrixXd& slopes, Index c,
                          const Eigen::VectorXd& difference, double fraction) {
  for (Index r = 0; r < std::ssize(difference); ++r) {
    double size = 0;
    for (Index other = 0; other < std::ssize(difference); ++other)
      if (columns[other].kind == columns[r].kind) size = std::max(size, slopes.row(other).cwiseAbs().maxCoeff());
    EXPECT_NEAR(slopes(r, c), difference[r], fraction * size) << "reading " << r << ", column " << c;
  }
}

}  // namespace softkin::testing
