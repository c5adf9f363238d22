#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/kinematics/walk.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using testing::by_load;
using testing::cable;

constexpr double length = 50, area = 100, modulus = 1;    // of the elastic part of the bar [mm, mm^2, MPa]
constexpr double compliance = length / (modulus * area);  // [mm/N], of small strains
constexpr double strong = 0.5;                            // [N], more than any pull below

struct Friction {
  double rear_forward, rear_backward, front_forward, front_backward;
};

/// A bar along x between two rigid ends, its feet, which a cable pulls together; Poisson's ratio 0, so that it is a
/// linear spring under small strains.
RobotSpec bar(const Friction& friction) {
  RobotSpec spec = testing::physical_robot(testing::block_mesh({12, 2, 2}, {60, 10, 10}));
  spec.materials[0].elastic = testing::elastic(Law::st_venant_kirchhoff, modulus, 0);
  spec.rigid = {{{Box{{-1, -1, -1}, {5.1, 11, 11}}, {}}, "rear"}, {{Box{{54.9, -1, -1}, {61, 11, 11}}, {}}, "front"}};
  spec.fixed.push_back({{std::string("x_high"), {}}, {false, true, true}});
  spec.actuators = {by_load(cable("pull", {{2, 5, 5}, {58, 5, 5}}))};
  spec.markers = {{"rear", {std::string("x_low"), {}}}, {"front", {std::string("x_high"), {}}}};
  spec.feet = {{"rear", friction.rear_forward, friction.rear_backward, {}},
               {"front", friction.front_forward, friction.front_backward, {}}};
  return spec;
}

/// Both feet slide forward at a force, and hold backward.
Friction forward(double force) {
  return {force, strong, force, strong};
}

std::vector<WalkStep> walk(const RobotSpec& spec, const std::vector<double>& commands) {
  const Model model = compile(spec);
  Walker walker(model, testing::tight(1e-8));
  std::vector<WalkStep> steps;
  for (const double command : commands) {
    steps.push_back(walker.advance(testing::values({command})));
    EXPECT_EQ(steps.back().equilibrium.report.status, Status::converged);
  }
  return steps;
}

TEST(Walk, StrideOfALinearSpring) {
  const double pull = 0.2, friction = 0.02;
  const auto steps = walk(bar(forward(friction)), {0, pull, 0, pull, 0, pull, 0});
  const double first = (pull - friction) * compliance, later = (pull - 2 * friction) * compliance;
  const double small = 4e-3 * pull * compliance;  // strains of 0.2 %
  double rear = 0, front = 60;
  for (std::size_t i = 1; i < steps.size(); ++i) {
    const bool pulled = i % 2 == 1;
    EXPECT_EQ(steps[i].sliding, pulled ? Sliding::rear : Sliding::front) << i;
    EXPECT_NEAR(steps[i].friction_N, pulled ? friction : -friction, 1e-12) << i;
    (pulled ? rear : front) += i == 1 ? first : later;
    EXPECT_NEAR(steps[i].rear_mm, rear, static_cast<double>(i) * small) << i;
    EXPECT_NEAR(steps[i].front_mm, front, static_cast<double>(i) * small) << i;
    EXPECT_NEAR(steps[i].travel_mm, (steps[i].rear_mm + steps[i].front_mm - 60) / 2, 1e-12) << i;
  }
  EXPECT_NEAR(steps[6].travel_mm - steps[4].travel_mm, steps[4].travel_mm - steps[2].travel_mm, 1e-6);
}

/// What slides under a friction has the length of a bar on which a dead load of that size acts.
TEST(Walk, LengthsAreThoseUnderDeadLoads) {
  const double pull = 8, friction = 2;  // strains of 6 %
  const auto steps = walk(bar({friction, 50, friction, 50}), {0, pull, 0});
  RobotSpec loaded = bar(forward(0));
  loaded.feet.clear();
  const auto length_under = [&](double command, double force) {
    loaded.loads.forces = {{"floor", {std::string("x_high"), {}}, {force, 0, 0}}};
    const Model model = compile(loaded);
    const Statics statics(model);
    const Equilibrium found = testing::solve_converged(statics, testing::values({command}));
    return (testing::marker_at(model, found, 1) - testing::marker_at(model, found, 0)).x();
  };
  EXPECT_NEAR(steps[1].front_mm - steps[1].rear_mm, length_under(pull, friction), 1e-6);
  EXPECT_NEAR(steps[2].front_mm - steps[2].rear_mm, length_under(0, -friction), 1e-6);
  EXPECT_LT(steps[1].front_mm - steps[1].rear_mm, 57.5);
}

TEST(Walk, StandsWhereFrictionBearsThePull) {
  for (const WalkStep& step : walk(bar(forward(0.05)), {0, 0.03, 0.045, 0.01, 0})) {
    EXPECT_EQ(step.sliding, Sliding::none);
    EXPECT_EQ(step.rear_mm, 0);
    EXPECT_NEAR(step.front_mm, 60, 1e-9);
    EXPECT_NEAR(step.friction_N, step.equilibrium.actuation[0], 1e-6);  // friction carries the tension, the bar nothing
  }
}

TEST(Walk, DoesNotDependOnTheSteps) {
  std::vector<double> fine;
  for (int cycle = 0; cycle < 2; ++cycle) {
    for (int i = cycle; i <= 10; ++i) fine.push_back(0.02 * i);
    for (int i = 9; i >= 0; --i) fine.push_back(0.02 * i);
  }
  const auto coarse = walk(bar(forward(0.02)), {0, 0.2, 0, 0.2, 0}), many = walk(bar(forward(0.02)), fine);
  EXPECT_NEAR(many.back().rear_mm, coarse.back().rear_mm, 1e-6);
  EXPECT_NEAR(many.back().front_mm, coarse.back().front_mm, 1e-6);
  int standing = 0;
  for (const WalkStep& step : many) standing += step.sliding == Sliding::none ? 1 : 0;
  EXPECT_GE(standing, 5);  // the start, and twice two at every turn
}

TEST(Walk, FrictionTurnedRoundWalksBack) {
  const auto there = walk(bar(forward(0.02)), {0, 0.2, 0, 0.2, 0});
  const auto back = walk(bar({strong, 0.02, strong, 0.02}), {0, 0.2, 0, 0.2, 0});
  ASSERT_GT(there.back().travel_mm, 0.1);
  EXPECT_NEAR(back.back().travel_mm, -there.back().travel_mm, 1e-6);
}

TEST(Walk, EqualFrictionStaysInPlace) {
  const auto steps = walk(bar({0.02, 0.02, 0.02, 0.02}), {0, 0.2, 0, 0.2});
  EXPECT_EQ(steps[1].sliding, Sliding::both);
  EXPECT_GT(steps[1].rear_mm, 0.04);
  for (const WalkStep& step : steps) EXPECT_NEAR(step.travel_mm, 0, 1e-12);
}

/// Without forces a cycle takes the robot on by what its length changes.
TEST(Walk, TargetShapesSlideFreely) {
  Mesh mesh = testing::block_mesh({10, 3, 3}, {50, 12, 12});
  testing::add_volume_region(mesh, "chamber", [](const Vec3& p) {
    return p.x() > 10 && p.x() < 40 && p.y() > 4 && p.y() < 8 && p.z() > 4 && p.z() < 8;
  });
  RobotSpec spec = testing::block_robot(std::move(mesh));
  spec.fixed.push_back({{std::string("x_high"), {}}, {false, true, true}});
  spec.actuators = {testing::air("chamber")};
  const RobotSpec feet = bar(forward(0.02));
  spec.markers = feet.markers;
  spec.feet = feet.feet;
  const auto steps = walk(spec, {1, 2, 1});

  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium longer = testing::solve_converged(statics, testing::values({2}), testing::tight(1e-8));
  const double change = testing::marker_at(model, longer, 1).x() - 50;
  ASSERT_GT(change, 0.5);
  EXPECT_NEAR(steps[2].travel_mm, change, 1e-6);
  EXPECT_EQ(steps[1].sliding, Sliding::front);
  EXPECT_EQ(steps[2].sliding, Sliding::rear);
  EXPECT_EQ(steps[1].friction_N, 0);
}

TEST(Walk, ShapesStandWhereTheFeetAre) {
  const Model model = compile(bar(forward(0.02)));
  Walker walker(model, testing::tight(1e-8));
  EXPECT_NEAR((walker.direction() - Vec3::UnitX()).norm(), 0, 1e-12);
  for (const double command : {0.0, 0.2, 0.0, 0.1}) {
    const WalkStep step = walker.advance(testing::values({command}));
    const Points& shape = step.equilibrium.state.positions;
    EXPECT_NEAR(model.markers[0].point.at(shape).x(), step.rear_mm, 1e-12);
    EXPECT_NEAR(model.markers[1].point.at(shape).x(), step.front_mm, 1e-6);
    EXPECT_NEAR(model.markers[1].point.at(shape).y(), 5, 1e-9);
    EXPECT_EQ(step.equilibrium.actuation.size(), 1);
    EXPECT_EQ(step.equilibrium.state.multipliers.size(), 1);
  }
}

TEST(Walk, InterruptedStaysWhereItWas) {
  const Model model = compile(bar(forward(0.02)));
  Walker walker(model, testing::tight(1e-8)), undisturbed(model, testing::tight(1e-8));
  for (Walker* each : {&walker, &undisturbed}) (void)each->advance(testing::values({0}));
  const WalkStep cut = walker.advance(testing::values({0.2}), [](const Progress&) { return false; });
  EXPECT_EQ(cut.equilibrium.report.status, Status::interrupted);
  EXPECT_EQ(cut.rear_mm, 0);
  EXPECT_EQ(walker.advance(testing::values({0.2})).rear_mm, undisturbed.advance(testing::values({0.2})).rear_mm);
}

void expect_refused(const RobotSpec& spec, const std::string& message) {
  try {
    const Model model = compile(spec);
    Walker walker(model, {});
    (void)walker.advance(testing::values({0.2}));
    ADD_FAILURE() << "not refused: " << message;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
  }
}

TEST(Walk, Refusals) {
  const RobotSpec good = bar(forward(0.02));
  RobotSpec spec = good;
  spec.feet.clear();
  expect_refused(spec, "the robot has no feet to walk on");
  spec = good;
  spec.contact = ContactSpec{};
  spec.contact->obstacles = {{"kerb", Box{{500, 0, 0}, {501, 1, 1}}, std::nullopt, {"s.yaml", 7}}};
  expect_refused(spec,
                 "s.yaml:7: 'kerb' stands where it is while the robot walks away from it: a walk knows no floor "
                 "but that of the feet; leave it out");
  spec = good;
  spec.feet.pop_back();
  expect_refused(spec, "walks on two feet, the rear one and the front one, not on 1");
  spec = good;
  spec.feet[1].marker = "toe";
  expect_refused(spec, "marker 'toe', which the robot does not have");
  spec = good;
  spec.feet[1].marker = "rear";
  expect_refused(spec, "both feet stand at marker 'rear'");
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    spec = good;
    spec.feet[0].backward = bad;
    expect_refused(spec, "the friction backward must be 0 N or more");
  }
  spec = good;
  spec.markers[1].at = spec.markers[0].at;
  expect_refused(spec, "the feet stand at one place");
  spec = good;
  spec.fixed.back().axes = {true, true, true};
  expect_refused(spec, "held along x on both sides");
  spec = good;
  spec.loads.forces = {{"wind", {std::string("x_high"), {}}, {0.1, 0, 0}}};
  expect_refused(spec, "act along the direction of travel with 0.1");
  spec.loads.forces.clear();
  spec.loads.tractions = {{"water", {std::string("z_high"), {}}, true, {0, 0, 0}, 1}};
  expect_refused(spec, "a pressure, traction or moment may push");
  spec = good;
  spec.fixed.back().axes = {false, true, false};
  spec.loads.gravity = {0, 0, -9.81};
  spec.materials[0].density = 1000;
  expect_refused(spec, "the feet leave the line between them");
}

TEST(Walk, CommandsAreChecked) {
  const Model model = compile(bar(forward(0.02)));
  Walker walker(model, {});
  EXPECT_THROW((void)walker.advance(testing::values({0.1, 0.1})), InvalidInput);
  EXPECT_THROW((void)walker.advance(testing::values({-0.1})), InvalidInput);
  EXPECT_THROW((void)walker.advance(testing::values({std::nan("")})), InvalidInput);
}

}  // namespace
}  // namespace softkin
