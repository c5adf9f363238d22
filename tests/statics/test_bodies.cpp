#include <gtest/gtest.h>

#include <cmath>
#include <softkin/statics/statics.hpp>

#include "statics/contact_scenes.hpp"
#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

double weight(const Vec3& size) {
  return 1e-6 * size.prod() * gravity_m_s2;  // of 1000 kg/m^3
}

/// hold, then forces along x, y and z.
Equilibrium released(const Statics& statics) {
  return statics.solve(values({0, 0, 0, 0}), statics.rest(), tight());
}

}  // namespace

TEST(Bodies, AreHeldUntilReleased) {
  const Model model = compile(body_on_floor({10, 10, 10}, 0.5));
  const Statics statics(model);
  const Equilibrium held = solve_converged(statics, values({1, 0, 0, 0})), free = released(statics);
  ASSERT_EQ(held.report.status, Status::converged) << held.report.remark;
  ASSERT_EQ(free.report.status, Status::converged) << free.report.remark;
  const Index first = model.bodies[0].vertices.front();
  EXPECT_LT((held.state.positions.row(first) - model.rest.row(first)).norm(), 1e-4);
  const double drop = model.rest(first, 2) - free.state.positions(first, 2);
  EXPECT_GT(drop, 0.01);
  EXPECT_LT(drop, 0.06);
}

/// A block on a slope of 26.565 degrees: the tangent is 0.5 but for 1.1e-6.
TEST(Bodies, StickOnASlopeOrSlide) {
  constexpr double slope = 26.565 * M_PI / 180;
  const Model rough = compile(body_on_floor({10, 10, 10}, 0.50, slope));
  const Statics statics(rough);
  const Equilibrium sticks = released(statics);
  ASSERT_EQ(sticks.report.status, Status::converged) << sticks.report.remark;
  const ElementDeformation measured = statics.measured(sticks.state);
  ASSERT_EQ(measured.contacts->pairs.size(), 1U);
  const Vec3 force = measured.contacts->pairs[0].force;
  EXPECT_NEAR(std::abs(force.x()), weight({10, 10, 10}) * std::sin(slope), 0.01 * weight({10, 10, 10}));
  const Model smooth = compile(body_on_floor({10, 10, 10}, 0.49, slope));
  const Equilibrium slides = released(Statics(smooth));
  EXPECT_EQ(slides.report.status, Status::limit);
  EXPECT_NE(slides.report.remark.find("100 % of the friction contacts slip"), std::string::npos)
      << slides.report.remark;
}

/// A body that is pulled along the floor slips at the friction limit, or tips over its edge.
TEST(Bodies, PulledTheySlideOrTip) {
  struct Case {
    Vec3 size;
    double friction, fraction;  // of the weight
  };
  for (const Case& each : {Case{{10, 10, 10}, 0.3, 0.3}, Case{{10, 10, 40}, 1.0, 0.25}}) {
    const Model model = compile(body_on_floor(each.size, each.friction));
    const Statics statics(model);
    const Equilibrium free = released(statics);
    ASSERT_EQ(free.report.status, Status::converged) << free.report.remark;
    const double pull = weight(each.size);
    const Equilibrium pulled = statics.solve(values({0, pull, 0, 0}), free.state, tight(1e-8));
    EXPECT_EQ(pulled.report.status, Status::limit);
    EXPECT_NEAR(pulled.state.actuation[1] / pull, each.fraction, 0.01 * each.fraction) << pulled.report.remark;
  }
}

namespace {

/// A beam held at its end, above a block that is moved up against it.
RobotSpec pushed_beam(const Vec3& rest) {
  RobotSpec spec = physical_robot(block_mesh({8, 2, 2}, {40, 10, 10}));
  spec.fixed = {{{std::string("x_low"), {}}, {true, true, true}, {0, 0, 0}}};
  spec.contact.emplace();
  spec.contact->distance_mm = 0.1;
  spec.contact->obstacles.push_back(
      {"block", Box{Vec3(30, -5, -20) + rest, Vec3(36, 15, -1) + rest}, {}, {}, {false, false, true}});
  return spec;
}

}  // namespace

/// An obstacle that was moved is one that stood there.
TEST(Bodies, ObstaclesMove) {
  const Model model = compile(pushed_beam({0, 0, 0}));
  const Statics statics(model);
  const Equilibrium low = solve_converged(statics, values({1.5}), tight(1e-10));
  const Equilibrium moved = statics.solve(values({2.5}), low.state, tight(1e-10));
  ASSERT_EQ(moved.report.status, Status::converged) << moved.report.remark;
  EXPECT_GT((moved.state.positions - model.rest).topRows(model.robot_vertices()).col(2).maxCoeff(), 1);
  // over a lower one of the same place: from a start that has moved less
  const Model other = compile(pushed_beam({0, 0, -1}));
  const Statics below(other);
  const Equilibrium same = solve_converged(below, values({3.5}), tight(1e-10));
  EXPECT_LT(distance(moved.state.positions.topRows(model.robot_vertices()),
                     same.state.positions.topRows(model.robot_vertices())),
            1e-7);
}

/// A part that starts on the other side of an obstacle would stay there.
TEST(Bodies, AStartThatPassesThroughAnObstacleIsRefused) {
  const Model model = compile(pushed_beam({0, 0, 0}));
  const Statics statics(model);
  State start;
  start.positions = model.rest;
  for (Index v = 0; v < model.robot_vertices(); ++v)
    if (model.rest(v, 0) > 20) start.positions(v, 2) -= 4;
  try {
    (void)statics.solve(values({0}), start);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("the robot and obstacle 'block' pass through each other at ("),
              std::string::npos)
        << error.what();
  }
  for (Index v = 0; v < model.robot_vertices(); ++v)
    if (model.rest(v, 0) > 20) start.positions(v, 2) += 3.5;
  EXPECT_EQ(statics.solve(values({0}), start).report.status, Status::converged);
}

/// By the motion of an obstacle against central differences.
TEST(Bodies, JacobianByMotions) {
  const Model model = compile(pushed_beam({0, 0, 0}));
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({2.0}), tight(1e-11));
  const Sensitivity slopes = statics.sensitivity(at.state);
  ASSERT_TRUE(slopes.regular);
  constexpr double step = 1e-4;
  const Points high = statics.solve(values({2.0 + step}), at.state, tight(1e-11)).state.positions;
  const Points low = statics.solve(values({2.0 - step}), at.state, tight(1e-11)).state.positions;
  const Points difference = (high - low) / (2 * step);
  EXPECT_LT((slopes.positions[0] - difference).norm(), 1e-4 * difference.norm());
}

/// By forces on a body that stands on a floor and by its release.
TEST(Bodies, JacobianByForcesAndHolds) {
  RobotSpec spec = body_on_floor({10, 10, 10}, 0.5);
  const Model model = compile(spec);
  const Statics statics(model);
  const Actuation actuation = values({0.2, 2e-3, 1e-3, -4e-3});
  const Equilibrium at = solve_converged(statics, actuation, tight(1e-11));
  const Sensitivity slopes = statics.sensitivity(at.state);
  ASSERT_TRUE(slopes.regular);
  for (Index a = 0; a < 4; ++a) {
    const double step = a == 0 ? 1e-4 : 1e-6;
    const auto beside = [&](double change) {
      return statics.solve(actuation + change * Eigen::VectorXd::Unit(4, a), at.state, tight(1e-12)).state.positions;
    };
    const Points difference = (beside(step) - beside(-step)) / (2 * step);
    EXPECT_LT((slopes.positions[a] - difference).norm(), 1e-3 * difference.norm()) << a;
  }
}

}  // namespace softkin
