#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/prediction.hpp>

#include "statics/sensitivity_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

constexpr double degree = std::numbers::pi / 180;

Points turned(const Points& points, const Vec3& axis, double degrees, const Vec3& about) {
  const Mat3 rotation = Eigen::AngleAxisd(degrees * degree, axis.normalized()).toRotationMatrix();
  return ((points.rowwise() - about.transpose()) * rotation.transpose()).rowwise() + about.transpose();
}

FixedSpec turning(const std::string& region, const Vec3& axis, std::optional<Vec3> about = {}, double degrees = 0) {
  FixedSpec fixed{{region, {}}};
  fixed.rotation = RotationSpec{axis, degrees, about};
  return fixed;
}

/// A square bar of 10 mm, 80 mm long, of elements of order 2, held at both ends, of which the far one turns about the
/// bar's axis.
RobotSpec twisted_bar(double degrees, std::array<int, 3> cells = {16, 4, 4}) {
  RobotSpec spec = physical_robot(block_mesh(cells, {80, 10, 10}));
  spec.mesh_options.quadratic = true;
  spec.fixed.push_back(turning("x_high", {1, 0, 0}, {}, degrees));
  return spec;
}

/// Angle by which the section at x has turned about the bar's axis, by all of its vertices [degrees].
double section_turn(const Model& model, const Points& positions, double x) {
  double sine = 0, cosine = 0;
  for (Index v = 0; v < positions.rows(); ++v) {
    if (!model.elements.used[v] || std::abs(model.rest(v, 0) - x) > 1e-6) continue;
    const Eigen::Vector2d from(model.rest(v, 1) - 5, model.rest(v, 2) - 5);
    const Eigen::Vector2d to(positions(v, 1) - 5, positions(v, 2) - 5);
    cosine += from.dot(to);
    sine += from.x() * to.y() - from.y() * to.x();
  }
  return std::atan2(sine, cosine) / degree;
}

double moment_x(const Model& model, const Statics& statics, const State& at) {
  return reactions(model, at.positions, statics.measured(at))[1].moment.x();
}

}  // namespace

/// Saint-Venant's torque of a square bar, G theta / L times 0.1406 a^4; its ends cannot warp, which is a little
/// stiffer. The energy of the twist is half the torque times the angle.
TEST(TurnedSupport, TwistsABarBySaintVenantsTorque) {
  const Model model = compile(twisted_bar(2));
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  const double shear = 1 / (2 * 1.4);  // MPa
  const double expected = shear * 0.1406 * std::pow(10, 4) * 2 * degree / 80;
  const double torque = moment_x(model, statics, found.state);
  EXPECT_GT(torque, expected);
  EXPECT_NEAR(torque / expected, 1, 0.03);
  EXPECT_NEAR(found.report.energy, 0.5 * torque * 2 * degree, 1e-3 * found.report.energy);
  EXPECT_NEAR(section_turn(model, found.state.positions, 40), 1, 1e-3);
}

/// Two halves in series: the interface rotates by the first half's fraction of the compliance, 1 / (1 + ratio).
TEST(TurnedSupport, TurnsTheInterfaceOfTwoMaterialsByTheirShare) {
  for (const double ratio : {4.0, 0.5}) {
    RobotSpec spec = twisted_bar(3);
    add_volume_region(spec.mesh, "first", [](const Vec3& p) { return p.x() < 40; });
    MaterialSpec first = spec.materials[0];
    first.region = "first";
    first.elastic->youngs_modulus = ratio;
    spec.materials.push_back(first);
    const Model model = compile(spec);
    const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
    EXPECT_NEAR(section_turn(model, found.state.positions, 40) / (3 / (1 + ratio)), 1, 0.02) << ratio;
  }
}

/// After a full turn at once from rest the bar is twisted, not back at rest, so that its middle has turned by half. On
/// the same path back it returns to rest.
TEST(TurnedSupport, FollowsAWholeTurn) {
  RobotSpec spec = twisted_bar(0, {16, 2, 2});
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium whole = solve_converged(statics, values({360}));
  EXPECT_GT(whole.report.continuation_steps, 11);
  EXPECT_NEAR(std::abs(section_turn(model, whole.state.positions, 40)), 180, 1);
  EXPECT_NEAR(section_turn(model, whole.state.positions, 20), 90, 2);
  for (const Index v : model.held.turns[0].vertices)
    EXPECT_LT((whole.state.positions.row(v) - model.rest.row(v)).norm(), 1e-12);
  const double torque = moment_x(model, statics, whole.state);
  EXPECT_GT(torque, 0);
  // the torque is the derivative of the energy by the angle
  const auto energy = [&](double degrees) {
    return statics.solve(values({degrees}), whole.state, tight()).report.energy;
  };
  EXPECT_NEAR((energy(361) - energy(359)) / (2 * degree) / torque, 1, 1e-3);
  const Equilibrium back = statics.solve(values({0}), whole.state, tight());
  EXPECT_EQ(back.report.status, Status::converged);
  EXPECT_LT(distance(back.state.positions, model.rest), 1e-6);
}

/// All that is held turns by the same: the robot is turned and nothing else, in both formulations, whatever the angle;
/// a shift comes after the turn.
TEST(TurnedSupport, TurnsARobotRigidlyWithAllThatHoldsIt) {
  const Vec3 axis(1, 2, -1), about(3, -4, 5), shift(2, 1, -3);
  for (const bool physical : {true, false}) {
    const Mesh mesh = block_mesh({6, 2, 2}, {30, 10, 10});
    RobotSpec spec = physical ? physical_robot(mesh) : block_robot(mesh);
    spec.fixed = {turning("x_low", axis, about), turning("x_high", axis, about)};
    for (FixedSpec& fixed : spec.fixed) fixed.displacement = shift;
    const Model model = compile(spec);
    const Statics statics(model);
    for (const double degrees : {20.0, 90.0, -250.0, 360.0}) {
      const Equilibrium found = solve_converged(statics, values({degrees, degrees}));
      const Points expected = turned(model.rest, axis, degrees, about).rowwise() + shift.transpose();
      EXPECT_LT(distance(found.state.positions, expected), 1e-7) << physical << " " << degrees;
      EXPECT_LT(std::abs(found.report.energy), 1e-9) << physical << " " << degrees;
    }
  }
}

/// Of one support alone, without a point: about the mean of its vertices. The angle of the scene is that of rest.
TEST(TurnedSupport, TurnsAboutTheMeanOfWhatItHoldsByTheScenesAngle) {
  RobotSpec spec = physical_robot(block_mesh({6, 2, 2}, {30, 10, 10}));
  spec.fixed = {turning("x_low", {0, 0, 1}, {}, 90)};
  const Model model = compile(spec);
  EXPECT_EQ(model.actuators[0].name, "x_low_turn");
  const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
  EXPECT_LT(distance(found.state.positions, turned(model.rest, {0, 0, 1}, 90, {0, 5, 5})), 1e-7);
}

/// Target shapes: step by step and at once lead to the same twist, as does Algorithm 1.
TEST(TurnedSupport, TwistsTargetShapes) {
  RobotSpec spec = block_robot(block_mesh({12, 2, 2}, {60, 10, 10}));
  spec.fixed.push_back(turning("x_high", {1, 0, 0}));
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium at_once = solve_converged(statics, values({150}));
  EXPECT_NEAR(section_turn(model, at_once.state.positions, 30), 75, 1.5);
  EXPECT_GE(at_once.report.continuation_steps, 15);
  Equilibrium step = solve_converged(statics, values({60}));
  for (const double degrees : {110.0, 150.0}) step = statics.solve(values({degrees}), step.state, tight());
  EXPECT_LT(distance(step.state.positions, at_once.state.positions), 1e-6);
  StaticsOptions printed = tight(1e-7);
  printed.solver = Solver::local_global;
  const Equilibrium algorithm = statics.solve(values({150}), statics.rest(), printed);
  EXPECT_EQ(algorithm.report.status, Status::converged) << algorithm.report.remark;
  EXPECT_LT(distance(algorithm.state.positions, at_once.state.positions), 1e-3);
}

/// A rigid region of which a turning support holds a face turns with it, all of it.
TEST(TurnedSupport, TurnsARigidRegionThatItHolds) {
  for (const bool physical : {true, false}) {
    const Mesh mesh = block_mesh({8, 2, 2}, {40, 10, 10});
    RobotSpec spec = physical ? physical_robot(mesh) : block_robot(mesh);
    spec.fixed.push_back(turning("x_high", {1, 0, 0}));
    spec.rigid.push_back({{Box{{30, 0, 0}, {40, 10, 10}}, {}}, "end"});
    const Model model = compile(spec);
    const Equilibrium found = solve_converged(Statics(model), values({40}));
    const Points expected = turned(model.rest, {1, 0, 0}, 40, {40, 5, 5});
    for (const Index v : model.rigid[0].vertices)
      EXPECT_LT((found.state.positions.row(v) - expected.row(v)).norm(), 1e-12) << physical;
  }
}

/// Derivatives of equilibria by the angle against differences, beside chambers, cables, weight and rigid regions.
TEST(TurnedSupport, HasTheDerivativeOfDifferences) {
  RobotSpec crowded = crowded_robot();
  crowded.fixed[0].rotation = RotationSpec{{1, 0.5, 0.2}, 0, {}};
  expect_differences_at(crowded, values({1.2, 5, 1.05, 0.97, 0.01, 25}));
  RobotSpec bar = twisted_bar(0, {8, 2, 2});
  bar.fixed[1].displacement = {3, 0, 1};
  expect_differences_at(bar, values({70}));
  for (const bool minimum_norm : {true, false}) {
    RobotSpec mixed = mixed_robot(minimum_norm, minimum_norm ? 0.6 : 1);
    mixed.fixed.push_back(turning("x_high", {1, 0, 0.3}));
    expect_differences_at(mixed, values({1.1, 1.2, 0.95, 12}), 1e-5);
  }
}

/// The error of the prediction for a nearby angle is quadratic in the step.
TEST(TurnedSupport, IsPredictedToFirstOrder) {
  const Model model = compile(twisted_bar(0, {8, 2, 2}));
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({50}));
  Neighbourhood around(statics, at.state);
  double before = 0;
  for (const double path : {8.0, 4.0, 2.0}) {
    const Points expected = statics.solve(values({50 + path}), at.state, tight()).state.positions;
    const double error = distance(around.predict(values({50 + path})).positions, expected);
    EXPECT_LT(error, 0.2 * distance(at.state.positions, expected));
    if (before > 0) {
      EXPECT_GT(before / error, 3.5);
    }
    before = error;
  }
}

/// Where the commands of a start are not known, its angle is determined from its shape.
TEST(TurnedSupport, KnowsTheAngleOfAShape) {
  const Model model = compile(twisted_bar(0, {8, 2, 2}));
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({100}));
  State start = statics.rest();
  start.positions = at.state.positions;
  const Equilibrium again = statics.solve(values({120}), start, tight());
  EXPECT_EQ(again.report.status, Status::converged);
  EXPECT_LT(again.report.continuation_steps, 3);
  EXPECT_LT(distance(again.state.positions, solve_converged(statics, values({120})).state.positions), 1e-6);
}

/// With a factor in double precision, whose matrix is no longer stored, a support that turns still moves the body
/// along: the error of the prediction is quadratic in the step.
TEST(TurnedSupport, IsPredictedWithAFactorInDoublePrecision) {
  const Model model = compile(twisted_bar(10, {8, 2, 2}));
  const Statics statics(model);
  const physical::System system(model);
  physical::Workspace work(system);
  work.saddle.precision() = linear::MixedLdlt::Precision::twice;
  Team team(1);
  const Equilibrium found = statics.solve(model.rest_actuation(), statics.rest(), tight());
  ASSERT_EQ(found.report.status, Status::converged);
  const physical::LoadState here{found.state.actuation, 1};
  const physical::Iterate at = system.iterate(found.state);
  physical::Balance balance;
  const std::vector<bool> none(system.actuators());
  system.evaluate(at, here, none, work, balance, team);
  (void)system.factorise(at, here, none, balance, {}, work, team);
  ASSERT_TRUE(work.saddle.factor().in_double());
  double missed[2];
  for (int i = 0; i < 2; ++i) {
    const physical::LoadState there{here.actuation.array() + 2.0 / (1 + i), 1};
    physical::Iterate predicted = at;
    (void)physical::predict(system, here, there, none, work, team, predicted);
    const Equilibrium exact = statics.solve(there.actuation, found.state, tight());
    missed[i] =
        (predicted.positions - exact.state.positions).norm() / (exact.state.positions - found.state.positions).norm();
  }
  EXPECT_LT(missed[0], 0.1);
  EXPECT_NEAR(missed[1] / missed[0], 0.5, 0.1);
}

}  // namespace softkin
