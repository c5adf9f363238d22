#include <gtest/gtest.h>

#include <softkin/kinematics/inverse.hpp>

#include "statics/physical_samples.hpp"

/// Inverse kinematics of robots with friction of cables: a solution is reached by the motion from the start.

namespace softkin {
namespace {

using namespace testing;

RobotSpec arm_with_two_tendons() {
  RobotSpec spec = physical_robot(block_mesh({10, 2, 2}, {80, 8, 8}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 3, 0.4);
  spec.markers = {{"tip", {std::string("x_high"), {}}}};
  spec.actuators = {by_load(cable("upper", {{0, 4, 7}, {80, 4, 7}}), 0, 6),
                    by_load(cable("side", {{0, 7, 4}, {80, 7, 4}}), 0, 6)};
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.as<CableSpec>()->spacing = 9;
    actuator.as<CableSpec>()->friction = 0.3;
  }
  return spec;
}

}  // namespace

TEST(InverseTendons, AnswersAreReachedFromTheStart) {
  const Model model = compile(arm_with_two_tendons());
  const Statics statics(model);
  InverseOptions options;
  const Equilibrium far = solve_converged(statics, values({5, 1}));
  for (const State& start : {statics.rest(), far.state})
    for (const Actuation& commands : {values({3, 1.5}), values({1, 4})}) {
      const Equilibrium there = statics.solve(commands, start, tight());
      ASSERT_EQ(there.report.status, Status::converged);
      const std::vector<Goal> goals{{PositionGoal{0, marker_at(model, there)}}};
      const InverseResult found = solve_inverse(statics, goals, start, options);
      ASSERT_EQ(found.status, InverseStatus::reached) << found.remark;
      const Equilibrium again = statics.solve(found.equilibrium.actuation, start, tight());
      EXPECT_LT((marker_at(model, again) - marker_at(model, there)).norm(), 2 * options.tolerance_mm);
    }
}

}  // namespace softkin
