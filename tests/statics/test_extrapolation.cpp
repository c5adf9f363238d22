#include <gtest/gtest.h>

#include <softkin/core/error.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

struct Case {
  const char* name;
  RobotSpec spec;
  Actuation at, path;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"chamber", bending_finger(), Actuation::Constant(1, 1.5), Actuation::Constant(1, 0.2)});
  all.push_back(
      {"chambers", chambers_beam(2), Actuation(Eigen::Vector2d(1.3, 1.1)), Actuation(Eigen::Vector2d(-0.1, 0.15))});
  all.push_back(
      {"cables", cable_beam(), Actuation(Eigen::Vector2d(0.9, 0.95)), Actuation(Eigen::Vector2d(-0.02, 0.01))});
  RobotSpec loaded = bending_finger();
  loaded.actuators = {by_load(loaded.actuators[0])};
  all.push_back({"pressure", loaded, Actuation::Constant(1, 200), Actuation::Constant(1, 40)});
  return all;
}

Points extrapolated(const Statics& statics, const Equilibrium& from, const Actuation& to) {
  (void)statics.sensitivity(from.state, tight());
  Points positions;
  EXPECT_TRUE(statics.extrapolate(to, from.state, tight(), positions));
  return positions;
}

}  // namespace

/// Half the step has an eighth of the error, which is far smaller than that of a tangent predictor.
TEST(Extrapolation, IsOfSecondOrder) {
  for (const Case& c : cases()) {
    const Model model = compile(c.spec);
    const Statics statics(model);
    const Equilibrium from = solve_converged(statics, c.at);
    double before = 0;
    for (const double fraction : {1.0, 0.5, 0.25}) {
      const Actuation to = c.at + fraction * c.path;
      const Points expected = Statics(model).solve(to, from.state, tight()).state.positions;
      const Sensitivity slopes = statics.sensitivity(from.state, tight());
      Points tangent = from.state.positions;
      for (Index a = 0; a < c.path.size(); ++a) tangent += fraction * c.path[a] * slopes.positions[a];
      const double error = distance(extrapolated(statics, from, to), expected);
      EXPECT_LT(error, 0.3 * distance(tangent, expected)) << c.name << " " << fraction;
      if (before > 0) {
        EXPECT_NEAR(before / error, 8, 2) << c.name << " " << fraction;
      }
      before = error;
    }
  }
}

/// A solve that starts from an extrapolation converges to the same shape, also for an actuation nearby.
TEST(Extrapolation, SolvesBeginWithIt) {
  for (const Case& c : cases()) {
    const Model model = compile(c.spec);
    const Statics statics(model);
    const Equilibrium from = solve_converged(statics, c.at);
    for (const double fraction : {0.5, 0.49}) {
      const Actuation to = c.at + fraction * c.path;
      const Equilibrium expected = Statics(model).solve(to, from.state, tight());
      (void)extrapolated(statics, from, c.at + 0.5 * c.path);
      const Equilibrium found = statics.solve(to, from.state, tight());
      ASSERT_EQ(found.report.status, Status::converged) << c.name;
      EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-8) << c.name;
      EXPECT_LT((found.state.multipliers - expected.state.multipliers).norm(),
                1e-8 * expected.state.multipliers.norm());
      const auto steps = [](const SolveReport& report) { return report.iterations + 5 * report.factorisations; };
      EXPECT_LT(steps(found.report), steps(expected.report)) << c.name;
      ASSERT_EQ(statics.solve(c.at, found.state, tight()).report.status, Status::converged);
    }
  }
}

TEST(Extrapolation, SaysWhereItDoesNot) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const Equilibrium from = solve_converged(statics, Actuation::Constant(1, 1.2));
  Points positions;
  const Actuation to = Actuation::Constant(1, 1.3);
  EXPECT_FALSE(statics.extrapolate(to, from.state, tight(), positions));  // no derivative
  (void)statics.sensitivity(from.state, tight());
  EXPECT_TRUE(statics.extrapolate(to, from.state, tight(), positions));
  StaticsOptions fresh = tight();
  fresh.reuse_factor = false;
  EXPECT_FALSE(statics.extrapolate(to, from.state, fresh, positions));
  EXPECT_THROW((void)statics.extrapolate(Actuation::Constant(1, 99), from.state, tight(), positions), InvalidInput);

  const Model shapes = compile(finger_robot(false));
  const Statics of_shapes(shapes);
  const Equilibrium shape = of_shapes.solve(shapes.rest_actuation(), of_shapes.rest());
  (void)of_shapes.sensitivity(shape.state);
  EXPECT_FALSE(of_shapes.extrapolate(shapes.rest_actuation(), shape.state, {}, positions));
}

}  // namespace softkin
