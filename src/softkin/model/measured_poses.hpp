#pragma once

#include <softkin/model/equilibrium.hpp>
#include <string>
#include <vector>

namespace softkin {

/// What a column of measured poses holds: a coordinate of a marker [mm], or the pressure [kPa] or tension [N] with
/// which an actuator answers.
struct PoseColumn {
  std::string name;     // as in the file
  Index marker = -1;    // of the model; -1: none
  int axis = -1;        // of it
  Index actuator = -1;  // of the model; -1: none
};

/// Poses of a real robot: what it was told, and what was read.
struct MeasuredPoses {
  std::string file;
  std::vector<PoseColumn> columns;
  std::vector<Actuation> commands;  // per pose, all in the model's order
  std::vector<std::size_t> lines;   // of the file, per pose
  Eigen::MatrixXd values;           // poses by columns; NaN: not read
};

}  // namespace softkin
