#pragma once

#include <softkin/core/types.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/model/measurements.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// Which points of two tracks belong together: those of the same row, of the same time (or other parameter), or of the
/// same fraction of the track's length.
enum class Resampling { waypoint, parameter, arc };

/// A waypoint of the reference and the other track's point that belongs to it, straight between its points.
struct WaypointError {
  std::size_t waypoint = 0;  // of the reference, from 0
  double place = 0;          // row, parameter or fraction of the length
  Vec3 reference, other;     // [mm]; other after the alignment; 0 along axes that are not compared
  double error_mm = 0;       // distance along the axes that both tracks have
};

struct PathComparison {
  Resampling by = Resampling::waypoint;
  std::array<bool, 3> axes{true, true, true};  // compared
  std::vector<WaypointError> waypoints;
  std::size_t left_out = 0;  // waypoints of the reference outside the other track's parameter
  double largest_mm = 0, mean_mm = 0, rms_mm = 0;
  std::size_t worst = 0;  // index into waypoints
  bool aligned = false;
  Mat3 rotation = Mat3::Identity();  // other = rotation * its points + translation
  Vec3 translation = Vec3::Zero();   // [mm]
  bool unique = true;                // false: the points lie on a line, so that other rotations fit as well
};

/// parameter where both tracks have one; else waypoint where they have as many points; else arc.
[[nodiscard]] Resampling natural_resampling(const Track& reference, const Track& other);

/// Distance of a track from a reference, waypoint by waypoint of the reference.
///
/// align   first moves the other track rigidly onto the reference: the rotation (no reflection) and translation of
///         least squares over the waypoints; in the plane where two axes are compared
/// source  W. Kabsch, "A solution for the best rotation to relate two sets of vectors", Acta Cryst. A32, 1976
/// throws  InvalidInput naming the track: no axes in common, rows of another number (waypoint), no parameter or no
///         overlap (parameter), no length (arc)
[[nodiscard]] PathComparison compare_paths(const Track& reference, const Track& other, Resampling by, bool align);

/// Positions of a marker while one actuator moves and the others stay at their start.
struct SingleSweep {
  std::string name;              // for messages
  std::vector<double> commands;  // of the actuator that moves; the first one is its start
  std::vector<Vec3> points;      // [mm]
};

/// Sum of the displacements that single actuators would cause, the analytic baseline of the paper's Fig. 15d: start +
/// sum over the sweeps of (point at the command - start), straight between a sweep's points.
///
/// commands  per sweep
/// source    Fang et al. 2020, Section V-C: "simply combining the prediction results of individual chambers"
/// throws    InvalidInput naming the sweep: a command outside it, a start at another place than that of the first
[[nodiscard]] Vec3 superposed(const std::vector<SingleSweep>& sweeps, const std::vector<double>& commands);

/// Tracks compared with a reference.
struct PathReport {
  std::vector<Track> tracks;                // the first is the reference
  std::vector<PathComparison> comparisons;  // of each other track
  std::string parameter;                    // the column or actuator that is compared by; empty: time

  /// Of tables and legends: the names of the files, with the markers that were chosen of them.
  [[nodiscard]] std::vector<std::string> labels() const;
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
