#pragma once

#include <softkin/core/progress.hpp>
#include <string>
#include <vector>

#include "columns.hpp"
#include "follow_waypoint.hpp"
#include "terminal.hpp"

namespace softkin::cli {

/// The waypoints on the terminal, a row each as they come.
class FollowTable {
 public:
  FollowTable(const Model& model, const MarkerPath& path);

  [[nodiscard]] std::string header() const;
  [[nodiscard]] std::string row(std::size_t waypoint, const DoneWaypoint& done) const;

 private:
  Columns columns_;
};

/// Waypoints done, time and time left, on the terminal.
class FollowProgress {
 public:
  FollowProgress(std::size_t first, std::size_t waypoints);

  void show(std::size_t waypoint, const Progress& progress);
  void clear() { line_.clear(); }

 private:
  ProgressLine line_;
  std::size_t first_, waypoints_;
  double start_;  // [s]
};

/// "55 waypoints, 55 reached to 0.001 mm: error at most 3.2e-04 mm, ...".
[[nodiscard]] std::string summary_of(const std::vector<DoneWaypoint>& done, double tolerance_mm);

/// Which waypoints were not reached, and by how much at worst; empty where all were.
[[nodiscard]] std::string missed_text(const std::vector<DoneWaypoint>& done);

}  // namespace softkin::cli
