#include <Eigen/Geometry>
#include <thread>

#include "statics/physical_samples.hpp"

/// Statics::solve in the physical formulation: starts, invariance, threads, interruption, what it refuses.

namespace softkin {

namespace {

using namespace testing;

}  // namespace

/// Wherever the search begins, with or without knowing of what the start is an equilibrium, it ends in one shape.
TEST(PhysicalSolve, TheStartDoesNotMatter) {
  const Model model = compile(chambers_beam(2));
  const Statics statics(model);
  const Actuation requested = values({1.8, 1.1});
  const Equilibrium expected = solve_converged(statics, requested);
  const Equilibrium other = solve_converged(statics, values({1.2, 2.0}));
  State unknown{other.state.positions};
  State with_pressure{other.state.positions, {}, other.state.multipliers};
  State wrong{other.state.positions, values({1, 1})};  // claims to be at rest
  State shaken{model.rest + noise(model.rest.rows(), 0.3, 1)};
  for (const State& start : {other.state, unknown, with_pressure, wrong, shaken}) {
    const Equilibrium found = statics.solve(requested, start, tight());
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-7);
    EXPECT_LT((found.state.multipliers - expected.state.multipliers).norm(), 1e-6);
  }
  // where it is already there is nothing to do
  const Equilibrium again = statics.solve(requested, expected.state, tight());
  EXPECT_LT(distance(again.state.positions, expected.state.positions), 1e-8);
  EXPECT_LE(again.report.iterations, 2);
}

TEST(PhysicalSolve, UnknownActuationUnderLoadControl) {
  RobotSpec spec = cable_beam();
  for (ActuatorSpec& a : spec.actuators) a = by_load(a);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium expected = solve_converged(statics, values({0.8, 0.1})),
                    other = solve_converged(statics, values({0.1, 1.0}));
  for (const State& start : {State{other.state.positions}, State{other.state.positions, {}, other.state.multipliers}}) {
    const Equilibrium found = statics.solve(values({0.8, 0.1}), start, tight());
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-7);
  }
}

/// A mesh that stands elsewhere, turned: the same shape there, the same forces.
TEST(PhysicalSolve, InvariantUnderRigidMotion) {
  RobotSpec spec = bending_finger();
  spec.actuators.push_back(cable("tendon", {{0, 6, 14}, {30, 6, 14}, {58, 6, 14}}));
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 0, -5};
  RobotSpec turned = spec;
  const Mat3 r = Eigen::AngleAxisd(2.2, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Vec3 shift(100, -50, 20);
  turned.mesh.vertices = (spec.mesh.vertices * r.transpose()).rowwise() + shift.transpose();
  turned.loads.gravity = r * spec.loads.gravity;
  for (PointRef& point : turned.actuators[1].as<CableSpec>()->points)
    point.point = Vec3(r * std::get<Vec3>(point.point) + shift);
  const Model model = compile(spec), turned_model = compile(turned);
  const Statics statics(model), turned_statics(turned_model);
  const Equilibrium a = solve_converged(statics, values({1.6, 0.97})),
                    b = solve_converged(turned_statics, values({1.6, 0.97}));
  EXPECT_LT(distance((a.state.positions * r.transpose()).rowwise() + shift.transpose(), b.state.positions), 1e-7);
  EXPECT_LT((a.state.multipliers - b.state.multipliers).norm(), 1e-7 * a.state.multipliers.norm());
  EXPECT_GT(a.state.multipliers.cwiseAbs().minCoeff(), 1e-3);
}

/// A robot is solved alike at every size: unknowns of turns count as much as those of moves.
TEST(PhysicalSolve, RigidRegionsOfAnySize) {
  const auto bent = [](double scale) {
    RobotSpec spec = physical_robot(block_mesh({6, 2, 2}, {60, 10, 10}));
    spec.mesh.vertices *= scale;
    spec.rigid.push_back({{std::string("x_high"), {}}, "end"});
    spec.loads.forces.push_back({"weight", {std::string("x_high"), {}}, scale * scale * Vec3(0, 0.01, -0.03)});
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = statics.solve(Actuation(0), statics.rest());
    EXPECT_EQ(found.report.status, Status::converged);
    return Points((found.state.positions - model.rest) / scale);
  };
  const Points moves = bent(1);
  EXPECT_GT(moves.rowwise().norm().maxCoeff(), 0.9);
  for (const double scale : {1e-4, 1e3, 1e7}) EXPECT_LT(distance(bent(scale), moves), 1e-5) << scale;
}

TEST(PhysicalSolve, ThreadsChangeNothing) {
  const Model model = compile(chambers_beam(3));
  const Statics statics(model);
  StaticsOptions one = tight(1e-6), two = tight(1e-6);
  one.threads = 1;
  two.threads = 2;
  const Equilibrium a = solve_converged(statics, values({1.5, 1.3, 0.9}), one),
                    b = solve_converged(statics, values({1.5, 1.3, 0.9}), two);
  EXPECT_EQ(a.report.iterations, b.report.iterations);
  EXPECT_EQ(a.state.positions, b.state.positions);
}

/// One object serves several threads at once, and one solve after another, without one being seen in the next.
TEST(PhysicalSolve, SolvesSideBySideAndAgain) {
  const Model model = compile(chambers_beam(2));
  const Statics statics(model);
  const Actuation requested[] = {values({1.5, 1.1}), values({0.9, 1.7}), values({1.2, 1.2}), values({2.0, 0.8})};
  std::vector<Points> expected, found(4);
  for (const Actuation& actuation : requested) {
    const Statics fresh(model);
    expected.push_back(solve_converged(fresh, actuation).state.positions);
  }
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      StaticsOptions options = tight();
      options.threads = 1;
      found[i] = statics.solve(requested[i], statics.rest(), options).state.positions;
    });
  for (std::thread& thread : threads) thread.join();
  for (int i = 0; i < 4; ++i) EXPECT_LT(distance(found[i], expected[i]), 1e-9);
  // a path that comes back; each solve begins with the factor that the last one left
  State state = statics.rest();
  for (const int i : {0, 1, 2, 3, 2, 0}) {
    const Equilibrium next = statics.solve(requested[i], state, tight());
    EXPECT_EQ(next.report.status, Status::converged);
    EXPECT_LT(distance(next.state.positions, expected[i]), 1e-7);
    state = next.state;
  }
}

/// The shape left behind is the last good one, and its actuation is known.
TEST(PhysicalSolve, StopsWhenTheCallbackSaysSo) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const Equilibrium found =
      statics.solve(values({3.0}), statics.rest(), tight(), [](const Progress& p) { return p.iteration < 2; });
  EXPECT_EQ(found.report.status, Status::interrupted);
  EXPECT_EQ(found.report.iterations, 2);
  EXPECT_TRUE(found.state.positions.allFinite());
  EXPECT_NEAR(found.state.actuation[0], 1 + 2 * found.report.reached, 1e-12);
  EXPECT_EQ(statics.solve(values({3.0}), found.state, tight()).report.status, Status::converged);
}

/// Of a large robot a factor takes as long as many iterations.
TEST(PhysicalSolve, AsksBeforeItsFirstFactor) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const Equilibrium found =
      statics.solve(values({3.0}), statics.rest(), tight(), [](const Progress&) { return false; });
  EXPECT_EQ(found.report.status, Status::interrupted);
  EXPECT_EQ(found.report.factorisations, 0);
  EXPECT_TRUE(found.state.positions == model.rest);
}

/// Newton converges quadratically: near the end every step is far shorter than the one before.
TEST(PhysicalSolve, ConvergesFastAtTheEnd) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const State start = solve_converged(statics, values({1.5})).state;
  const Equilibrium found = statics.solve(values({1.6}), start, tight(1e-7));
  EXPECT_LE(found.report.iterations, 8);
  EXPECT_LE(found.report.continuation_steps, 1);
  EXPECT_LE(found.report.gradient_norm, 1e-7);
  EXPECT_LT(found.report.step_mm, 1e-7);
}

/// From rest to both ends of a wide range in one call, every law, both orders.
TEST(PhysicalSolve, FromRestToTheEndsOfARange) {
  for (const Law law : all_laws)
    for (const bool quadratic : {false, true}) {
      RobotSpec spec = bending_finger();
      spec.materials[0].elastic = elastic(law, 1, 0.4);
      spec.mesh_options.quadratic = quadratic;
      const Model model = compile(spec);
      const Statics statics(model);
      for (const double ratio : {0.7, 2.5}) {
        const Equilibrium found = statics.solve(values({ratio}), statics.rest());
        EXPECT_EQ(found.report.status, Status::converged)
            << static_cast<int>(law) << " " << ratio << ": " << found.report.remark << " at " << found.report.reached;
      }
    }
}

/// A cable whose range lets it hang is slack at once, however long.
TEST(PhysicalSolve, ALongCableHangsFromTheStart) {
  const Model model = compile(cable_beam());
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.5, 1.5}));
  EXPECT_LT(distance(found.state.positions, model.rest), 1e-9);
  EXPECT_EQ(found.state.multipliers, Eigen::VectorXd::Zero(2));
  EXPECT_LE(found.report.iterations, 4);
}

TEST(PhysicalSolve, RefusesWhatIsNotARobotsStart) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const auto refused = [&](const State& start, const StaticsOptions& options = {}) {
    EXPECT_THROW((void)statics.solve(values({1.2}), start, options), InvalidInput);
  };
  refused({model.rest.topRows(3)});
  refused({model.rest, values({1, 1})});
  refused({model.rest, {}, values({1, 1})});
  refused({model.rest, values({std::numeric_limits<double>::quiet_NaN()})});
  refused({model.rest, {}, values({std::numeric_limits<double>::infinity()})});
  StaticsOptions local_global;
  local_global.solver = Solver::local_global;
  refused(statics.rest(), local_global);
  Points crushed = model.rest;
  crushed.col(0).setZero();  // every element is flat: no shape to begin from, but none to fail on either
  const Equilibrium found = statics.solve(values({1.2}), {crushed});
  EXPECT_TRUE(found.state.positions.allFinite());
}

}  // namespace softkin
