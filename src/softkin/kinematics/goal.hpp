#pragma once

#include <softkin/model/model.hpp>
#include <string>
#include <variant>
#include <vector>

namespace softkin {

/// A marker is to be at a point.
struct PositionGoal {
  Index marker = 0;
  Vec3 target = Vec3::Zero();                  // [mm]
  std::array<bool, 3> axes{true, true, true};  // coordinates that count
};

/// A marker is to lie in a plane.
struct PlaneGoal {
  Index marker = 0;
  Vec3 point = Vec3::Zero();    // of the plane [mm]
  Vec3 normal = Vec3::UnitZ();  // of any length > 0
};

/// The line from one marker to another is to point somewhere. Its error is that of the unit vectors times lever_mm.
struct DirectionGoal {
  Index from = 0, to = 0;          // different markers
  Vec3 direction = Vec3::UnitX();  // of any length > 0
  double lever_mm = 1;             // > 0; the distance at which a wrong direction counts [mm]
};

/// What inverse kinematics is to reach, with its weight (> 0) in the sum of squares.
struct Goal {
  std::variant<PositionGoal, PlaneGoal, DirectionGoal> what;
  double weight = 1;
};

/// throws InvalidInput on a marker that the model does not have, a number that is not finite, an empty list, a weight
/// or lever that is not > 0, no axis, a normal or direction of length 0, a direction from a marker to itself
void check_goals(const Model& model, const std::vector<Goal>& goals);

/// Distance of each goal from being met [mm], unweighted.
[[nodiscard]] Eigen::VectorXd goal_errors(const Model& model, const std::vector<Goal>& goals, const Points& positions);

/// What looks wrong about targets beside this robot, a sentence each: 100 times its size away, or near it if they were
/// in metres.
[[nodiscard]] std::vector<std::string> doubts_about(const Model& model, const std::vector<Goal>& goals);

}  // namespace softkin
