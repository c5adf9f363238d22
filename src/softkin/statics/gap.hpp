#pragma once

#include <optional>
#include <softkin/model/model.hpp>

namespace softkin {

/// Place where a robot is nearest to an obstacle or a body with which it may have contact.
struct Gap {
  double width_mm = 0;            // >= 0
  Vec3 towards = Vec3::Zero();    // from the robot to the other, of length 1; 0 where the two touch
  std::array<Index, 4> points{};  // of the ContactPoints: a vertex and a triangle's corners
  Vec3 corners = Vec3::Zero();    // weights of the corners, their sum is 1 [-]
  bool vertex_of_robot = true;    // else the triangle is the robot's
};

/// Finds the smallest distance of a vertex of either to a triangle of the other: crossing edges count as far apart as
/// their ends.
///
/// part       of model.contact.parts, an obstacle or a body
/// positions  #V by 3 [mm]
/// returns    none where contact between the robot and the part is excluded
[[nodiscard]] std::optional<Gap> gap_before(const Model& model, Index part, const Points& positions);

/// Returns the change of its width along moves of the vertices, #V by 3 [mm], to first order [mm].
[[nodiscard]] double change_of(const Gap& gap, const Model& model, const Points& moves);

}  // namespace softkin
