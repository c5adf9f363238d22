#include <cmath>

#include "statics/contact_scenes.hpp"
#include "statics/physical_samples.hpp"

/// Load paths that once took far too many iterations: how many they take now, and that their ends are those of others.

namespace softkin {

namespace {

using namespace testing;

/// The bending finger of soft rubber on a sheet of paper, 20,000 times as stiff and 0.3 mm thick.
RobotSpec paper_finger(double poisson_ratio) {
  RobotSpec spec = bending_finger();
  Mesh& mesh = spec.mesh;
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices(v, 2) < 5 && mesh.vertices(v, 2) > 1) mesh.vertices(v, 2) = 0.3;
  add_volume_region(mesh, "paper", [](const Vec3& p) { return p.z() < 0.3; });
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 0.1, poisson_ratio);
  MaterialSpec paper = spec.materials[0];
  paper.region = "paper";
  paper.elastic = elastic(Law::neo_hookean, 2000, 0.3);
  spec.materials.push_back(paper);
  return spec;
}

Equilibrium pressed(const RobotSpec& by_volume, double pressure) {
  RobotSpec spec = by_volume;
  spec.actuators[0] = by_load(spec.actuators[0]);
  const Model model = compile(spec);
  const Statics statics(model);
  return statics.solve(values({pressure}), statics.rest());
}

}  // namespace

/// However nearly incompressible the rubber is, and to the shape that the volume leads to.
TEST(PhysicalPaths, StiffLayerAndNearlyIncompressibleRubber) {
  int least = 1000, most = 0;
  for (const double poisson_ratio : {0.45, 0.49, 0.499, 0.4999}) {
    const RobotSpec spec = paper_finger(poisson_ratio);
    const Equilibrium found = pressed(spec, 3);
    ASSERT_EQ(found.report.status, Status::converged) << poisson_ratio << ": " << found.report.remark;
    least = std::min(least, found.report.iterations);
    most = std::max(most, found.report.iterations);
    const Model model = compile(spec);
    const Statics statics(model);
    const double ratio = achieved_ratio(model, model.actuators[0], found.state.positions);
    const Equilibrium same = solve_converged(statics, values({ratio}));
    EXPECT_NEAR(same.state.multipliers[0], 3, 1e-3) << poisson_ratio;
    EXPECT_LT(distance(same.state.positions, found.state.positions), 1e-3) << poisson_ratio;
  }
  EXPECT_LE(most, 20);
  EXPECT_LE(most, std::ceil(1.5 * least) + 3);
}

/// A pressure near its maximum: a step along the volume leads far past it, and from there back to it, by volume.
TEST(PhysicalPaths, PressureBelowItsMaximum) {
  RobotSpec spec = paper_finger(0.49);
  const Model by_volume = compile(spec);
  const Statics volumes(by_volume);
  spec.actuators[0] = by_load(spec.actuators[0]);
  const Model model = compile(spec);
  const Statics statics(model);
  const double most = statics.solve(values({1000}), statics.rest()).state.actuation[0];
  StaticsOptions options = tight();
  options.trace = true;
  for (const double fraction : {0.7, 0.8, 0.9, 0.98}) {
    statics.forget();
    const Equilibrium found = statics.solve(values({fraction * most}), statics.rest(), options);
    ASSERT_EQ(found.report.status, Status::converged) << fraction << ": " << found.report.remark;
    EXPECT_LE(found.report.iterations, 80) << fraction;
    const double ratio = achieved_ratio(model, model.actuators[0], found.state.positions);
    ASSERT_TRUE(found.report.trace.back().taken && !found.report.trace.back().along.empty());
    EXPECT_NEAR(found.report.trace.back().to, ratio, 0.05 * ratio) << fraction;
    const Equilibrium same = solve_converged(volumes, values({ratio}));
    EXPECT_NEAR(same.state.multipliers[0], fraction * most, 1e-6 * most) << fraction;
    EXPECT_LT(distance(same.state.positions, found.state.positions), 1e-3) << fraction;
  }
}

/// Loads beyond a maximum along a path: the maximum is reported again, from the state where it was first found.
TEST(PhysicalPaths, PathBeyondAMaximum) {
  RobotSpec spec = paper_finger(0.49);
  spec.materials[0].density = 1000;
  spec.loads.gravity = {0, 0, -9.81};
  const Model by_volume = compile(spec);
  const Statics volumes(by_volume);
  double most = 0;
  State state = volumes.rest();
  for (const double ratio : {2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0}) {
    state = volumes.solve(values({ratio}), state).state;
    most = std::max(most, state.multipliers[0]);
  }
  ASSERT_GT(most, 1.02 * state.multipliers[0]);
  spec.actuators[0] = by_load(spec.actuators[0]);
  const Model model = compile(spec);
  const Statics statics(model);
  const std::string reported = "the pressure of chamber 'chamber' has its maximum there, ";
  const auto check = [&](const Equilibrium& found) {
    EXPECT_EQ(found.report.status, Status::limit);
    ASSERT_EQ(found.report.remark.find(reported), 0u) << found.report.remark;
    const double limit_point = std::stod(found.report.remark.substr(reported.size()));
    EXPECT_GT(limit_point, 0.9999 * most);
    EXPECT_LT(limit_point, 1.01 * most);
    EXPECT_NEAR(found.state.actuation[0], limit_point, 1e-3 * limit_point);
  };
  // from rest, where weight and pressure come at once
  const Equilibrium at_once = statics.solve(values({3 * most}), statics.rest());
  check(at_once);
  EXPECT_LE(at_once.report.iterations, 50);
  EXPECT_NEAR(at_once.report.reached, at_once.state.actuation[0] / (3 * most), 1e-9);
  const Equilibrium below = solve_converged(statics, values({0.5 * most}));
  const Equilibrium first = statics.solve(values({1.2 * most}), below.state);
  check(first);
  const Equilibrium second = statics.solve(values({2 * most}), first.state);
  check(second);
  EXPECT_LE(second.report.iterations, 10);
  EXPECT_EQ(distance(second.state.positions, first.state.positions), 0);
}

/// Of both orders, with the paper and without, from rest and under its weight, in few iterations. With paper and of
/// order 2 it is that of the path.
TEST(PhysicalPaths, MaximumOfAPressure) {
  for (const bool quadratic : {false, true})
    for (const bool paper : {false, true}) {
      if (quadratic && paper) continue;
      RobotSpec spec = paper_finger(0.49);
      spec.mesh_options.quadratic = quadratic;
      if (!paper) spec.materials.pop_back();
      spec.materials[0].density = 1000;
      spec.loads.gravity = {0, 0, -9.81};
      const Model by_volume = compile(spec);
      const Statics volumes(by_volume);
      double most = 0;
      State state = volumes.rest();
      for (const double ratio : {1.5, 2.0, 2.5, 2.75, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 8.0}) {
        const Equilibrium found = volumes.solve(values({ratio}), state);
        state = found.state;
        most = std::max(most, state.multipliers[0]);
      }
      ASSERT_GT(most, 1.01 * state.multipliers[0]) << "no maximum was passed";
      spec.actuators[0] = by_load(spec.actuators[0]);
      const Model model = compile(spec);
      const Statics statics(model);
      const Equilibrium found = statics.solve(values({6 * most}), statics.rest());
      ASSERT_EQ(found.report.status, Status::limit);
      const std::string reported = "the pressure of chamber 'chamber' has its maximum there, ";
      ASSERT_EQ(found.report.remark.find(reported), 0u) << found.report.remark;
      EXPECT_NEAR(std::stod(found.report.remark.substr(reported.size())), most, 0.01 * most);
      EXPECT_LE(found.report.iterations, 70) << quadratic << paper;
    }
}

/// A heavy strip on a smooth floor, one end lifted: it leaves the floor over the length a of a beam without moment at
/// either end, 24 E I h = q a^4, and q a / 2 holds its end. It is held at its lower edge, which turns outwards from its
/// middle by d = sin(2 h / a) of half its height: 1.5 d / a of that force less, to first order.
TEST(PhysicalPaths, HeavyStripLiftedFromAFloor) {
  constexpr double gap = 0.01, distance = 0.005, lift = 2, width = 10, height = 2, modulus = 1;
  RobotSpec spec = physical_robot(block_mesh({60, 1, 1}, {120, width, height}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, modulus, 0);
  spec.materials[0].density = 1000;
  spec.loads.gravity = {0, 0, -9.81};
  const Points& at = spec.mesh.vertices;
  VertexList edge;
  for (Index v = 0; v < at.rows(); ++v)
    if (at(v, 0) > 120 - 1e-9 && at(v, 2) == 0) edge.vertices.push_back(v);
  const FixedSpec end{{std::move(edge), {}}, {false, false, true}, {0, 0, lift}};
  FixedSpec back = plane_support(at, 0, 0);
  back.axes = {true, true, false};
  spec.fixed = {back, end};
  spec.contact = contact_below(distance);
  spec.contact->obstacles.push_back({"floor", Halfspace{{0, 0, -gap}, {0, 0, 1}}, std::nullopt, {}});
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, {});
  EXPECT_LE(found.report.iterations, 80);
  const double q = 1000e-9 * 9.81 * width * height, bending = modulus * width * std::pow(height, 3) / 12;
  const double rests = distance;  // so little presses on it that it lies where forces begin
  const auto length = [&](double high) { return std::pow(24 * bending * high / q, 0.25); };
  const double high = lift + gap - rests, turn = 2 * high / length(high);
  const double a = length(high - 0.5 * height * (1 - std::cos(turn))), outwards = 0.5 * height * std::sin(turn);
  const double force = 0.5 * q * a * (1 - 1.5 * outwards / a);
  EXPECT_NEAR(reaction_of(model, statics, found, 1).z(), force, 0.002 * force);
}

/// If displacements and dead loads alone do not converge, they are applied together with the loads, at one load factor.
TEST(PhysicalPaths, WhatLeadsNowhereAloneComesTogetherWithLoads) {
  RobotSpec spec = bending_finger();
  spec.materials[0].elastic = elastic(Law::yeoh, 1, 0.45);
  spec.actuators[0] = by_load(spec.actuators[0]);
  spec.fixed.push_back({{std::string("x_high"), {}}, {true, true, true}, {-61, 0, 0}});  // of 60 mm
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve(values({20}), statics.rest());
  EXPECT_EQ(found.report.status, Status::limit);
  EXPECT_GT(found.report.reached, 0.1) << found.report.remark;
  EXPECT_LT(found.report.reached, 1);
  EXPECT_NEAR(found.state.load_factor, found.report.reached, 1e-12);
  EXPECT_NEAR(found.state.actuation[0], 20 * found.report.reached, 1e-12);
}

}  // namespace softkin
