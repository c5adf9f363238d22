#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/system.hpp>

#include "statics/contact_scenes.hpp"
#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

/// Of the top on the block [N].
Vec3 reaction(const Model& model, const Statics& statics, const State& at) {
  const Points all = statics.measured(at).reactions;
  Vec3 sum = Vec3::Zero();
  for (Index v = 0; v < model.robot_vertices(); ++v) sum += all.row(v).transpose();
  return sum;
}

/// Moves a robot in equal steps and returns the last equilibrium; checks that it converges.
Equilibrium moved(const Model& model, const Statics& statics, int steps) {
  Equilibrium last;
  last.state = statics.rest();
  last.state.actuation = model.rest_actuation();
  last.state.multipliers = Eigen::VectorXd::Zero(0);
  for (int i = 1; i <= steps; ++i) last = statics.solve(model.rest_actuation(), last.state, tight(1e-8));
  EXPECT_EQ(last.report.status, Status::converged) << last.report.remark;
  return last;
}

}  // namespace

/// Where all of the floor's contact slips the force along it is the friction coefficient times that across it.
TEST(Friction, OfWhatSlidesIsItsCoefficient) {
  for (const double friction : {0.1, 0.25}) {
    const Model model = compile(block_on_rough_floor(friction, {4, 0, -0.5}));
    const Statics statics(model);
    const Equilibrium found = moved(model, statics, 1);
    const Vec3 force = reaction(model, statics, found.state);
    EXPECT_NEAR(std::hypot(force.x(), force.y()), friction * std::abs(force.z()),
                0.01 * friction * std::abs(force.z()));
    EXPECT_GT(force.x(), 0);
    EXPECT_LE(found.report.physical.friction_change, 1e-4);
  }
}

TEST(Friction, NoneLeavesTheFloorSmooth) {
  const Model model = compile(block_on_rough_floor(0, {1, 0, -0.5}));
  const Statics statics(model);
  const Vec3 force = reaction(model, statics, moved(model, statics, 1).state);
  EXPECT_LT(std::hypot(force.x(), force.y()), 1e-8 * std::abs(force.z()));
}

/// What sticks does not creep: solving again from the equilibrium changes nothing.
TEST(Friction, WhatSticksStays) {
  const Model model = compile(block_on_rough_floor(2, {0.3, 0, -0.5}));
  const Statics statics(model);
  const Equilibrium once = moved(model, statics, 1);
  Equilibrium again = once;
  for (int i = 0; i < 5; ++i) again = statics.solve(model.rest_actuation(), again.state, tight(1e-8));
  EXPECT_LT(distance(again.state.positions, once.state.positions), 1e-5);
  const Vec3 before = reaction(model, statics, once.state), after = reaction(model, statics, again.state);
  EXPECT_LT((after - before).norm(), 1e-3 * before.norm());
  EXPECT_GT(std::abs(before.x()), 0.01 * std::abs(before.z()));
}

/// A contact that begins within a step sticks where it begins, however long the step: as if the path began there.
TEST(Friction, WhatComesToTouchSticksWhereItDoes) {
  const auto reaction_over = [](double gap, const Vec3& move) {
    RobotSpec spec = block_on_rough_floor(2, move);
    spec.contact->obstacles[0].shape = Halfspace{{0, 0, -gap}, {0, 0, 1}};
    const Model model = compile(spec);
    const Statics statics(model);
    return reaction(model, statics, moved(model, statics, 1).state);
  };
  const double reach = 0.05, sideways = 0.12, down = 0.2;  // from where it touches
  const auto from = [&](double gap) {
    const double times = (gap - reach + down) / down;
    return reaction_over(gap, {times * sideways, 0, -times * down});
  };
  const Vec3 near = from(0.051), far = from(0.35);
  EXPECT_GT(near.x(), 0.1 * std::abs(near.z()));
  EXPECT_LT((far - near).norm(), 0.03 * near.x());
}

namespace {

void expect_derivatives(const Model& model) {
  const Statics statics(model);
  const State found = moved(model, statics, 1).state;
  const physical::System system(model);
  physical::Workspace work(system);
  Team team(1);
  const physical::LoadState load_state{model.rest_actuation(), 1};
  physical::Iterate at = system.iterate(found);
  at.multipliers = Eigen::VectorXd::Zero(0);
  physical::Balance balance;
  const std::vector<bool> none;
  std::mt19937 engine(4);
  std::normal_distribution<double> normal;
  const Index size = system.freedoms().size();
  for (const double shake : {1e-4, 1e-3, 5e-3}) {  // where it sticks, and where it slips
    physical::Iterate from = at;
    Eigen::VectorXd move(size);
    for (Index i = 0; i < size; ++i) move[i] = shake * normal(engine);
    system.freedoms().move(move, 1, from.positions);
    physical::hold_friction(system, from, work, team);
    ASSERT_FALSE(work.contacts->holds.empty());
    system.evaluate(from, load_state, none, work, balance, team);
    ASSERT_FALSE(balance.forbidden);
    const Eigen::VectorXd force = balance.force;
    system.assemble(from, load_state, balance, physical::System::Stiffness::exact, work, team);
    system.gather(from, balance, work, team);
    Eigen::VectorXd path(size);
    for (Index i = 0; i < size; ++i) path[i] = normal(engine);
    Eigen::MatrixXd product(size, 1);
    system.multiply(from, path, work, product, team);
    const double step = 1e-7;
    const auto beside = [&](double scale, bool held) {
      physical::Iterate there = from;
      system.freedoms().move(path, scale, there.positions);
      physical::hold_friction(system, held ? from : there, work, team);
      system.evaluate(there, load_state, none, work, balance, team);
      return std::pair(balance.energy, Eigen::VectorXd(balance.force));
    };
    EXPECT_NEAR(force.dot(path), (beside(step, true).first - beside(-step, true).first) / (2 * step),
                1e-6 * force.norm() * path.norm());
    // with the normal forces of each shape
    const Eigen::VectorXd force_high = beside(step, false).second, force_low = beside(-step, false).second;
    EXPECT_LT((product.col(0) - (force_high - force_low) / (2 * step)).norm(), 1e-4 * product.norm()) << shake;
  }
}

}  // namespace

TEST(Friction, GradientAndStiffnessAreDerivatives) {
  expect_derivatives(compile(block_on_rough_floor(0.5, {0.4, 0.1, -0.5}, 2)));
  expect_derivatives(compile(block_on_rough_floor(0.5, {0.4, 0.1, -0.5}, 1, true)));
}

namespace {

/// A beam bent onto a floor under its end.
RobotSpec leaning_beam(double friction) {
  RobotSpec spec = cable_beam();
  spec.contact.emplace();
  spec.contact->distance_mm = 0.1;
  spec.contact->friction = friction;
  spec.contact->obstacles.push_back({"floor", Halfspace{{0, 0, -2}, {0, 0, 1}}, {}, {}});
  return spec;
}

}  // namespace

/// Compares with differences of equilibria: in both directions without friction, in the direction of slip with
/// friction.
TEST(Friction, JacobianOfWhatLeansOnAFloor) {
  for (const double friction : {0.0, 0.3}) {
    const Model model = compile(leaning_beam(friction));
    const Statics statics(model);
    Equilibrium at = solve_converged(statics, values({1.1, 0.9}));
    for (const double length : {0.88, 0.86}) at = statics.solve(values({1.1, length}), at.state, tight(1e-10));
    ASSERT_EQ(at.report.status, Status::converged);
    EXPECT_LT(marker_at(model, at).z(), 5);  // of the middle of the end
    const Sensitivity slopes = statics.sensitivity(at.state);
    ASSERT_TRUE(slopes.regular);
    constexpr double step = 2e-5;
    const Points further = statics.solve(values({1.1, 0.86 - step}), at.state, tight(1e-11)).state.positions;
    const Points back = friction == 0
                            ? statics.solve(values({1.1, 0.86 + step}), at.state, tight(1e-11)).state.positions
                            : at.state.positions;
    const Points difference = (back - further) / (friction == 0 ? 2 * step : step);
    EXPECT_LT((slopes.positions[1] - difference).norm(), (friction == 0 ? 1e-4 : 1e-2) * difference.norm()) << friction;
  }
}

namespace {

constexpr double drum = 40, ends = 10;  // radius, and length of the straight part on either side [mm]

/// A strip of 4 x 0.5 mm, without stress, around a quarter of a drum, with a force at its high end.
RobotSpec strip_over_drum(double friction, double pull) {
  constexpr double gap = 0.06, arc = M_PI / 2;
  const double radius = drum + gap, length = 2 * ends + arc * radius;
  RobotSpec spec = physical_robot(block_mesh({48, 1, 1}, {length, 4, 0.5}));
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v) {
    const double s = spec.mesh.vertices(v, 0) - ends, out = radius + spec.mesh.vertices(v, 2);
    const double angle = std::clamp(s / radius, 0.0, arc), beyond = s - angle * radius;
    spec.mesh.vertices.row(v) << out * std::sin(angle) + beyond * std::cos(angle), spec.mesh.vertices(v, 1),
        out * std::cos(angle) - beyond * std::sin(angle);
  }
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic->youngs_modulus = 10;
  spec.fixed = {{{std::string("x_low"), {}}, {true, true, true}, {0, 0, 0}},
                {{std::string("x_high"), {}}, {true, true, true}, {0, 0, -pull}}};
  spec.contact.emplace();
  spec.contact->distance_mm = 0.05;
  spec.contact->friction = friction;
  spec.contact->self = false;
  spec.contact->obstacles.push_back({"drum", Cylinder{{0, -5, 0}, {0, 9, 0}, drum}, {}, {}});
  return spec;
}

}  // namespace

/// Where all of the strip slips its tensions are in the ratio of Euler and Eytelwein.
TEST(Friction, OfAStripOverADrum) {
  for (const double friction : {0.2, 0.4}) {
    const Model model = compile(strip_over_drum(friction, 3));
    const Statics statics(model);
    const Equilibrium found = moved(model, statics, 1);
    const Points all = statics.measured(found.state).reactions;
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (Index v = 0; v < model.robot_vertices(); ++v) (model.rest(v, 0) < 0 ? low : high) += all.row(v).transpose();
    EXPECT_NEAR(-high.z() / -low.x(), std::exp(friction * M_PI / 2), 0.03 * std::exp(friction * M_PI / 2));
    std::printf("friction %.1f: T2 / T1 %.4f, Eytelwein %.4f\n", friction, high.z() / low.x(),
                std::exp(friction * M_PI / 2));
  }
}

}  // namespace softkin
