#include <gtest/gtest.h>

#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/trajectory.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

/// A beam with three chambers, in equilibrium with all of them partly filled.
struct EquilibriumBeam {
  Model model;
  Statics statics;
  Equilibrium start;

  EquilibriumBeam()
      : model(compile(beam_to_settle())),
        statics(model),
        start(statics.solve(values({1.2, 1.3, 1.4}), statics.rest())) {}

  static RobotSpec beam_to_settle() {
    RobotSpec spec = chambers_beam(3);
    for (ActuatorSpec& actuator : spec.actuators) {
      actuator.low = 1;
      actuator.high = 1.6;
    }
    return spec;
  }
  [[nodiscard]] std::vector<Goal> tip_at(const Vec3& target) const { return {{PositionGoal{0, target}}}; }
  [[nodiscard]] Vec3 tip() const { return marker_at(model, start); }
};

/// Checks that solve() reports an equilibrium that it is given as it reports one that it solves for.
void expect_reported(const EquilibriumBeam& beam, const InverseResult& result) {
  const Equilibrium again =
      beam.statics.solve(beam.start.actuation, beam.start.state, StaticsOptions{.keep_history = false});
  const SolveReport &reported = result.equilibrium.report, &known = again.report;
  EXPECT_EQ(reported.status, Status::converged);
  EXPECT_EQ(reported.solver, "newton");
  EXPECT_EQ(reported.tolerance_mm, known.tolerance_mm);
  EXPECT_GT(reported.step_mm, 0);
  EXPECT_LE(reported.step_mm, reported.tolerance_mm);
  EXPECT_NEAR(reported.physical.pull_N, known.physical.pull_N, 1e-6 * known.physical.pull_N);
  EXPECT_LE(reported.physical.residual_N, 1e-6 * reported.physical.pull_N);
  EXPECT_NEAR(reported.energy, known.energy, 1e-9 * known.energy);
  EXPECT_EQ(result.equilibrium.actuation, beam.start.actuation);
  EXPECT_LT(distance(result.equilibrium.state.positions, beam.start.state.positions), 1e-5);
}

/// A search that is interrupted at any point returns an equilibrium that is no farther from the target than the start.
TEST(InverseStart, StoppedItKeepsTheBest) {
  const EquilibriumBeam beam;
  const Vec3 target = beam.tip() + Vec3(-2, 4, 3);
  const double at_start = (target - beam.tip()).norm();
  double least = at_start;
  for (int looks = 0;; looks += 5) {
    const auto stop = [looks](const Progress&) mutable { return looks-- > 0; };
    const InverseResult found = solve_inverse(beam.statics, beam.tip_at(target), beam.start, InverseOptions(), stop);
    if (!found.stopped) break;
    ASSERT_EQ(found.status, InverseStatus::interrupted) << looks;
    EXPECT_LE(found.errors_mm[0], at_start + 1e-9);
    least = std::min(least, found.errors_mm[0]);
    const Equilibrium& best = found.equilibrium;
    const Equilibrium same = beam.statics.solve(best.state.actuation, best.state);
    EXPECT_LT(distance(same.state.positions, best.state.positions), 1e-4) << looks;
  }
  EXPECT_LT(least, at_start) << "nothing was stopped on its way";
  InverseOptions options;
  options.statics.deadline = Deadline(1e-9);
  const InverseResult late = solve_inverse(beam.statics, beam.tip_at(target), beam.start, options);
  EXPECT_EQ(late.status, InverseStatus::not_converged);
  EXPECT_EQ(late.remark, "the budget of 1e-09 s was spent");
  EXPECT_TRUE(late.stopped);
  const InverseResult none = solve_inverse_from(beam.statics, beam.tip_at(target), beam.start.actuation, options);
  EXPECT_EQ(none.status, InverseStatus::not_converged);
  EXPECT_EQ(none.errors_mm.size(), 1);
}

TEST(InverseStart, ThatStaysBestIsMeasured) {
  const EquilibriumBeam beam;
  const InverseResult reached = solve_inverse(beam.statics, beam.tip_at(beam.tip()), beam.start.state);
  EXPECT_EQ(reached.status, InverseStatus::reached);
  EXPECT_EQ(reached.equilibria, 1);
  expect_reported(beam, reached);
  InverseOptions options;
  options.free = {false, false, false};
  const InverseResult missed =
      solve_inverse(beam.statics, beam.tip_at(beam.tip() + Vec3(0, 0, 1)), beam.start.state, options);
  EXPECT_EQ(missed.status, InverseStatus::unreachable);
  EXPECT_NEAR(missed.errors_mm[0], 1, 1e-5);
  expect_reported(beam, missed);
}

TEST(InverseStart, WithAReportKeepsIt) {
  const EquilibriumBeam beam;
  const InverseResult result = solve_inverse(beam.statics, beam.tip_at(beam.tip()), beam.start);
  EXPECT_EQ(result.status, InverseStatus::reached);
  EXPECT_EQ(result.equilibria, 0);
  EXPECT_EQ(result.equilibrium.report.iterations, beam.start.report.iterations);
  EXPECT_EQ(result.equilibrium.report.physical.residual_N, beam.start.report.physical.residual_N);
  EXPECT_EQ(result.equilibrium.state.positions, beam.start.state.positions);
  expect_reported(beam, result);
}

TEST(InverseStart, OfASolveThatDidNotConvergeIsMeasured) {
  const EquilibriumBeam beam;
  Equilibrium lost = beam.start;
  lost.report.status = Status::limit;  // farther on; its state is an equilibrium
  lost.report.physical.pull_N = 0;
  const InverseResult result = solve_inverse(beam.statics, beam.tip_at(beam.tip()), lost);
  EXPECT_EQ(result.equilibria, 1);
  expect_reported(beam, result);
}

/// A waypoint that the prediction reaches needs no search, and is reported all the same.
TEST(InverseStart, OfAWaypointIsThatOfItsPrediction) {
  const EquilibriumBeam beam;
  MarkerPath path{{0}, {{true, true, true}}, {}};
  for (int i = 0; i < 6; ++i) {
    const Actuation actuation = values({1.2, 1.3, 1.4}) + 0.002 * i * values({1, -1, 0.5});
    Waypoint waypoint;
    waypoint.targets = {marker_at(beam.model, solve_converged(beam.statics, actuation))};
    path.waypoints.push_back(waypoint);
  }
  for (const InverseResult& each : follow_path(beam.statics, path)) {
    EXPECT_EQ(each.status, InverseStatus::reached);
    EXPECT_EQ(each.equilibrium.report.solver, "newton");
    EXPECT_GT(each.equilibrium.report.physical.pull_N, 0);
    EXPECT_GT(each.equilibrium.report.tolerance_mm, 0);
  }
}

}  // namespace
}  // namespace softkin
