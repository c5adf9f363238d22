#include "statics/physical_samples.hpp"

/// Pressures and tensions are the slopes of the energy in what the actuators hold: dE/dV and -dE/dL.

namespace softkin {

namespace {

using namespace testing;

/// Slope of the energy of equilibria in one actuation, by central differences, over the measure at rest.
double energy_slope(const Model& model, const Statics& statics, const Equilibrium& at, Index actuator) {
  const double reach = 1e-3;
  double energies[2];
  for (int side = 0; side < 2; ++side) {
    Actuation actuation = at.actuation;
    actuation[actuator] += side == 0 ? reach : -reach;
    const Equilibrium found = statics.solve(actuation, at.state, tight());
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    energies[side] = found.report.energy;
  }
  return (energies[0] - energies[1]) / (2 * reach * model.actuators[actuator].rest_measure);
}

void expect_slopes(const RobotSpec& spec, const Actuation& actuation) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, actuation);
  for (Index a = 0; a < actuation.size(); ++a) {
    const bool cable = model.actuators[a].is<CableDrive>();
    const double force = cable ? -found.state.multipliers[a] : 1e-3 * found.state.multipliers[a];  // kPa to MPa
    EXPECT_GT(std::abs(force), 1e-4);
    EXPECT_NEAR(force, energy_slope(model, statics, found, a), 1e-5 * std::abs(force)) << "actuator " << a;
  }
}

}  // namespace

TEST(PhysicalMultipliers, PressureOfAChamber) {
  for (const Law law : all_laws) {
    SCOPED_TRACE(static_cast<int>(law));
    RobotSpec spec = bending_finger();
    spec.materials[0].elastic = elastic(law, 1, 0.4);
    expect_slopes(spec, values({1.5}));
  }
  expect_slopes(bending_finger(), values({0.7}));
}

TEST(PhysicalMultipliers, TensionOfACable) {
  RobotSpec spec = cable_beam();
  spec.actuators.pop_back();
  expect_slopes(spec, values({0.85}));
}

TEST(PhysicalMultipliers, OfOrder2) {
  RobotSpec spec = bending_finger();
  spec.mesh_options.quadratic = true;
  expect_slopes(spec, values({1.3}));
}

/// All at once, with weight and a payload, a rigid end, and a support that is displaced.
TEST(PhysicalMultipliers, OfManyTogether) {
  RobotSpec spec = chambers_beam(3);
  spec.actuators.push_back(cable("tendon", {{0, 10, 19}, {24, 10, 19}, {48, 10, 19}}));
  spec.materials[0].density = 1200;
  spec.loads.gravity = {0, 0, -9810e-3};
  spec.loads.forces.push_back({"payload", {std::string("x_high"), {}}, {0, 0.01, -0.02}});
  spec.rigid.push_back({{Box{{42, 0, 0}, {48, 20, 20}}, {}}, "end"});
  spec.fixed[0].displacement = {0, 0, 2};
  expect_slopes(spec, values({1.4, 1.2, 1.05, 0.93}));
}

TEST(PhysicalMultipliers, OfAnEmbeddedSurface) {
  expect_slopes(robot_with_bags({"bag"}), values({1.3}));
}

/// Commanded by the multiplier that was found, the robot takes the same shape.
TEST(PhysicalMultipliers, LoadControlGivesTheSameShape) {
  for (const bool cables : {false, true}) {
    const RobotSpec spec = cables ? cable_beam() : chambers_beam(2);
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, cables ? values({0.9, 0.97}) : values({1.6, 1.2}));
    RobotSpec loaded = spec;
    for (ActuatorSpec& a : loaded.actuators) a = by_load(a);
    const Model loaded_model = compile(loaded);
    const Statics loaded_statics(loaded_model);
    const Actuation loads = found.state.multipliers;
    EXPECT_GT(loads.cwiseAbs().minCoeff(), 1e-4);
    const Equilibrium same = solve_converged(loaded_statics, loads);
    EXPECT_LT(distance(same.state.positions, found.state.positions), 1e-7);
    EXPECT_LT((same.state.multipliers - loads).norm(), 1e-12 * loads.norm());
    // one of each
    loaded.actuators[0] = spec.actuators[0];
    const Model mixed_model = compile(loaded);
    const Statics mixed_statics(mixed_model);
    const Equilibrium mixed = solve_converged(mixed_statics, values({found.actuation[0], loads[1]}));
    EXPECT_LT(distance(mixed.state.positions, found.state.positions), 1e-7);
    EXPECT_NEAR(mixed.state.multipliers[0], loads[0], 1e-7 * std::abs(loads[0]));
  }
}

/// E scales forces but not shapes; scaling by a power of two scales every number of the path exactly.
TEST(PhysicalMultipliers, ScaleWithTheModulus) {
  for (const Law law : {Law::neo_hookean, Law::yeoh}) {
    RobotSpec soft = bending_finger(), hard = bending_finger();
    soft.materials[0].elastic = elastic(law, 0.02, 0.4);
    hard.materials[0].elastic = elastic(law, std::ldexp(0.02, 17), 0.4);
    const Model soft_model = compile(soft), hard_model = compile(hard);
    const Statics soft_statics(soft_model), hard_statics(hard_model);
    const Equilibrium a = solve_converged(soft_statics, values({1.8})),
                      b = solve_converged(hard_statics, values({1.8}));
    EXPECT_LT(distance(a.state.positions, b.state.positions), 1e-7);
    EXPECT_NEAR(b.state.multipliers[0] / a.state.multipliers[0], std::ldexp(1.0, 17), 1e-3);
    EXPECT_EQ(a.report.iterations, b.report.iterations);
  }
}

}  // namespace softkin
