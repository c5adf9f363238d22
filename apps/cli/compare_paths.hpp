#pragma once

#include <optional>
#include <softkin/calibration/path_comparison.hpp>
#include <string>
#include <vector>

#include <softkin/io/output_files.hpp>

namespace softkin::cli {

/// What the user asks of `softkin compare` where it compares paths. An empty text: not given.
struct PathCompareOptions {
  std::vector<std::string> files;  // the first is the reference; "F.csv@marker"
  std::vector<std::string> sum;    // reports of single actuators
  std::string marker, by, plane, output, plot;
  std::optional<double> start;  // of the first file's clock, in that of the tables after it [s]
  bool align = false, json = false;

  [[nodiscard]] std::vector<Output> outputs() const;
  /// The files themselves, without markers.
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const;
};

/// Axes of the robot that the two coordinates of a plane's tracks are, and their signs: "xz", "x-z", "-yz".
struct Plane {
  Index axes[2] = {0, 1};
  double signs[2] = {1, 1};
};

/// Throws InvalidInput where text names no two different axes.
[[nodiscard]] Plane parse_plane(const std::string& text);

/// The tracks of the files, then that of the sum. Throws InvalidInput.
[[nodiscard]] std::vector<Track> tracks_of(const PathCompareOptions& options);

[[nodiscard]] int compare_tracks(const PathCompareOptions& options);

}  // namespace softkin::cli
