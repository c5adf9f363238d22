#include <Eigen/Geometry>
#include <softkin/model/joined.hpp>

#include "statics/physical_samples.hpp"

/// Robots that do not touch answer together as each does alone.

namespace softkin {

namespace {

using namespace testing;

Placement turned(double angle, const Vec3& axis, const Vec3& to) {
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), to};
}

Placement upside_down(const Vec3& to) {
  Placement place;
  place.rotation = Vec3(1, -1, -1).asDiagonal();
  place.translation = to;
  return place;
}

RobotSpec together(const RobotSpec& spec, const std::vector<Placement>& places) {
  std::vector<PlacedRobot> robots;
  for (std::size_t i = 0; i < places.size(); ++i) robots.push_back({"r" + std::to_string(i), spec, places[i], {}});
  return joined(robots, {"all", {}, {}, {}});
}

/// Solves a robot alone with each actuation and as many of it together, one at each place.
void expect_alike(const RobotSpec& spec, const std::vector<Placement>& places, const std::vector<Actuation>& asked) {
  const Model alone = compile(spec), all = compile(together(spec, places));
  const Statics one(alone), whole(all);
  Actuation every(static_cast<Index>(alone.actuators.size() * places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    every.segment(static_cast<Index>(i) * asked[i].size(), asked[i].size()) = asked[i];
  const Equilibrium found = whole.solve(every, {all.rest}, tight());
  ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
  const auto count = static_cast<Index>(alone.rest.rows());
  ASSERT_EQ(all.rest.rows(), count * static_cast<Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Equilibrium expected = one.solve(asked[i], {alone.rest}, tight());
    ASSERT_EQ(expected.report.status, Status::converged) << expected.report.remark;
    const Points& shape = expected.state.positions;
    EXPECT_GT((shape - alone.rest).rowwise().norm().maxCoeff(), 0.02 * alone.diagonal_mm);
    const Points moved = (shape * places[i].rotation.transpose()).rowwise() + places[i].translation.transpose();
    const Points there = found.state.positions.middleRows(static_cast<Index>(i) * count, count);
    EXPECT_LT((there - moved).rowwise().norm().maxCoeff(), 1e-9 * alone.diagonal_mm) << "robot " << i;
  }
}

const std::vector<Placement>& three_places() {
  static const std::vector<Placement> places{
      {Mat3::Identity(), Vec3(0, -20, 0)}, upside_down({0, 20, 0}), turned(2.2, {1, 2, -1}, {100, -50, 20})};
  return places;
}

}  // namespace

/// A finger with a chamber, a cable, a rigid end and a force at it, held by a shape.
TEST(SeveralRobots, PhysicalFingersAnswerAsEachAlone) {
  RobotSpec spec = bending_finger();
  spec.fixed = {{{Selector(Box{{-1, -1, -1}, {0, 20, 20}}), {}}}};
  spec.rigid.push_back({{Selector(Halfspace{{59, 0, 0}, {1, 0, 0}}), {}}, "rigid_1"});
  spec.actuators.push_back(cable("tendon", {{0, 6, 14}, {30, 6, 14}, {58, 6, 14}}));
  spec.forces.push_back({"push", {Vec3(55, 6, 8), {}}, Vec3(0, 0.002, -0.004)});
  expect_alike(spec, three_places(), {values({1.6, 0.97}), values({1.3, 0.99}), values({1.5, 0.98})});
}

TEST(SeveralRobots, OfOrderTwo) {
  RobotSpec spec = physical_robot(block_mesh({4, 1, 1}, {40, 8, 8}));
  spec.quadratic = true;
  // shapes choose nodes of edges whose ends they do not hold
  spec.fixed = {{{Selector(Halfspace{{6, 0, 0}, {-1, 0, 0}}), {}}}};
  spec.forces.push_back({"push", {std::string("x_high"), {}}, Vec3(0, 0.02, -0.04)});
  expect_alike(spec, three_places(), {Actuation(0), Actuation(0), Actuation(0)});
}

/// A plane of symmetry and a displacement, under quarter turns.
TEST(SeveralRobots, SupportsAlongSomeAxesAndPulled) {
  RobotSpec spec = physical_robot(block_mesh({4, 2, 2}, {40, 16, 16}));
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}},
                {{std::string("x_high"), {}}, {true, false, false}, Vec3(4, 0, 0)}};
  Placement about_z = turned(0, {0, 0, 1}, {0, 100, 0});
  about_z.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  expect_alike(spec, {{}, upside_down({0, 50, 5}), about_z}, {Actuation(0), Actuation(0), Actuation(0)});
}

/// Chambers that are the empty space of their robot's body.
TEST(SeveralRobots, ChambersThatAreEmptySpaces) {
  RobotSpec spec = robot_with_bags({"bag"});
  spec.actuators[0].surface.reset();
  expect_alike(spec, three_places(), {values({1.8}), values({2}), values({1.5})});
}

TEST(SeveralRobots, ChambersOfSurfaces) {
  RobotSpec spec = robot_with_bags({"bag"});
  spec.actuators[0].surface = box_surface({13.9, 6.1, 12.2}, {23.7, 5.8, 5.7});  // no vertex on a face of elements
  expect_alike(spec, three_places(), {values({1.8}), values({2}), values({1.5})});
}

/// With prisms of a dea, a chamber and a cable.
TEST(SeveralRobots, TargetShapesAnswerAsEachAlone) {
  expect_alike(mixed_robot(true), three_places(),
               {values({1.2, 1.3, 0.9}), values({1, 1.2, 0.95}), values({1.3, 1, 0.9})});
}

}  // namespace softkin
