#pragma once

#include <optional>
#include <softkin/model/model.hpp>

namespace softkin {

/// Where a robot is nearest to an obstacle or a body that it may touch.
struct Gap {
  double width_mm = 0;            // >= 0
  Vec3 towards = Vec3::Zero();    // from the robot to the other, of length 1; 0 where the two touch
  std::array<Index, 4> points{};  // of the ContactPoints: a vertex and a triangle's corners
  Vec3 corners = Vec3::Zero();    // weights of the corners, their sum is 1 [-]
  bool vertex_of_robot = true;    // else the triangle is the robot's
};

/// Looks at vertices of the one before triangles of the other, both ways: edges that cross count as far apart as their
/// ends are.
///
/// part       of model.contact.parts, an obstacle or a body
/// positions  #V by 3 [mm]
/// returns    none where the robot and the part do not feel each other
[[nodiscard]] std::optional<Gap> gap_before(const Model& model, Index part, const Points& positions);

/// How its width changes along moves of the vertices, #V by 3 [mm], to first order [mm].
[[nodiscard]] double change_of(const Gap& gap, const Model& model, const Points& moves);

}  // namespace softkin
