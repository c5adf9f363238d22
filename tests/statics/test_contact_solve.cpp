#include <Eigen/Geometry>
#include <cstdio>

#include "statics/physical_samples.hpp"
#include "statics/pressed_balls.hpp"
#include "statics/pressed_blocks.hpp"

/// Equilibria of robots that touch themselves or obstacles.

namespace softkin {
namespace {

using namespace testing;

Unevenness unevenness_at(const StackedBlocks& blocks) {
  const Unevenness found = unevenness_of(blocks, {3, 3, 2}, {4, 4, 2}, tight());
  EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
  std::printf("%-9s %-5s distance %.5f: force %+.2e, stress %.2e, root mean %.2e, %3d iterations, %.2f s\n",
              blocks.quadratic ? "quadratic" : "linear", blocks.walls ? "walls" : "free",
              blocks.distance / StackedBlocks::size, found.force, found.largest, found.root_mean,
              found.report.iterations, found.report.seconds);
  return found;
}

StackedBlocks free_blocks(double distance, bool quadratic) {
  StackedBlocks blocks = blocks_at(distance, quadratic);
  blocks.walls = blocks.uneven = false;
  return blocks;
}

/// Vertices push for areas of their own on surfaces with other vertices: uneven until gaps, which are of the order of
/// the distance, have made up for it.
TEST(ContactSolve, BlocksWithOtherMeshesPressEachOtherEvenly) {
  for (const double distance : {0.02, 0.005, 0.00125}) {
    const Unevenness found = unevenness_at(free_blocks(distance, false));
    EXPECT_LT(std::abs(found.force), 0.4 * distance) << distance;
    EXPECT_LT(found.largest, 0.05) << distance;
    EXPECT_LT(found.root_mean, 0.015) << distance;
  }
  EXPECT_LT(unevenness_at(free_blocks(0.0002, false)).largest, 0.01);
}

TEST(ContactSolve, BlocksOfOrder2PressEachOther) {
  for (const double distance : {0.005, 0.00125}) {
    const Unevenness found = unevenness_at(free_blocks(distance, true));
    EXPECT_LT(std::abs(found.force), 0.4 * distance) << distance;
    EXPECT_LT(found.largest, 0.08) << distance;
    EXPECT_LT(found.root_mean, 0.015) << distance;
  }
}

/// The patch test: in the limit of small distances the stress is uniform, of either order.
TEST(ContactSolve, WhatIsUnevenShrinksWithTheDistance) {
  for (const bool quadratic : {false, true}) {
    const Unevenness coarse = unevenness_at(blocks_at(0.0005, quadratic)),
                     fine = unevenness_at(blocks_at(0.00005, quadratic));
    EXPECT_LT(coarse.largest, 0.01) << quadratic;
    EXPECT_LT(fine.largest, 0.3 * coarse.largest) << quadratic;
    EXPECT_LT(fine.root_mean, 0.3 * coarse.root_mean) << quadratic;
    EXPECT_LT(std::abs(fine.force), 3e-5) << quadratic;
  }
}

std::vector<Index> bottom_of(const Model& model, double height) {
  std::vector<Index> bottom;
  for (Index v = 0; v < model.robot_vertices(); ++v)
    if (std::abs(model.rest(v, 2) - height) < 1e-9) bottom.push_back(v);
  return bottom;
}

TEST(ContactSolve, AFloorBearsWhatPressesOnIt) {
  for (const bool quadratic : {false, true}) {
    const BlockOnFloor block{0.2, 0.1, 1, quadratic};
    RobotSpec spec = block.robot();
    const double load = 7;
    spec.loads.forces = {{"weight", {std::string("z_low"), {}}, {0, 0, -load}}};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, {});
    const std::vector<Index> bottom = bottom_of(model, block.gap);
    const Eigen::VectorXd push = push_of_floor(model, found.state.positions, bottom);
    const double held = -reaction_of(model, statics, found, 0).z();
    EXPECT_NEAR(push.sum(), held + load, 1e-6 * push.sum());
    std::printf("floor, %s: bears %.9g N of %.9g\n", quadratic ? "quadratic" : "linear", push.sum(), held + load);
  }
}

/// Of the stress under a block on a floor: greatest over least, less 1.
double unevenness_on_floor(double distance, bool quadratic) {
  const Model model = compile(BlockOnFloor{distance, 0.5 * distance, 1, quadratic}.robot());
  const Statics statics(model);
  const std::vector<double> stresses = statics.measured(solve_converged(statics, {}).state).stress.von_mises;
  const auto [least, most] = std::minmax_element(stresses.begin(), stresses.end());
  std::printf("floor, %s, distance %g: stress %.6f to %.6f MPa\n", quadratic ? "quadratic" : "linear", distance, *least,
              *most);
  return *most / *least - 1;
}

/// Edges of the block push for their sides too; gaps make up for it, the more exactly the smaller the distance.
TEST(ContactSolve, PressureOnAFloorIsUniform) {
  for (const bool quadratic : {false, true}) {
    const double coarse = unevenness_on_floor(0.1, quadratic), fine = unevenness_on_floor(0.01, quadratic);
    EXPECT_LT(coarse, 0.02) << quadratic;
    EXPECT_LT(fine, 0.15 * coarse) << quadratic;
  }
}

/// Clamped at its top, pressed on a floor and pushed aside, all turned and moved.
RobotSpec turned_block(const Mat3& turn, const Vec3& shift) {
  Mesh mesh = block_mesh({3, 2, 2}, {24, 20, 16});
  VertexList top;
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices(v, 2) == 16) top.vertices.push_back(v);
  const auto moved = [&](const Vec3& p) { return Vec3(turn * p + shift); };
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    mesh.vertices.row(v) = moved(mesh.vertices.row(v).transpose()).transpose();
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.fixed = {{{top, {}}, {true, true, true}, turn * Vec3(1, 2, -1.5)}};
  spec.loads.forces = {{"push", {moved({24, 10, 8}), {}}, turn * Vec3(0.5, 0.3, -1)}};
  spec.contact = contact_below(0.2);
  spec.contact->obstacles.push_back({"floor", Halfspace{moved({3, 4, -0.1}), turn * Vec3(0, 0, 1)}, std::nullopt, {}});
  return spec;
}

TEST(ContactSolve, TurnsWithEverythingAround) {
  const auto solved = [](const Mat3& turn, const Vec3& shift) {
    const Model model = compile(turned_block(turn, shift));
    const Statics statics(model);
    return Points(solve_converged(statics, {}, tight(1e-10)).state.positions.topRows(model.robot_vertices()));
  };
  const Points straight = solved(Mat3::Identity(), Vec3::Zero());
  for (const Vec3& axis : {Vec3(1, 2, 3), Vec3(0, 1, 0), Vec3(-3, 1, 0.2)}) {
    const Mat3 turn = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
    const Vec3 shift = 10 * axis;
    const Points turned = solved(turn, shift);
    const Points back = (turned.rowwise() - shift.transpose()) * turn;
    const double error = distance(back, straight) / 35;
    std::printf("turned: %.2e of the diagonal\n", error);
    EXPECT_LT(error, 1e-9);
  }
}

/// A ball on a plane.
TEST(ContactSolve, Hertz) {
  for (const double fraction : {0.01, 0.02}) {
    const PressedBalls balls{.approach = fraction * PressedBalls::radius, .distance = 0.02};
    StaticsOptions options;
    options.threads = 1;
    const BallContact found = pressed(balls, options);
    ASSERT_EQ(found.found.report.status, Status::converged);
    const HertzRatios ratios = beside_hertz(balls, found);
    EXPECT_NEAR(ratios.force_of_ball, 1, 0.04) << fraction;
    EXPECT_NEAR(ratios.force_of_radius, 1, 0.05) << fraction;
    EXPECT_NEAR(ratios.radius, 1, 0.05) << fraction;
    std::printf("Hertz, approach %.4f: F/F(d) %.4f, F/F(d') %.4f, F/F(a) %.4f, a/a(d) %.4f, %.1f s\n",
                found.approach / PressedBalls::radius, ratios.force, ratios.force_of_ball, ratios.force_of_radius,
                ratios.radius, found.found.report.seconds);
  }
}

TEST(ContactSolve, ThreadsChangeNoBit) {
  StaticsOptions options;
  options.threads = 1;
  const PressedBalls balls{.approach = 0.02 * PressedBalls::radius, .distance = 0.05};
  const Equilibrium alone = pressed(balls, options).found;
  options.threads = 2;
  const Equilibrium shared = pressed(balls, options).found;
  EXPECT_EQ(shared.report.iterations, alone.report.iterations);
  EXPECT_EQ(shared.report.factorisations, alone.report.factorisations);
  EXPECT_EQ(shared.state.positions, alone.state.positions);
}

/// A beam between a floor and a ceiling: whatever was solved before, a solve is that of a new object.
TEST(ContactSolve, SolvesBeforeChangeNoBit) {
  constexpr double gap = 0.5, distance = 0.2;
  RobotSpec spec = cable_beam();
  spec.contact = contact_below(distance);
  spec.contact->obstacles = {{"floor", Halfspace{{0, 0, -gap}, {0, 0, 1}}, std::nullopt, {}},
                             {"ceiling", Halfspace{{0, 0, 10 + gap}, {0, 0, -1}}, std::nullopt, {}}};
  const Model model = compile(spec);
  StaticsOptions options;
  options.threads = 1;
  options.reuse_factor = false;
  const auto pulled = [](double top, double bottom) { return Actuation(Eigen::Vector2d(top, bottom)); };
  const Statics used(model);
  State start = used.rest();
  for (const Actuation& requested : {pulled(0.97, 1), pulled(1, 0.99), pulled(0.96, 1), pulled(1, 0.96)}) {
    const Statics fresh(model);
    const Equilibrium expected = fresh.solve(requested, start, options);
    ASSERT_EQ(expected.report.status, Status::converged) << expected.report.remark;
    const double low = expected.state.positions.col(2).minCoeff(), high = expected.state.positions.col(2).maxCoeff();
    EXPECT_LT(std::min(low + gap, 10 + gap - high), distance) << "it touches";
    const Equilibrium found = used.solve(requested, start, options);
    EXPECT_EQ(found.report.iterations, expected.report.iterations);
    EXPECT_EQ(found.report.factorisations, expected.report.factorisations);
    EXPECT_EQ(found.state.positions, expected.state.positions);
    start = expected.state;
  }
}

}  // namespace
}  // namespace softkin
