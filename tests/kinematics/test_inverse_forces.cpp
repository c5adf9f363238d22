#include <gtest/gtest.h>

#include <random>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/inverse_response.hpp>

#include "statics/physical_samples.hpp"

/// Inverse kinematics for the forces that a robot exerts on its supports and on obstacles.

namespace softkin {
namespace {

using namespace testing;

/// A beam with three chambers, and a marker in its middle.
RobotSpec stiff_beam() {
  RobotSpec spec = chambers_beam(3);
  spec.materials[0].elastic->youngs_modulus = 3;
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 1;
    actuator.high = 4;
  }
  spec.markers.push_back({"middle", {Vec3(24, 10, 10), {}}});
  return spec;
}

/// Its free end stands on a load cell that holds it along z and y.
RobotSpec beam_on_a_cell() {
  RobotSpec spec = stiff_beam();
  spec.fixed.push_back({{std::string("x_high"), {}}, {false, true, true}, Vec3::Zero(), "cell"});
  return spec;
}

/// Its free end comes to a floor when it bends down.
RobotSpec beam_over_a_floor(double friction = 0) {
  RobotSpec spec = stiff_beam();
  spec.contact = ContactSpec{};
  spec.contact->distance_mm = 0.1;
  spec.contact->friction = friction;
  spec.contact->self = false;
  spec.contact->obstacles = {{"floor", Halfspace{{0, 0, -0.5}, {0, 0, 1}}, std::nullopt, {}}};
  return spec;
}

struct Pressing {
  Model model;
  Statics statics;

  explicit Pressing(const RobotSpec& spec) : model(compile(spec)), statics(model) {}

  [[nodiscard]] Vec3 force(const ForceGoal& goal, const Equilibrium& found) const {
    const std::vector<Goal> goals{{goal}};
    return inverse::exertions_of(statics, goals, found.state)[0].force;
  }
  [[nodiscard]] ForceGoal requested(const std::string& name, const Vec3& force, std::array<bool, 3> axes) const {
    ForceGoal goal = force_on(model, name);
    goal.force = force;
    goal.axes = axes;
    goal.mm_per_N = 1 / force.norm();  // a thousandth of it is 0.001 mm
    return goal;
  }
};

constexpr std::array<bool, 3> only_x{true, false, false}, only_z{false, false, true};

/// The derivatives of what is exerted at an equilibrium.
std::vector<inverse::ExertionSlopes> slopes_at(const Pressing& robot, const std::vector<Goal>& goals,
                                               const Equilibrium& found, Sensitivity& sensitivity) {
  inverse::Pose pose;
  pose.equilibrium = found;
  pose.exertions = inverse::exertions_of(robot.statics, goals, found.state);
  return inverse::exertion_slopes(robot.statics, goals, pose, tight(), 1e-10, sensitivity);
}

/// Terms of forces by the commands, against those of equilibria beside.
void expect_slopes(const Pressing& robot, const std::vector<Goal>& goals, const Actuation& at, double accuracy) {
  const Equilibrium found = solve_converged(robot.statics, at);
  const auto exertions = inverse::exertions_of(robot.statics, goals, found.state);
  Sensitivity sensitivity = robot.statics.sensitivity(found.state, tight(), 1e-10);
  const auto changes = slopes_at(robot, goals, found, sensitivity);
  const Eigen::MatrixXd slopes =
      inverse::goal_slopes(robot.model, goals, found.state.positions, sensitivity, exertions, changes);
  constexpr double reach = 1e-4;
  const auto terms_at = [&](Index a, double change) {
    Actuation beside = at;
    beside[a] += change;
    const State there = robot.statics.solve(beside, found.state, tight()).state;
    return inverse::goal_terms(robot.model, goals, there.positions, inverse::exertions_of(robot.statics, goals, there));
  };
  for (Index a = 0; a < 3; ++a) {  // chambers
    const Eigen::VectorXd near = (terms_at(a, reach) - terms_at(a, -reach)) / (2 * reach);
    const Eigen::VectorXd far = (terms_at(a, 2 * reach) - terms_at(a, -2 * reach)) / (4 * reach);
    const Eigen::VectorXd change = (4 * near - far) / 3;  // by Richardson
    EXPECT_LT((slopes.col(a) - change).norm(), accuracy * slopes.norm()) << slopes.col(a) << "\n" << change;
  }
}

TEST(InverseForces, SlopesOfASupportsForceEqualDifferences) {
  const Pressing robot(beam_on_a_cell());
  const std::vector<Goal> goals{{robot.requested("cell", {0, 0.2, 0.5}, {false, true, true})},
                                {robot.requested("x_low", {1, 1, 1}, {true, true, true}), 3},
                                {PositionGoal{1, {20, 10, 10}}}};
  expect_slopes(robot, goals, values({1.2, 1.1, 1.3}), 1e-6);
}

TEST(InverseForces, SlopesOfAnObstaclesForceEqualDifferences) {
  const Pressing robot(beam_over_a_floor());
  const std::vector<Goal> goals{{robot.requested("floor", {0.1, 0.1, -2}, {true, true, true})}};
  const Equilibrium found = solve_converged(robot.statics, values({1.05, 1.1, 3}));
  EXPECT_LT(robot.force(robot.requested("floor", {0, 0, -1}, only_z), found).z(), -0.3);
  expect_slopes(robot, goals, values({1.05, 1.1, 3}), 1e-6);
}

TEST(InverseForces, SlopesOfABodysForceEqualDifferences) {
  RobotSpec spec = beam_over_a_floor();
  spec.contact->obstacles.clear();
  spec.contact->bodies = {{"cube", Box{{36, 5, -10.3}, {47, 14, -0.5}}, std::nullopt, {}, 1000}};
  const Pressing robot(spec);
  const std::vector<Goal> goals{{robot.requested("cube", {0.1, 0.1, -1}, {true, true, true})}};
  Actuation at = robot.model.rest_actuation();  // with the body's
  at.head(3) = values({1.05, 1.1, 3});
  EXPECT_LT(robot.force(robot.requested("cube", {0, 0, -1}, only_z), solve_converged(robot.statics, at)).z(), -0.2);
  expect_slopes(robot, goals, at, 1e-6);
}

/// Of what slides the derivative is that for sliding on.
TEST(InverseForces, SlopesOfAForceThatRubsAreThoseForSlidingOn) {
  const Pressing robot(beam_over_a_floor(0.2));
  const std::vector<Goal> goals{{robot.requested("floor", {0.1, 0.1, -2}, {true, true, true})}};
  Equilibrium found = solve_converged(robot.statics, values({1, 1, 2.5}), tight(1e-10));
  for (const double high : {2.8, 2.9, 3.0})
    found = robot.statics.solve(values({1, 1, high}), found.state, tight(1e-10));
  ASSERT_EQ(found.report.status, Status::converged);
  const auto exertions = inverse::exertions_of(robot.statics, goals, found.state);
  EXPECT_GT(std::abs(exertions[0].force.x()), 0.1);
  Sensitivity sensitivity = robot.statics.sensitivity(found.state, tight(), 1e-10);
  const auto changes = slopes_at(robot, goals, found, sensitivity);
  constexpr double step = 1e-4;
  const Equilibrium further = robot.statics.solve(values({1, 1, 3 + step}), found.state, tight(1e-11));
  const Vec3 difference =
      (inverse::exertions_of(robot.statics, goals, further.state)[0].force - exertions[0].force) / step;
  EXPECT_LT((changes[0].force.col(2) - difference).norm(), 1e-2 * difference.norm())
      << changes[0].force.col(2).transpose() << " and " << difference.transpose();
}

/// There is no contact: the gap to the floor has a gradient.
TEST(InverseForces, SlopesOfAGapEqualDifferences) {
  const Pressing robot(beam_over_a_floor());
  const std::vector<Goal> goals{{robot.requested("floor", {0, 0, -2}, only_z)}};
  const Equilibrium found = solve_converged(robot.statics, values({1.05, 1.02, 1.1}));
  const auto exertions = inverse::exertions_of(robot.statics, goals, found.state);
  ASSERT_TRUE(exertions[0].gap.has_value());
  EXPECT_GT(exertions[0].gap->width_mm, 0.1);
  EXPECT_LT(exertions[0].gap->towards.z(), -0.999);
  expect_slopes(robot, goals, values({1.05, 1.02, 1.1}), 1e-6);
}

TEST(InverseForces, ALoadCellIsPressedAsAsked) {
  const Pressing robot(beam_on_a_cell());
  const ForceGoal any = robot.requested("cell", {0, 0, 1}, only_z);
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> ratio(1, 2);
  for (int i = 0; i < 6; ++i) {
    const Equilibrium made = solve_converged(robot.statics, values({ratio(engine), ratio(engine), ratio(engine)}));
    const Vec3 force = robot.force(any, made);
    const std::vector<Goal> goals{{robot.requested("cell", force, {false, true, true})},
                                  {PositionGoal{1, marker_at(robot.model, made, 1), only_x}}};
    const InverseResult result = solve_inverse(robot.statics, goals, robot.statics.rest());
    ASSERT_EQ(result.status, InverseStatus::reached) << result.remark << ", errors " << result.errors_mm.transpose();
    const Equilibrium again = solve_converged(robot.statics, result.equilibrium.actuation);
    EXPECT_LT((robot.force(any, again) - force).tail<2>().norm(), 2e-3 * force.norm());
    const ElementDeformation deformation = robot.statics.measured(again.state);
    EXPECT_EQ(robot.force(any, again), -reactions(robot.model, again.state.positions, deformation)[1].force);
    EXPECT_LT(std::abs((marker_at(robot.model, again, 1) - marker_at(robot.model, made, 1)).x()), 2e-3);
  }
}

/// Synthetic poses in contact are each requested from rest, where there is no contact.
TEST(InverseForces, AFloorIsPressedWhileAMarkerStays) {
  const Pressing robot(beam_over_a_floor());
  const ForceGoal any = robot.requested("floor", {0, 0, -1}, only_z);
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> low(1, 1.6), high(2.2, 4);
  int pressed = 0;
  for (int i = 0; i < 12; ++i) {
    const Equilibrium made = solve_converged(robot.statics, values({low(engine), low(engine), high(engine)}), {});
    const double force = robot.force(any, made).z();
    if (force > -0.2) continue;
    ++pressed;
    const Vec3 there = marker_at(robot.model, made);
    const std::vector<Goal> goals{{robot.requested("floor", {0, 0, force}, only_z)},
                                  {PositionGoal{0, there, {true, true, false}}}};
    const InverseResult result = solve_inverse(robot.statics, goals, robot.statics.rest());
    ASSERT_EQ(result.status, InverseStatus::reached) << result.remark << ", errors " << result.errors_mm.transpose();
    const Equilibrium again = solve_converged(robot.statics, result.equilibrium.actuation);
    EXPECT_NEAR(robot.force(any, again).z(), force, 2e-3 * std::abs(force));
    EXPECT_LT((marker_at(robot.model, again) - there).head<2>().norm(), 2e-3);
  }
  EXPECT_GE(pressed, 8);
  EXPECT_TRUE(doubts_about(robot.model, {{any}}).empty());
}

/// With friction, the search still reaches the requested force, along its own motion.
TEST(InverseForces, AFloorThatRubsIsPressedAsAsked) {
  const Pressing robot(beam_over_a_floor(0.4));
  const std::vector<Goal> goals{{robot.requested("floor", {0, 0, -2}, only_z)}};
  ASSERT_EQ(doubts_about(robot.model, goals).size(), 1u);
  EXPECT_NE(doubts_about(robot.model, goals)[0].find("depends on its path"), std::string::npos);
  const InverseResult result = solve_inverse(robot.statics, goals, robot.statics.rest());
  ASSERT_EQ(result.status, InverseStatus::reached) << result.remark << ", errors " << result.errors_mm.transpose();
  EXPECT_NEAR(robot.force(robot.requested("floor", {0, 0, -2}, only_z), result.equilibrium).z(), -2, 0.0021);
}

TEST(InverseForces, SaysWhatIsOutOfReach) {
  const Pressing robot(beam_over_a_floor());
  const std::vector<Goal> much{{robot.requested("floor", {0, 0, -200}, only_z)}};
  const InverseResult most = solve_inverse(robot.statics, much, robot.statics.rest());
  EXPECT_EQ(most.status, InverseStatus::unreachable) << most.remark;
  EXPECT_NE(most.active, (std::vector<int>{0, 0, 0}));
  EXPECT_GT(most.errors_mm[0], 0.9);
  EXPECT_LT(robot.force(robot.requested("floor", {0, 0, -1}, only_z), most.equilibrium).z(), -2);
  // a floor does not hold back
  const std::vector<Goal> pull{{robot.requested("floor", {0, 0, 2}, only_z)}};
  const InverseResult none = solve_inverse(robot.statics, pull, robot.statics.rest());
  EXPECT_EQ(none.status, InverseStatus::unreachable);
  EXPECT_NE(none.remark.find("nothing touches 'floor' there"), std::string::npos) << none.remark;
  EXPECT_NEAR(none.errors_mm[0], 1, 1e-12);
}

/// The robot never comes there.
TEST(InverseForces, AnObstacleOutOfReachStaysUntouched) {
  RobotSpec spec = beam_over_a_floor();
  spec.contact->obstacles = {{"wall", Halfspace{{0, 0, -60}, {0, 0, 1}}, std::nullopt, {}}};
  const Pressing robot(spec);
  const std::vector<Goal> goals{{robot.requested("wall", {0, 0, -2}, only_z)}};
  const InverseResult result = solve_inverse(robot.statics, goals, robot.statics.rest());
  EXPECT_EQ(result.status, InverseStatus::unreachable) << result.remark;
  EXPECT_NE(result.remark.find("nothing touches 'wall' there"), std::string::npos) << result.remark;
  EXPECT_EQ(result.active[2], 1);  // it came as near as it can
}

TEST(InverseForces, RefusesWhatMeansNothing) {
  const Pressing robot(beam_over_a_floor());
  EXPECT_THROW((void)force_on(robot.model, "flor"), InvalidInput);
  EXPECT_THROW((void)force_on(robot.model, "robot"), InvalidInput);
  EXPECT_EQ(names_of_pressed(robot.model), (std::vector<std::string>{"x_low", "floor"}));
  const ForceGoal good = robot.requested("floor", {0, 0, -2}, only_z);
  const auto expect_refused = [&](ForceGoal goal, const Model& model) {
    EXPECT_THROW(check_goals(model, {{goal}}), InvalidInput);
  };
  EXPECT_NO_THROW(check_goals(robot.model, {{good}}));
  ForceGoal bad = good;
  bad.axes = {false, false, false};
  expect_refused(bad, robot.model);
  bad = good;
  bad.mm_per_N = 0;
  expect_refused(bad, robot.model);
  bad = good;
  bad.index = 0;  // the robot itself
  expect_refused(bad, robot.model);
  bad.index = 9;
  expect_refused(bad, robot.model);
  bad = good;
  bad.force.z() = HUGE_VAL;
  expect_refused(bad, robot.model);
  bad = {ForceGoal::On::support, 0, {0, 0, 1}};
  expect_refused(bad, compile(mixed_robot(true)));
  EXPECT_THROW((void)goal_errors(robot.model, {{good}}, robot.model.rest), InvalidInput);
}

}  // namespace
}  // namespace softkin
