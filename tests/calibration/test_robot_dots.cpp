#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <random>
#include <softkin/calibration/assignment.hpp>
#include <softkin/io/table/measured_poses.hpp>

#include "calibration/arm_poses.hpp"

/// Dots of which it is not known which markers they are.

namespace softkin::calibration {

namespace {

using namespace softkin::testing;

/// Returns the minimum sum over all assignments of columns, or of none, to rows.
double min_by_trying(const Eigen::MatrixXd& costs, double alone, Eigen::Index row, std::vector<bool>& taken) {
  if (row == costs.rows()) return 0;
  double least = alone + min_by_trying(costs, alone, row + 1, taken);
  for (Eigen::Index c = 0; c < costs.cols(); ++c) {
    const std::size_t column = c;
    if (taken[column] || !std::isfinite(costs(row, c))) continue;
    taken[column] = true;
    least = std::min(least, costs(row, c) + min_by_trying(costs, alone, row + 1, taken));
    taken[column] = false;
  }
  return least;
}

/// The poses with their markers' readings as dots, shuffled in each pose; named keeps the columns of these markers.
MeasuredPoses with_dots(const MeasuredPoses& poses, unsigned seed, const std::vector<Index>& named = {}) {
  MeasuredPoses seen = poses;
  std::mt19937 engine(seed);
  std::vector<Eigen::Index> keep;
  std::vector<Index> markers;
  for (Eigen::Index c = 0; c < std::ssize(poses.columns); ++c) {
    const Index marker = poses.columns[c].marker;
    const bool has_name = std::find(named.begin(), named.end(), marker) != named.end();
    if (has_name) keep.push_back(c);
    if (!has_name && poses.columns[c].axis == 0) markers.push_back(c);
  }
  seen.columns.clear();
  for (const Eigen::Index c : keep) seen.columns.push_back(poses.columns[c]);
  seen.values = poses.values(Eigen::all, keep).eval();
  seen.dots.axes = {0, 1, 2};
  for (std::size_t d = 0; d < markers.size(); ++d) seen.dots.names.push_back("dot" + std::to_string(d + 1));
  seen.dots.places.resize(poses.values.rows(), 3 * markers.size());
  for (Eigen::Index pose = 0; pose < poses.values.rows(); ++pose) {
    std::shuffle(markers.begin(), markers.end(), engine);
    for (std::size_t d = 0; d < markers.size(); ++d)
      seen.dots.places.row(pose).segment(3 * d, 3) = poses.values.row(pose).segment(markers[d], 3);
  }
  return seen;
}

/// The dot of a pose nearest to a place.
Eigen::Index dot_at(const MeasuredPoses& seen, Eigen::Index pose, const Vec3& place) {
  Eigen::Index best = 0;
  for (Eigen::Index d = 0; 3 * d < seen.dots.places.cols(); ++d)
    if ((seen.dots.places.row(pose).segment(3 * d, 3).transpose() - place).norm() <
        (seen.dots.places.row(pose).segment(3 * best, 3).transpose() - place).norm())
      best = d;
  return best;
}

RobotFitOptions within(double mm) {
  RobotFitOptions options;
  options.match_within_mm = mm;
  return options;
}

const std::vector<std::string> made{"materials.body.youngs_modulus=0.2", "actuators.t1.factor=0.85", "base.ry=4"},
    fitted{"materials.body.youngs_modulus=0.3,0.05,2", "actuators.t1.factor=1", "base.ry"};

}  // namespace

TEST(Assignment, IsTheLeastOfAll) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> cost(0, 1), whole(0, 4);
  int with_none = 0, full = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Eigen::MatrixXd costs(1 + trial % 5, 1 + trial / 5 % 6);
    for (Eigen::Index i = 0; i < costs.size(); ++i)  // some of them alike, some forbidden
      costs.data()[i] = trial % 3 == 0 ? std::floor(whole(engine)) : cost(engine);
    if (trial % 4 == 0) costs(0, 0) = std::numeric_limits<double>::infinity();
    const double alone = trial % 2 == 0 ? 0.4 : 10;
    const std::vector<Index> columns = min_assignment(costs, alone);
    ASSERT_EQ(columns.size(), static_cast<std::size_t>(costs.rows()));
    double sum = 0;
    std::vector<bool> taken(costs.cols());
    for (std::size_t row = 0; row < columns.size(); ++row) {
      sum += columns[row] < 0 ? alone : costs(row, columns[row]);
      if (columns[row] < 0) {
        ++with_none;
        continue;
      }
      EXPECT_FALSE(taken[columns[row]]);
      taken[columns[row]] = true;
      ++full;
    }
    std::vector<bool> none(costs.cols());
    EXPECT_NEAR(sum, min_by_trying(costs, alone, 0, none), 1e-12) << costs << "\nalone " << alone;
  }
  EXPECT_GT(with_none, 100);
  EXPECT_GT(full, 500);
}

/// The order of the dots does not matter: the fit is that of the named markers. It is the same step by step where the
/// frame is known; otherwise it agrees to the convergence tolerance, as the frame is corrected before the first step.
TEST(RobotDots, ShuffledAreFittedAsNamed) {
  const Arm arm;
  const MeasuredPoses poses = arm.poses(made, 0.3, 4);
  const std::vector<std::string> of_robot{fitted[0], fitted[1]};
  for (const std::vector<std::string>& numbers : {of_robot, fitted}) {
    const NumberedRobot robot = arm.robot(numbers);
    const RobotFit named = fit_robot(robot, poses, {});
    ASSERT_EQ(named.status, Status::converged);
    const double least = numbers.size() == 2 ? 1e-7 : 1e-3;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const MeasuredPoses seen = with_dots(poses, seed);
      const RobotFit fit = fit_robot(robot, seen, within(8));
      EXPECT_EQ(fit.status, Status::converged) << fit.remark;
      for (Index i = 0; i < std::ssize(numbers); ++i) {
        EXPECT_NEAR(fit.values[i], named.values[i], least * named.deviations[i]) << i;
        EXPECT_NEAR(fit.deviations[i], named.deviations[i], 1e-4 * named.deviations[i]) << i;
      }
      EXPECT_NEAR(fit.markers_mm.rms, named.markers_mm.rms, 1e-6);
      for (Index pose = 0; pose < 6; ++pose)
        for (std::size_t d = 0; d < 2; ++d) {
          const DotMatch& match = fit.dots[pose][d];
          ASSERT_GE(match.marker, 0);
          EXPECT_EQ(dot_at(seen, pose, poses.values.row(pose).segment(3 * match.marker, 3).transpose()),
                    static_cast<Eigen::Index>(d));
          EXPECT_TRUE(numbers.size() == 2 || !match.rival) << pose;
          EXPECT_LT(match.distance_mm, numbers.size() == 2 ? 8 : 2);
        }
    }
  }
}

/// A marker whose name was read is no dot; what is missing of its readings is no dot's either.
TEST(RobotDots, ComeBesideNames) {
  const Arm arm;
  const MeasuredPoses poses = arm.poses(made, 0.3, 4);
  const NumberedRobot robot = arm.robot(fitted);
  const RobotFit named = fit_robot(robot, poses, {});
  const RobotFit fit = fit_robot(robot, with_dots(poses, 1, {1}), within(5));
  EXPECT_EQ(fit.status, Status::converged) << fit.remark;
  for (Index i = 0; i < 3; ++i) EXPECT_NEAR(fit.values[i], named.values[i], 1e-3 * named.deviations[i]) << i;
  for (const auto& pose : fit.dots) EXPECT_EQ(pose[0].marker, 0);
}

/// The robot stands elsewhere than it is thought to: none of the dots is near its marker at first. Some are missing,
/// and some are no markers.
TEST(RobotDots, AreMatchedFromARoughStartOfTheFrame) {
  const Arm arm;
  std::vector<std::string> there = made, here = fitted;
  for (const char* name : {"base.x=35", "base.y=-20", "base.z=50", "base.rz=25", "base.rx=-15"}) {
    there.emplace_back(name);
    here.push_back(std::string(name).substr(0, std::string(name).find('=')));
  }
  MeasuredPoses poses = arm.poses(there, 0.2, 4);
  MeasuredPoses seen = with_dots(poses, 2);
  const auto tip = [&](Index pose) -> Vec3 { return poses.values.row(pose).head(3).transpose(); };
  seen.dots.places.row(3).segment(3 * dot_at(seen, 3, tip(3)), 3).setConstant(std::nan(""));
  seen.dots.places.row(5).segment(3 * dot_at(seen, 5, tip(5)), 3) += Eigen::RowVector3d(10, -20, 20);
  for (const Index pose : {3, 5}) poses.values.row(pose).head(3).setConstant(std::nan(""));
  const NumberedRobot robot = arm.robot(here);
  const RobotFit predicted = predict_poses(robot, seen, robot.start(), within(3));
  EXPECT_EQ(predicted.markers_mm.readings, 0u) << "nothing is where it was thought to be";
  const RobotFit named = fit_robot(robot, poses, {}), fit = fit_robot(robot, seen, within(3));
  EXPECT_EQ(fit.status, Status::converged) << fit.remark;
  EXPECT_EQ(fit.markers_mm.readings, 10u);
  for (Index i = 0; i < 8; ++i) EXPECT_NEAR(fit.values[i], named.values[i], 1e-3 * named.deviations[i]) << i;
}

/// Fewer dots than markers, and dots that are no markers, 30 mm off: as if the missing ones had not been read by name.
TEST(RobotDots, AreFewerOrFalse) {
  const Arm arm;
  MeasuredPoses poses = arm.poses(made, 0.3, 4);
  const double nan = std::nan("");
  MeasuredPoses seen = with_dots(poses, 3);
  const auto tip = [&](Index pose) -> Vec3 { return poses.values.row(pose).head(3).transpose(); };
  const Eigen::Index missing = dot_at(seen, 1, tip(1)), wrong = dot_at(seen, 4, tip(4));
  seen.dots.places.row(1).segment(3 * missing, 3).setConstant(nan);
  seen.dots.places.row(4).segment(3 * wrong, 3) += Eigen::RowVector3d(0, 30, 0);
  poses.values.row(1).head(3).setConstant(nan);
  poses.values.row(4).head(3).setConstant(nan);
  // and one more in a pose that shows all
  seen.dots.names.emplace_back("dot3");
  seen.dots.places.conservativeResize(Eigen::NoChange, 9);
  seen.dots.places.rightCols(3).setConstant(nan);
  seen.dots.places.row(2).tail(3) = tip(2).transpose() + Eigen::RowVector3d(0, 0, -30);
  const NumberedRobot robot = arm.robot(fitted);
  const RobotFit named = fit_robot(robot, poses, {});
  for (const Loss loss : {Loss::squares, Loss::huber}) {
    RobotFitOptions options = within(5);
    options.loss = loss;
    const RobotFit fit = fit_robot(robot, seen, options);
    EXPECT_EQ(fit.status, Status::converged) << fit.remark;
    for (Index i = 0; loss == Loss::squares && i < 3; ++i)
      EXPECT_NEAR(fit.values[i], named.values[i], 1e-3 * named.deviations[i]) << i;
    EXPECT_EQ(fit.markers_mm.readings, 10u);
    EXPECT_FALSE(fit.dots[1][missing].seen);
    const DotMatch& no_marker = fit.dots[4][wrong];
    EXPECT_TRUE(no_marker.seen);
    EXPECT_EQ(no_marker.marker, -1);
    EXPECT_EQ(no_marker.nearest, 0);
    EXPECT_NEAR(no_marker.distance_mm, 30, 2);
    EXPECT_EQ(fit.dots[2][2].marker, -1);
    const Model model = robot.model(robot.start());
    const RobotFitReport report{robot, seen, options, fit, model};
    const std::string text = robot_fit_text(report), table = robot_fit_table(report).csv();
    EXPECT_NE(text.find("10 of 12 dots matched to markers within 5 mm"), std::string::npos) << text;
    EXPECT_NE(text.find("pose 5 (line 6): dot" + std::to_string(wrong + 1) + " is no marker; tip is nearest"),
              std::string::npos)
        << text;
    EXPECT_NE(table.find("difference,kept,marker,may_be\n"), std::string::npos) << table;
    EXPECT_NE(table.find(",0,none,\n"), std::string::npos) << table;
    EXPECT_NE(table.find(",0,tip,\n"), std::string::npos) << table;
    EXPECT_EQ(robot_fit_plot(report).rows[0][0].series.size(), 5u) << "apart, half, tip, computed, no marker";
  }
}

/// Two markers are closer together than the noise: the fit reports that a dot may be either of them, and nothing else.
TEST(RobotDots, SayWhichMayBeAnother) {
  const Arm arm(std::string(arm_scene) + "  - {name: twin, point: [30, 0, 5.4]}\n");
  const NumberedRobot robot = arm.robot(fitted);
  MeasuredPoses poses = arm.poses(made, 0.5, 6);
  const MeasuredPoses seen = with_dots(poses, 5);
  ASSERT_EQ(seen.dots.names.size(), 3u);
  const RobotFit fit = fit_robot(robot, seen, within(6));
  EXPECT_EQ(fit.status, Status::converged) << fit.remark;
  int doubtful = 0;
  for (const auto& pose : fit.dots)
    for (const DotMatch& match : pose) {
      ASSERT_GE(match.marker, 0);
      EXPECT_TRUE(match.marker != 0 || !match.rival) << "the tip is alone";
      EXPECT_TRUE(!match.rival || *match.rival == 3 - match.marker);
      doubtful += match.rival.has_value();
    }
  EXPECT_GE(doubtful, 8);
  const Model model = robot.model(robot.start());
  const RobotFitOptions options = within(6);
  const std::string text = robot_fit_text({robot, seen, options, fit, model});
  EXPECT_NE(text.find(" is taken for twin but may as well be half"), std::string::npos) << text;
}

/// Kept aside: matched too, and not fitted to.
TEST(RobotDots, AreKeptAside) {
  const Arm arm;
  const MeasuredPoses poses = arm.poses(made, 0.3, 4);
  RobotFitOptions named, unnamed = within(5);
  named.kept = unnamed.kept = {false, false, true, false, false, false};
  const NumberedRobot robot = arm.robot(fitted);
  const RobotFit by_name = fit_robot(robot, poses, named), fit = fit_robot(robot, with_dots(poses, 9), unnamed);
  EXPECT_EQ(fit.kept_mm.readings, 2u);
  EXPECT_NEAR(fit.kept_mm.rms, by_name.kept_mm.rms, 1e-4);
  const RobotFit predicted = predict_poses(robot, with_dots(poses, 9), by_name.values, unnamed);
  EXPECT_NEAR(predicted.kept_mm.rms, by_name.kept_mm.rms, 1e-7);
}

/// Each step lowers the sum in which a dot that is no marker counts as the distance: nearby that sum is larger.
TEST(RobotDots, AreFittedToALeastSum) {
  const Arm arm;
  const NumberedRobot robot = arm.robot(fitted);
  const MeasuredPoses seen = with_dots(arm.poses(made, 1, 8), 2);
  constexpr double most = 2;  // leaves some out
  const RobotFit fit = fit_robot(robot, seen, within(most));
  ASSERT_EQ(fit.status, Status::converged) << fit.remark;
  const auto sum = [&](const Eigen::VectorXd& values) {
    const RobotFit at = predict_poses(robot, seen, values, within(most));
    double all = 0;
    for (const auto& pose : at.dots)
      for (const DotMatch& match : pose) all += match.marker < 0 ? most * most : std::pow(match.distance_mm, 2);
    return all;
  };
  EXPECT_LT(fit.markers_mm.readings, 12u);
  EXPECT_GT(fit.markers_mm.readings, 6u);
  const double least = sum(fit.values);
  for (Index i = 0; i < 3; ++i)
    for (const double part : {-0.03, 0.03}) {
      Eigen::VectorXd other = fit.values;
      other[i] += part * std::max(1.0, std::abs(other[i])) * (i == 2 ? 10 : 1);
      EXPECT_GT(sum(other), least) << i << " " << part;
    }
}

TEST(RobotDots, AreRefusedWithAReason) {
  const Arm arm;
  const NumberedRobot robot = arm.robot(fitted);
  const MeasuredPoses poses = arm.poses(made);
  const Model model = robot.model(robot.start());
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text, bool dots = true, const Model* of = nullptr) {
    std::ofstream(folder / "poses.csv") << text;
    return read_measured_poses(folder / "poses.csv", of ? *of : model, dots);
  };
  const MeasuredPoses two =
      read("t1_N,dot1_x_mm,dot1_z_mm,tip_x_mm,dot7_z_mm,dot7_x_mm\n0.1,61,5,,2,30\n0.2,,,9,3,31\n");
  EXPECT_EQ(two.dots.names, (std::vector<std::string>{"dot1", "dot7"}));
  EXPECT_EQ(two.dots.axes, (std::vector<int>{0, 2}));
  EXPECT_EQ(two.dots.places(0, 2), 30);
  EXPECT_EQ(two.dots.places(1, 3), 3);
  EXPECT_TRUE(std::isnan(two.dots.places(1, 0)));
  EXPECT_EQ(two.columns.size(), 1u);
  expect_refused([&] { (void)fit_robot(robot, with_dots(poses, 1), {}); }, "poses.csv: it has dots without names");
  expect_refused([&] { (void)fit_robot(robot, poses, within(3)); }, "no dot without a name");
  expect_refused([&] { (void)read("t1,dot1_x_mm\n0,1\n", false); }, "no marker 'dot1'");
  expect_refused([&] { (void)read("t1,dot0_x_mm\n0,1\n"); }, "no marker 'dot0'");
  expect_refused([&] { (void)read("t1,dot1_x_mm,dot2_z_mm\n0,1,2\n"); }, "poses.csv:1: column 'dot1_z_mm' is missing");
  expect_refused([&] { (void)read("t1,dot1_x_mm,dot1_z_mm\n0,1,2\n0,,2\n"); },
                 "poses.csv:3: column 'dot1_x_mm' is empty");
  expect_refused([&] { (void)read("t1,dot1_x_mm\n0,\n"); }, "every reading is missing");
  std::string called = arm_scene;
  called.replace(called.find("name: tip"), 9, "name: dot1");
  const Arm other(called);
  const Model of_dot = other.robot({}).model(Eigen::VectorXd(0));
  EXPECT_EQ(read("t1,dot1_x_mm\n0,1\n", true, &of_dot).columns[0].marker, 0) << "a marker's name comes first";
  expect_refused([&] { (void)read("t1,dot2_x_mm\n0,1\n", true, &of_dot); }, "no marker 'dot2'");
  const Arm none(std::string(arm_scene).substr(0, std::string(arm_scene).find("markers:")));
  const Model bare = none.robot({}).model(Eigen::VectorXd(0));
  expect_refused([&] { (void)read("t1,dot1_x_mm\n0,1\n", true, &bare); }, "the scene's markers, and it has none");
}

}  // namespace softkin::calibration
