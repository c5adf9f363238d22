#include <cmath>

#include "statics/physical_samples.hpp"

/// Beyond the maximum of a pressure or tension: the same equilibria as by volume or length, where the load falls.

namespace softkin {

namespace {

using namespace testing;

RobotSpec balloon(Law law, bool quadratic) {
  RobotSpec spec = hollow_ball(quadratic ? 4 : 6, 30, 10);
  spec.materials[0].elastic = elastic(law, 0.03, 0.45);
  if (law == Law::gent) spec.materials[0].elastic->jm = 15;
  spec.mesh_options.quadratic = quadratic;
  spec.actuators = {air("hollow", 0.5, 60)};
  return spec;
}

RobotSpec by_pressure(RobotSpec spec) {
  spec.actuators[0] = by_load(spec.actuators[0]);
  return spec;
}

StaticsOptions beyond(double ratio) {
  StaticsOptions options = tight(1e-8);
  options.beyond = ratio;
  return options;
}

}  // namespace

/// A path leads to a volume and reports its pressures; lower pressures requested from there give the same equilibria.
TEST(PostLimitPath, AlongTheVolumeAndBack) {
  for (const bool quadratic : {false, true}) {
    const RobotSpec spec = balloon(Law::neo_hookean, quadratic);
    const Model by_volume = compile(spec), model = compile(by_pressure(spec));
    const Statics volumes(by_volume), statics(model);
    const auto pressure_at = [&](double ratio, const State& near) {
      return volumes.solve(values({ratio}), near, tight(1e-8)).state.multipliers[0];
    };
    const Equilibrium far = statics.solve(values({100}), statics.rest(), beyond(8));
    ASSERT_EQ(far.report.status, Status::limit) << far.report.remark;
    EXPECT_NEAR(achieved_ratio(model, model.actuators[0], far.state.positions), 8, 1e-6);
    EXPECT_EQ(far.report.physical.unstable_modes, 1);
    const Equilibrium same = solve_converged(volumes, values({8.0}), tight(1e-8));
    EXPECT_LT(distance(same.state.positions, far.state.positions), 1e-4);
    EXPECT_NEAR(far.state.actuation[0], same.state.multipliers[0], 1e-6 * same.state.multipliers[0]);
    const auto& points = far.report.physical.branch.points;
    ASSERT_GE(points.size(), 8u);
    EXPECT_EQ(far.report.physical.branch.actuator, 0);
    double most = 0;
    for (std::size_t i = 0; i < points.size(); i += 3) {
      EXPECT_TRUE(i == 0 || points[i].measure > points[i - 1].measure);
      EXPECT_NEAR(points[i].load, pressure_at(points[i].measure, volumes.rest()), 1e-5 * same.state.multipliers[0]);
    }
    for (const auto& point : points) most = std::max(most, point.load);
    EXPECT_GT(most, 1.05 * same.state.multipliers[0]);
    State last = far.state;
    for (const double fraction : {0.3, 0.7, 0.5}) {
      const double requested = same.state.multipliers[0] + fraction * (most - same.state.multipliers[0]);
      const Equilibrium found = statics.solve(values({requested}), last, beyond(8));
      ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
      EXPECT_EQ(found.report.physical.unstable_modes, 1);
      const double ratio = achieved_ratio(model, model.actuators[0], found.state.positions);
      EXPECT_GT(ratio, 3);
      EXPECT_NEAR(pressure_at(ratio, same.state), requested, 1e-5 * requested);
      last = found.state;
    }
  }
}

/// A material of limited stretch stiffens and carries the pressure again: a solve beyond the maximum snaps to that
/// shape.
TEST(PostLimitPath, TheNextStableShapeCarriesTheLoad) {
  const RobotSpec spec = balloon(Law::gent, false);
  const Model by_volume = compile(spec), model = compile(by_pressure(spec));
  const Statics volumes(by_volume), statics(model);
  const Equilibrium limit_point = statics.solve(values({100}), statics.rest());
  ASSERT_EQ(limit_point.report.status, Status::limit);
  const double requested = 1.03 * limit_point.state.actuation[0];
  EXPECT_EQ(statics.solve(values({requested}), statics.rest()).report.status, Status::limit);
  StaticsOptions stable = tight(1e-8);
  stable.stable = true;
  for (const StaticsOptions& options : {stable, beyond(30)}) {
    const Equilibrium found = statics.solve(values({requested}), statics.rest(), options);
    ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
    EXPECT_EQ(found.report.physical.unstable_modes, 0);
    EXPECT_GT(found.report.physical.snapped_mm, 1);
    EXPECT_NEAR(found.report.physical.snapped_from, 1 / 1.03, 0.01);
    const double ratio = achieved_ratio(model, model.actuators[0], found.state.positions);
    EXPECT_GT(ratio, 1.5 * achieved_ratio(model, model.actuators[0], limit_point.state.positions));
    const Equilibrium same = solve_converged(volumes, values({ratio}));
    EXPECT_NEAR(same.state.multipliers[0], requested, 1e-5 * requested);
    EXPECT_LT(distance(same.state.positions, found.state.positions), 1e-3);
  }
}

TEST(PostLimitPath, WhatIsNotBeyondTheMaximumIsToldSo) {
  const Model model = compile(by_pressure(balloon(Law::neo_hookean, false)));
  const Statics statics(model);
  const Equilibrium before = statics.solve(values({100}), statics.rest(), beyond(1.2));
  EXPECT_EQ(before.report.status, Status::limit);
  EXPECT_NE(before.report.remark.find("; 1.2 times its volume is not beyond it"), std::string::npos)
      << before.report.remark;
  EXPECT_EQ(before.report.physical.unstable_modes, 0);
  for (const double wrong : {-1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW((void)statics.solve(values({1}), statics.rest(), beyond(wrong)), InvalidInput) << wrong;
}

}  // namespace softkin
