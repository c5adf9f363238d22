#include <Eigen/LU>
#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/stability.hpp>

#include "statics/physical_equations.hpp"
#include "statics/physical_samples.hpp"

/// Whether forces balance where steps are small, and whether an equilibrium is one at which a robot stays.

namespace softkin {

namespace {

using namespace testing;

/// The equations at a state that is given, apart from the solve that found it.
struct Equations : PhysicalEquations {
  Equations(const Model& robot, const State& state) : PhysicalEquations(robot) {
    load_state = {state.actuation, state.load_factor};
    at = system.iterate(state);
    for (Index a = 0; a < system.actuators(); ++a)
      active.push_back(system.measures().constrains(a) && at.multipliers[a] != 0);
    system.evaluate(at, load_state, active, work, balance, team);
  }

  /// The stiffness on the directions that keep the active measures, dense: its eigenvalues, ascending.
  Eigen::VectorXd eigenvalues() {
    (void)system.factorise(at, load_state, active, balance, {}, work, team);
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(system.freedoms().size(), system.freedoms().size());
    work.saddle.solve(inverse, team);
    Eigen::MatrixXd stiffness = inverse.inverse();
    if (const Eigen::MatrixXd& slopes = work.saddle.slopes(); slopes.cols() > 0) {
      const Eigen::MatrixXd kept = singular_values(slopes.transpose()).right.rightCols(slopes.rows() - slopes.cols());
      stiffness = (kept.transpose() * stiffness * kept).eval();
    }
    return symmetric_eigenvalues(stiffness);
  }
};

StaticsOptions stable() {
  StaticsOptions options;
  options.stable = true;
  return options;
}

/// A shallow arch of 100 mm, 40 mm above a foot that a soft band ties to its top.
RobotSpec snapping_arch() {
  Mesh mesh = block_mesh({20, 1, 6}, {100, 10, 42});
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {  // layers of the band, and the arch above them
    const double layer = mesh.vertices(v, 2) / 7;
    mesh.vertices(v, 2) = layer < 5.5 ? 8 * layer : 42;
  }
  add_volume_region(mesh, "arch", [](const Vec3& p) { return p.z() > 40; });
  add_volume_region(mesh, "band", [](const Vec3& p) { return p.z() < 40 && std::abs(p.x() - 50) < 5; });
  add_volume_region(mesh, "nothing", [](const Vec3& p) { return p.z() < 40 && std::abs(p.x() - 50) > 5; });
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    mesh.vertices(v, 2) += 6 * std::sin(EIGEN_PI * mesh.vertices(v, 0) / 100) * std::min(1.0, mesh.vertices(v, 2) / 40);
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.mesh_options.quadratic = true;
  MaterialSpec band = spec.materials[0];
  band.region = "band";
  band.elastic = elastic(Law::neo_hookean, 4e-4, 0.3);
  spec.materials.push_back(band);
  spec.voids = {{std::string("nothing"), {}}};
  spec.fixed = {{{Box{{-1, -1, 39}, {0.1, 11, 50}}, {}}},
                {{Box{{99.9, -1, 39}, {101, 11, 50}}, {}}},
                {{Box{{44, -1, -1}, {56, 11, 0.1}}, {}}}};
  spec.markers = {{"top", {Vec3(50, 5, 47), {}}}};
  return spec;
}

/// A bar whose ends are pressed together.
RobotSpec pressed_bar(double by) {
  RobotSpec spec = physical_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0.3);
  spec.fixed.push_back({{std::string("x_high"), {}}, {true, true, true}, Vec3(-by, 0, 0)});
  spec.markers = {{"mid", {Vec3(15, 5, 5), {}}}};
  return spec;
}

}  // namespace

/// With a stiff insert, steps are small although the residual is large compared with the soft body's internal forces.
TEST(Balance, ForcesBalanceWhereStepsAreSmall) {
  RobotSpec spec = bending_finger();
  add_volume_region(spec.mesh, "fabric", [](const Vec3& p) { return p.z() < 4; });
  MaterialSpec fabric;
  fabric.region = "fabric";
  fabric.shape_ratio.reset();
  fabric.elastic = elastic(Law::neo_hookean, 2e5, 0.3);
  spec.materials.push_back(fabric);
  const Model model = compile(spec);
  const Statics statics(model);
  for (const double ratio : {1.001, 1.05, 1.5}) {
    const Equilibrium found = statics.solve(values({ratio}), statics.rest());
    ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
    Equations equations(model, found.state);
    const double pull = found.report.physical.pull_N;
    EXPECT_NEAR(found.report.physical.residual_N, equations.system.freedoms().largest(equations.balance.force),
                1e-9 * pull);
    EXPECT_LT(found.report.physical.residual_N, 1e-6 * pull + 1e-7) << ratio;
  }
}

/// The lowest mode and its curvature, against all eigenvalues of the dense matrix.
TEST(Stability, TheLowestModeIsThatOfTheDenseMatrix) {
  RobotSpec spec = physical_robot(block_mesh({6, 3, 3}, {60, 9, 9}));
  add_volume_region(spec.mesh, "chamber", [](const Vec3& p) {
    return p.x() > 10 && p.x() < 50 && p.y() > 3 && p.y() < 6 && p.z() > 3 && p.z() < 6;
  });
  spec.actuators = {air("chamber"), cable("tendon", {{0, 4, 8}, {30, 4, 8}, {60, 4, 8}})};
  const Model model = compile(spec);
  for (const double compression : {0.8, 0.55}) {
    State state{model.rest * Eigen::Vector3d(compression, 1, 1).asDiagonal(), values({1, 1}), values({1, 1})};
    Equations equations(model, state);
    const Eigen::VectorXd all = equations.eigenvalues();
    physical::SolveRecord record;
    const physical::LowestMode mode = physical::lowest_mode(equations.system, equations.at, equations.load_state,
                                                            equations.active, equations.work, equations.team, record);
    EXPECT_EQ(mode.unstable, (all.array() < 0).count());
    ASSERT_GT(mode.unstable, 0);
    EXPECT_NEAR(mode.curvature, all[0], 1e-3 * std::abs(all[0])) << compression;
    EXPECT_NEAR(mode.direction.norm(), 1, 1e-12);
    EXPECT_LT((equations.work.saddle.slopes().transpose() * mode.direction).norm(),
              1e-8 * equations.work.saddle.slopes().norm());
  }
}

/// A bar under compression stays straight unless `stable` is set: then it buckles, to a shape of less energy that is
/// stable by the dense matrix, too.
TEST(Stability, APressedBarBuckles) {
  const Model model = compile(pressed_bar(15));
  const Statics statics(model);
  const Equilibrium straight = statics.solve({}, statics.rest()), bent = statics.solve({}, statics.rest(), stable());
  ASSERT_EQ(straight.report.status, Status::converged) << straight.report.remark;
  EXPECT_EQ(straight.report.physical.unstable_modes,
            (Equations(model, straight.state).eigenvalues().array() < 0).count());
  EXPECT_GT(straight.report.physical.unstable_modes, 0);
  EXPECT_EQ(straight.report.physical.buckled, 0);
  ASSERT_EQ(bent.report.status, Status::converged) << bent.report.remark;
  EXPECT_EQ(bent.report.physical.unstable_modes, 0);
  EXPECT_GT(bent.report.physical.buckled, 0);
  EXPECT_GT(bent.report.physical.buckled_mm, 0.1);
  EXPECT_GT(Equations(model, bent.state).eigenvalues()[0], 0);
  EXPECT_LT(bent.report.energy, 0.95 * straight.report.energy);
  const Vec3 aside = marker_at(model, bent) - marker_at(model, straight);
  EXPECT_GT(aside.tail<2>().norm(), 2);
  // the same again, and from the unstable shape
  const Equilibrium again = statics.solve({}, statics.rest(), stable());
  EXPECT_EQ(again.state.positions, bent.state.positions);
  const Equilibrium from_there = statics.solve({}, straight.state, stable());
  EXPECT_EQ(from_there.report.physical.unstable_modes, 0);
  EXPECT_LT(from_there.report.energy, 0.95 * straight.report.energy);
  EXPECT_GT(from_there.report.physical.buckled_mm, 2);
}

/// A factor from nearby is used again only where the least eigenvalue of the dense matrix is still about the same: long
/// before a pressed strut becomes unstable that is noticed.
TEST(Stability, AFactorThatIsNoLongerAsStiffIsNoticed) {
  const Model model = compile(physical_robot(block_mesh({8, 1, 1}, {100, 8, 4})));
  const auto pressed = [&](double by) {
    return State{model.rest * Eigen::Vector3d(1 - by, 1, 1).asDiagonal(), values({}), values({})};
  };
  Equations here(model, pressed(0));
  const double least = here.eigenvalues()[0];
  int same = 0, other = 0;
  for (double by = 0; by < 5e-3; by += 1e-4) {
    Equations there(model, pressed(by));
    here.at = there.at;
    here.system.evaluate(here.at, here.load_state, here.active, here.work, here.balance, here.team);
    const bool as_stiff =
        as_stiff_as_factorised(here.system, here.at, here.load_state, here.active, here.balance, here.work, here.team);
    const double change = std::abs(there.eigenvalues()[0] / least - 1);
    if (change < 0.2 || change > 0.3) {
      EXPECT_EQ(as_stiff, change < 0.25) << by << " changes it by " << change;
    }
    ++(as_stiff ? same : other);
  }
  EXPECT_GT(same, 1);
  EXPECT_GT(other, 1);
}

/// Beyond buckling a slender strut that is clamped at both ends carries Euler's load, 4 pi^2 E I / L^2, instead of
/// E A dL / L.
TEST(Stability, AStrutCarriesEulersLoad) {
  RobotSpec spec = physical_robot(block_mesh({16, 1, 1}, {100, 8, 4}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0.3);
  const double euler = 4 * EIGEN_PI * EIGEN_PI * (8 * 64.0 / 12) / 1e4, by = 1.5;
  spec.fixed.push_back({{std::string("x_high"), {}}, {true, true, true}, Vec3(-by, 0, 0)});
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve({}, statics.rest(), stable());
  ASSERT_EQ(found.report.status, Status::converged);
  EXPECT_EQ(found.report.physical.unstable_modes, 0);
  const Vec3 force = reactions(model, found.state.positions, statics.measured(found.state))[1].force;
  EXPECT_NEAR(-force.x(), euler, 0.05 * euler);
}

/// The end of a clamped arch with a soft band below its top is pulled down. The band is softer than the arch, so that
/// the arch snaps through under a displacement. The snap-through is reported with its start; before it, none is.
TEST(Stability, ASnapUnderDisplacementIsTold) {
  RobotSpec spec = snapping_arch();
  const auto solved = [&](double by) {
    spec.fixed.back().displacement.z() = -by;
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = statics.solve({}, statics.rest());
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    return std::pair(found.report, marker_at(model, found).z());
  };
  const auto [before, above] = solved(6);
  EXPECT_EQ(before.physical.snapped_mm, 0);
  EXPECT_GT(above, 40);
  const auto [beyond, below] = solved(30);
  EXPECT_LT(below, 38);
  EXPECT_GT(beyond.physical.snapped_mm, 3);
  const double from = 30 * beyond.physical.snapped_from;
  EXPECT_EQ(solved(0.999 * from).first.physical.snapped_mm, 0);
  EXPECT_GT(solved(1.02 * from).first.physical.snapped_mm, 3);
}

/// What is stable already is the same with and without.
TEST(Stability, StableRobotsDoNotChange) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const Equilibrium a = statics.solve(values({1.8}), statics.rest()),
                    b = statics.solve(values({1.8}), statics.rest(), stable());
  EXPECT_EQ(a.state.positions, b.state.positions);
  EXPECT_EQ(b.report.physical.buckled, 0);
  RobotSpec targets = finger_robot(true);
  const Model target_model = compile(targets);
  const Statics target_statics(target_model);
  EXPECT_THROW((void)target_statics.solve(values({1.2}), target_statics.rest(), stable()), InvalidInput);
}

}  // namespace softkin
