#pragma once

#include <optional>
#include <softkin/model/model.hpp>
#include <softkin/statics/deformation.hpp>
#include <string>
#include <variant>
#include <vector>

namespace softkin {

/// A marker is to be at a point.
struct PositionGoal {
  Index marker = 0;                            // of the model
  Vec3 target = Vec3::Zero();                  // [mm]
  std::array<bool, 3> axes{true, true, true};  // coordinates that count
};

/// A marker is to lie in a plane.
struct PlaneGoal {
  Index marker = 0;             // of the model
  Vec3 point = Vec3::Zero();    // of the plane [mm]
  Vec3 normal = Vec3::UnitZ();  // of any length > 0
};

/// The line from one marker to another is to point somewhere. Its error is that of the unit vectors times lever_mm.
struct DirectionGoal {
  Index from = 0, to = 0;          // different markers
  Vec3 direction = Vec3::UnitX();  // of any length > 0
  double lever_mm = 1;             // > 0; the distance at which a wrong direction counts [mm]
};

/// The robot is to exert a force on a support, an obstacle or a body: on a support minus its reaction; on an obstacle
/// or a body the sum of all contact forces on it. The error is that of the force, multiplied by mm_per_N.
struct ForceGoal {
  /// On what the force acts: a support, which is an entry of the description's `fixed`; or an obstacle or a body.
  enum class On { support, part };
  On on = On::support;                         // which of these index numbers
  Index index = 0;                             // of model.held.supports; of model.contact.parts, an obstacle or a body
  Vec3 force = Vec3::Zero();                   // [N]
  std::array<bool, 3> axes{true, true, true};  // components that count
  double mm_per_N = 1;                         // > 0; weight of an error of the force [mm/N]
};

/// A goal of inverse kinematics, with its weight (> 0) in the sum of squares.
struct Goal {
  std::variant<PositionGoal, PlaneGoal, DirectionGoal, ForceGoal> what;  // one goal
  double weight = 1;                                                     // of its squared error, > 0
};

/// throws InvalidInput on a marker that the model does not have, a number that is not finite, an empty list, a weight
/// or lever that is not > 0, no axis, a normal or direction of length 0, a direction from a marker to itself, a force
/// on nothing that the robot has or may touch, or one of target shapes
void check_goals(const Model& model, const std::vector<Goal>& goals);

/// Distance of each goal from being met [mm], unweighted.
///
/// throws  InvalidInput on a force, which positions alone do not determine
[[nodiscard]] Eigen::VectorXd goal_errors(const Model& model, const std::vector<Goal>& goals, const Points& positions);

/// Is a force among them?
[[nodiscard]] bool any_force(const std::vector<Goal>& goals);

/// Returns the names of everything on which a force goal may act: supports, obstacles and bodies, in this order.
[[nodiscard]] std::vector<std::string> names_of_pressed(const Model& model);

/// Returns a force goal on the support, obstacle or body of that name, with no force yet.
///
/// throws  InvalidInput where nothing has the name, listing those that exist, and where a support and an obstacle or
///         body both have it
[[nodiscard]] ForceGoal force_on(const Model& model, const std::string& name);

/// mm_per_N of a goal that is to be met at its own tolerance while places are at theirs: tolerance_mm over tolerance_N;
/// none: a thousandth of the force, 0.001 N where that is zero.
///
/// throws  InvalidInput on tolerances that are not finite and > 0
[[nodiscard]] double usual_mm_per_N(const ForceGoal& goal, double tolerance_mm, std::optional<double> tolerance_N);

/// Returns the force that a robot exerts on the goal's support, obstacle or body in an equilibrium [N].
///
/// reactions  of every support, in their order
/// contacts   none: nothing can touch
[[nodiscard]] Vec3 exerted_force(const ForceGoal& goal, const std::vector<Reaction>& reactions,
                                 const std::optional<std::vector<PairForces>>& contacts);

/// Returns warnings about implausible targets, a sentence each: targets 100 times the robot's size away, or near it if
/// they were in metres; forces in a robot with friction, as they depend on the path.
[[nodiscard]] std::vector<std::string> doubts_about(const Model& model, const std::vector<Goal>& goals);

}  // namespace softkin
