#pragma once

#include <softkin/calibration/report_parts.hpp>
#include <softkin/calibration/robot_report_parts.hpp>

// The part of a robot's report about outlines in pictures; no header of the module includes this one.

namespace softkin::calibration {

[[nodiscard]] bool has_outlines(const RobotFitReport& report);
/// Of the points of a pose that count, their root mean square [mm]; NaN: there is none.
[[nodiscard]] double outline_error(const RobotFitReport& report, std::size_t pose);
/// "38 of 40": how many points of a pose count; "-": it has none.
[[nodiscard]] std::string outline_counts(const RobotFitReport& report, std::size_t pose);

/// How far off they are, and what of them does not count; empty: there are none.
[[nodiscard]] std::string outlines_text(const RobotFitReport& report);
/// Of a pose.
[[nodiscard]] Json outline_json(const RobotFitReport& report, std::size_t pose);
/// Of all.
[[nodiscard]] Json outlines_json(const RobotFitReport& report);

/// A coordinate of a point as a row of the table.
struct OutlineRow {
  std::string name;
  double measured = 0, computed = 0;
  const OutlineReading* reading = nullptr;
};
[[nodiscard]] std::vector<OutlineRow> outline_rows(const RobotFitReport& report, std::size_t pose);
/// The table's cells of a point: how far it is off, and whether it counts.
[[nodiscard]] std::array<Cell, 2> outline_cells(const OutlineReading& reading);

/// Measured points of all poses and the computed outlines, seen along z; empty: there are none.
[[nodiscard]] std::vector<PlotSeries> outline_series(const RobotFitReport& report);

}  // namespace softkin::calibration
