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

/// The shape of an obstacle or body; the surface of an obstacle need not be closed.
using ObstacleShape = std::variant<Box, Sphere, Cylinder, Capsule, Halfspace, TriangleSurface>;

/// A rigid obstacle that stays in place, or moves as commanded.
struct ObstacleSpec {
  std::string name;                // for messages, reports and commands
  ObstacleShape shape;             // where it is and what it looks like [mm]
  std::optional<double> friction;  // Coulomb's coefficient with everything [-], >= 0; none: ContactSpec's
  Origin origin;                   // of its entry, for messages
  std::array<bool, 3> motion{false, false, false};  // axes along which it moves, each by a command
};

/// A rigid body that moves freely: it is held in place until a command releases it.
struct BodySpec {
  std::string name;                // for messages, reports and commands
  ObstacleShape shape;             // bounded; a surface is closed
  std::optional<double> friction;  // Coulomb's coefficient [-], >= 0; none: that of the other surface
  Origin origin;                   // of its entry, for messages
  double density = 0;              // [kg/m^3], >= 0
};

/// Overrides the friction of two parts: obstacles, bodies, regions of the robot, or "robot", everything of it in no
/// region that a pair names.
struct ContactPairSpec {
  std::string a, b;     // names, or "robot"
  double friction = 0;  // [-], >= 0
  Origin origin;        // of its entry, for messages
};

/// The surfaces with which the robot can be in contact, its own included; physical.
struct ContactSpec {
  std::optional<double> distance_mm;    // > 0; none: 5e-4 of the robot's diagonal
  double friction = 0;                  // Coulomb's coefficient [-], >= 0
  bool self = true;                     // can the robot be in contact with itself
  std::vector<ContactPairSpec> pairs;   // those that override friction
  std::vector<ObstacleSpec> obstacles;  // which stay or are moved by commands
  std::vector<BodySpec> bodies;         // which move freely
  Origin origin;                        // of the entry, for messages
};

}  // namespace softkin
