#include <gtest/gtest.h>

#include <cmath>
#include <softkin/calibration/robot_problem.hpp>

#include "calibration/arm_poses.hpp"

/// Play of motors, from poses that were taken one after another.

namespace softkin::calibration {

namespace {

std::string arm_with_play() {
  std::string text = arm_scene;
  return text.replace(text.find("range: [0, 2]"), 13, "range: [0, 2], backlash: 0.02");
}

/// A tendon up and down and up.
MeasuredPoses up_and_down(const Arm& arm, const std::vector<std::string>& numbers) {
  MeasuredPoses poses = arm.poses({});
  poses.commands.clear();
  poses.lines.clear();
  for (const double tension : {0.0, 0.1, 0.2, 0.19, 0.15, 0.08, 0.02, 0.04, 0.12}) {
    poses.commands.push_back((Actuation(2) << tension, 0.02).finished());
    poses.lines.push_back(poses.commands.size() + 1);
  }
  poses.values = Eigen::MatrixXd::Zero(9, 6);
  const NumberedRobot truth = arm.robot(numbers);
  RobotFitOptions options;
  options.ordered = true;
  poses.values = predict_poses(truth, poses, truth.start(), options).computed.values;
  return poses;
}

const std::vector<std::string> play_made{"actuators.t1.backlash=0.03", "actuators.t1.factor=0.9"},
    play_fitted{"actuators.t1.backlash=0.01,0,0.1", "actuators.t1.factor=1"};

}  // namespace

TEST(RobotBacklash, IsFoundFromPosesInTheirOrder) {
  const Arm arm(arm_with_play());
  const MeasuredPoses poses = up_and_down(arm, play_made);
  RobotFitOptions options;
  options.ordered = true;
  const NumberedRobot robot = arm.robot(play_fitted);
  const RobotFit fit = fit_robot(robot, poses, options);
  EXPECT_EQ(fit.status, Status::converged) << fit.remark;
  EXPECT_NEAR(fit.values[0], 0.03, 1e-6);
  EXPECT_NEAR(fit.values[1], 0.9, 1e-5);
  EXPECT_LT(fit.markers_mm.rms, 1e-4);
  // commands that only fall, by less than the play, have no effect; commands that rise act fully
  EXPECT_NEAR((fit.computed.values.row(3) - fit.computed.values.row(2)).norm(), 0, 1e-6);
  options.ordered = false;  // each from rest: the play is never felt
  const RobotFit each = fit_robot(robot, poses, options);
  EXPECT_TRUE(std::isnan(each.deviations[0]));
  EXPECT_GT(each.markers_mm.rms, 0.05);
}

/// Compares with differences of equilibria. In four of the poses the effective command lags; in one the command rises.
TEST(RobotBacklash, SlopesAreThoseOfDifferences) {
  const Arm arm(arm_with_play());
  const std::vector<std::string> numbers{"actuators.t1.backlash=0.025", "actuators.t1.factor=0.9",
                                         "materials.body.youngs_modulus=0.25"};
  const MeasuredPoses poses = up_and_down(arm, play_made);
  const NumberedRobot robot = arm.robot(numbers);
  RobotFitOptions options;
  options.ordered = true;
  options.solver.step_tolerance_mm = 1e-10;
  const FitCallback unreported;
  RobotProblem problem(robot, poses, options, unreported);
  const Eigen::VectorXd at = robot.start();
  const auto point = problem.solve(at, nullptr, true);
  ASSERT_TRUE(point);
  for (Index i = 0; i < 3; ++i) {
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(9, 6);
    for (const auto& [part, weight] : {std::pair{1.0, 8.0}, std::pair{2.0, -1.0}}) {
      Eigen::VectorXd more = at, less = at;
      const double step = 0.01 * at[i];
      more[i] += part * step;
      less[i] -= part * step;
      slope += weight / (12 * step) *
               (problem.solve(more, nullptr, false)->computed - problem.solve(less, nullptr, false)->computed);
    }
    for (Index pose = 0; pose < 9; ++pose) {
      const Eigen::VectorXd exact = point->slopes[pose].col(i);
      EXPECT_LT((exact - slope.row(pose).transpose()).norm(), 1e-5 * slope.norm()) << i << ", pose " << pose;
      const bool lags = pose >= 4 && pose <= 7;
      EXPECT_TRUE(i != 0 || (exact.norm() > 0) == lags) << pose;
    }
  }
}

}  // namespace softkin::calibration
