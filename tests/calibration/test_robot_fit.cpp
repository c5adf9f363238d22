#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <softkin/calibration/robot_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/table/measured_poses.hpp>

#include "calibration/arm_poses.hpp"

/// Numbers of made-up robots from their poses.

namespace softkin::calibration {

namespace {

using namespace softkin::testing;

const std::vector<std::string> truth{"materials.body.youngs_modulus=0.2",
                                     "materials.body.density=1000",
                                     "actuators.t1.factor=0.85",
                                     "base.ry=4",
                                     "base.z=2",
                                     "markers.tip.offset.3=9"};
const std::vector<std::string> requested{"materials.body.youngs_modulus=0.3,0.05,2",
                                         "materials.body.density",
                                         "actuators.t1.factor=1",
                                         "base.ry",
                                         "base.z",
                                         "markers.tip.offset.3"};

double value_of(const std::string& text) {
  return std::stod(text.substr(text.find('=') + 1));
}

}  // namespace

/// What made the poses is found again, whatever kind of number it is.
TEST(RobotFit, FindsTheNumbersThatMadeThePoses) {
  const Arm arm;
  const MeasuredPoses poses = arm.poses(truth);
  const NumberedRobot robot = arm.robot(requested);
  const RobotFit fit = fit_robot(robot, poses, {});
  EXPECT_EQ(fit.status, Status::converged) << fit.remark;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double expected = value_of(truth[i]);
    EXPECT_NEAR(fit.values[i], expected, 1e-4 * std::abs(expected)) << truth[i];
  }
  EXPECT_LT(fit.markers_mm.rms, 1e-4);
  EXPECT_EQ(fit.without_equilibrium, 0);
}

/// Poses are solved side by side; what one leaves to the next on its thread must not count.
TEST(RobotFit, IsTheSameBitForBitWhateverTheThreads) {
  const Arm arm;
  const MeasuredPoses poses = arm.poses(truth, 0.1);
  const NumberedRobot robot = arm.robot(requested);
  RobotFitOptions options;
  options.threads = 1;
  const RobotFit alone = fit_robot(robot, poses, options);
  for (options.threads = 2; options.threads < 6; ++options.threads) {
    const RobotFit fit = fit_robot(robot, poses, options);
    EXPECT_EQ(fit.values, alone.values) << options.threads << " threads";
    EXPECT_EQ(fit.deviations, alone.deviations) << options.threads << " threads";
    EXPECT_EQ(fit.iterations, alone.iterations) << options.threads << " threads";
  }
}

/// Missing readings do not count, and neither do poses that are kept aside; the latter are predicted.
TEST(RobotFit, LeavesOutWhatIsMissingOrKept) {
  const Arm arm;
  MeasuredPoses poses = arm.poses(truth);
  poses.values(2, 1) = poses.values(3, 4) = std::nan("");
  poses.values.row(5).array() += 7;  // wrong, and kept
  RobotFitOptions options;
  options.kept = {false, false, false, false, false, true};
  const RobotFit fit = fit_robot(arm.robot(requested), poses, options);
  EXPECT_EQ(fit.status, Status::converged);
  EXPECT_NEAR(fit.values[0], 0.2, 1e-4);
  EXPECT_EQ(fit.markers_mm.readings, 10u);
  EXPECT_EQ(fit.kept_mm.readings, 2u);
  EXPECT_NEAR(fit.kept_mm.rms, 7 * std::sqrt(3.0), 1e-2);
}

/// Without weight, tensions over moduli alone count: the fit cannot separate the two and reports this.
TEST(RobotFit, SaysWhatCannotBeToldApart) {
  std::string light = arm_scene;
  light.replace(light.find("gravity"), std::string("gravity: [0, 0, -9.81]").size(), "weights: printed");
  const Arm arm(light);
  const MeasuredPoses poses = arm.poses({"materials.body.youngs_modulus=0.2"}, 0.05, 3);
  RobotFitOptions options;
  options.max_iterations = 15;
  const std::vector<std::string> numbers{"materials.body.youngs_modulus=0.25,0.05,2", "actuators.t1.factor=1,0.2,5",
                                         "actuators.t2.factor=1,0.2,5", "materials.body.density"};
  const NumberedRobot robot = arm.robot(numbers);
  const RobotFit fit = fit_robot(robot, poses, options);
  EXPECT_TRUE(std::isnan(fit.deviations[3])) << "nothing weighs anything";
  const bool apart = std::isnan(fit.deviations[0]) || fit.correlations(0, 1) > 0.999;
  EXPECT_TRUE(apart) << fit.deviations.transpose() << "\n" << fit.correlations;
  const Model model = robot.model(robot.start());
  const std::string text = robot_fit_text({robot, poses, options, fit, model});
  EXPECT_NE(text.find("the poses do not determine it"), std::string::npos) << text;
  // a prior of one of them determines both
  std::vector<std::string> known = numbers;
  known.pop_back();
  known[0] = "materials.body.youngs_modulus=0.2+-0.01";
  const RobotFit with_prior = fit_robot(arm.robot(known), poses, options);
  EXPECT_EQ(with_prior.status, Status::converged) << with_prior.remark;
  EXPECT_NEAR(with_prior.values[1], 1, 0.1);
  EXPECT_NEAR(with_prior.deviations[0], 0.01, 0.002);
}

/// A load cell at the base reads the weight; the rest of the shape is not needed for the density.
TEST(RobotFit, ForcesOfSupportsTellTheDensity) {
  const Arm arm;
  const NumberedRobot robot = arm.robot({"materials.body.density=1300,500,3000"});
  MeasuredPoses poses = arm.poses({"materials.body.density=1000"});
  poses.columns = {{"x_low_force_z_N", -1, 2, -1, Reading::force, 0},
                   {"x_low_force_x_N", -1, 0, -1, Reading::force, 0}};
  poses.values.resize(poses.commands.size(), 2);
  poses.values.col(0).setConstant(1000 * 6e-6 * 9.81);
  poses.values.col(1).setZero();
  const RobotFit fit = fit_robot(robot, poses, {});
  EXPECT_EQ(fit.status, Status::converged) << fit.remark;
  EXPECT_NEAR(fit.values[0], 1000, 1e-3);
}

/// The direction of a tracker at the tip determines the bend and the base's orientation; the fit converges to the
/// truth.
TEST(RobotFit, DirectionsTellTheModulusAndTheBase) {
  const Arm arm(std::string(arm_scene) +
                "sensors: [{name: tracker, kind: direction, region: x_high, axis: [1, 0, 0.5]}]\n");
  const NumberedRobot made = arm.robot({"materials.body.youngs_modulus=0.2", "base.ry=4", "base.z=7"}),
                      robot = arm.robot({"materials.body.youngs_modulus=0.3,0.05,2", "base.ry"});
  MeasuredPoses poses = arm.poses({});
  poses.columns.clear();
  for (int axis = 0; axis < 3; ++axis) poses.columns.push_back({"d", -1, axis, -1, Reading::direction, -1, 0});
  poses.values.setZero(poses.commands.size(), 3);
  poses.values = predict_poses(made, poses, made.start(), {}).computed.values;
  EXPECT_NEAR(poses.values.row(0).norm(), 1, 1e-9);
  const RobotFit fit = fit_robot(robot, poses, {});
  EXPECT_EQ(fit.status, Status::converged) << fit.remark;
  EXPECT_NEAR(fit.values[0], 0.2, 1e-5);
  EXPECT_NEAR(fit.values[1], 4, 1e-3);
  EXPECT_LT(fit.iterations, 10);
}

/// Nine of ten intervals of 1.645 deviations hold the truth.
TEST(RobotFit, DeviationsAreThoseOfTheNoise) {
  const Arm arm;
  const std::vector<std::string> made{truth[0], truth[2]}, fitted{requested[0], requested[2]};
  const NumberedRobot robot = arm.robot(fitted);
  const MeasuredPoses exact = arm.poses(made);
  int inside = 0;
  constexpr int draws = 40;
  for (unsigned draw = 1; draw <= draws; ++draw) {
    MeasuredPoses poses = exact;
    std::mt19937 engine(draw);
    std::normal_distribution<double> normal(0, 0.5);
    for (Index i = 0; i < std::ssize(poses.values); ++i) poses.values.data()[i] += normal(engine);
    const RobotFit fit = fit_robot(robot, poses, {});
    EXPECT_NEAR(fit.scales[0], 0.5, 0.2);
    for (Index i = 0; i < 2; ++i) inside += std::abs(fit.values[i] - value_of(made[i])) < 1.645 * fit.deviations[i];
  }
  EXPECT_GE(inside, 0.82 * 2 * draws);
  EXPECT_LE(inside, 0.97 * 2 * draws);
}

/// Readings that are 30 mm off move nothing by more than a deviation.
TEST(RobotFit, WrongReadingsHardlyCount) {
  const Arm arm;
  const std::vector<std::string> made{truth[0], truth[2], truth[3]}, fitted{requested[0], requested[2], requested[3]};
  const NumberedRobot robot = arm.robot(fitted);
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    RobotFitOptions options;
    options.loss = loss;
    const RobotFit good = fit_robot(robot, arm.poses(made, 0.5, 5), options);
    const RobotFit bad = fit_robot(robot, arm.poses(made, 0.5, 5, 0.1), options);
    EXPECT_GT(bad.markers_mm.largest, 20);
    EXPECT_EQ(bad.status, Status::converged) << bad.remark;
    for (Index i = 0; i < 3; ++i) EXPECT_LT(std::abs(bad.values[i] - good.values[i]), good.deviations[i]) << i;
  }
}

/// A tendon that seems to push: its factor cannot be negative.
TEST(RobotFit, SaysWhereTheSceneRefusesWhatWouldFitBetter) {
  const Arm arm;
  MeasuredPoses poses = arm.poses({"actuators.t1.factor=0.01"});
  for (Index pose = 0; pose < poses.values.rows(); ++pose)
    if (poses.commands[pose][0] > 0) poses.values(pose, 2) -= 5;
  const RobotFit fit = fit_robot(arm.robot({"actuators.t1.factor=0.5"}), poses, {});
  EXPECT_EQ(fit.status, Status::not_converged);
  EXPECT_NE(fit.remark.find("give bounds"), std::string::npos) << fit.remark;
  EXPECT_NE(fit.remark.find("greater than 0"), std::string::npos) << fit.remark;
  EXPECT_LT(fit.values[0], 0.3);
  EXPECT_GT(fit.values[0], 0);
  const RobotFit bounded = fit_robot(arm.robot({"actuators.t1.factor=0.5,0.1,2"}), poses, {});
  EXPECT_EQ(bounded.status, Status::converged);
  EXPECT_EQ(bounded.at_bound[0], -1);
}

TEST(RobotFit, StopsWhereTheUserSays) {
  const Arm arm;
  const MeasuredPoses poses = arm.poses(truth);
  int calls = 0;
  const RobotFit fit = fit_robot(arm.robot(requested), poses, {}, [&](const FitProgress& p) {
    ++calls;
    return p.iteration < 2;
  });
  EXPECT_EQ(fit.status, Status::interrupted);
  EXPECT_EQ(fit.values.size(), 6) << "the best so far";
  EXPECT_GT(calls, 6);
}

TEST(RobotFit, RefusesWithAReason) {
  const Arm arm;
  for (const auto& [text, why] :
       std::vector<std::pair<std::string, std::string>>{{"", "expected NAME"},
                                                        {"E=", "finite number"},
                                                        {"E=1,2", "both bounds"},
                                                        {"E=1,3,2", "low bound must be below"},
                                                        {"E=5,1,2", "start is outside"},
                                                        {"E=1+-0", "deviation must be above 0"},
                                                        {"E=1+-x", "finite number"}})
    expect_refused([&, text = text] { (void)parse_fitted_number("--fit", text); }, why);
  expect_refused([&] { (void)arm.robot({"materials.bdy.youngs_modulus"}); }, "bdy");
  expect_refused([&] { (void)arm.robot({"materials.body.youngs_modulos"}); }, "the scene has no such number");
  expect_refused([&] { (void)arm.robot({"actuators.t1.range"}); }, "it is no number");
  expect_refused([&] { (void)arm.robot({"base.x", "base.x"}); }, "given twice");
  expect_refused([&] { (void)arm.robot({"base.q"}); }, "base");
  MeasuredPoses none = arm.poses(truth);
  none.values.setConstant(std::nan(""));
  expect_refused([&] { (void)fit_robot(arm.robot(requested), none, {}); }, "no reading");
}

TEST(MeasuredPoses, AreReadWithGaps) {
  const Arm arm(std::string(arm_scene) + "sensors: [{name: imu, kind: direction, region: x_high, axis: [1, 0, 0]}]\n");
  const Model model = arm.robot({}).model(Eigen::VectorXd(0));
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    std::ofstream(folder / "poses.csv") << text;
    return read_measured_poses(folder / "poses.csv", model);
  };
  const MeasuredPoses poses = read("t1_N,tip_x_mm,half_z_mm\n0.1,61,5\n0.2,,4.5\n");
  ASSERT_EQ(poses.commands.size(), 2u);
  EXPECT_EQ(poses.commands[1][0], 0.2);
  EXPECT_EQ(poses.commands[1][1], 0);
  EXPECT_TRUE(std::isnan(poses.values(1, 0)));
  EXPECT_EQ(poses.values(1, 1), 4.5);
  EXPECT_EQ(poses.columns[1].marker, 1);
  EXPECT_EQ(poses.columns[1].axis, 2);
  const PoseColumn direction = read("t1,imu_direction_y\n0,0.3\n").columns[0];
  EXPECT_EQ(direction.kind, Reading::direction);
  EXPECT_EQ(direction.axis, 1);
  EXPECT_EQ(direction.sensor, 0);
  for (const auto& [text, why] :
       std::vector<std::pair<std::string, std::string>>{{"t1,tap_x_mm\n0,1\n", "no marker 'tap'"},
                                                        {"t1,tip_x\n0,1\n", "tip_x"},
                                                        {"t1,tip_x_mm\n,1\n", "a command is missing"},
                                                        {"t1\n0\n", "no column is a reading"},
                                                        {"t1,tip_x_mm\n0,\n", "every reading is missing"},
                                                        {"t1,t1_tension_N\n0,1\n", "commanded by that"}})
    try {
      (void)read(text);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
}

}  // namespace softkin::calibration
