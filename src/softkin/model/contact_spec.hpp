#pragma once

#include <array>
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

/// Something rigid that stays, or moves as commanded.
struct ObstacleSpec {
  std::string name;                // for messages, reports and commands
  ObstacleShape shape;             // where it is and what it looks like [mm]
  std::optional<double> friction;  // Coulomb's coefficient with everything [-], >= 0; none: ContactSpec's
  Origin origin;                   // of its entry, for messages
  std::array<bool, 3> motion{false, false, false};  // axes along which it moves, each by a command
};

/// Something rigid that moves freely: it is held where it is until a command releases it.
struct BodySpec {
  std::string name;                // for messages, reports and commands
  ObstacleShape shape;             // bounded; a surface is closed
  std::optional<double> friction;  // Coulomb's coefficient [-], >= 0; none: that of what it touches
  Origin origin;                   // of its entry, for messages
  double density = 0;              // [kg/m^3], >= 0
};

/// Overrides the friction of two: obstacles, bodies, regions of the robot, or "robot", what is in no region named so.
struct ContactPairSpec {
  std::string a, b;     // names, or "robot"
  double friction = 0;  // [-], >= 0
  Origin origin;        // of its entry, for messages
};

/// What may touch the robot, itself included; physical.
struct ContactSpec {
  std::optional<double> distance_mm;    // > 0; none: 5e-4 of the robot's diagonal
  double friction = 0;                  // Coulomb's coefficient [-], >= 0
  bool self = true;                     // may the robot touch itself
  std::vector<ContactPairSpec> pairs;   // those that override friction
  std::vector<ObstacleSpec> obstacles;  // what stays or is moved by commands
  std::vector<BodySpec> bodies;         // what moves freely
  Origin origin;                        // of the entry, for messages
};

}  // namespace softkin
