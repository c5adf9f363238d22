#include <Eigen/Geometry>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/sensitivity_samples.hpp"

/// Moments on rigid regions, and pressures on the surface that are commanded.

namespace softkin {

namespace {

using namespace testing;

/// A strip of 60 x 4 x 4 mm whose last 5 mm are rigid, held at x = 0, with a commanded wrench there and water beside.
RobotSpec tool_strip(bool quadratic = true) {
  RobotSpec spec = physical_robot(block_mesh({12, 1, 2}, {60, 4, 4}));
  spec.mesh_options.quadratic = quadratic;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0);
  spec.rigid = {{{Box{{54.9, -1, -1}, {61, 5, 5}}, {}}, "plate"}};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  const std::array<Vec3, 2> any{Vec3::Constant(-10), Vec3::Constant(10)};
  spec.loads.forces = {{"tool", {std::string("x_high"), {}}, {0, 0, 0}, any, {0, 0, 0}, any}};
  TractionSpec water{"water", {std::string("z_low"), {}}, true, {0, 0, 0}, 0};
  water.range_kPa = {-5, 5};
  spec.loads.tractions = {water};
  return spec;
}

/// fx, fy, fz, mx, my, mz, water
Actuation loads(std::initializer_list<double> of) {
  return values(of);
}

Mat3 turn_of_tip(const Model& model, const Points& positions) {
  const std::vector<Index>& vertices = model.rigid[0].vertices;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  for (const Index v : vertices) {
    from += vertex_at(model.rest, v) / static_cast<double>(vertices.size());
    to += vertex_at(positions, v) / static_cast<double>(vertices.size());
  }
  Mat3 both = Mat3::Zero();
  for (const Index v : vertices) both += (vertex_at(positions, v) - to) * (vertex_at(model.rest, v) - from).transpose();
  const Eigen::JacobiSVD<Mat3> parts(both, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return parts.matrixU() * parts.matrixV().transpose();
}

}  // namespace

/// An end moment bends a slender strip to a circle, up to where its tip has turned by a right angle and more.
TEST(Moments, BendAStripToACircle) {
  const Model model = compile(tool_strip());
  const Statics statics(model);
  const double bending = 4.0 * 64 / 12;  // E I [N mm^2]
  State at;
  for (const double degrees : {30.0, 110.0}) {
    const double moment = bending * degrees * std::numbers::pi / 180 / 55;
    const Equilibrium found = solve_converged(statics, loads({0, 0, 0, 0, moment, 0, 0}));
    const Eigen::AngleAxisd turn(turn_of_tip(model, found.state.positions));
    EXPECT_NEAR(turn.angle() * 180 / std::numbers::pi, degrees, 0.01 * degrees);
    EXPECT_NEAR(std::abs(turn.axis().y()), 1, 1e-6);
    EXPECT_GT(turn.axis().y(), 0);
  }
}

/// The support carries the wrench and its moment about the support, whatever the rotation of the tip.
TEST(Moments, AreBorneByTheSupport) {
  for (const bool quadratic : {false, true}) {
    const Model model = compile(tool_strip(quadratic));
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, loads({0.003, -0.004, 0.005, 0.2, 0.3, -0.25, 0}));
    const Reaction held = reactions(model, found.state.positions, statics.measured(found.state))[0];
    const Vec3 force(0.003, -0.004, 0.005), moment(0.2, 0.3, -0.25);
    EXPECT_GT(Eigen::AngleAxisd(turn_of_tip(model, found.state.positions)).angle(), 0.15);
    const Vec3 at = model.markers[0].at(found.state.positions).transpose();
    EXPECT_LT((held.force + force).norm(), 1e-8);
    EXPECT_LT((held.moment + moment + (at - held.center).cross(force)).norm(), 1e-7);
  }
}

/// The same as two dead forces far apart on the rigid part, which make that moment in the shape that it has.
TEST(Moments, AreThoseOfACouple) {
  RobotSpec spec = tool_strip();
  spec.loads.tractions.clear();
  const Vec3 moment(0.1, 0.35, 0);
  spec.loads.forces = {{"tool", {std::string("x_high"), {}}, {0, 0, 0}, std::nullopt, moment, std::nullopt}};
  const Model by_moment = compile(spec);
  const Equilibrium expected = solve_converged(Statics(by_moment), values({}));
  const auto corner = [&](double y, double z) {
    for (const Index v : by_moment.rigid[0].vertices)
      if ((vertex_at(by_moment.rest, v) - Vec3(60, y, z)).norm() < 1e-9) return v;
    return Index(-1);
  };
  // along two edges of the end: arms a, b, and forces F, G on their ends with a x F + b x G = moment
  const Index o = corner(0, 0), y = corner(4, 0), z = corner(0, 4);
  const auto now = [&](Index v) { return vertex_at(expected.state.positions, v); };
  const Vec3 a = now(y) - now(o), b = now(z) - now(o);
  Eigen::Matrix<double, 3, 6> arms;
  for (int axis = 0; axis < 3; ++axis) {
    arms.col(axis) = a.cross(Vec3::Unit(axis));
    arms.col(3 + axis) = b.cross(Vec3::Unit(axis));
  }
  const Eigen::Matrix<double, 6, 1> pulls = arms.completeOrthogonalDecomposition().solve(moment);
  const Vec3 first = pulls.head<3>(), second = pulls.tail<3>();
  spec.loads.forces = {{"a", {Vec3(60, 4, 0), {}}, first},
                       {"b", {Vec3(60, 0, 4), {}}, second},
                       {"o", {Vec3(60, 0, 0), {}}, -first - second}};
  const Model by_forces = compile(spec);
  const Equilibrium found = Statics(by_forces).solve(values({}), expected.state, tight());
  EXPECT_EQ(found.report.status, Status::converged);
  EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-6);
  EXPECT_GT(distance(expected.state.positions, by_moment.rest), 5);
}

TEST(Moments, AndPressuresHaveDerivatives) {
  for (const bool quadratic : {false, true}) {
    Steps steps;
    steps.pressure = 2e-4;
    expect_differences_at(tool_strip(quadratic), loads({0.003, -0.004, 0.005, 0.2, 0.3, -0.25, 0.03}), 1e-6, steps);
  }
}

/// A pressure that is commanded is that of the description.
TEST(Moments, ACommandedPressureIsTheSameAsAGivenOne) {
  RobotSpec spec = tool_strip();
  const Model commanded = compile(spec);
  spec.loads.tractions[0] = {"water", {std::string("z_low"), {}}, true, {0, 0, 0}, 0.05};
  const Model given = compile(spec);
  const Equilibrium one = solve_converged(Statics(commanded), loads({0, 0, 0, 0, 0, 0, 0.05})),
                    other = solve_converged(Statics(given), loads({0, 0, 0, 0, 0, 0}));
  EXPECT_GT(distance(one.state.positions, commanded.rest), 1);
  EXPECT_LT(distance(one.state.positions, other.state.positions), 1e-6);
}

/// What is given of a moment beside what is commanded.
TEST(Moments, AddUp) {
  RobotSpec spec = tool_strip();
  const Model both = compile(spec);
  spec.loads.forces[0].moment = {0.1, 0.2, 0};
  spec.loads.forces[0].moment_range = std::array<Vec3, 2>{Vec3(0.1, 0.2, -1), Vec3(0.1, 0.2, 1)};
  const Model one = compile(spec);
  ASSERT_EQ(one.actuators.size(), 5u);
  const Equilibrium found = solve_converged(Statics(one), loads({0, 0, 0, 0.15, 0})),
                    expected = solve_converged(Statics(both), loads({0, 0, 0, 0.1, 0.2, 0.15, 0}));
  EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-6);
}

}  // namespace softkin
