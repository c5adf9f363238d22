#include <gtest/gtest.h>

#include <softkin/kinematics/inverse.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

InverseOptions by_gradient(double tolerance_mm) {
  InverseOptions options;
  options.method = InverseMethod::gradient;
  options.tolerance_mm = tolerance_mm;
  return options;
}

Model two_chambers() {
  RobotSpec spec = chambers_beam(2);
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 1;
    actuator.high = 1.6;
  }
  return compile(spec);
}

TEST(GradientMethod, ReachesWhatNewtonReaches) {
  const Model model = two_chambers();
  const Statics statics(model);
  const Equilibrium made = solve_converged(statics, values({1.3, 1.2}));
  const std::vector<Goal> goals{{PositionGoal{0, marker_at(model, made)}}};
  const InverseResult result = solve_inverse(statics, goals, statics.rest(), by_gradient(0.2));
  ASSERT_EQ(result.status, InverseStatus::reached) << result.remark;
  EXPECT_LE((marker_at(model, result.equilibrium) - marker_at(model, made)).norm(), 0.2);
  // each iteration takes two equilibria per actuator and those of its line search
  EXPECT_GE(result.equilibria, 1 + result.iterations * (2 * 2 + 2));
  for (const InverseTrial& record : result.history)
    for (Index a = 0; a < 2; ++a) {
      EXPECT_GE(record.actuation[a], 1);
      EXPECT_LE(record.actuation[a], 1.6);
    }
  const InverseResult newton = solve_inverse(statics, goals, statics.rest());
  EXPECT_EQ(newton.status, InverseStatus::reached);
  EXPECT_LT(3 * newton.equilibria, result.equilibria);
}

TEST(GradientMethod, DescendsAndSaysWhereItStopped) {
  const Model model = two_chambers();
  const Statics statics(model);
  const std::vector<Goal> goals{{PositionGoal{0, {45, 10, 30}}}};  // out of reach
  InverseOptions options = by_gradient(0.2);
  double last = goal_errors(model, goals, model.rest)[0];
  for (const int iterations : {1, 2, 4}) {
    options.max_iterations = iterations;
    const InverseResult result = solve_inverse(statics, goals, statics.rest(), options);
    EXPECT_EQ(result.status, InverseStatus::not_converged);
    EXPECT_NE(result.remark, "");
    EXPECT_LE(result.iterations, iterations);
    EXPECT_LE(result.errors_mm[0], last);
    last = result.errors_mm[0];
  }
  const InverseResult newton = solve_inverse(statics, goals, statics.rest());
  EXPECT_EQ(newton.status, InverseStatus::unreachable);
  EXPECT_LE(newton.errors_mm[0], last + 1e-6);
}

TEST(GradientMethod, CanBeInterrupted) {
  const Model model = two_chambers();
  const Statics statics(model);
  const std::vector<Goal> goals{{PositionGoal{0, {45, 10, 16}}}};
  int calls = 0;
  const InverseResult result =
      solve_inverse(statics, goals, statics.rest(), by_gradient(0.2), [&](const Progress&) { return ++calls < 12; });
  EXPECT_EQ(result.status, InverseStatus::interrupted);
  EXPECT_TRUE(result.equilibrium.state.positions.allFinite());
}

}  // namespace
}  // namespace softkin
