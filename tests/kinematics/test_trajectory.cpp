#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/kinematics/workspace.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using testing::chambers_beam;

/// Three chambers around the axis of a beam, which bend its tip in any direction and lengthen it.
RobotSpec beam(Formulation formulation) {
  RobotSpec spec = chambers_beam(3);
  spec.formulation = formulation;
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 1;
    actuator.high = 2;
  }
  if (formulation == Formulation::target_shape) spec.materials[0].shape_ratio = 0.8;
  return spec;
}

struct Robot {
  Model model;
  Statics statics;

  explicit Robot(const RobotSpec& spec) : model(compile(spec)), statics(model) {}
  explicit Robot(Formulation formulation = Formulation::physical) : Robot(beam(formulation)) {}

  [[nodiscard]] Vec3 tip(const State& state) const { return model.markers[0].point.at(state.positions); }
};

Actuation turn(double fraction) {
  const double angle = 2 * std::numbers::pi * fraction;
  return Actuation{{1.4 + 0.25 * std::cos(angle), 1.4 + 0.25 * std::sin(angle), 1.4 - 0.25 * std::cos(2 * angle)}};
}

/// Where the tip is along a closed curve of actuations: reachable by construction.
MarkerPath made_by_actuation(const Robot& robot, int count) {
  MarkerPath path{{0}, {{true, true, true}}, {}};
  State state = robot.statics.rest();
  for (int i = 0; i < count; ++i) {
    const Equilibrium found = robot.statics.solve(turn(static_cast<double>(i) / (count - 1)), state);
    EXPECT_EQ(found.report.status, Status::converged);
    state = found.state;
    Waypoint waypoint;
    waypoint.targets = {robot.tip(state)};
    path.waypoints.push_back(waypoint);
  }
  return path;
}

double mean_equilibria(const std::vector<InverseResult>& waypoints) {
  double sum = 0;
  for (const InverseResult& each : waypoints) sum += each.equilibria;
  return sum / static_cast<double>(waypoints.size());
}

void expect_reached(const Robot& robot, const MarkerPath& path, const std::vector<InverseResult>& found,
                    double tolerance_mm) {
  ASSERT_EQ(found.size(), path.waypoints.size());
  State state = robot.statics.rest();
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].status, InverseStatus::reached) << i << " " << found[i].remark;
    EXPECT_LE(found[i].errors_mm.maxCoeff(), tolerance_mm) << i;
    check_actuation(robot.model, found[i].equilibrium.actuation);
    const Equilibrium again =
        robot.statics.solve(found[i].equilibrium.actuation, state);  // forward kinematics has the last word
    ASSERT_EQ(again.report.status, Status::converged);
    state = again.state;
    EXPECT_LE((robot.tip(state) - path.waypoints[i].targets[0]).norm(), tolerance_mm + 1e-5) << i;
    EXPECT_LE((robot.tip(found[i].equilibrium.state) - robot.tip(state)).norm(), 1e-5) << i;
  }
}

class FollowPath : public ::testing::TestWithParam<Formulation> {};

TEST_P(FollowPath, LeadsTheTipAlongAReachableCurve) {
  const Robot robot(GetParam());
  const MarkerPath path = made_by_actuation(robot, 25);
  const std::vector<InverseResult> found = follow_path(robot.statics, path);
  expect_reached(robot, path, found, 1e-3);
  EXPECT_LE(mean_equilibria(found), 3);
  for (std::size_t i = 1; i < found.size(); ++i)  // three coordinates, three chambers: one solution nearby
    EXPECT_LE((found[i].equilibrium.actuation - turn(static_cast<double>(i) / 24)).norm(), 0.01) << i;
}

INSTANTIATE_TEST_SUITE_P(Formulations, FollowPath, ::testing::Values(Formulation::physical, Formulation::target_shape));

TEST(Trajectory, PredictionSavesEquilibria) {
  const Robot robot(Formulation::target_shape);
  const MarkerPath path = made_by_actuation(robot, 21);
  TrajectoryOptions without;
  without.predict = false;
  const auto plain = follow_path(robot.statics, path, without);
  const auto predicted = follow_path(robot.statics, path);
  expect_reached(robot, path, predicted, 1e-3);
  EXPECT_LT(mean_equilibria(predicted), 0.9 * mean_equilibria(plain));
}

/// Of all samples of the grid, each solved for alone, the one with the nearest tip is taken: the commands are the same
/// whether the samples are made during the run or are given. Making them costs the first waypoint as many equilibria.
TEST(Trajectory, NearestTakesTheNearestOfAllSamples) {
  for (const Formulation formulation : {Formulation::physical, Formulation::target_shape}) {
    const Robot robot(formulation);
    MarkerPath path = made_by_actuation(robot, 9);
    path.axes = {{true, false, true}};
    const Index count = 64;
    const Actuations grid = sample_actuations(robot.model, {.samples = count});
    std::vector<WorkspaceSample> known;
    for (Index i = 0; i < count; ++i) {
      const Equilibrium found = robot.statics.solve(grid.row(i), robot.statics.rest());
      ASSERT_EQ(found.report.status, Status::converged);
      known.push_back({.number = i,
                       .actuation = grid.row(i),
                       .markers = robot.tip(found.state).transpose(),
                       .status = Status::converged});
    }
    TrajectoryOptions made, given;
    made.nearest = count;
    given.nearest = known;
    const auto by_grid = follow_path(robot.statics, path, made);
    const auto by_known = follow_path(robot.statics, path, given);
    ASSERT_EQ(by_grid.size(), path.waypoints.size());
    ASSERT_EQ(by_known.size(), path.waypoints.size());
    for (std::size_t w = 0; w < path.waypoints.size(); ++w) {
      const auto distance = [&](const Vec3& tip) {
        const Vec3 off = tip - path.waypoints[w].targets[0];
        return std::hypot(off.x(), off.z());
      };
      const auto nearest = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
        return distance(a.markers.row(0)) < distance(b.markers.row(0));
      });
      for (const auto* found : {&by_grid[w], &by_known[w]}) {
        EXPECT_EQ(found->equilibrium.actuation, nearest->actuation) << w;
        EXPECT_NEAR(found->errors_mm[0], distance(robot.tip(found->equilibrium.state)), 1e-12);
        EXPECT_NEAR(found->errors_mm[0], distance(nearest->markers.row(0)), 1e-4);
        EXPECT_EQ(found->status, InverseStatus::unreachable);
        EXPECT_EQ(found->remark, "the nearest of 64 samples");
      }
      EXPECT_EQ(by_known[w].equilibria, 1);
      EXPECT_EQ(by_grid[w].equilibria, w == 0 ? 65 : 1);
    }
  }
}

TEST(Trajectory, NearestNeedsSamples) {
  const Robot robot;
  const MarkerPath path = made_by_actuation(robot, 2);
  TrajectoryOptions none, no_grid;
  none.nearest = std::vector<WorkspaceSample>();
  no_grid.nearest = 10;  // of three actuators 8 or 27
  EXPECT_THROW(PathFollower(robot.statics, path, none), InvalidInput);
  EXPECT_THROW(PathFollower(robot.statics, path, no_grid), InvalidInput);
  no_grid.nearest = 8;
  PathFollower follower(robot.statics, path, no_grid);
  const InverseResult stopped = follower.advance([](const Progress&) { return false; });
  EXPECT_TRUE(stopped.stopped);
  EXPECT_EQ(follower.next(), 0u);
  const int equilibria = follower.advance().equilibria;  // of the eight samples those that it was not stopped after
  EXPECT_GE(equilibria, 1);
  EXPECT_LE(equilibria, 9);
}

/// Where the search looks ahead one equilibrium a waypoint does.
TEST(Trajectory, AWaypointCostsOneEquilibrium) {
  const Robot robot;
  const MarkerPath path = made_by_actuation(robot, 41);
  const auto found = follow_path(robot.statics, path);
  expect_reached(robot, path, found, 1e-3);
  EXPECT_LT(mean_equilibria(found), 1.2);
}

TEST(Trajectory, OutsideTheWorkspaceItKeepsToTheNearestPointsAndComesBack) {
  const Robot robot;
  const Actuation half = Actuation::Constant(3, 1.5);
  const Vec3 inside = robot.tip(robot.statics.solve(half, robot.statics.rest()).state);
  MarkerPath path{{0}, {{true, true, true}}, {}};
  constexpr int count = 21;
  for (int i = 0; i < count; ++i) {  // along the axis, farther than the longest robot reaches, and back
    Waypoint waypoint;
    waypoint.targets = {inside + Vec3(12 * std::sin(std::numbers::pi * i / (count - 1)), 0, 0)};
    path.waypoints.push_back(waypoint);
  }
  const auto found = follow_path(robot.statics, path);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(count));
  int out = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool reached = found[i].status == InverseStatus::reached;
    EXPECT_TRUE(reached || found[i].status == InverseStatus::unreachable) << i << " " << found[i].remark;
    EXPECT_EQ(reached, found[i].errors_mm.maxCoeff() <= 1e-3) << i;
    EXPECT_NEAR(found[i].errors_mm.maxCoeff(),
                (robot.tip(found[i].equilibrium.state) - path.waypoints[i].targets[0]).norm(), 1e-9);
    check_actuation(robot.model, found[i].equilibrium.actuation);
    out += reached ? 0 : 1;
    if (i > 0) {
      EXPECT_LE((robot.tip(found[i].equilibrium.state) - robot.tip(found[i - 1].equilibrium.state)).norm(),
                1.5 * (path.waypoints[i].targets[0] - path.waypoints[i - 1].targets[0]).norm() + 0.05);
    }
  }
  EXPECT_GT(out, 5);
  EXPECT_EQ(found.front().status, InverseStatus::reached);
  EXPECT_EQ(found.back().status, InverseStatus::reached);
  EXPECT_GT(found[count / 2].errors_mm.maxCoeff(), 1);
  const Actuation most = Actuation::Constant(3, 2);  // no sample of the ranges is nearer than what was found
  for (const double a : {1.0, 1.5, 2.0})
    for (const double b : {1.0, 1.5, 2.0}) {
      const State state = robot.statics.solve(Actuation{{a, b, 2.0}}, robot.statics.rest()).state;
      EXPECT_GE((robot.tip(state) - path.waypoints[count / 2].targets[0]).norm(),
                found[count / 2].errors_mm.maxCoeff() - 1e-3);
    }
  EXPECT_EQ(robot.statics.solve(most, robot.statics.rest()).report.status, Status::converged);
}

TEST(Trajectory, CoordinatesThatDoNotCountAreFree) {
  const Robot robot;
  MarkerPath path = made_by_actuation(robot, 9);
  path.axes[0] = {false, true, true};
  for (Waypoint& waypoint : path.waypoints) waypoint.targets[0].x() = 0;
  for (const InverseResult& each : follow_path(robot.statics, path)) {
    EXPECT_EQ(each.status, InverseStatus::reached) << each.remark;
    EXPECT_GT(robot.tip(each.equilibrium.state).x(), 40);
  }
}

TEST(Trajectory, InterruptedItKeepsWhatIsDoneAndGoesOnFromThere) {
  const Robot robot;
  const MarkerPath path = made_by_actuation(robot, 12);
  const auto whole = follow_path(robot.statics, path);

  PathFollower follower(robot.statics, path, {});
  State last;
  for (int i = 0; i < 5; ++i) last = follower.advance().equilibrium.state;
  const InverseResult stopped = follower.advance([](const Progress&) { return false; });
  EXPECT_EQ(stopped.status, InverseStatus::interrupted);
  EXPECT_EQ(follower.next(), 5u);

  PathFollower again(robot.statics, path, {});
  again.resume(5, last);
  while (!again.done()) {
    const std::size_t i = again.next();
    const InverseResult found = again.advance();
    EXPECT_EQ(found.status, InverseStatus::reached);
    EXPECT_LE((found.equilibrium.actuation - whole[i].equilibrium.actuation).norm(), 1e-3) << i;
  }
  int calls = 0;
  const auto part = follow_path(robot.statics, path, {}, [&calls](const Progress&) { return ++calls < 40; });
  EXPECT_GT(part.size(), 0u);
  EXPECT_LT(part.size(), path.waypoints.size());
  for (const InverseResult& each : part) EXPECT_EQ(each.status, InverseStatus::reached);
}

TEST(Trajectory, StartsWhereItIsTold) {
  const Robot robot;
  MarkerPath path = made_by_actuation(robot, 2);
  path.waypoints.resize(1);
  TrajectoryOptions near;
  near.start = turn(0);
  const auto from_rest = follow_path(robot.statics, path);
  const auto from_near = follow_path(robot.statics, path, near);
  EXPECT_LE(from_near[0].equilibria, 2);
  EXPECT_LT(from_near[0].equilibria, from_rest[0].equilibria);
  EXPECT_LE((from_near[0].equilibrium.actuation - turn(0)).norm(), 1e-4);
}

TEST(Trajectory, AlgorithmTwoFollowsToo) {
  const Robot robot(Formulation::target_shape);
  const MarkerPath path = made_by_actuation(robot, 25);
  MarkerPath begin{path.markers, path.axes, {path.waypoints.begin(), path.waypoints.begin() + 3}};
  TrajectoryOptions gradient;
  gradient.inverse.method = InverseMethod::gradient;
  gradient.inverse.tolerance_mm = 0.2;
  gradient.start = turn(0);
  const auto slow = follow_path(robot.statics, begin, gradient);
  expect_reached(robot, begin, slow, 0.2);
  EXPECT_GT(mean_equilibria(slow), mean_equilibria(follow_path(robot.statics, begin)));
}

TEST(Densified, InsertsEvenlyOnTheStraightLines) {
  MarkerPath path{{0, 1}, {{true, true, true}, {true, true, true}}, {}};
  path.waypoints.resize(3);
  path.waypoints[0] = {{Vec3(0, 0, 0), Vec3(5, 5, 5)}, 1.0, 2, false};
  path.waypoints[1] = {{Vec3(3, 0, 0), Vec3(5, 9, 5)}, 3.0, 3, false};  // the second marker moves farther: 4 mm
  path.waypoints[2] = {{Vec3(3, 0, 0.9), Vec3(5, 9, 5)}, 3.5, 4, false};
  const MarkerPath dense = densified(path, 1);
  ASSERT_EQ(dense.waypoints.size(), 6u);
  for (std::size_t i = 0; i < 5; ++i) {
    const double fraction = static_cast<double>(i) / 4;
    EXPECT_EQ(dense.waypoints[i].inserted, i % 4 != 0);
    EXPECT_LE((dense.waypoints[i].targets[0] - Vec3(3 * fraction, 0, 0)).norm(), 1e-12);
    EXPECT_LE((dense.waypoints[i].targets[1] - Vec3(5, 5 + 4 * fraction, 5)).norm(), 1e-12);
    EXPECT_NEAR(*dense.waypoints[i].time, 1 + 2 * fraction, 1e-12);
  }
  EXPECT_FALSE(dense.waypoints[5].inserted);
  EXPECT_EQ(densified(path, 100).waypoints.size(), 3u);
  for (const double bad : {0.0, -1.0, std::nan(""), 1e-9})
    EXPECT_THROW((void)densified(path, bad), InvalidInput) << bad;
}

TEST(Trajectory, RefusesWhatIsNoPath) {
  const Robot robot;
  const auto refused = [&](const MarkerPath& path, const TrajectoryOptions& options = {}) {
    EXPECT_THROW(PathFollower(robot.statics, path, options), InvalidInput);
  };
  MarkerPath path{{0}, {{true, true, true}}, {{{Vec3(60, 10, 10)}, {}, 0, false}}};
  EXPECT_NO_THROW(PathFollower(robot.statics, path, {}));
  refused({{0}, {{true, true, true}}, {}});
  refused({{}, {}, path.waypoints});
  refused({{7}, path.axes, path.waypoints});
  refused({{0}, {{false, false, false}}, path.waypoints});
  path.waypoints[0].targets[0].y() = std::nan("");
  refused(path);
  path.waypoints[0].targets.clear();
  refused(path);
  path.waypoints[0].targets = {Vec3(60, 10, 10)};
  TrajectoryOptions outside;
  outside.start = Actuation::Constant(3, 5);
  refused(path, outside);
}

}  // namespace
}  // namespace softkin
