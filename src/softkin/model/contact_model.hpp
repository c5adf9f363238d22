#pragma once

#include <array>
#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <string>
#include <vector>

namespace softkin {

/// Of two that touch, which carries the potential between them: the vertices of the one that stands first here; both by
/// halves where they are alike.
enum class ContactRank { robot, body, obstacle };

/// A surface that may touch others, and itself.
struct ContactPart {
  std::string name;  // of the robot: "robot", or a region; of an obstacle or body its own
  ContactRank rank = ContactRank::robot;
  bool halfspace = false;  // all behind the plane of its only triangle is solid
  Origin origin;
};

/// What two parts do to each other.
struct ContactPair {
  bool touch = true;    // do they feel each other at all
  double friction = 0;  // Coulomb's coefficient [-]
};

/// Which surfaces of a robot and its surroundings may touch; physical.
struct ContactModel {
  double distance_mm = 0;  // below which surfaces repel each other; 0: nothing touches anything
  double modulus_MPa = 0;  // > 0: of that repulsion
  std::vector<ContactPart> parts;
  std::vector<ContactPair> pairs;               // of parts a, b and b, a alike, at a * #parts + b
  std::vector<std::array<Index, 3>> triangles;  // vertices of the model, normals outwards; faces of order 2 as four
  std::vector<EdgeWithNode> edges;              // of faces of order 2, by their nodes
  std::vector<Index> part_of;                   // per triangle
  std::vector<double> area;                     // per vertex of the model: for which it carries pressure [mm^2]
  Index obstacle_vertices = 0;                  // the last vertices of the model, none of the robot's

  [[nodiscard]] bool any() const { return distance_mm > 0; }
  [[nodiscard]] const ContactPair& pair(Index a, Index b) const {
    return pairs[static_cast<std::size_t>(a) * parts.size() + static_cast<std::size_t>(b)];
  }
};

}  // namespace softkin
