#pragma once

#include <softkin/calibration/path_comparison.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>

namespace softkin::calibration {

/// Tracks beside a reference.
struct PathReport {
  std::vector<Track> tracks;                // the first is the reference
  std::vector<PathComparison> comparisons;  // of each other track
  std::string parameter;                    // the column or actuator that is compared by; empty: time

  /// What each track is and how it is compared, a line each.
  [[nodiscard]] std::vector<std::string> heads() const;
  /// The reference's waypoints, and how far off each track is; long tables have twenty even rows.
  [[nodiscard]] Table waypoints() const;
  /// Largest, mean and root mean square distance.
  [[nodiscard]] Table summary() const;
  /// Every waypoint with its error, for CSV.
  [[nodiscard]] Table errors() const;
  [[nodiscard]] std::string json() const;
  [[nodiscard]] Plot plot() const;
};

/// by     "waypoint", "arc", "time", a column or actuator; empty: natural_resampling
/// align  tracks that are not in the scene's frame already, as compare_paths does
/// throws  InvalidInput as compare_paths does
[[nodiscard]] PathReport path_report(std::vector<Track> tracks, const std::string& by, bool align);

}  // namespace softkin::calibration
