#include <softkin/core/error.hpp>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/supports/global_step.hpp>
#include <softkin/statics/target_shape/system.hpp>

#include "statics/robots.hpp"

namespace softkin {

namespace {

using testing::mixed_robot;
using testing::noise;

/// The mixed robot with two rigid regions: its free end, and a patch under the chamber.
RobotSpec rigid_robot() {
  RobotSpec spec = mixed_robot(false);
  spec.rigid.push_back({{Box{{50, 0, 0}, {60, 20, 24}}, {}}, "end"});
  spec.rigid.push_back({{Box{{20, 0, 8}, {30, 20, 8}}, {}}, "patch"});
  return spec;
}

double largest_stretch(const Model& model, const Points& positions) {
  double largest = 0;
  for (const RigidRegion& region : model.rigid)
    for (const Index a : region.vertices)
      for (const Index b : region.vertices)
        largest = std::max(largest, std::abs((positions.row(a) - positions.row(b)).norm() -
                                             (model.rest.row(a) - model.rest.row(b)).norm()));
  return largest;
}

}  // namespace

/// At fixed targets the energy is x'Ax - 2x'b: after one step no admissible motion is pulled any more.
TEST(GlobalStep, MinimisesTheQuadraticOverVerticesAndPosesTogether) {
  const Model model = compile(rigid_robot());
  const target_shape::System system(model);
  const Eigen::SparseMatrix<double> lower = system.global_matrix();
  const Eigen::SparseMatrix<double> matrix = lower.selfadjointView<Eigen::Lower>();
  const supports::GlobalStep global(model, lower);
  Team alone(1);
  target_shape::System::Scratch scratch = system.make_scratch();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Points positions = model.rest + noise(model.rest.rows(), 2, seed);
    std::vector<supports::Pose> poses = global.project(model.rest_actuation(), positions);
    system.local_step((Actuation(3) << 1.3, 1.8, 0.8).finished(), positions, scratch, alone);
    const Points residual = scratch.residual, before = positions;
    global.step(residual, positions, poses, alone);
    const Points after = residual - matrix * (positions - before);
    EXPECT_GT(global.free_norm(residual, poses), 1);
    EXPECT_LT(global.free_norm(after, poses), 1e-8 * global.free_norm(residual, poses));
    EXPECT_LT(largest_stretch(model, positions), 1e-12);
  }
}

TEST(Rigid, EnergyFallsAndRegionsKeepTheirShapeExactly) {
  const Model model = compile(rigid_robot());
  const Statics statics(model);
  StaticsOptions options;
  options.anderson = 0;
  options.max_iterations = 200;
  const Equilibrium found = statics.solve((Actuation(3) << 1.3, 1.8, 0.8).finished(), statics.rest(), options);
  for (std::size_t i = 1; i < found.report.history.size(); ++i)
    ASSERT_LE(found.report.history[i].energy, found.report.history[i - 1].energy * (1 + 1e-13));
  EXPECT_LT(largest_stretch(model, found.state.positions), 1e-11);
  EXPECT_GT((found.state.positions - model.rest).rowwise().norm().maxCoeff(), 1);
}

/// A rigid region is the limit of ever heavier elements.
TEST(Rigid, IsTheLimitOfHeavyElements) {
  RobotSpec spec = testing::finger_robot(false);
  testing::add_volume_region(spec.mesh, "end", [](const Vec3& p) { return p.x() > 45; });
  StaticsOptions options;
  options.step_tolerance_mm = 1e-8;
  const Actuation actuation = Actuation::Constant(1, 1.8);
  RobotSpec rigid = spec;
  rigid.rigid.push_back({{std::string("end"), {}}, "end"});
  const Model exact = compile(rigid);
  const Statics exact_statics(exact);
  const Points limit = exact_statics.solve(actuation, exact_statics.rest(), options).state.positions;
  double last = 0;
  for (const double weight : {30.0, 300.0}) {
    RobotSpec heavy = spec;
    MaterialSpec end;
    end.region = "end";
    end.weight = weight;
    heavy.materials.push_back(end);
    const Model model = compile(heavy);
    const Statics statics(model);
    const double distance =
        (statics.solve(actuation, statics.rest(), options).state.positions - limit).rowwise().norm().maxCoeff();
    if (last > 0) {
      EXPECT_NEAR(distance / last, 0.1, 0.05);
    }
    last = distance;
  }
  EXPECT_LT(last, 0.01);
}

/// Held along z by a face, a region slides and turns in the plane; displaced, it goes along.
TEST(Rigid, RegionHeldAlongAnAxisMovesInThePlane) {
  RobotSpec spec = rigid_robot();
  FixedSpec ground{{Box{{50, 0, 0}, {60, 20, 0}}, {}}};
  ground.axes = {false, false, true};
  ground.displacement = {0, 0, 1.5};
  spec.fixed.push_back(ground);
  // off the middle, so that the end turns about z
  spec.actuators[2].as<CableSpec>()->points = {{Vec3(5, 2, 22), {}}, {Vec3(25, 2, 22), {}}, {Vec3(45, 2, 22), {}}};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve((Actuation(3) << 1.0, 1.2, 0.7).finished(), statics.rest());
  EXPECT_EQ(found.report.status, Status::converged);
  EXPECT_LT(largest_stretch(model, found.state.positions), 1e-11);
  double turned = 0;
  for (const Index v : model.rigid[0].vertices) {
    EXPECT_NEAR(found.state.positions(v, 2) - model.rest(v, 2), 1.5, 1e-12);
    turned = std::max(turned, std::abs(found.state.positions(v, 0) - model.rest(v, 0) -
                                       (found.state.positions(model.rigid[0].vertices[0], 0) -
                                        model.rest(model.rigid[0].vertices[0], 0))));
  }
  EXPECT_GT(turned, 0.05);
  EXPECT_LT(found.report.gradient_norm, 1e-3 * found.report.history.front().gradient_norm);
}

TEST(Rigid, RegionHeldAlongAllAxesStaysWhereItIsHeld) {
  RobotSpec spec = rigid_robot();
  FixedSpec hold{{Box{{60, 0, 0}, {60, 20, 24}}, {}}};
  hold.displacement = {1, -2, 0.5};
  spec.fixed.push_back(hold);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve((Actuation(3) << 1.2, 1.4, 0.9).finished(), statics.rest());
  EXPECT_EQ(found.report.status, Status::converged);
  for (const Index v : model.rigid[0].vertices)
    EXPECT_NEAR((found.state.positions.row(v) - model.rest.row(v) - hold.displacement.transpose()).norm(), 0, 1e-12);
}

}  // namespace softkin
