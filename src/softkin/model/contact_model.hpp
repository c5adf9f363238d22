#pragma once

#include <algorithm>
#include <array>
#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <vector>

namespace softkin {

/// The name of the part that contains everything of the robots but the regions that a pair names.
inline constexpr const char* robot_part_name = "robot";

/// The rank determines which of two parts in contact carries the contact potential: the vertices of the part that comes
/// first here; each carries half of it where the ranks are equal.
enum class ContactRank { robot, body, obstacle };

/// A surface that may touch others, and itself.
struct ContactPart {
  std::string name;  // of the robot: "robot", of several its own, or a region; of an obstacle or body its own
  ContactRank rank = ContactRank::robot;  // to what it belongs
  Index robot = -1;                       // which of the robots it is of, 0 where there is one; -1: an obstacle or body
  bool halfspace = false;                 // all behind the plane of its only triangle is solid
  Origin origin;                          // of the entry that describes it, for messages
};

/// The contact properties of two parts.
struct ContactPair {
  bool touch = true;    // can they be in contact
  double friction = 0;  // Coulomb's coefficient [-]
};

/// Which surfaces of a robot and its surroundings may touch; physical.
struct ContactModel {
  double distance_mm = 0;                       // below which surfaces repel each other; 0: no contact
  double modulus_MPa = 0;                       // > 0: of that repulsion
  std::vector<ContactPart> parts;               // the robots; their regions; bodies and obstacles
  std::vector<ContactPair> pairs;               // of parts a, b and b, a alike, at a * #parts + b
  std::vector<std::array<Index, 3>> triangles;  // vertices of the model, normals outwards; faces of order 2 as four
  std::vector<EdgeWithNode> edges;              // of faces of order 2, by their nodes
  std::vector<Index> part_of;                   // per triangle
  std::array<Index, 2> sheets{0, 0};            // triangles from, to before: solid on neither side
  std::vector<double> area;                     // per vertex of the model: for which it carries pressure [mm^2]
  Index other_vertices = 0;                     // the last vertices of the model: of bodies and obstacles

  [[nodiscard]] bool any() const { return distance_mm > 0; }  // can there be any contact
  /// Is a triangle of a sheet, solid on neither side?
  [[nodiscard]] bool sheet(Index triangle) const { return triangle >= sheets[0] && triangle < sheets[1]; }
  /// Returns the contact properties of two parts, in either order.
  [[nodiscard]] const ContactPair& pair(Index a, Index b) const {
    return pairs[static_cast<std::size_t>(a) * parts.size() + static_cast<std::size_t>(b)];
  }
  /// Has any pair of parts friction?
  [[nodiscard]] bool has_friction() const {
    return std::any_of(pairs.begin(), pairs.end(),
                       [](const ContactPair& pair) { return pair.touch && pair.friction > 0; });
  }
  /// "the robot", "robot 'left'", "region 'skin'", "body 'pen'", "obstacle 'floor'"
  [[nodiscard]] std::string label(Index part) const;
  /// Returns the label of the whole robot to which the region belongs.
  [[nodiscard]] std::string label_of_solid(Index part) const;
};

}  // namespace softkin
