#pragma once

#include <softkin/calibration/robot_report.hpp>
#include <utility>

// Declarations for the .cpp files of a robot's report; no public header of the module includes this one.

namespace softkin::calibration {

[[nodiscard]] std::vector<Index> markers_of(const RobotFitReport& report);
[[nodiscard]] const std::string& marker_name(const RobotFitReport& report, Index marker);
[[nodiscard]] bool has_dots(const RobotFitReport& report);
[[nodiscard]] bool kept(const RobotFitReport& report, Index pose);

/// Where a marker was measured and is computed in a pose; coordinates that are not known are NaN.
[[nodiscard]] std::pair<Vec3, Vec3> places_of(const RobotFitReport& report, Index pose, Index marker);
/// Where a dot was seen; NaN: it was not.
[[nodiscard]] Vec3 dot_place(const RobotFitReport& report, Index pose, std::size_t dot);

}  // namespace softkin::calibration
