#pragma once

#include <softkin/calibration/report_parts.hpp>
#include <softkin/calibration/robot_report_parts.hpp>

// The part of a robot's report about dots without names; no header of the module includes this one.

namespace softkin::calibration {

/// How many dots are markers, and which are none or may be another; empty: there are no such dots.
[[nodiscard]] std::string dots_text(const RobotFitReport& report);
/// Of a pose: each dot with its marker, and how sure that is.
[[nodiscard]] Json dots_json(const RobotFitReport& report, std::size_t pose);
/// How many there are.
[[nodiscard]] Json dot_counts_json(const RobotFitReport& report);

/// Which marker a dot is, and which it may be, as cells of the table.
[[nodiscard]] std::array<Cell, 2> dot_cells(const RobotFitReport& report, const DotMatch& match);

}  // namespace softkin::calibration
