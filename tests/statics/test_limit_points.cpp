#include <functional>
#include <softkin/statics/deformation.hpp>

#include "statics/physical_samples.hpp"

/// However large the load that is requested, the answer is the end of the path of equilibria, a limit, or a
/// snap-through that is reported.

namespace softkin {

namespace {

using namespace testing;

/// A clamped arch of 100 x 10 x 2 mm that rises by 6 mm; under a load from above it has a limit point.
RobotSpec low_arch() {
  RobotSpec spec = physical_robot(block_mesh({20, 1, 1}, {100, 10, 2}));
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
    spec.mesh.vertices(v, 2) += 6 * std::sin(EIGEN_PI * spec.mesh.vertices(v, 0) / 100);
  spec.mesh_options.quadratic = true;
  spec.fixed.push_back({{std::string("x_high"), {}}});
  spec.markers = {{"top", {Vec3(50, 5, 7), {}}}};
  return spec;
}

StaticsOptions to_stable() {
  StaticsOptions options;
  options.stable = true;
  return options;
}

/// A robot under a multiple of a load, which is commanded or in its description.
struct LoadedRobot {
  RobotSpec spec;
  Actuation command;
};
using Loading = std::function<LoadedRobot(double)>;

Equilibrium solve_loaded(const Loading& loading, double factor, const StaticsOptions& options = {}) {
  const LoadedRobot robot = loading(factor);
  const Model model = compile(robot.spec);
  const Statics statics(model);
  return statics.solve(robot.command, statics.rest(), options);
}

/// Checks that neither the limit load nor its report depends on how much is requested.
///
/// snap_mm  lower bound of the snap-through that --stable reports; 0: --stable is not used
void expect_one_limit(const Loading& loading, double beyond, double snap_mm) {
  const Equilibrium near = solve_loaded(loading, beyond);
  ASSERT_EQ(near.report.status, Status::limit);
  const double limit = beyond * near.report.reached;
  // just below it the load is carried, just above it is not
  const Equilibrium below = solve_loaded(loading, 0.98 * limit), above = solve_loaded(loading, 1.02 * limit);
  EXPECT_EQ(below.report.status, Status::converged) << below.report.remark;
  EXPECT_EQ(below.report.physical.snapped_mm, 0);
  EXPECT_EQ(above.report.status, Status::limit);
  for (const double times : {1.3, 3.0, 12.0, 14.0, 16.0, 100.0}) {
    const Equilibrium far = solve_loaded(loading, times * limit);
    EXPECT_EQ(far.report.status, Status::limit) << times << " times the limit load: " << far.report.remark;
    EXPECT_NEAR(times * far.report.reached, 1, 0.02) << times;
    if (snap_mm == 0) continue;
    const Equilibrium through = solve_loaded(loading, times * limit, to_stable());
    // far beyond the limit load there may be no such shape, or none that is found
    if (times < 20) EXPECT_EQ(through.report.status, Status::converged) << times << ": " << through.report.remark;
    if (through.report.status != Status::converged) continue;
    EXPECT_GT(through.report.physical.snapped_mm, snap_mm) << times;
    EXPECT_EQ(through.report.physical.unstable_modes, 0) << times;
  }
}

}  // namespace

TEST(LimitPoints, DeadForceOnAnArch) {
  expect_one_limit(
      [](double factor) {
        RobotSpec spec = low_arch();
        spec.loads.forces = {{"p", {Vec3(50, 5, 7), {}}, {0, 0, -0.006 * factor}}};
        return LoadedRobot{spec, Actuation(0)};
      },
      1.8, 6.5);
}

/// A loose tolerance makes the shapes less exact; it does not end the path earlier.
TEST(LimitPoints, ALooseToleranceComesAsFar) {
  RobotSpec spec = low_arch();
  spec.loads.forces = {{"p", {Vec3(50, 5, 7), {}}, {0, 0, -0.03}}};
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions loose;
  loose.step_tolerance_mm = 0.02;
  const Equilibrium exact = statics.solve(Actuation(0), statics.rest());
  const Equilibrium found = statics.solve(Actuation(0), statics.rest(), loose);
  EXPECT_EQ(exact.report.status, Status::limit);
  EXPECT_EQ(found.report.status, Status::limit);
  EXPECT_GT(exact.report.reached, 0.1);
  EXPECT_NEAR(found.report.reached / exact.report.reached, 1, 0.02);
}

TEST(LimitPoints, CommandedForceOnAnArch) {
  expect_one_limit(
      [](double factor) {
        RobotSpec spec = low_arch();
        spec.loads.forces = {
            {"p", {Vec3(50, 5, 7), {}}, {0, 0, 0}, std::array<Vec3, 2>{Vec3(0, 0, -50), Vec3::Zero()}}};
        return LoadedRobot{spec, values({-0.006 * factor})};
      },
      1.8, 6.5);
}

TEST(LimitPoints, TractionOnAnArch) {
  expect_one_limit(
      [](double factor) {
        RobotSpec spec = low_arch();
        TractionSpec traction;
        traction.name = "q";
        traction.where = {std::string("z_high"), {}};
        traction.kilopascals = Vec3(0, 0, -0.01 * factor);
        spec.loads.tractions = {traction};
        return LoadedRobot{spec, Actuation(0)};
      },
      3, 6.5);
}

TEST(LimitPoints, FollowingPressureOnAnArch) {
  expect_one_limit(
      [](double factor) {
        RobotSpec spec = low_arch();
        TractionSpec traction;
        traction.name = "q";
        traction.where = {std::string("z_high"), {}};
        traction.follows = true;
        traction.range_kPa = {0, 100};
        spec.loads.tractions = {traction};
        return LoadedRobot{spec, values({0.01 * factor})};
      },
      3, 6.5);
}

TEST(LimitPoints, SeveralCommandsAtOnceOnAnArch) {
  expect_one_limit(
      [](double factor) {
        RobotSpec spec = low_arch();
        spec.loads.forces = {{"p",
                              {Vec3(40, 5, 2 + 6 * std::sin(0.4 * EIGEN_PI)), {}},
                              {0, 0, 0},
                              std::array<Vec3, 2>{Vec3(0, 0, -50), Vec3::Zero()}},
                             {"q",
                              {Vec3(60, 5, 2 + 6 * std::sin(0.6 * EIGEN_PI)), {}},
                              {0, 0, 0},
                              std::array<Vec3, 2>{Vec3(0, 0, -50), Vec3::Zero()}}};
        return LoadedRobot{spec, values({-0.004 * factor, -0.004 * factor})};
      },
      3, 0);
}

TEST(LimitPoints, WeightOfAnArch) {
  expect_one_limit(
      [](double factor) {
        RobotSpec spec = low_arch();
        spec.materials[0].density = 1000;
        spec.loads.gravity = {0, 0, -5 * factor};
        return LoadedRobot{spec, Actuation(0)};
      },
      3, 6.5);
}

/// A chamber above the arch and one below it, closed by lids and by the planes that hold the sides.
TEST(LimitPoints, TwoChambersOnAnArch) {
  expect_one_limit(
      [](double factor) {
        Mesh mesh = block_mesh({20, 1, 9}, {100, 10, 18});
        const auto is_in = [](const Vec3& p, double from, double to) {
          return p.x() > 5 && p.x() < 95 && p.z() > from && p.z() < to;
        };
        add_volume_region(mesh, "below", [&](const Vec3& p) { return is_in(p, 2, 8); });
        add_volume_region(mesh, "above", [&](const Vec3& p) { return is_in(p, 10, 16); });
        for (Index v = 0; v < mesh.vertices.rows(); ++v)
          mesh.vertices(v, 2) += 6 * std::sin(EIGEN_PI * mesh.vertices(v, 0) / 100);
        RobotSpec spec = physical_robot(std::move(mesh));
        spec.mesh_options.quadratic = true;
        for (const char* face : {"x_high", "z_low", "z_high"}) spec.fixed.push_back({{std::string(face), {}}});
        for (const char* side : {"y_low", "y_high"})
          spec.fixed.push_back({{std::string(side), {}}, {false, true, false}});
        spec.actuators = {by_load(air("below"), 0, 1e4), by_load(air("above"), 0, 1e4)};
        return LoadedRobot{spec, values({0.01 * factor, 0.03 * factor})};
      },
      5, 0);
}

/// Rows of a path are steps like others, and so is one from a shape that was kept.
TEST(LimitPoints, RowsOfAPathAndALaterStart) {
  RobotSpec spec = low_arch();
  spec.loads.forces = {{"p", {Vec3(50, 5, 7), {}}, {0, 0, 0}, std::array<Vec3, 2>{Vec3(0, 0, -50), Vec3::Zero()}}};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium half = statics.solve(values({-0.005}), statics.rest());
  ASSERT_EQ(half.report.status, Status::converged) << half.report.remark;
  for (const double force : {-0.02, -0.13, -0.15, -1.0}) {
    const Equilibrium on = statics.solve(values({force}), half.state);
    EXPECT_EQ(on.report.status, Status::limit) << force;
    EXPECT_NEAR(on.state.actuation[0], -0.0098, 2e-4) << force;
    State kept = half.state;  // as a file has it, without what the solver remembers
    const Statics fresh(model);
    EXPECT_EQ(fresh.solve(values({force}), kept).report.status, Status::limit) << force;
  }
  // on the far branch a large step is as good as several
  const Equilibrium through = statics.solve(values({-0.02}), half.state, to_stable());
  ASSERT_EQ(through.report.status, Status::converged) << through.report.remark;
  const Equilibrium once = statics.solve(values({-0.3}), through.state);
  State row = through.state;
  for (const double force : {-0.05, -0.1, -0.2, -0.3}) row = statics.solve(values({force}), row).state;
  EXPECT_EQ(once.report.status, Status::converged) << once.report.remark;
  EXPECT_EQ(once.report.physical.snapped_mm, 0);
  EXPECT_LT(largest_move(once.state.positions, row.positions), 1e-3);
}

}  // namespace softkin
