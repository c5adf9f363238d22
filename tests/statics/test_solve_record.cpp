#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <softkin/statics/physical/continuation.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

/// A report as an unrelated solve, or nobody, may have left it.
SolveReport meaningless_report() {
  SolveReport report;
  report.status = Status::converged;
  report.iterations = report.factorisations = report.continuation_steps = 1000000;
  report.factorisations_in_double = report.projections = report.shifts = -1000000;
  report.reached = report.step_mm = report.gradient_norm = report.energy = std::numeric_limits<double>::quiet_NaN();
  report.remark = "nothing: ";
  report.physical.snapped_mm = report.physical.friction_change = 1e9;
  report.physical.unstable_from = report.physical.snapped_from = 0.5;
  report.physical.buckled = 1000;
  report.physical.branch = {.actuator = 0, .points = {{1, 1}}};
  return report;
}

/// The end of a path, and its report.
struct PathEnd {
  Status status = Status::not_converged;
  physical::Iterate at;
  SolveReport report;
};

/// Traces the path of a robot from rest to a command, with a report that contains these values before.
PathEnd trace_path(const Model& model, const Actuation& command, bool stable, const SolveReport& before) {
  const physical::System system(model);
  physical::Workspace work(system);
  Team team(1);
  const physical::Equilibria::Options options{.tolerance_mm = 1e-7 * model.diagonal_mm, .stable = stable};
  const ProgressCallback silent;
  physical::SolveRecord record;
  PathEnd end{.at = {model.rest, Eigen::VectorXd::Zero(system.actuators())}, .report = before};
  physical::Continuation continuation(system, work, team, options, silent, record, end.report);
  end.status = continuation.follow({model.rest_actuation(), 0}, {command, 1}, end.at);
  record.write_to(end.report);
  return end;
}

/// Checks that the path, its end and its report do not depend on the values of the report that is passed in.
void expect_independent(const RobotSpec& spec, const Actuation& command, bool stable, Status status) {
  const Model model = compile(spec);
  const PathEnd plain = trace_path(model, command, stable, {}),
                other = trace_path(model, command, stable, meaningless_report());
  EXPECT_EQ(plain.status, status) << plain.report.remark;
  EXPECT_EQ(other.status, status) << other.report.remark;
  EXPECT_EQ(plain.at.positions, other.at.positions);
  EXPECT_EQ(plain.at.multipliers, other.at.multipliers);
  EXPECT_EQ(plain.report.remark, other.report.remark);
  EXPECT_GT(plain.report.iterations, 0);
  EXPECT_EQ(plain.report.iterations, other.report.iterations);
  EXPECT_EQ(plain.report.factorisations, other.report.factorisations);
  EXPECT_EQ(plain.report.factorisations_in_double, other.report.factorisations_in_double);
  EXPECT_EQ(plain.report.continuation_steps, other.report.continuation_steps);
  EXPECT_EQ(plain.report.reached, other.report.reached);
  EXPECT_EQ(plain.report.step_mm, other.report.step_mm);
  EXPECT_EQ(plain.report.physical.snapped_mm, other.report.physical.snapped_mm);
  EXPECT_EQ(plain.report.physical.unstable_from, other.report.physical.unstable_from);
  EXPECT_EQ(plain.report.physical.buckled, other.report.physical.buckled);
  EXPECT_EQ(plain.report.physical.branch.points.size(), other.report.physical.branch.points.size());
}

/// A clamped arch of 100 x 10 x 2 mm that rises by 6 mm, under more than it carries.
RobotSpec overloaded_arch() {
  RobotSpec spec = physical_robot(block_mesh({20, 1, 1}, {100, 10, 2}));
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
    spec.mesh.vertices(v, 2) += 6 * std::sin(EIGEN_PI * spec.mesh.vertices(v, 0) / 100);
  spec.mesh_options.quadratic = true;
  spec.fixed.push_back({{std::string("x_high"), {}}});
  spec.loads.forces = {{"weight", {Vec3(50, 5, 7), {}}, {0, 0, -0.01}}};
  return spec;
}

RobotSpec pressed_bar_between_supports() {
  RobotSpec spec = physical_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0.3);
  spec.fixed.push_back({{std::string("x_high"), {}}, {true, true, true}, Vec3(-15, 0, 0)});
  return spec;
}

}  // namespace

/// Load steps and arc-length continuation, up to a limit point and with a snap-through beyond it.
TEST(SolveRecord, NoReportChangesAPathAlongArcLength) {
  expect_independent(overloaded_arch(), {}, false, Status::limit);
  expect_independent(overloaded_arch(), {}, true, Status::converged);
}

/// Measure-controlled continuation of a pressure, up to its maximum.
TEST(SolveRecord, NoReportChangesAPathAlongAMeasure) {
  RobotSpec spec = hollow_ball(6, 30, 10);
  spec.materials[0].elastic = elastic(Law::mooney_rivlin, 0.03, 0.45);
  spec.actuators = {by_load(air("hollow", 0.5, 12))};
  expect_independent(spec, values({100}), false, Status::limit);
}

/// Buckling of a bar that is pressed between its supports.
TEST(SolveRecord, NoReportChangesHowABarBuckles) {
  expect_independent(pressed_bar_between_supports(), {}, true, Status::converged);
}

}  // namespace softkin
