#pragma once

#include <optional>
#include <softkin/core/types.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin {

/// One row of a file of commands.
struct CommandRow {
  Eigen::VectorXd actuation;  // per actuator of the model, as it is commanded: ratio [-], tension [N], pressure [kPa]
  Eigen::VectorXd pressures_kpa;  // per actuator; of chambers that are commanded by volume, where known
  std::optional<double> time_s;   // [s]; none: the file has no times
  std::size_t line = 0;           // of the file, from 1
};

/// The commands of a robot: at least one row; either all rows have times, which increase, or none has.
struct Commands {
  std::string file;                  // for messages
  std::vector<bool> commanded;       // per actuator: has it a column
  std::vector<bool> pressure_known;  // per actuator: do pressures_kpa hold it
  std::vector<CommandRow> rows;      // in the order of the file
};

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
  std::vector<Waypoint> waypoints;        // in the order in which they are visited
};

}  // namespace softkin
