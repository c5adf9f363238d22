#pragma once

#include <array>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// The way of one marker: measured, predicted, or computed elsewhere.
struct Track {
  std::string name;                            // for messages: its file
  std::vector<Vec3> points;                    // [mm]; 0 along axes that are not known
  std::array<bool, 3> axes{true, true, true};  // coordinates that are known
  std::vector<double> parameter;               // time [s], or what else ascends along it; empty: none
  bool robot_frame = false;                    // coordinates are those of the scene, as a prediction has them
};

}  // namespace softkin
