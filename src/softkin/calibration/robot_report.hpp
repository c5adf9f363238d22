#pragma once

#include <softkin/calibration/robot_fit.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>

namespace softkin::calibration {

/// A robot, its poses, the fit and, where poses were kept aside, its prediction of these.
struct RobotFitReport {
  const NumberedRobot& robot;
  const MeasuredPoses& poses;
  const RobotFitOptions& options;
  const RobotFit& fit;
  const Model& model;
};

/// Numbers with their deviations, pairs that are inseparable, misfits by marker and pose, and changes of the scene.
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
