#pragma once

#include <softkin/calibration/robot_fit.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>

namespace softkin::calibration {

/// A robot, its poses, what was fitted and, where poses were kept aside, how well it foretells these.
struct RobotFitReport {
  const NumberedRobot& robot;
  const MeasuredPoses& poses;
  const RobotFitOptions& options;
  const RobotFit& fit;
  const Model& model;
};

/// Numbers with their deviations, what cannot be told apart, misfits by marker and pose, and what the scene takes.
[[nodiscard]] std::string robot_fit_text(const RobotFitReport& report);
[[nodiscard]] std::string robot_fit_json(const RobotFitReport& report);
/// A row for each reading: measured, computed, and their difference.
[[nodiscard]] Table robot_fit_table(const RobotFitReport& report);
/// Measured and computed places of the markers, seen along each axis.
[[nodiscard]] Plot robot_fit_plot(const RobotFitReport& report);

/// Lets numbers begin where those of an earlier report ended; those with a prior stay as they are.
///
/// throws  InvalidInput naming the file: it is no such report, or of other numbers
void begin_where_fit_ended(const std::string& file, std::vector<FittedNumber>& numbers);

}  // namespace softkin::calibration
