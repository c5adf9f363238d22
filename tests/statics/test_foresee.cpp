#include <gtest/gtest.h>

#include <softkin/core/error.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

struct Case {
  const char* name;
  RobotSpec spec;
  Actuation at, way;
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

Points foreseen(const Statics& statics, const Equilibrium& from, const Actuation& to) {
  (void)statics.sensitivity(from.state, tight());
  Points positions;
  EXPECT_TRUE(statics.foresee(to, from.state, tight(), positions));
  return positions;
}

}  // namespace

/// Half the way, an eighth of the error; and far less of it than a tangent has.
TEST(Foresee, IsOfSecondOrder) {
  for (const Case& c : cases()) {
    const Model model = compile(c.spec);
    const Statics statics(model);
    const Equilibrium from = settled(statics, c.at);
    double before = 0;
    for (const double share : {1.0, 0.5, 0.25}) {
      const Actuation to = c.at + share * c.way;
      const Points expected = Statics(model).solve(to, from.state, tight()).state.positions;
      const Sensitivity slopes = statics.sensitivity(from.state, tight());
      Points tangent = from.state.positions;
      for (Index a = 0; a < c.way.size(); ++a) tangent += share * c.way[a] * slopes.positions[a];
      const double error = distance(foreseen(statics, from, to), expected);
      EXPECT_LT(error, 0.3 * distance(tangent, expected)) << c.name << " " << share;
      if (before > 0) {
        EXPECT_NEAR(before / error, 8, 2) << c.name << " " << share;
      }
      before = error;
    }
  }
}

/// A solve that begins with what was foreseen comes to the same shape; also to an actuation near by.
TEST(Foresee, SolvesBeginWithIt) {
  for (const Case& c : cases()) {
    const Model model = compile(c.spec);
    const Statics statics(model);
    const Equilibrium from = settled(statics, c.at);
    for (const double share : {0.5, 0.49}) {
      const Actuation to = c.at + share * c.way;
      const Equilibrium expected = Statics(model).solve(to, from.state, tight());
      (void)foreseen(statics, from, c.at + 0.5 * c.way);
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

TEST(Foresee, SaysWhereItDoesNot) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const Equilibrium from = settled(statics, Actuation::Constant(1, 1.2));
  Points positions;
  const Actuation to = Actuation::Constant(1, 1.3);
  EXPECT_FALSE(statics.foresee(to, from.state, tight(), positions));  // no derivative
  (void)statics.sensitivity(from.state, tight());
  EXPECT_TRUE(statics.foresee(to, from.state, tight(), positions));
  StaticsOptions fresh = tight();
  fresh.reuse_factor = false;
  EXPECT_FALSE(statics.foresee(to, from.state, fresh, positions));
  EXPECT_THROW((void)statics.foresee(Actuation::Constant(1, 99), from.state, tight(), positions), InvalidInput);

  const Model shapes = compile(finger_robot(false));
  const Statics of_shapes(shapes);
  const Equilibrium shape = of_shapes.solve(shapes.rest_actuation(), of_shapes.rest());
  (void)of_shapes.sensitivity(shape.state);
  EXPECT_FALSE(of_shapes.foresee(shapes.rest_actuation(), shape.state, {}, positions));
}

}  // namespace softkin
