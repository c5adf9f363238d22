#include <gtest/gtest.h>

#include <functional>
#include <softkin/model/model.hpp>
#include <softkin/model/sensor.hpp>

#include "model/physical_robots.hpp"

/// Coordinates in metres beside a mesh in mm, and parts that no robot of this size has, are warned of.

namespace softkin {
namespace {

using namespace testing;

/// A bar of 60 x 10 x 10 mm at the origin.
RobotSpec bar_with(const std::function<void(RobotSpec&)>& change) {
  RobotSpec spec = physical_robot(block_mesh({18, 3, 3}, {60, 10, 10}));
  spec.mesh_options.quadratic = true;
  change(spec);
  return spec;
}

std::vector<std::string> warned(const std::function<void(RobotSpec&)>& change) {
  return compile(bar_with(change)).warnings;
}

void expect_warning(const std::function<void(RobotSpec&)>& change, const std::string& words) {
  const std::vector<std::string> warnings = warned(change);
  if (words.empty()) {
    EXPECT_TRUE(warnings.empty()) << warnings[0];
    return;
  }
  ASSERT_EQ(warnings.size(), 1u) << words;
  EXPECT_NE(warnings[0].find(words), std::string::npos) << warnings[0];
}

std::function<void(RobotSpec&)> cable(const Vec3& from, const Vec3& to) {
  return [=](RobotSpec& spec) {
    CableSpec tendon;
    for (const Vec3& point : {from, to}) tendon.points.push_back({point, {}});
    ActuatorSpec actuator;
    actuator.name = "tendon";
    actuator.drive = tendon;
    actuator.control = Control::load;
    actuator.high = 1;
    actuator.rest = 0;
    spec.actuators.push_back(actuator);
  };
}

TEST(Misplaced, CablesInMetres) {
  expect_warning(cable({0, 0, 2}, {60, 0, 2}), "");
  expect_warning(cable({0, 0, 2}, {3, 0, 2}), "");
  expect_warning(
      cable({0, 0, 0.002}, {0.055, 0, 0.002}),
      "The points of cable 'tendon' span 0.055 mm, where the robot is 61.64 mm across; a thousand times that "
      "(m taken for mm) would be 55 mm: is it that? Coordinates are in the scene's unit of lengths");
  expect_warning(cable({30, 5, 5}, {30, 5, 5.0005}), "span 0.0005 mm, where the robot is 61.64 mm across. Coordinates");
}

TEST(Misplaced, PointsInMetres) {
  const auto marker = [](const Vec3& at) {
    return [at](RobotSpec& spec) { spec.markers.push_back({"tip", {at, {}}}); };
  };
  expect_warning(marker({60, 5, 5}), "");
  expect_warning(marker({0, 0, 0}), "");
  expect_warning(marker({0.001, 0, 0}), "");  // beside a vertex
  expect_warning(marker({0.4, 0.1, 0}), "");  // a thousand times that is nowhere near
  expect_warning(marker({0.06, 0.005, 0.005}),
                 "Marker 'tip' is 0.06042 mm from the origin, where the robot is 61.64 mm");
  expect_warning(
      [](RobotSpec& spec) {
        spec.loads.forces.push_back({"payload", {Vec3(0.06, 0, 0), {}}, {0, 0, -1e-3}});
      },
      "The point of force 'payload' is 0.06 mm from the origin");
}

TEST(Misplaced, ShapesInMetres) {
  const auto region = [](const Selector& selector) {
    return [selector](RobotSpec& spec) { spec.regions.push_back({"part", selector, {}}); };
  };
  expect_warning(region(Box{{-1, -1, -1}, {1, 11, 11}}), "");
  expect_warning(region(Box{{-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}}), "");  // the vertex at the origin
  expect_warning(region(Box{{59.99, 9.99, 9.99}, {60.01, 10.01, 10.01}}), "");
  expect_warning(region(Box{{-0.001, -0.001, -0.001}, {0.03, 0.011, 0.011}}),
                 "Region 'part' measures 0.03534 mm from corner to corner");
  expect_warning(region(Sphere{{0.005, 0, 0}, 0.011}), "");  // its middle is near enough to the origin
  expect_warning(region(VertexList{{0}}), "");
}

TEST(Misplaced, SupportsThatHoldEverything) {
  const auto held = [](const Vec3& high) {
    return [high](RobotSpec& spec) { spec.fixed = {{{Selector(Box{{-1, -1, -1}, high}), {}}}}; };
  };
  expect_warning(held({59, 11, 11}), "");
  expect_warning(held({61, 11, 11}),
                 "Every vertex of the robot is held by an entry of 'fixed', so that nothing can move");
}

TEST(Misplaced, ObstaclesOfAnotherSizeOrOutOfReach) {
  const auto obstacle = [](const ObstacleShape& shape) {
    return [shape](RobotSpec& spec) {
      spec.contact.emplace();
      spec.contact->obstacles.push_back({"pin", shape, {}, {}});
    };
  };
  expect_warning(obstacle(Sphere{{30, 5, 20}, 5}), "");
  expect_warning(obstacle(Halfspace{{0, 0, -10}, {0, 0, 1}}), "");
  expect_warning(obstacle(Sphere{{30, 5, 20}, 0.05}), "Obstacle 'pin' measures 0.1732 mm from corner to corner");
  expect_warning(obstacle(Box{{30000, 0, 0}, {30010, 10, 10}}), "Obstacle 'pin' is 2.994e+04 mm from the robot");
  expect_warning(obstacle(Halfspace{{0, 0, -20000}, {0, 0, 1}}), "Obstacle 'pin' is 2");
}

}  // namespace
}  // namespace softkin
