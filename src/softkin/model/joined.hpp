#pragma once

#include <softkin/model/robot_spec.hpp>

namespace softkin {

/// Where a robot stands: turned about the origin, then moved.
struct Placement {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();  // [mm]

  [[nodiscard]] Vec3 operator()(const Vec3& point) const { return rotation * point + translation; }
};

struct PlacedRobot {
  std::string name;  // without '.'
  RobotSpec robot;   // in a frame of its own, without contact
  Placement place;
  Origin origin;
};

/// Settings of several robots as a whole, which replace those of each robot.
struct CommonSpec {
  std::string name;  // the scene's file name, for messages
  std::optional<Formulation> formulation;
  std::optional<Vec3> gravity;  // [m/s^2]
  Origin gravity_origin;
  std::optional<ElementWeights> weights{};
};

/// Several robots, each where it stands, as one.
///
/// Names become ROBOT.NAME, the region "all" of a robot its name. Lists and shapes choose in the robot's own frame and
/// become their members. Meshes that are to be of order 2 are elevated.
/// robots  in the order of the mesh that is made of theirs
/// throws  InvalidInput at the robot's origin, with its name and the place in its own scene: contact, formulations,
///         weights, gravities or orders that differ, supports along some axes that the turn takes to no axes, what
///         RegionTable refuses
[[nodiscard]] RobotSpec joined(std::vector<PlacedRobot> robots, const CommonSpec& common);

/// Adds common entries to robots that were joined: regions, materials, supports, rigid regions, actuators, forces,
/// markers, feet, contact; their names are those of the joined robots.
void add_common(RobotSpec& robots, RobotSpec common);

}  // namespace softkin
