#pragma once

#include <Eigen/Core>
#include <softkin/model/model.hpp>
#include <vector>

namespace softkin {

/// How an equilibrium changes with its actuation, to first order. A unit of command is 1 (a ratio), 1 N or 1 kPa.
struct Sensitivity {
  std::vector<Points> positions;  // per actuator, #V by 3 [mm per unit of its command]
  Eigen::MatrixXd multipliers;    // m x m: of tension [N] or pressure [kPa] i by command j [per unit of its command]
  bool regular = false;           // false: at a limit of existence or a branch; then all values are zero
};

/// A robot with one of its numbers a little larger and a little smaller: models that were compiled from descriptions
/// which differ in nothing else.
struct Perturbed {
  const Model& more;      // compiled with the number larger; must outlive its use
  const Model& less;      // and smaller
  double difference = 0;  // of the number between them, in its unit; not 0
};

/// How an equilibrium changes with numbers of the robot under the same commands, to first order.
struct ParameterSensitivity {
  std::vector<Points> positions;    // per number, #V by 3 [mm per unit of it]
  Eigen::MatrixXd multipliers;      // m by numbers: of tension [N] or pressure [kPa] of actuator i
  bool regular = false;             // false: at a limit of existence or a branch; then all values are zero
  std::vector<Points> reactions{};  // per number where requested, #V by 3: of the forces of supports [N per unit of it]
};

/// Gradient of a number that is reported of an equilibrium, by its shape and loads.
struct ShapeGradient {
  Points by_places;          // #V by 3 [per mm]; no rows: not at all
  Eigen::VectorXd by_loads;  // m: by tensions [per N] and pressures [per kPa]; no rows: not at all
};

/// Zeros, not regular.
[[nodiscard]] inline Sensitivity no_sensitivity(Index vertices, Index actuators) {
  return {std::vector<Points>(actuators, Points::Zero(vertices, 3)), Eigen::MatrixXd::Zero(actuators, actuators),
          false};
}

}  // namespace softkin
