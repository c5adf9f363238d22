#include <softkin/statics/deformation.hpp>

#include "statics/physical_samples.hpp"

/// Limits of existence: a balloon whose pressure passes a maximum.

namespace softkin {

namespace {

using namespace testing;

/// A ball of rubber, 15 mm in radius, around a hollow of 10 mm.
RobotSpec balloon(double modulus, bool quadratic) {
  RobotSpec spec = hollow_ball(6, 30, 10);
  spec.materials[0].elastic = elastic(Law::mooney_rivlin, modulus, 0.45);
  spec.mesh_options.quadratic = quadratic;
  spec.actuators = {air("hollow", 0.5, 12)};
  return spec;
}

/// Pressure in a thick incompressible neo-Hookean shell (c10 = mu / 2), over mu: Green and Zerna; a: its inner radius
/// over that at rest.
double shell_pressure(double a, double inner_over_outer) {
  const double b = std::cbrt(1 + (a * a * a - 1) * std::pow(inner_over_outer, 3));
  const auto f = [](double stretch) { return 4 / stretch + std::pow(stretch, -4); };
  return (f(b) - f(a)) / 2;
}

}  // namespace

/// Volume control goes through the maximum, and down on the other side. The shell is not quite incompressible, and its
/// mesh is coarse: 12 % of the thick incompressible sphere.
TEST(PhysicalLimits, VolumeControlPassesTheMaximumOfAPressure) {
  const double modulus = 0.03;
  const Model model = compile(balloon(modulus, true));
  const Statics statics(model);
  State state = statics.rest();
  double most = 0, last = 0;
  for (const double ratio : {1.5, 2.5, 4.0, 6.0, 9.0}) {
    const Equilibrium found = statics.solve(values({ratio}), state);
    ASSERT_EQ(found.report.status, Status::converged) << ratio << ": " << found.report.remark;
    state = found.state;
    last = state.multipliers[0];
    most = std::max(most, last);
    const double expected = 1e3 * modulus / 2.9 * shell_pressure(std::cbrt(ratio), 10.0 / 15);
    EXPECT_NEAR(last, expected, 0.12 * expected) << ratio;
  }
  EXPECT_LT(last, 0.95 * most);
  // in one call too
  const Equilibrium once = solve_converged(statics, values({9.0}));
  EXPECT_NEAR(once.state.multipliers[0], last, 1e-5 * last);
}

/// Pressure control ends at the maximum, reports it, and leaves the last good shape.
TEST(PhysicalLimits, PressureControlEndsAtTheMaximum) {
  const double modulus = 0.03;
  const Model by_volume = compile(balloon(modulus, false));
  const Statics volume_statics(by_volume);
  double most = 0;
  State state = volume_statics.rest();
  for (const double ratio : {3.0, 3.5, 4.0, 4.5, 5.0, 5.5}) {
    state = volume_statics.solve(values({ratio}), state).state;
    most = std::max(most, state.multipliers[0]);
  }
  RobotSpec spec = balloon(modulus, false);
  spec.actuators[0] = by_load(spec.actuators[0]);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium below = statics.solve(values({0.98 * most}), statics.rest());
  EXPECT_EQ(below.report.status, Status::converged) << below.report.remark;
  for (const double factor : {1.05, 1.5}) {
    const Equilibrium beyond = statics.solve(values({factor * most}), statics.rest());
    EXPECT_EQ(beyond.report.status, Status::limit);
    EXPECT_LT(beyond.report.iterations, 150);
    // how much it can take, to many digits, and what to do
    const std::string& remark = beyond.report.remark;
    const std::size_t at = remark.find("the pressure of chamber 'hollow' has its maximum there, ");
    ASSERT_EQ(at, 0u) << remark;
    EXPECT_NE(remark.find("command its volume (control: volume) to go on beyond it"), std::string::npos) << remark;
    const double reported = std::stod(remark.substr(remark.find("there, ") + 7));
    EXPECT_GE(reported, most * (1 - 1e-5));
    EXPECT_LT(reported, 1.002 * most);
    const double volume = std::stod(remark.substr(remark.find(" kPa at ") + 8));
    const Equilibrium there = volume_statics.solve(values({volume}), volume_statics.rest());
    EXPECT_NEAR(there.state.multipliers[0], reported, 1e-4 * reported);
    for (const double beside : {0.97, 1.03})
      EXPECT_LT(volume_statics.solve(values({beside * volume}), there.state).state.multipliers[0], reported);
    EXPECT_TRUE(beyond.state.positions.allFinite());
    const double reached = beyond.state.actuation[0];
    EXPECT_NEAR(reached, factor * most * beyond.report.reached, 1e-9 * most);
    EXPECT_LT(reached, 1.002 * most);
    EXPECT_GT(reached, 0.98 * most);
    // the shape is the equilibrium of what was reached
    const Equilibrium again = statics.solve(values({reached}), beyond.state, tight());
    EXPECT_EQ(again.report.status, Status::converged);
    EXPECT_LT(distance(again.state.positions, beyond.state.positions), 1e-3);
    EXPECT_GT(achieved_ratio(by_volume, by_volume.actuators[0], beyond.state.positions), 2);
  }
}

/// A path along which several loads change ends at the maximum, too, and the report suggests what to command instead.
TEST(PhysicalLimits, SeveralLoadsEndAtTheMaximum) {
  RobotSpec spec = balloon(0.03, false);
  spec.actuators = {by_load(spec.actuators[0]), by_load(cable("tendon", {{0, 0, 12.5}, {12.5, 0, 0}}))};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium beyond = statics.solve(values({100, 1e-4}), statics.rest());
  EXPECT_EQ(beyond.report.status, Status::limit);
  EXPECT_EQ(beyond.report.remark,
            "beyond this point no equilibrium follows: the curve of equilibria turns back there; --stable (in Python "
            "stable=True) follows it to the next stable shape that carries more, where there is one; where a "
            "pressure has its "
            "maximum, command volumes (control: volume) and lengths (control: length) to go on beyond it");
  // 230 and 556 where the limit was bisected by steps beyond it
  EXPECT_LT(beyond.report.iterations, 120);
  EXPECT_LT(beyond.report.factorisations, 200);
  spec.actuators.pop_back();
  const Model alone = compile(spec);
  const Statics one(alone);
  const double most = one.solve(values({100}), one.rest()).state.actuation[0];
  EXPECT_NEAR(beyond.state.actuation[0], most, 0.01 * most);
}

/// Along the curve of equilibria, too, an iteration is recorded with its step in mm and its residual in N: forces that
/// are 1024 times as large, as are all moduli, take the same steps, bit by bit, and have 1024 times the residual.
TEST(PhysicalLimits, RecordsStepsInMillimetresAndResidualsInNewtons) {
  const auto history = [](double factor) {
    RobotSpec spec = balloon(factor * 0.03, false);
    spec.actuators = {by_load(spec.actuators[0]), by_load(cable("tendon", {{0, 0, 12.5}, {12.5, 0, 0}}))};
    spec.actuators[0].high *= factor;
    spec.actuators[1].high *= factor;
    const Model model = compile(spec);
    const Statics statics(model);
    StaticsOptions options;
    options.keep_history = true;
    const Equilibrium found = statics.solve(values({factor * 100, factor * 1e-4}), statics.rest(), options);
    EXPECT_NE(found.report.remark.find("turns back there"), std::string::npos) << found.report.remark;
    return found.report.history;
  };
  const std::vector<IterationRecord> soft = history(1), hard = history(1024);
  ASSERT_EQ(soft.size(), hard.size());
  for (std::size_t i = 0; i < soft.size(); ++i) {
    EXPECT_NEAR(hard[i].step_mm, soft[i].step_mm, 1e-6 * soft[i].step_mm) << i;
    EXPECT_NEAR(hard[i].gradient_norm, 1024 * soft[i].gradient_norm, 1e-6 * hard[i].gradient_norm) << i;
  }
}

/// Slightly less than the loads that several actuators reach together is carried, slightly more is not, each solved
/// from rest.
TEST(PhysicalLimits, TheCurveTurnsBackWhereNoMoreIsBorne) {
  RobotSpec spec = balloon(0.03, false);
  spec.actuators = {by_load(spec.actuators[0]), by_load(cable("tendon", {{0, 0, 12.5}, {12.5, 0, 0}}))};
  spec.loads.gravity = Vec3(0, 0, -9.81);
  spec.materials[0].density = 1070;
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium most = statics.solve(values({60, 0.3}), statics.rest());
  ASSERT_EQ(most.report.status, Status::limit) << most.report.remark;
  EXPECT_NE(most.report.remark.find("turns back there"), std::string::npos) << most.report.remark;
  EXPECT_LT(most.report.iterations, 80);
  const auto borne = [&](double fraction) {
    return statics.solve(fraction * most.state.actuation, statics.rest()).report.status == Status::converged;
  };
  EXPECT_TRUE(borne(0.999));
  EXPECT_FALSE(borne(1.001));
}

/// A shallow arch under a weight at its top snaps through: just below the limit load the weight is carried; just above
/// it, the last good shape is reported with the load factor it carries, and the arch still stands.
TEST(PhysicalLimits, AnArchSnaps) {
  RobotSpec spec = physical_robot(block_mesh({20, 1, 1}, {100, 10, 2}));
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
    spec.mesh.vertices(v, 2) += 6 * std::sin(EIGEN_PI * spec.mesh.vertices(v, 0) / 100);
  spec.mesh_options.quadratic = true;
  spec.fixed.push_back({{std::string("x_high"), {}}});
  spec.markers = {{"top", {Vec3(50, 5, 7), {}}}};
  double last_top = 7;
  for (const double weight : {0.005, 0.0095}) {
    spec.loads.forces = {{"weight", {Vec3(50, 5, 7), {}}, {0, 0, -weight}}};
    const Model model = compile(spec);
    const Statics statics(model);
    const double top = marker_at(model, solve_converged(statics, {}))[2];
    EXPECT_LT(top, last_top);
    EXPECT_GT(top, 4);
    last_top = top;
  }
  spec.loads.forces = {{"weight", {Vec3(50, 5, 7), {}}, {0, 0, -0.01}}};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve({}, statics.rest());
  EXPECT_EQ(found.report.status, Status::limit);
  EXPECT_FALSE(found.report.remark.empty());
  EXPECT_GT(0.01 * found.report.reached, 0.0095);
  EXPECT_GT(marker_at(model, found)[2], 4);
  EXPECT_LT(marker_at(model, found)[2], last_top);
  // and, with `stable`, up to the shape that carries the weight again, as when it is pressed through first
  StaticsOptions stable;
  stable.stable = true;
  const Equilibrium through = statics.solve({}, statics.rest(), stable);
  ASSERT_EQ(through.report.status, Status::converged) << through.report.remark;
  EXPECT_EQ(through.report.physical.unstable_modes, 0);
  EXPECT_LT(marker_at(model, through)[2], 0);
  EXPECT_GT(through.report.physical.snapped_mm, 5);
  EXPECT_NEAR(through.report.physical.snapped_from, found.report.reached, 1e-3);
  spec.loads.forces[0].force *= 2;
  const Model pressed = compile(spec);
  const Statics under_more(pressed);
  const Equilibrium below = statics.solve({}, under_more.solve({}, under_more.rest(), stable).state);
  EXPECT_EQ(below.report.status, Status::converged);
  EXPECT_LT(largest_move(below.state.positions, through.state.positions), 1e-4);
}

/// Where the law knows no inversion, no accepted shape is inverted, not even at a limit.
TEST(PhysicalLimits, NoShapeIsInvertedWhereTheLawForbidsIt) {
  RobotSpec spec = physical_robot(block_mesh({6, 2, 2}, {30, 10, 10}));
  spec.materials[0].elastic = elastic(Law::yeoh, 1, 0.45);
  spec.loads.forces.push_back({"push", {std::string("x_high"), {}}, {-5000, 0, 0}});
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve({}, statics.rest());
  const ElementDeformation shape = deformation_of(model, found.state.positions);
  for (const double ratio : shape.volume_ratio) EXPECT_GT(ratio, 0);
  EXPECT_NE(found.report.status, Status::converged);
  EXPECT_FALSE(found.report.remark.empty());
}

/// Constraints that cannot be satisfied are not reported as satisfied: of a body that cannot move, and different
/// volumes of two chambers that are one.
TEST(PhysicalLimits, AConstraintThatCannotBeMet) {
  RobotSpec stiff = bending_finger();
  stiff.actuators.push_back(cable("tendon", {{0, 6, 14}, {58, 6, 14}}));
  stiff.fixed = {{{Box{{-1, -1, -1}, {100, 100, 100}}, {}}}};
  const Model stiff_model = compile(stiff);
  const Statics stiff_statics(stiff_model);
  EXPECT_EQ(solve_converged(stiff_statics, values({1.0, 1.0})).report.status, Status::converged);
  EXPECT_EQ(solve_converged(stiff_statics, values({1.0, 1.2})).report.status, Status::converged);
  for (const Actuation& requested : {values({1.2, 1.0}), values({1.0, 0.9}), values({0.9, 0.8})}) {
    const Equilibrium found = stiff_statics.solve(requested, stiff_statics.rest());
    EXPECT_EQ(found.report.status, Status::limit);
    EXPECT_FALSE(found.report.remark.empty());
    EXPECT_LT(distance(found.state.positions, stiff_model.rest), 1e-12);
  }
  const Model model = compile(robot_with_bags({"bag", "twin"}));
  const Statics statics(model);
  EXPECT_EQ(statics.solve(values({1.3, 1.1}), statics.rest()).report.status, Status::limit);
  const Equilibrium same = solve_converged(statics, values({1.3, 1.3}));
  EXPECT_NEAR(achieved_ratio(model, model.actuators[0], same.state.positions), 1.3, 1e-7);
}

}  // namespace softkin
