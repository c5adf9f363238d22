#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// Where the markers of a path are to be at one moment.
struct Waypoint {
  std::vector<Vec3> targets;   // of each marker of the path [mm]; 0 along axes that do not count
  std::optional<double> time;  // [s]; all waypoints of a path have one, or none
  std::size_t line = 0;        // of the file; 0: not from a file
  bool inserted = false;       // between two that were given
};

/// Places that markers are to visit one after another.
struct MarkerPath {
  std::vector<Index> markers;             // of the model
  std::vector<std::array<bool, 3>> axes;  // of each marker: coordinates that count
  std::vector<Waypoint> waypoints;
};

}  // namespace softkin
