#include <softkin/statics/deformation.hpp>
#include <softkin/statics/statics.hpp>

#include "statics/robots.hpp"

namespace softkin {

namespace {

using testing::finger_robot;
using testing::mixed_robot;
using testing::noise;
using testing::shared;
using testing::values;

StaticsOptions newton(double tolerance_mm) {
  StaticsOptions options;
  options.step_tolerance_mm = tolerance_mm;
  options.max_iterations = 2000;
  return options;
}

/// Algorithm 1 as printed, to its end.
StaticsOptions as_printed() {
  StaticsOptions options;
  options.solver = Solver::local_global;
  options.step_tolerance_mm = 1e-11;
  options.max_iterations = 300000;
  options.anderson = 0;
  options.keep_history = false;
  return options;
}

/// Newton and Algorithm 1 from rest arrive at one shape, which is not the start.
void expect_same_fixed_point(const RobotSpec& spec, const Actuation& actuation) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium printed = statics.solve(actuation, statics.rest(), as_printed());
  ASSERT_EQ(printed.report.status, Status::converged);
  const Equilibrium found = statics.solve(actuation, statics.rest(), newton(1e-8));
  EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
  EXPECT_EQ(found.report.solver, "newton");
  EXPECT_EQ(found.report.continuation_steps, 1);
  EXPECT_LT(largest_move(found.state.positions, printed.state.positions), 1e-6)
      << "iterations " << found.report.iterations << ", energies " << found.report.energy << " and "
      << printed.report.energy;
  EXPECT_GT(largest_move(found.state.positions, model.rest), 0.5);
}

/// The mixed robot with one actuator at a time away from rest, then all.
const std::vector<Actuation> mixed_actuations{values({1.4, 1, 1}), values({0.7, 1, 1}), values({1, 1.8, 1}),
                                              values({1, 1, 0.7}), values({1.2, 1.6, 0.8})};

}  // namespace

TEST(TargetNewton, RestIsFoundAtOnce) {
  for (const bool minimum_norm : {false, true}) {
    const Model model = compile(mixed_robot(minimum_norm, 0.5));
    const Statics statics(model);
    const Equilibrium found = statics.solve(model.rest_actuation(), statics.rest());
    EXPECT_EQ(found.report.status, Status::converged);
    EXPECT_EQ(found.report.iterations, 1);
    EXPECT_LT(largest_move(found.state.positions, model.rest), 1e-12);
  }
}

TEST(TargetNewton, EveryActuatorWithUniformRatios) {
  for (const Actuation& actuation : mixed_actuations) {
    SCOPED_TRACE(actuation.transpose());
    expect_same_fixed_point(mixed_robot(false), actuation);
  }
}

TEST(TargetNewton, EveryActuatorWithLeastNormRatios) {
  for (const Actuation& actuation : mixed_actuations) {
    SCOPED_TRACE(actuation.transpose());
    expect_same_fixed_point(mixed_robot(true), actuation);
  }
}

TEST(TargetNewton, BlendedTargets) {
  for (const double shape_ratio : {0.5, 0.14})
    for (const bool minimum_norm : {false, true}) {
      SCOPED_TRACE(shape_ratio);
      expect_same_fixed_point(mixed_robot(minimum_norm, shape_ratio), values({1.2, 1.5, 0.85}));
      expect_same_fixed_point(finger_robot(minimum_norm, shape_ratio), values({1.8}));
    }
}

TEST(TargetNewton, FinerMesh) {
  const RobotSpec spec = mixed_robot(true, 0.5, 2);
  EXPECT_GT(spec.mesh.tetrahedra.size(), 1000u);
  expect_same_fixed_point(spec, values({1.2, 1.5, 0.85}));
}

TEST(TargetNewton, TwoMaterials) {
  RobotSpec spec = finger_robot(true);
  MaterialSpec floor;
  floor.region = "floor";
  floor.shape_ratio = 0.14;
  spec.materials.push_back(floor);
  expect_same_fixed_point(spec, values({1.6}));
  spec.materials.back().weight = 20;
  expect_same_fixed_point(spec, values({1.6}));
}

TEST(TargetNewton, RigidRegionsAndFixedAxes) {
  for (const bool minimum_norm : {false, true})
    for (const double shape_ratio : {1.0, 0.5}) {
      RobotSpec spec = mixed_robot(minimum_norm, shape_ratio);
      spec.rigid.push_back({{Box{{50, 0, 0}, {60, 20, 24}}, {}}, "end"});
      spec.rigid.push_back({{Box{{20, 0, 8}, {30, 20, 8}}, {}}, "patch"});
      expect_same_fixed_point(spec, values({1.2, 1.6, 0.85}));
      spec.rigid.pop_back();
      spec.fixed.push_back({{Box{{20, 0, 24}, {40, 0, 24}}, {}}, {false, true, false}});
      expect_same_fixed_point(spec, values({1.2, 1.6, 0.85}));
    }
}

TEST(TargetNewton, FromRandomStarts) {
  for (const bool minimum_norm : {false, true}) {
    const Model model = compile(finger_robot(minimum_norm));
    const Statics statics(model);
    const Points expected = statics.solve(values({1.8}), statics.rest(), as_printed()).state.positions;
    for (const double size : {0.3, 1.0, 3.0}) {
      State start = statics.rest();
      start.positions += noise(model.rest.rows(), size, 17);
      const Equilibrium found = statics.solve(values({1.8}), start, newton(1e-8));
      EXPECT_EQ(found.report.status, Status::converged);
      EXPECT_LT(largest_move(found.state.positions, expected), 1e-6) << "noise of " << size << " mm";
    }
  }
}

/// Every small step is followed by one of at most the size of its square: Algorithm 1 takes off a few percent.
TEST(TargetNewton, ConvergesQuadratically) {
  for (const bool minimum_norm : {false, true})
    for (const double shape_ratio : {1.0, 0.5}) {
      const Model model = compile(finger_robot(minimum_norm, shape_ratio));
      const Statics statics(model);
      const auto history = statics.solve(values({4.0}), statics.rest(), newton(1e-9)).report.history;
      int pairs = 0;
      for (std::size_t k = 1; k < history.size(); ++k) {
        const double before = history[k - 1].step_mm, after = history[k].step_mm;
        if (before > 0.3 || before < 1e-6) continue;
        EXPECT_LT(after, 3 * before * before);
        ++pairs;
      }
      EXPECT_GE(pairs, 2);
      EXPECT_LT(history.back().gradient_norm, 1e-10 * history.front().gradient_norm);
    }
}

TEST(TargetNewton, UsesFewIterationsAndFactorisations) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  for (const double ratio : {0.5, 0.7, 1.5, 2.0, 3.0, 4.0}) {
    const SolveReport report = statics.solve(values({ratio}), statics.rest()).report;
    EXPECT_EQ(report.status, Status::converged) << ratio;
    EXPECT_LE(report.iterations, 20) << ratio;
    EXPECT_LE(report.factorisations, 2 * report.iterations);
    EXPECT_GT(report.factorisations, 0);
  }
}

TEST(TargetNewton, ResultDoesNotDependOnThreads) {
  const Model model = compile(mixed_robot(true, 0.5));
  const Statics statics(model);
  StaticsOptions options;
  options.threads = 1;
  const Points alone = statics.solve(values({0.8, 1.6, 0.85}), statics.rest(), options).state.positions;
  for (const int threads : {2, 3}) {
    options.threads = threads;
    EXPECT_EQ(statics.solve(values({0.8, 1.6, 0.85}), statics.rest(), options).state.positions, alone);
  }
}

TEST(TargetNewton, ASecondSolveFromTheResultEndsAtOnce) {
  for (const bool minimum_norm : {false, true}) {
    const Model model = compile(mixed_robot(minimum_norm));
    const Statics statics(model);
    const Actuation actuation = values({1.2, 1.5, 0.9});
    const Equilibrium first = statics.solve(actuation, statics.rest());
    EXPECT_EQ(first.state.actuation, actuation);
    const Equilibrium second = statics.solve(actuation, first.state);
    EXPECT_EQ(second.report.status, Status::converged);
    EXPECT_LE(second.report.iterations, 2);
    EXPECT_LT(largest_move(first.state.positions, second.state.positions), 1e-6);
  }
}

TEST(TargetNewton, ReportsWhatHappened) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  StaticsOptions options;
  options.max_iterations = 2;
  const Equilibrium cut = statics.solve(values({1.5}), statics.rest(), options);
  EXPECT_EQ(cut.report.status, Status::not_converged);
  EXPECT_EQ(cut.report.iterations, 2);
  EXPECT_FALSE(cut.report.remark.empty());
  EXPECT_EQ(cut.state.actuation.size(), 0);
  int calls = 0;
  const Equilibrium stopped =
      statics.solve(values({1.5}), statics.rest(), {}, [&](const Progress& p) { return ++calls, p.iteration < 3; });
  EXPECT_EQ(stopped.report.status, Status::interrupted);
  EXPECT_EQ(stopped.report.iterations, 3);
  EXPECT_EQ(calls, 3);
  const SolveReport report = statics.solve(values({1.5}), statics.rest()).report;
  EXPECT_EQ(report.iterations, static_cast<int>(report.history.size()));
  EXPECT_LT(report.step_mm, report.tolerance_mm);
}

TEST(TargetNewton, OverflowEndsAsNotConvergedWithFiniteNumbers) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  State start = statics.rest();
  start.positions += noise(model.rest.rows(), 1e200, 3);
  const Equilibrium found = statics.solve(values({1.5}), start);
  EXPECT_EQ(found.report.status, Status::not_converged);
  EXPECT_TRUE(found.state.positions.allFinite());
  const SolveReport& r = found.report;
  EXPECT_TRUE(std::isfinite(r.energy + r.step_mm + r.gradient_norm + r.estimated_error_mm));
}

/// Nothing resists a free chamber's growth: the matrix near the derivative is singular but for the redistribution.
TEST(TargetNewton, FreeChamberAlone) {
  RobotSpec spec;
  spec.mesh = testing::block_mesh({3, 3, 3}, {9, 9, 9}, testing::Split::five);
  spec.fixed = {{{VertexList{{0}}, {}}, {true, true, true}},
                {{VertexList{{3}}, {}}, {false, true, true}},
                {{VertexList{{12}}, {}}, {false, false, true}}};
  ActuatorSpec air = testing::actuator("air", PneumaticSpec{.region = "body"}, 0.5, 3, true);
  for (const bool minimum_norm : {true, false}) {
    air.distribution = testing::shared(minimum_norm);
    spec.actuators = {air};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = statics.solve(values({1.7}), statics.rest(), newton(1e-9));
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    EXPECT_NEAR(achieved_ratio(model, model.actuators[0], found.state.positions), 1.7, 1e-8);
  }
}

/// A chamber is to have many times its volume at once: Newton's method finds the shape by intermediate equilibria.
/// Rounding decides which of these commands are too far for one call.
TEST(TargetNewton, GoesThroughEquilibriaInBetweenWhereOneCallIsTooFar) {
  struct Case {
    bool minimum_norm;
    double load_state;
  };
  bool any = false;
  for (const auto& [minimum_norm, load_state] : {Case{false, 100}, Case{true, 80}, Case{true, 70}, Case{true, 90}}) {
    RobotSpec spec = finger_robot(minimum_norm, 0.5);
    spec.actuators[0].high = 200;
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = statics.solve(values({load_state}), statics.rest(), newton(1e-8));
    if (found.report.status != Status::converged || found.report.continuation_steps <= 1) continue;
    StaticsOptions once = as_printed();
    once.max_iterations = 1;
    EXPECT_LT(statics.solve(values({load_state}), found.state, once).report.step_mm, 1e-7);  // Algorithm 1 stays there
    any = true;
    // from an equilibrium nearby it is one step
    const Equilibrium next = statics.solve(values({load_state + 1}), found.state, newton(1e-8));
    EXPECT_EQ(next.report.status, Status::converged) << load_state;
    EXPECT_EQ(next.report.continuation_steps, 1) << load_state;
    break;
  }
  EXPECT_TRUE(any);
}

TEST(TargetNewton, EarlierSolvesLeaveNoTrace) {
  const Model model = compile(mixed_robot(true, 0.5));
  const Statics statics(model), fresh(model);
  (void)statics.solve(values({0.7, 2.0, 0.8}), statics.rest());
  EXPECT_EQ(statics.solve(values({1.2, 1.5, 0.9}), statics.rest()).state.positions,
            fresh.solve(values({1.2, 1.5, 0.9}), fresh.rest()).state.positions);
}

/// A layer without resistance to shear is a mechanism: no shape to converge to, and no blow-up.
TEST(TargetNewton, MechanismEndsWithFiniteNumbers) {
  RobotSpec spec = finger_robot(true);
  MaterialSpec floor;
  floor.region = "floor";
  floor.shape_ratio = 0;
  spec.materials.push_back(floor);
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options;
  options.max_iterations = 1500;
  const Equilibrium found = statics.solve(values({1.6}), statics.rest(), options);
  EXPECT_TRUE(found.state.positions.allFinite());
  EXPECT_TRUE(std::isfinite(found.report.energy + found.report.step_mm + found.report.gradient_norm));
}

TEST(TargetNewton, SoftAndNearlyRigidNeighbours) {
  for (const double ratio : {0.0, 0.001}) {
    RobotSpec spec = finger_robot(true);
    testing::add_volume_region(spec.mesh, "inclusion", [](const Vec3& p) { return p.x() > 20 && p.x() < 30; });
    MaterialSpec soft;
    soft.region = "inclusion";
    soft.shape_ratio = ratio;
    spec.materials.push_back(soft);
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = statics.solve(values({1.6}), statics.rest());
    EXPECT_EQ(found.report.status, Status::converged);
    const ElementDeformation deformation = deformation_of(model, found.state.positions);
    EXPECT_GT(*std::min_element(deformation.volume_ratio.begin(), deformation.volume_ratio.end()), 0.5);
  }
}

}  // namespace softkin
