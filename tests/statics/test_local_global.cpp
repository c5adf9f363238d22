#include <Eigen/Geometry>
#include <softkin/core/error.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/statics.hpp>

#include "statics/robots.hpp"

namespace softkin {

namespace {

using testing::finger_robot;
using testing::mixed_robot;
using testing::noise;

StaticsOptions local_global() {
  StaticsOptions options;
  options.solver = Solver::local_global;
  return options;
}

StaticsOptions to_the_end(int anderson) {
  StaticsOptions options = local_global();
  options.step_tolerance_mm = 1e-11;
  options.max_iterations = 200000;
  options.anderson = anderson;
  options.keep_history = false;
  return options;
}

Actuation one(double value) {
  return Actuation::Constant(1, value);
}

}  // namespace

TEST(LocalGlobal, EnergyFallsAtEveryIterationWhereTargetsAreFixed) {
  const Model model = compile(mixed_robot(false));
  const Statics statics(model);
  std::mt19937 engine(5);
  StaticsOptions options = local_global();
  options.anderson = 0;
  options.max_iterations = 60;
  for (int round = 0; round < 100; ++round) {
    Actuation actuation(3);
    for (int a = 0; a < 3; ++a)
      actuation[a] = std::uniform_real_distribution<double>(model.actuators[a].low, model.actuators[a].high)(engine);
    State start = statics.rest();
    if (round % 2) start.positions += noise(model.rest.rows(), 3, round);
    const auto history = statics.solve(actuation, start, options).report.history;
    ASSERT_GT(history.size(), 5u);
    for (std::size_t i = 1; i < history.size(); ++i)
      ASSERT_LE(history[i].energy, history[i - 1].energy * (1 + 1e-13)) << "round " << round << " iteration " << i;
  }
}

TEST(LocalGlobal, SameShapeFromRestAndFromARandomStart) {
  const Model model = compile(finger_robot(false));
  EXPECT_NEAR(static_cast<double>(model.elements.tetrahedra.size()), 500, 50);
  const Statics statics(model);
  const Points from_rest = statics.solve(one(1.8), statics.rest(), to_the_end(0)).state.positions;
  EXPECT_GT(largest_move(from_rest, model.rest), 1);
  for (const double size : {1.0, 5.0, 10.0, 20.0}) {
    State start = statics.rest();
    start.positions += noise(model.rest.rows(), size, 17);
    for (const int anderson : {0, 6}) {
      if (anderson > 0 && size > 5) continue;  // from a crumpled start its jumps may end in another equilibrium
      const Equilibrium found = statics.solve(one(1.8), start, to_the_end(anderson));
      EXPECT_EQ(found.report.status, Status::converged);
      EXPECT_LT(largest_move(found.state.positions, from_rest), 1e-6)
          << "noise of " << size << " mm, Anderson " << anderson;
    }
  }
}

TEST(LocalGlobal, AndersonReachesTheSameShapeInFewerIterations) {
  for (const bool minimum_norm : {false, true})
    for (const double ratio : {1.0, 0.3}) {
      const Model model = compile(mixed_robot(minimum_norm, ratio));
      const Statics statics(model);
      const Actuation actuation = (Actuation(3) << 1.1, 1.5, 0.9).finished();
      const Equilibrium plain = statics.solve(actuation, statics.rest(), to_the_end(0));
      const Equilibrium fast = statics.solve(actuation, statics.rest(), to_the_end(6));
      EXPECT_EQ(plain.report.status, Status::converged);
      EXPECT_EQ(fast.report.status, Status::converged);
      EXPECT_LT(largest_move(plain.state.positions, fast.state.positions), 1e-6);
      EXPECT_LT(2 * fast.report.iterations, plain.report.iterations);
    }
}

TEST(LocalGlobal, EstimatedErrorBoundsTheTrueOne) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  const Points end = statics.solve(one(1.5), statics.rest(), to_the_end(6)).state.positions;
  for (const int anderson : {0, 6}) {
    StaticsOptions options = local_global();
    options.step_tolerance_mm = 1e-4;
    options.anderson = anderson;
    const Equilibrium found = statics.solve(one(1.5), statics.rest(), options);
    const double true_error = largest_move(found.state.positions, end);
    EXPECT_GT(true_error, 5e-4);  // the step alone would promise 1e-4
    EXPECT_GT(found.report.estimated_error_mm, 0.3 * true_error);
    EXPECT_LT(found.report.estimated_error_mm, 30 * true_error);
  }
}

/// Counted by hand: the iterations of Algorithm 1, one by one, until no marker has moved by 0.032 mm, ten at least.
TEST(LocalGlobal, StopsAsPublishedWhereMarkersHardlyMove) {
  RobotSpec spec = mixed_robot(true);
  spec.markers = {{"tip", {Vec3(60, 10, 12), {}}}, {"middle", {Vec3(30, 10, 12), {}}}};
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions published = local_global();
  published.as_published = true;
  StaticsOptions single = local_global();
  single.anderson = 0;
  single.max_iterations = 1;
  std::vector<int> counts;
  for (const Actuation& requested : {testing::values({1, 1.01, 1}), testing::values({1.9, 2.9, 0.55})}) {
    const Equilibrium stopped = statics.solve(requested, statics.rest(), published);
    EXPECT_EQ(stopped.report.status, Status::converged);
    EXPECT_EQ(stopped.report.tolerance_mm, 0.032);
    State shape = statics.rest();
    int iterations = 0;
    double moved = 1;
    while (iterations < 10 || moved >= 0.032) {
      const Points before = shape.positions;
      shape.positions = statics.solve(requested, shape, single).state.positions;
      ++iterations;
      moved = 0;
      for (const Marker& marker : model.markers)
        moved = std::max(moved, (marker.point.at(shape.positions) - marker.point.at(before)).norm());
    }
    EXPECT_EQ(stopped.report.iterations, iterations);
    EXPECT_LT(largest_move(stopped.state.positions, shape.positions), 1e-6);  // rotations begin warm there
    counts.push_back(iterations);
  }
  EXPECT_EQ(counts[0], 10);
  EXPECT_GT(counts[1], 20);
}

TEST(LocalGlobal, StoppingAsPublishedNeedsMarkersAndAlgorithmOne) {
  const auto refusal = [](bool marker, Solver solver) -> std::string {
    RobotSpec spec = finger_robot(true);
    if (marker) spec.markers = {{"tip", {Vec3(50, 6, 6), {}}}};
    const Model model = compile(spec);
    const Statics statics(model);
    StaticsOptions options;
    options.solver = solver;
    options.as_published = true;
    try {
      (void)statics.solve(one(1.1), statics.rest(), options);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(true, Solver::newton), "to stop as published is for solver local-global");
  EXPECT_EQ(refusal(false, Solver::local_global), "to stop as published watches the robot's markers, and it has none");
}

TEST(LocalGlobal, RigidMotionOfTheSceneMovesTheResult) {
  const RobotSpec spec = mixed_robot(true, 0.5);
  const Mat3 turn = Eigen::AngleAxisd(2.3, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Vec3 shift(40, -70, 15);
  const auto move = [&](const Vec3& p) { return Vec3(turn * p + shift); };
  RobotSpec moved = spec;
  moved.mesh.vertices = (spec.mesh.vertices * turn.transpose()).rowwise() + shift.transpose();
  for (PointRef& point : moved.actuators[2].as<CableSpec>()->points) point.point = move(std::get<Vec3>(point.point));
  const Model here = compile(spec), there = compile(moved);
  const Statics statics_here(here), statics_there(there);
  const Actuation actuation = (Actuation(3) << 0.8, 1.6, 0.85).finished();
  const Points a = statics_here.solve(actuation, statics_here.rest(), to_the_end(6)).state.positions;
  const Points b = statics_there.solve(actuation, statics_there.rest(), to_the_end(6)).state.positions;
  const Points expected = (a * turn.transpose()).rowwise() + shift.transpose();
  EXPECT_LT(largest_move(b, expected), 1e-9 * here.diagonal_mm);
  EXPECT_GT(largest_move(a, here.rest), 1);
}

TEST(LocalGlobal, ScalingTheSceneScalesTheResult) {
  const RobotSpec spec = mixed_robot(true, 0.5);
  const Actuation actuation = (Actuation(3) << 0.8, 1.6, 0.85).finished();
  const Model here = compile(spec);
  const Statics statics(here);
  const Points a = statics.solve(actuation, statics.rest(), to_the_end(6)).state.positions;
  for (const double scale : {1e-3, 7.0, 1000.0}) {
    RobotSpec scaled = spec;
    scaled.mesh.vertices *= scale;
    for (PointRef& point : scaled.actuators[2].as<CableSpec>()->points)
      point.point = Vec3(scale * std::get<Vec3>(point.point));
    const Model there = compile(scaled);
    const Statics statics_there(there);
    StaticsOptions options = to_the_end(6);
    options.step_tolerance_mm *= scale;
    const Points b = statics_there.solve(actuation, statics_there.rest(), options).state.positions;
    EXPECT_LT(largest_move(b / scale, a), 1e-9 * here.diagonal_mm) << "scale " << scale;
    // the default tolerance scales with the robot
    EXPECT_NEAR(statics_there.solve(actuation, statics_there.rest()).report.tolerance_mm,
                scale * statics.solve(actuation, statics.rest(), local_global()).report.tolerance_mm, 1e-12 * scale);
  }
}

TEST(LocalGlobal, ResultDoesNotDependOnThreads) {
  const Model model = compile(mixed_robot(true, 0.5));
  const Statics statics(model);
  const Actuation actuation = (Actuation(3) << 0.8, 1.6, 0.85).finished();
  StaticsOptions options = local_global();
  options.max_iterations = 50;
  options.threads = 1;
  const Points one_thread = statics.solve(actuation, statics.rest(), options).state.positions;
  for (const int threads : {2, 3}) {
    options.threads = threads;
    EXPECT_EQ(statics.solve(actuation, statics.rest(), options).state.positions, one_thread);
  }
}

/// A tenth of the finger's cross-section above the chamber, or a slice of it, that resists volume change only.
RobotSpec with_inclusion(double ratio, bool slice) {
  RobotSpec spec = finger_robot(true);
  testing::add_volume_region(spec.mesh, "inclusion", [&](const Vec3& p) {
    return slice ? p.x() > 20 && p.x() < 30 : p.z() > 8 && p.y() > 4 && p.y() < 8 && p.x() > 5 && p.x() < 45;
  });
  MaterialSpec soft;
  soft.region = "inclusion";
  soft.shape_ratio = ratio;
  spec.materials.push_back(soft);
  return spec;
}

TEST(LocalGlobal, SoftAndNearlyRigidNeighboursStayWellPosed) {
  for (const double ratio : {0.0, 0.001})
    for (const bool slice : {false, true}) {
      const Model model = compile(with_inclusion(ratio, slice));
      const Statics statics(model);
      const Equilibrium found = statics.solve(one(1.6), statics.rest(), local_global());
      EXPECT_EQ(found.report.status, Status::converged);
      const ElementDeformation deformation = deformation_of(model, found.state.positions);
      EXPECT_GT(*std::min_element(deformation.volume_ratio.begin(), deformation.volume_ratio.end()), 0.5);
    }
  // a whole load-bearing layer without resistance to shear is a mechanism: no shape to converge to, but no blow-up
  RobotSpec fluid = finger_robot(true);
  MaterialSpec floor_material;
  floor_material.region = "floor";
  floor_material.shape_ratio = 0;
  fluid.materials.push_back(floor_material);
  const Model mechanism = compile(fluid);
  const Statics fluid_statics(mechanism);
  StaticsOptions few = local_global();
  few.max_iterations = 2000;
  const Equilibrium drifting = fluid_statics.solve(one(1.6), fluid_statics.rest(), few);
  EXPECT_EQ(drifting.report.status, Status::not_converged);
  EXPECT_TRUE(drifting.state.positions.allFinite());
  EXPECT_GT(drifting.report.estimated_error_mm, 0.1);
  // and it is seen before 50,000 iterations are over
  const Equilibrium stalled = fluid_statics.solve(one(1.6), fluid_statics.rest(), local_global());
  EXPECT_EQ(stalled.report.status, Status::not_converged);
  EXPECT_LT(stalled.report.iterations, 40000);
  EXPECT_EQ(stalled.report.remark, "the last 2000 iterations led nowhere");
  // ratio 1e3 of the weights
  RobotSpec spec = finger_robot(true);
  MaterialSpec floor;
  floor.region = "floor";
  floor.weight = 1000;
  spec.materials.push_back(floor);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve(one(1.6), statics.rest(), local_global());
  EXPECT_EQ(found.report.status, Status::converged);
  const ElementDeformation deformation = deformation_of(model, found.state.positions);
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    if (model.elements.tetrahedron_roles[e].material == 1) {
      EXPECT_LT(std::max(deformation.strain[e][0], -deformation.strain[e][2]), 0.01);
    }
}

TEST(LocalGlobal, UniformRatiosAreKeptAndLeastNormMeetsTheSum) {
  // a free chamber alone: nothing resists, so the achieved ratio is the requested one
  Mesh mesh = testing::block_mesh({3, 3, 3}, {9, 9, 9}, testing::Split::five);
  RobotSpec spec;
  spec.mesh = mesh;
  spec.fixed = {{{VertexList{{0}}, {}}, {true, true, true}},
                {{VertexList{{3}}, {}}, {false, true, true}},
                {{VertexList{{12}}, {}}, {false, false, true}}};
  ActuatorSpec air = testing::actuator("air", PneumaticSpec{.region = "body"}, 0.5, 3, true);
  for (const bool minimum_norm : {true, false}) {
    air.distribution = shared(minimum_norm);
    spec.actuators = {air};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = statics.solve(one(1.7), statics.rest(), to_the_end(6));
    EXPECT_EQ(found.report.status, Status::converged);
    EXPECT_NEAR(achieved_ratio(model, model.actuators[0], found.state.positions), 1.7, 1e-8);
    // uniform scaling about the held corner
    if (!minimum_norm) {
      EXPECT_LT(largest_move(found.state.positions, std::cbrt(1.7) * model.rest), 1e-7);
    }
  }
}

TEST(LocalGlobal, RefusesWhatItCannotSolve) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  State start = statics.rest();
  EXPECT_THROW((void)statics.solve(Actuation(2), start), InvalidInput);
  EXPECT_THROW((void)statics.solve(one(4.1), start), InvalidInput);
  EXPECT_THROW((void)statics.solve(one(std::nan("")), start), InvalidInput);
  StaticsOptions options = local_global();
  options.max_iterations = -1;
  EXPECT_THROW((void)statics.solve(one(1.2), start, options), InvalidInput);
  start.positions(3, 1) = std::nan("");
  EXPECT_THROW((void)statics.solve(one(1.2), start), InvalidInput);
  start.positions.resize(2, 3);
  EXPECT_THROW((void)statics.solve(one(1.2), start), InvalidInput);
}

TEST(LocalGlobal, OverflowEndsAsNotConvergedWithFiniteNumbers) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  State start = statics.rest();
  start.positions += noise(model.rest.rows(), 1e200, 3);
  const Equilibrium found = statics.solve(one(1.5), start, local_global());
  EXPECT_EQ(found.report.status, Status::not_converged);
  EXPECT_TRUE(found.state.positions.allFinite());
  const SolveReport& r = found.report;
  EXPECT_TRUE(std::isfinite(r.energy + r.step_mm + r.gradient_norm + r.estimated_error_mm));
}

TEST(LocalGlobal, WhenIterationsRunOutTheShapeIsOneThatWasSolvedFor) {
  const Model model = compile(finger_robot(false));
  const Statics statics(model);
  StaticsOptions options = local_global();
  options.max_iterations = 12;
  const Equilibrium stopped = statics.solve(one(1.5), statics.rest(), options);
  options.max_iterations = 1;
  // the energy at the shape is that after the last step, so not above the one before it
  EXPECT_LE(statics.solve(one(1.5), stopped.state, options).report.energy, stopped.report.energy);
}

TEST(LocalGlobal, ReportsWhatHappened) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  StaticsOptions options = local_global();
  options.max_iterations = 3;
  EXPECT_EQ(statics.solve(one(1.5), statics.rest(), options).report.status, Status::not_converged);
  int calls = 0;
  const Equilibrium stopped = statics.solve(one(1.5), statics.rest(), local_global(),
                                            [&](const Progress& p) { return ++calls, p.iteration < 4; });
  EXPECT_EQ(stopped.report.status, Status::interrupted);
  EXPECT_EQ(stopped.report.iterations, 4);
  EXPECT_EQ(calls, 4);
  const Equilibrium found = statics.solve(one(1.5), statics.rest(), local_global());
  EXPECT_EQ(found.report.status, Status::converged);
  EXPECT_EQ(found.report.iterations, static_cast<int>(found.report.history.size()));
  EXPECT_LT(found.report.step_mm, found.report.tolerance_mm);
  EXPECT_LT(found.report.history.back().gradient_norm, 1e-3 * found.report.history.front().gradient_norm);
}

/// The gradient norm that is reported is that of the energy that is reported.
TEST(LocalGlobal, GradientNormIsThatOfTheEnergy) {
  const Model model = compile(finger_robot(false));
  const Statics statics(model);
  StaticsOptions options = local_global();
  options.max_iterations = 1;
  State start = statics.rest();
  start.positions += noise(model.rest.rows(), 0.3, 1);
  for (Index v = 0; v < model.rest.rows(); ++v)
    if (model.held.fixed[v][0]) start.positions.row(v) = model.rest.row(v);
  const auto energy = [&](const Points& positions) {
    return statics.solve(one(1.5), {positions}, options).report.energy;
  };
  double squares = 0;
  const double h = 1e-5;
  for (Index v = 0; v < model.rest.rows(); ++v) {
    if (model.held.fixed[v][0]) continue;
    for (int axis = 0; axis < 3; ++axis) {
      Points up = start.positions, down = start.positions;
      up(v, axis) += h;
      down(v, axis) -= h;
      squares += std::pow((energy(up) - energy(down)) / (2 * h), 2);
    }
  }
  const double norm = statics.solve(one(1.5), start, options).report.gradient_norm;
  EXPECT_NEAR(norm, std::sqrt(squares), 1e-6 * norm);
}

}  // namespace softkin
