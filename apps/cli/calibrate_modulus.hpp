#pragma once

#include <filesystem>
#include <softkin/model/robot_spec.hpp>
#include <string>
#include <vector>

#include "calibrate_curve.hpp"

namespace softkin::cli {

/// What the physical formulation says of a measured curve.
struct ModulusReport {
  std::string text;
  Json json;
  bool complete = true;  // every ratio has an equilibrium
};

/// Pressures predicted by a scene's physical formulation beside those of a measured curve, and the factor of Young's
/// modulus that fits them best. Other chambers are open.
///
/// spec    of the scene; changed to the physical formulation with this chamber's volume controlled
/// throws  InvalidInput as compile() does, where the scene has no elastic constants
[[nodiscard]] ModulusReport compare_with_physics(RobotSpec spec, const std::string& actuator,
                                                 const ActuatorCurve& curve, int threads);

}  // namespace softkin::cli
