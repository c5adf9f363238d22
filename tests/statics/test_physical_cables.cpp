#include <softkin/statics/deformation.hpp>

#include "statics/physical_samples.hpp"

/// A cable pulls and never pushes.

namespace softkin {

namespace {

using namespace testing;

/// The finger with a cable along its lower side.
RobotSpec finger_with_cable() {
  RobotSpec spec = bending_finger();
  spec.actuators.push_back(cable("tendon", {{2, 6, 1}, {30, 6, 1}, {58, 6, 1}}));
  return spec;
}

/// How long the cable would be, over its length at rest, if it were not there.
double free_ratio(const Model& model, const Points& positions) {
  return achieved_ratio(model, model.actuators[1], positions);
}

}  // namespace

TEST(PhysicalCables, OneThatWouldPushGoesSlack) {
  const Model model = compile(finger_with_cable()), bare_model = compile(bending_finger());
  const Statics statics(model), bare(bare_model);
  const Equilibrium alone = solve_converged(bare, values({2.0}));
  const double free = free_ratio(model, alone.state.positions);
  const Equilibrium found = solve_converged(statics, values({2.0, free + 0.01}));
  EXPECT_EQ(found.state.multipliers[1], 0);
  EXPECT_LT(distance(found.state.positions, alone.state.positions), 1e-8);
  EXPECT_GT(solve_converged(statics, values({2.0, free - 0.01})).state.multipliers[1], 0.01);
}

/// Along a path of lengths: slack while it is longer than the body wants, tight from there on. Tension sets in at zero.
TEST(PhysicalCables, TightensAgainAlongAPath) {
  const Model model = compile(finger_with_cable()), bare_model = compile(bending_finger());
  const Statics statics(model), bare(bare_model);
  const Points slack = solve_converged(bare, values({1.5})).state.positions;
  const double free = free_ratio(model, slack);
  Equilibrium found = solve_converged(statics, values({1.5, free + 0.02}));
  EXPECT_EQ(found.state.multipliers[1], 0);
  double last = 0;
  for (const double beyond : {-0.004, -0.001, 0.001, 0.004, 0.016}) {
    found = statics.solve(values({1.5, free - beyond}), found.state, tight());
    ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
    const double tension = found.state.multipliers[1];
    if (beyond < 0) {
      EXPECT_EQ(tension, 0);
      EXPECT_LT(distance(found.state.positions, slack), 1e-7);
    } else {
      EXPECT_GT(tension, last);
      EXPECT_NEAR(achieved_ratio(model, model.actuators[1], found.state.positions), free - beyond, 1e-10);
      if (last > 0) {
        EXPECT_NEAR(tension / last, 4, 1);
      }
      last = tension;
    }
  }
  // and back
  found = statics.solve(values({1.5, free + 0.02}), found.state, tight());
  EXPECT_EQ(found.report.status, Status::converged);
  EXPECT_EQ(found.state.multipliers[1], 0);
  EXPECT_LT(distance(found.state.positions, slack), 1e-7);
}

/// Along a path a slack cable costs no factorisation more than none at all.
TEST(PhysicalCables, ASlackOneIsFree) {
  const Model model = compile(finger_with_cable()), bare_model = compile(bending_finger());
  const Statics statics(model), bare(bare_model);
  State state = solve_converged(statics, values({1.5, 1.4})).state,
        bare_state = solve_converged(bare, values({1.5})).state;
  for (const double ratio : {1.52, 1.54, 1.56}) {
    const Equilibrium found = statics.solve(values({ratio, 1.4}), state),
                      alone = bare.solve(values({ratio}), bare_state);
    EXPECT_EQ(found.report.factorisations, alone.report.factorisations);
    EXPECT_EQ(found.state.multipliers[1], 0);
    state = found.state;
    bare_state = alone.state;
  }
}

/// Of two cables one may slacken the other; both shortened, both pull. No cable is longer than it may be, and one that
/// is shorter carries nothing.
TEST(PhysicalCables, Two) {
  const Model model = compile(cable_beam());
  const Statics statics(model);
  const Actuation requested[] = {values({0.9, 1.0}),  values({0.9, 1.2}), values({0.95, 0.95}),
                                 values({0.97, 0.9}), values({1.2, 1.2}), values({0.8, 0.93})};
  int slack = 0, tight_ones = 0;
  for (const Actuation& actuation : requested) {
    const Equilibrium found = solve_converged(statics, actuation);
    for (Index a = 0; a < 2; ++a) {
      const double tension = found.state.multipliers[a],
                   ratio = achieved_ratio(model, model.actuators[a], found.state.positions);
      EXPECT_GE(tension, 0);
      if (tension > 0) {
        EXPECT_NEAR(ratio, actuation[a], 1e-9);
        ++tight_ones;
      } else {
        EXPECT_LT(ratio, actuation[a] + 1e-9);
        ++slack;
      }
    }
  }
  EXPECT_GT(slack, 2);
  EXPECT_GT(tight_ones, 5);
  const Equilibrium both = solve_converged(statics, values({0.95, 0.95}));
  EXPECT_NEAR(both.state.multipliers[0], both.state.multipliers[1], 0.1 * both.state.multipliers[0]);
  EXPECT_NEAR(marker_at(model, both)[2], 5, 0.5);
}

/// Four cables along the edges get random lengths one after another: active cables have their commanded length, the
/// others are slack and carry nothing.
TEST(PhysicalCables, FourWithRandomLengths) {
  RobotSpec spec = physical_robot(block_mesh({12, 3, 3}, {60, 12, 12}));
  for (const double y : {1.0, 11.0})
    for (const double z : {1.0, 11.0})
      spec.actuators.push_back(
          cable("cable" + std::to_string(spec.actuators.size()), {{0, y, z}, {20, y, z}, {40, y, z}, {60, y, z}}));
  const Model model = compile(spec);
  const Statics statics(model);
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> ratio(0.7, 1.4);
  State state = statics.rest();
  int slack = 0, pulling = 0;
  for (int i = 0; i < 15; ++i) {
    const Actuation requested = Actuation::NullaryExpr(4, [&] { return ratio(engine); });
    const Equilibrium found = statics.solve(requested, state);
    ASSERT_EQ(found.report.status, Status::converged) << requested.transpose() << ": " << found.report.remark;
    state = found.state;
    for (Index a = 0; a < 4; ++a) {
      const double length = achieved_ratio(model, model.actuators[a], state.positions);
      if (state.multipliers[a] > 0) {
        EXPECT_NEAR(length, requested[a], 1e-7);
        ++pulling;
      } else {
        EXPECT_EQ(state.multipliers[a], 0);
        EXPECT_LT(length, requested[a] + 1e-7);
        ++slack;
      }
    }
  }
  EXPECT_GT(slack, 10);
  EXPECT_GT(pulling, 10);
}

/// At rest nothing pulls, whatever the sign of what rounding leaves.
TEST(PhysicalCables, AtRest) {
  const Model model = compile(cable_beam());
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.0, 1.0}));
  EXPECT_LT(distance(found.state.positions, model.rest), 1e-9);
  EXPECT_LT(found.state.multipliers.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GE(found.state.multipliers.minCoeff(), 0);
  const Model finger = compile(finger_with_cable());
  const Statics finger_statics(finger);
  EXPECT_LT(distance(solve_converged(finger_statics, values({1.0, 1.0})).state.positions, finger.rest), 1e-9);
}

/// Two cables along one path: the shorter one carries all; with the same length, both carry half.
TEST(PhysicalCables, AlongOneWay) {
  RobotSpec spec = cable_beam();
  spec.actuators.pop_back();
  const Model alone = compile(spec);
  const Statics alone_statics(alone);
  spec.actuators.push_back(spec.actuators[0]);
  spec.actuators[1].name = "twin";
  const Model model = compile(spec);
  const Statics statics(model);
  for (const auto& [first, second] :
       {std::pair{0.9, 0.8}, {0.8, 0.9}, {0.9, 0.9}, {1.0, 0.9}, {0.9, 1.2}, {1.0, 1.0}}) {
    const Equilibrium both = solve_converged(statics, values({first, second})),
                      one = solve_converged(alone_statics, values({std::min(first, second)}));
    EXPECT_LT(distance(both.state.positions, one.state.positions), 1e-7) << first << " " << second;
    EXPECT_NEAR(both.state.multipliers.sum(), one.state.multipliers[0], 1e-6);
    EXPECT_GE(both.state.multipliers.minCoeff(), -1e-12);
    if (first != second) {
      EXPECT_EQ(both.state.multipliers[first > second ? 0 : 1], 0);
    }
  }
}

/// A cable under tension control accepts no negative command.
TEST(PhysicalCables, TensionControlPullsAsAsked) {
  RobotSpec spec = cable_beam();
  spec.actuators = {by_load(spec.actuators[0])};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium none = solve_converged(statics, values({0}));
  EXPECT_LT(distance(none.state.positions, model.rest), 1e-9);
  const Equilibrium pulled = solve_converged(statics, values({0.5}));
  EXPECT_EQ(pulled.state.multipliers[0], 0.5);
  EXPECT_GT(marker_at(model, pulled)[2], 5.5);
  EXPECT_THROW((void)statics.solve(values({-0.1}), statics.rest()), InvalidInput);
}

/// In a channel off the axis a tension T bends a beam into an arc: per length at rest it turns by T d over E I, I of
/// the section at rest and E by the slope of the law at the compression that T brings. Straight from end to end, across
/// the bend, the same tension has no equilibrium.
TEST(PhysicalCables, InAChannelBendsABeamIntoAnArc) {
  const double length = 100, side = 6, offset = 2, tension = 0.7;
  RobotSpec spec = physical_robot(block_mesh({20, 1, 1}, {length, side, side}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::st_venant_kirchhoff, 1, 0);
  spec.actuators = {
      by_load(cable("tendon", {{0, side / 2, side / 2 - offset}, {length, side / 2, side / 2 - offset}}))};
  // E (l^3 - l) / 2 is the force over the section at rest
  double stretch = 1;
  for (int i = 0; i < 50; ++i)
    stretch -= ((std::pow(stretch, 3) - stretch) / 2 + tension / (side * side)) / ((3 * stretch * stretch - 1) / 2);
  const double modulus = (3 * stretch * stretch - 1) / 2,
               curvature = tension * offset / (modulus * std::pow(side, 4) / 12);
  const auto solved = [&](const Model& model) {
    const Statics statics(model);
    return statics.solve(values({tension}), statics.rest());
  };
  spec.actuators[0].as<CableSpec>()->spacing = 2.5;
  const Model guided = compile(spec);
  const Equilibrium found = solved(guided);
  ASSERT_EQ(found.report.status, Status::converged);
  Vec3 across = Vec3::Zero();  // the end face, from below to above
  for (Index v = 0; v < guided.rest.rows(); ++v)
    if (guided.rest(v, 0) > length - 1e-6)
      across += (guided.rest(v, 2) - side / 2) * found.state.positions.row(v).transpose();
  EXPECT_NEAR(std::atan2(across[0], across[2]) / (curvature * length), 1, 0.01);
  spec.actuators[0].as<CableSpec>()->spacing = 0;
  EXPECT_EQ(solved(compile(spec)).report.status, Status::limit);
}

/// A negative offset of 0.5 N leaves the bottom cable slack up to a command of 0.5 N: until then the command changes
/// nothing, which tangents and derivatives know, and the path through that corner takes few iterations.
TEST(PhysicalCables, ACommandBelowANegativeOffsetDoesNothing) {
  RobotSpec spec = cable_beam();
  for (ActuatorSpec& each : spec.actuators) each = by_load(each);
  spec.actuators[1].offset = -0.5;
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium slack = solve_converged(statics, values({0.4, 0.3})),
                    none = solve_converged(statics, values({0.4, 0}));
  EXPECT_LT(distance(slack.state.positions, none.state.positions), 1e-9);
  const Sensitivity slopes = statics.sensitivity(slack.state);
  EXPECT_EQ(slopes.positions[1].cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(slopes.multipliers(1, 1), 0);
  const Equilibrium pulled = solve_converged(statics, values({0.4, 0.9}));
  RobotSpec acting = spec;
  acting.actuators[1].offset = 0;
  const Model other = compile(acting);
  const Statics direct(other);
  const Equilibrium expected = solve_converged(direct, values({0.4, 0.4}));
  EXPECT_LT(distance(pulled.state.positions, expected.state.positions), 1e-7);
  EXPECT_LE(pulled.report.iterations, 100);
  EXPECT_GT(statics.sensitivity(pulled.state).positions[1].cwiseAbs().maxCoeff(), 0);
}

}  // namespace softkin
