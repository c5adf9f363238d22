#pragma once

#include <optional>
#include <softkin/model/measurements.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// Axes of the robot that the two coordinates of a flat track are, and their signs: "xz", "x-z", "-yz".
struct TrackPlane {
  Index axes[2] = {0, 1};
  double signs[2] = {1, 1};
};

/// throws  InvalidInput where text names no two different axes
[[nodiscard]] TrackPlane parse_plane(const std::string& text);

/// Which paths are compared, and by what. An empty text: not given.
struct PathRequest {
  std::vector<std::string> files;  // reports and tables, the first is the reference; "F.csv@marker"
  std::vector<std::string> sum;  // reports in which one actuator moves each, superposed for the first report's commands
  std::string marker;            // where a file does not name one
  std::string by;                // "time", "waypoint", "arc", or a column or actuator that ascends
  std::optional<TrackPlane> plane;
  std::optional<double> start;  // of the first file's clock, in that of the tables after it [s]

  /// By a column or an actuator?
  [[nodiscard]] bool by_name() const { return !by.empty() && by != "waypoint" && by != "time" && by != "arc"; }
};

/// The tracks of the files, then that of the sum. Throws InvalidInput.
[[nodiscard]] std::vector<Track> read_tracks(const PathRequest& request);

}  // namespace softkin::calibration
