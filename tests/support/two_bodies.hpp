#pragma once

#include <softkin/model/robot_spec.hpp>

namespace softkin::testing {

/// A body of tetrahedra [mm], of which some vertices are held.
struct PressedBody {
  Points vertices;
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Index> held;
};

/// Two bodies as one robot of the physical formulation: neo-Hookean, E 0.1 MPa, nu 0.4. Vertices of the lower one come
/// first; it stands on its support "bottom", and the support "top" moves the upper one by a displacement [mm].
[[nodiscard]] RobotSpec two_bodies(const std::string& name, const PressedBody& lower, const PressedBody& upper,
                                   const Vec3& displacement);

/// Positions of which the rows from a vertex on are moved.
[[nodiscard]] Points moved_from(Index first, const Points& positions, const Vec3& move);

}  // namespace softkin::testing
