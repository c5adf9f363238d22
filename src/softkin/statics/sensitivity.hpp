#pragma once

#include <Eigen/Core>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin {

/// How an equilibrium changes with its actuation, to first order. A unit of command is 1 (a ratio), 1 N or 1 kPa.
struct Sensitivity {
  std::vector<Points> positions;  // per actuator, #V by 3 [mm per unit of its command]
  Eigen::MatrixXd multipliers;    // m x m: of tension [N] or pressure [kPa] i by command j [per unit of its command]
  bool regular = false;           // false: at a limit of existence or a branch; then all values are zero
};

/// Zeros, not regular.
[[nodiscard]] inline Sensitivity no_sensitivity(Index vertices, Index actuators) {
  return {std::vector<Points>(static_cast<std::size_t>(actuators), Points::Zero(vertices, 3)),
          Eigen::MatrixXd::Zero(actuators, actuators), false};
}

}  // namespace softkin
