#pragma once

#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/shapes.hpp>
#include <string>
#include <variant>
#include <vector>

namespace softkin {

/// Shapes of what stands in a robot's way; a surface need not be closed.
using ObstacleShape = std::variant<Box, Sphere, Cylinder, Capsule, Halfspace, TriangleSurface>;

/// Something rigid that does not move.
struct ObstacleSpec {
  std::string name;
  ObstacleShape shape;
  std::optional<double> friction;  // Coulomb's coefficient with everything [-], >= 0; none: ContactSpec's
  Origin origin;
};

/// Overrides the friction of two: obstacles, regions of the robot, or "robot", what is in no region named so.
struct ContactPairSpec {
  std::string a, b;
  double friction = 0;  // [-], >= 0
  Origin origin;
};

/// What may touch the robot, itself included; physical.
struct ContactSpec {
  std::optional<double> distance_mm;  // > 0; none: 5e-4 of the robot's diagonal
  double friction = 0;                // Coulomb's coefficient [-], >= 0
  bool self = true;                   // may the robot touch itself
  std::vector<ContactPairSpec> pairs;
  std::vector<ObstacleSpec> obstacles;
  Origin origin;
};

}  // namespace softkin
