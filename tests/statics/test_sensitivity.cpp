#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/system.hpp>

#include "statics/sensitivity_samples.hpp"

/// Sensitivities of the physical formulation against differences of equilibria.

namespace softkin {

namespace {

using namespace testing;

void expect_same(const Sensitivity& a, const Sensitivity& b, double tolerance) {
  ASSERT_EQ(a.positions.size(), b.positions.size());
  EXPECT_EQ(a.regular, b.regular);
  for (std::size_t i = 0; i < a.positions.size(); ++i) EXPECT_LE(off_by(a.positions[i], b.positions[i]), tolerance);
  EXPECT_LE(off_by(a.multipliers, b.multipliers), tolerance);
}

void expect_zero(const Sensitivity& found, const Model& model) {
  EXPECT_FALSE(found.regular);
  ASSERT_EQ(found.positions.size(), model.actuators.size());
  for (const Points& positions : found.positions) {
    EXPECT_EQ(positions.rows(), model.rest.rows());
    EXPECT_TRUE(positions.isZero(0));
  }
  EXPECT_EQ(found.multipliers.rows(), static_cast<Index>(model.actuators.size()));
  EXPECT_TRUE(found.multipliers.isZero(0));
}

StaticsOptions anew() {
  StaticsOptions options = tight();
  options.reuse_factor = false;
  return options;
}

}  // namespace

TEST(Sensitivity, ChamberByVolume) {
  for (const double ratio : {1.0, 0.8, 1.5, 2.6}) expect_differences_at(bending_finger(), values({ratio}));
}

TEST(Sensitivity, ChamberByPressure) {
  RobotSpec spec = bending_finger();
  spec.actuators = {by_load(spec.actuators[0])};
  for (const double pressure : {0.0, -20.0, 60.0, 200.0}) expect_differences_at(spec, values({pressure}));
}

TEST(Sensitivity, ChamberWithinASurface) {
  RobotSpec spec = robot_with_bags({"bag"});
  for (const double ratio : {1.0, 1.3, 1.8}) expect_differences_at(spec, values({ratio}));
  spec.actuators = {by_load(spec.actuators[0])};
  for (const double pressure : {0.0, 100.0}) expect_differences_at(spec, values({pressure}));
}

/// At rest towards a pull.
TEST(Sensitivity, Cable) {
  RobotSpec spec = cable_beam();
  spec.actuators.pop_back();
  for (const double ratio : {1.0, 0.95, 0.7, 0.5}) expect_differences_at(spec, values({ratio}));
  spec.actuators = {by_load(spec.actuators[0])};
  for (const double tension : {0.0, 0.2, 1.5}) expect_differences_at(spec, values({tension}));
}

TEST(Sensitivity, Layer) {
  for (const Law law :
       {Law::neo_hookean, Law::st_venant_kirchhoff, Law::corotational, Law::yeoh, Law::gent, Law::ogden}) {
    RobotSpec spec = dea_strip();
    spec.materials[0].elastic = elastic(law, 1, 0.4);
    for (const double ratio : {1.0, 0.8, 1.3}) expect_differences_at(spec, values({ratio}));
  }
}

TEST(Sensitivity, QuadraticElements) {
  RobotSpec finger = bending_finger();
  finger.mesh = block_mesh({6, 3, 3}, {60, 12, 12});
  add_volume_region(finger.mesh, "chamber", [](const Vec3& p) {
    return p.x() > 9 && p.x() < 51 && p.y() > 4 && p.y() < 8 && p.z() > 4 && p.z() < 8;
  });
  finger.mesh_options.quadratic = true;
  finger.actuators.push_back(cable("tendon", {{0, 6, 11}, {30, 6, 11}, {60, 6, 11}}));
  expect_differences_at(finger, values({1.4, 0.93}));
  finger.actuators[0] = by_load(finger.actuators[0]);
  finger.actuators[1] = by_load(finger.actuators[1]);
  expect_differences_at(finger, values({30, 0.3}));
}

namespace {

/// A finger with a force at a point and one over its tip, both commanded, the second along two axes.
RobotSpec pushed_finger() {
  RobotSpec spec = bending_finger();
  const std::array<Vec3, 2> all{Vec3(-2, -2, -2), Vec3(2, 2, 2)}, some{Vec3(-1, 0.5, -1), Vec3(1, 0.5, 1)};
  spec.loads.forces = {{"poke", {Vec3(40, 3, 15), {}}, {0, 0, -0.1}, all},
                       {"tip", {std::string("x_high"), {}}, {0, 0.5, 0}, some}};
  return spec;
}

}  // namespace

TEST(Sensitivity, ForcesAtPlacesOfTheRobot) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = pushed_finger();
    if (quadratic) {
      spec.mesh = block_mesh({6, 3, 3}, {60, 12, 16});
      add_volume_region(spec.mesh, "chamber", [](const Vec3& p) {
        return p.x() > 9 && p.x() < 51 && p.y() > 4 && p.y() < 8 && p.z() > 5 && p.z() < 11;
      });
      spec.mesh_options.quadratic = true;
    }
    const Model model = compile(spec);
    ASSERT_EQ(model.actuators.size(), 6u);
    EXPECT_EQ(model.actuators[3].name, "poke_fz");
    EXPECT_EQ(model.actuators[3].rest, -0.1);
    EXPECT_EQ(model.actuators[5].name, "tip_fz");
    EXPECT_FALSE(model.actuators[5].as<ForceCommand>()->faces.empty());
    const Statics statics(model);
    for (const Actuation& commands : {model.rest_actuation(), values({1.2, 0.3, -0.2, 0.5, 0.1, -0.3})})
      expect_differences(model, statics, solve_converged(statics, commands), 1e-6, {5e-4, 1e-3, 1e-2});
  }
}

/// As the same forces without a range.
TEST(Sensitivity, CommandedForcesDoAsOthers) {
  RobotSpec spec = pushed_finger();
  const Model commanded = compile(spec);
  const Equilibrium found = solve_converged(Statics(commanded), values({1.2, 0.3, -0.2, 0.5, 0.1, -0.3}));
  spec.loads.forces[0].force = {0.3, -0.2, 0.5};
  spec.loads.forces[1].force = {0.1, 0.5, -0.3};
  for (ForceSpec& force : spec.loads.forces) force.range.reset();
  const Model held = compile(spec);
  const Equilibrium expected = solve_converged(Statics(held), values({1.2}));
  EXPECT_LT((found.state.positions - expected.state.positions).cwiseAbs().maxCoeff(), 1e-6);
}

/// Bent by 163 degrees at a volume of 6, by 84 at 340 kPa.
TEST(Sensitivity, LargeBend) {
  RobotSpec spec = curling_finger();
  for (const bool by_pressure : {false, true}) {
    if (by_pressure) spec.actuators = {by_load(spec.actuators[0])};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium at = solve_converged(statics, values({by_pressure ? 340.0 : 6.0}));
    EXPECT_LT(marker_at(model, at)[2], -65);
    expect_differences(model, statics, at, 1e-6, {5e-3, 0, 0.2});
  }
  RobotSpec pulled = cable_beam();
  pulled.actuators = {by_load(pulled.actuators[0])};
  expect_differences_at(pulled, values({10}));  // 74 degrees; at half its length above: 158
}

TEST(Sensitivity, ManyActuatorsWithRigidRegionsLoadsAndADisplacedSupport) {
  const RobotSpec spec = crowded_robot();
  const Model model = compile(spec);
  const Statics statics(model);
  for (const Actuation& actuation : {values({1.0, 0, 1.0, 0.99, 0.01}), values({1.5, 40, 1.1, 0.9, 0.3})})
    expect_differences(model, statics, solve_converged(statics, actuation), 1e-6);
}

/// A rigid end that its support lets turn about one axis only.
TEST(Sensitivity, RigidRegionThatIsPartlyHeld) {
  RobotSpec spec = chambers_beam(2);
  spec.rigid.push_back({{Box{{42, 0, 0}, {48, 20, 20}}, {}}, "end"});
  FixedSpec ground{{Box{{42, 0, 0}, {48, 20, 0}}, {}}};
  ground.axes = {false, false, true};
  spec.fixed.push_back(ground);
  expect_differences_at(spec, values({1.4, 1.1}));
}

TEST(Sensitivity, ASlackCableChangesNothing) {
  RobotSpec spec = bending_finger();
  spec.actuators.push_back(cable("tendon", {{2, 6, 1}, {30, 6, 1}, {58, 6, 1}}));
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({1.5, 1.4}));
  ASSERT_EQ(at.state.multipliers[1], 0);
  const Sensitivity found = statics.sensitivity(at.state);
  EXPECT_TRUE(found.regular);
  EXPECT_TRUE(found.positions[1].isZero(0));
  EXPECT_TRUE(found.multipliers.col(1).isZero(0));
  EXPECT_TRUE(found.multipliers.row(1).isZero(0));
  const Difference expected = central(statics, at.state, 0, 1e-3);
  EXPECT_LT(off_by(found.positions[0], expected.positions), 1e-6);
  EXPECT_LT(off_by(found.multipliers.col(0), expected.multipliers), 1e-6);
}

/// As long as its path, without tension: shortened, it pulls.
TEST(Sensitivity, ACableOnTheVergeIsTaut) {
  RobotSpec spec = bending_finger();
  spec.actuators.push_back(cable("tendon", {{2, 6, 1}, {30, 6, 1}, {58, 6, 1}}));
  const Model model = compile(spec);
  const Statics statics(model);
  Equilibrium at = solve_converged(statics, values({1.5, 1.4}));
  at.state.actuation[1] = achieved_ratio(model, model.actuators[1], at.state.positions);
  const Sensitivity found = statics.sensitivity(at.state);
  const Difference expected = one_sided(statics, at.state, 1, -1e-3);
  EXPECT_LT(off_by(found.positions[1], expected.positions), 1e-6);
  EXPECT_LT(off_by(found.multipliers.col(1), expected.multipliers), 1e-6);
  EXPECT_LT(found.multipliers(1, 1), 0);
}

/// On the far side of the pressure maximum the stiffness has a negative eigenvalue that the volume takes away.
TEST(Sensitivity, WhereOnlyTheConstraintMakesItStable) {
  RobotSpec spec = chambers_beam(2);
  spec.materials[0].elastic = elastic(Law::mooney_rivlin, 0.1, 0.45);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({7.0, 1.1}));
  expect_differences(model, statics, at, 1e-6);
}

/// Wherever the factor was made, and by a new one: the same.
TEST(Sensitivity, DoesNotDependOnTheFactor) {
  const Model model = compile(crowded_robot());
  const Statics statics(model);
  StaticsOptions loose;
  loose.step_tolerance_mm = 1e-3;
  Equilibrium at = statics.solve(values({1.2, 10, 1.1, 0.95, 0.1}), statics.rest(), loose);
  for (const double volume : {1.3, 2.2}) {
    at = statics.solve(values({volume, 30, 1.1, 0.93, 0.2}), at.state, loose);
    ASSERT_EQ(at.report.status, Status::converged);
    const Sensitivity reused = statics.sensitivity(at.state);
    expect_same(reused, statics.sensitivity(at.state, anew()), 1e-8);
    expect_same(statics.sensitivity(at.state), reused, 1e-8);  // now with the factor of the shape itself
  }
}

TEST(Sensitivity, DoesNotDependOnThreads) {
  const Model model = compile(crowded_robot());
  Sensitivity alone;
  for (const int threads : {1, 2, 3}) {
    const Statics statics(model);
    StaticsOptions options = tight();
    options.threads = threads;
    const Equilibrium at = statics.solve(values({1.4, 20, 1.1, 0.95, 0.1}), statics.rest(), options);
    const Sensitivity found = statics.sensitivity(at.state, options);
    if (threads == 1) alone = found;
    expect_same(found, alone, 0);
  }
}

/// A sensitivity that is computed between two solves does not change the next equilibrium.
TEST(Sensitivity, LeavesSolvesAlone) {
  const Model model = compile(chambers_beam(2));
  const Statics statics(model), other(model);
  State state = statics.rest(), undisturbed = state;
  for (const double volume : {1.2, 1.5, 1.6}) {
    (void)statics.sensitivity(solve_converged(statics, values({volume, 1.0})).state);
    const Equilibrium found = statics.solve(values({volume, 1.1}), state, tight());
    (void)statics.sensitivity(found.state);
    const Equilibrium expected = other.solve(values({volume, 1.1}), undisturbed, tight());
    EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-8);
    state = found.state;
    undisturbed = expected.state;
  }
}

TEST(Sensitivity, WithoutActuators) {
  RobotSpec spec = cable_beam();
  spec.actuators.clear();
  spec.loads.forces.push_back({"payload", {std::string("x_high"), {}}, {0, 0, -0.01}});
  const Model model = compile(spec);
  const Statics statics(model);
  Equilibrium at = solve_converged(statics, {});
  const Sensitivity found = statics.sensitivity(at.state);
  EXPECT_TRUE(found.regular);
  EXPECT_TRUE(found.positions.empty());
  EXPECT_EQ(found.multipliers.size(), 0);
}

/// Constraints that depend on each other, or that nothing can move for.
TEST(Sensitivity, DependentConstraintsAreNotRegular) {
  RobotSpec spec = cable_beam();
  spec.actuators[1] = spec.actuators[0];
  spec.actuators[1].name = "twin";
  const Model twins = compile(spec);
  const Statics statics(twins);
  Equilibrium at = solve_converged(statics, values({0.9, 0.9}));
  at.state.multipliers.setConstant(at.state.multipliers.sum() / 2);
  expect_zero(statics.sensitivity(at.state), twins);
  expect_zero(statics.sensitivity(at.state, anew()), twins);

  RobotSpec held = bending_finger();
  held.fixed = {{{Box{{-1, -1, -1}, {100, 100, 100}}, {}}}};
  const Model stiff = compile(held);
  const Statics stiff_statics(stiff);
  expect_zero(stiff_statics.sensitivity(solve_converged(stiff_statics, values({1.0})).state), stiff);
}

/// A beam pressed shorter until its stiffness is singular, to the last digit: there is no derivative.
TEST(Sensitivity, SingularStiffnessIsNotRegular) {
  RobotSpec spec = cable_beam();
  spec.actuators = {by_load(cable("askew", {{0, 3, 9}, {30, 4, 8}, {60, 2, 7}}))};  // loads every mode
  const Model model = compile(spec);
  const physical::System system(model);
  physical::Workspace work(system);
  Team team(1);
  physical::Iterate at{model.rest, Eigen::VectorXd::Zero(1)};
  const physical::LoadState load_state{values({0}), 1};
  const auto press = [&](double length) { at.positions = model.rest * Eigen::Vector3d(length, 1, 1).asDiagonal(); };
  const auto modes = [&] {
    physical::Balance balance;
    system.evaluate(at, load_state, {false}, work, balance, team);
    return system.factorise(at, load_state, {false}, balance, {}, work, team);
  };
  double unstable = 0.5, stable = 1;
  press(unstable);
  ASSERT_GT(modes(), 0);
  for (int i = 0; i < 60; ++i) {
    press(0.5 * (unstable + stable));
    (modes() > 0 ? unstable : stable) = 0.5 * (unstable + stable);
  }
  const Statics statics(model);
  State state{{}, load_state.actuation, Eigen::VectorXd::Zero(1)};
  for (const double length : {stable, unstable}) {
    press(length);
    state.positions = at.positions;
    expect_zero(statics.sensitivity(state), model);
  }
  for (const double length : {stable + 1e-3, unstable - 1e-3}) {
    press(length);
    state.positions = at.positions;
    EXPECT_TRUE(statics.sensitivity(state).regular);
  }
}

TEST(Sensitivity, RefusesWhatItCannotKnow) {
  const Model model = compile(cable_beam());
  const Statics statics(model);
  const State good = solve_converged(statics, values({0.9, 1.0})).state;
  const auto refused = [&](const std::function<void(State&)>& spoil) {
    State state = good;
    spoil(state);
    EXPECT_THROW((void)statics.sensitivity(state), InvalidInput);
  };
  refused([](State& s) { s.actuation.resize(0); });
  refused([](State& s) { s.multipliers.resize(0); });
  refused([](State& s) { s.actuation = values({0.9}); });
  refused([](State& s) { s.positions.conservativeResize(3, 3); });
  refused([](State& s) { s.positions(4, 1) = NAN; });
  refused([](State& s) { s.multipliers[0] = INFINITY; });
  refused([](State& s) { s.load_factor = NAN; });
  StaticsOptions options;
  options.threads = -1;
  EXPECT_THROW((void)statics.sensitivity(good, options), InvalidInput);
}

/// Earlier solves with the same object have no influence where reuse is disabled.
TEST(Sensitivity, WithoutReuseNothingDependsOnEarlierSolves) {
  const Model model = compile(crowded_robot());
  const Statics used(model), fresh(model);
  State state = used.rest();
  for (const Actuation& earlier :
       {values({1.6, 50, 0.9, 0.85, 0.5}), values({1.0, 0, 1.3, 1.2, 0}), values({1.2, 10, 1.05, 0.97, 0.1})}) {
    (void)used.sensitivity(state = used.solve(earlier, state, tight()).state);
  }
  state = used.solve(values({1.21, 11, 1.05, 0.965, 0.1}), state, tight()).state;
  const Sensitivity reused = used.sensitivity(state), expected = fresh.sensitivity(state, anew());
  EXPECT_NE(reused.positions[0], expected.positions[0]);  // another factor, other rounding
  expect_same(used.sensitivity(state, anew()), expected, 0);
  state = used.solve(values({1.22, 11, 1.05, 0.965, 0.1}), state, tight()).state;
  const Actuation requested = values({1.25, 12, 1.05, 0.96, 0.1});
  for (const bool from_rest : {false, true}) {
    const State start = from_rest ? used.rest() : state;
    const Equilibrium a = used.solve(requested, start, anew()), b = fresh.solve(requested, start, anew());
    EXPECT_EQ(a.state.positions, b.state.positions);
    EXPECT_EQ(a.state.multipliers, b.state.multipliers);
    EXPECT_EQ(a.report.iterations, b.report.iterations);
    EXPECT_EQ(a.report.factorisations, b.report.factorisations);
    expect_same(used.sensitivity(a.state, anew()), fresh.sensitivity(b.state, anew()), 0);
  }
}

}  // namespace softkin
