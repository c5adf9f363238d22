#pragma once

#include <cstdint>
#include <softkin/model/robot_spec.hpp>

namespace softkin::testing {

/// Two small bodies that are pressed onto each other.
struct Drop {
  RobotSpec robot;             // every fourth of order 2
  Index upper = 0;             // the first vertex of the upper body
  double size_mm = 0;          // height of the upper body
  double gap_mm = 0;           // by which it would have to fall to touch the lower one, 0.02 to 0.5 of its size
  Vec3 displacement{0, 0, 0};  // of its top: down by 0.2 to 0.8 of its size; in every other, sideways by up to half
};

/// A drop from a seed, the same everywhere but for rounding: two bodies of 5 to 24 tetrahedra, each a cube, a
/// tetrahedron or an octahedron of random size, sheared, with every vertex moved and turned anyhow, the upper one a
/// little aside. Held are the vertices in the fifth of each that is farthest from the other, and more of the farthest
/// until they span a plane. At rest the bodies are apart; displaced, there are 0.3 of the upper one's size between what
/// is held of each.
[[nodiscard]] Drop random_drop(std::uint64_t seed);

}  // namespace softkin::testing
