#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <softkin/calibration/path_comparison.hpp>
#include <softkin/core/error.hpp>

namespace softkin {
namespace {

/// A helix, a second a step.
Track helix(int count, double end = 20) {
  Track track{"helix.csv", {}, {true, true, true}, {}};
  for (int i = 0; i < count; ++i) {
    const double t = end * i / (count - 1);
    track.points.emplace_back(30 * std::cos(0.3 * t), 30 * std::sin(0.3 * t), 2 * t);
    track.parameter.push_back(t);
  }
  return track;
}

Track moved(Track track, const Mat3& rotation, const Vec3& translation) {
  for (Vec3& point : track.points) point = rotation * point + translation;
  return track;
}

Mat3 turn(double angle, const Vec3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

TEST(PathComparison, ErrorsAreDistancesWithMaximumMeanAndRms) {
  Track reference{"a", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {true, true, true}, {}}, other = reference;
  other.points[1] += Vec3(0, 3, 4);
  other.points[2] += Vec3(0, 0, -1);
  const calibration::PathComparison found =
      calibration::compare_paths(reference, other, calibration::Resampling::waypoint, false);
  EXPECT_DOUBLE_EQ(found.largest_mm, 5);
  EXPECT_EQ(found.worst, 1U);
  EXPECT_DOUBLE_EQ(found.mean_mm, 2);
  EXPECT_NEAR(found.rms_mm, std::sqrt(26.0 / 3), 1e-12);
}

TEST(PathComparison, AlignmentRecoversARigidMotionAndNoReflection) {
  const Track reference = helix(40);
  const Mat3 rotation = turn(2.1, {1, -2, 0.5});
  const Track other = moved(reference, rotation.transpose(), {7, -30, 11});
  const calibration::PathComparison found =
      calibration::compare_paths(reference, other, calibration::Resampling::parameter, true);
  EXPECT_LT(found.largest_mm, 1e-9);
  EXPECT_LT((found.rotation - rotation).norm(), 1e-9);
  EXPECT_TRUE(found.unique);
  EXPECT_GT(calibration::compare_paths(reference, other, calibration::Resampling::parameter, false).mean_mm, 10);
  Mat3 mirror = Mat3::Identity();
  mirror(2, 2) = -1;
  const calibration::PathComparison mirrored = calibration::compare_paths(
      reference, moved(reference, mirror, {0, 0, 0}), calibration::Resampling::parameter, true);
  EXPECT_NEAR(mirrored.rotation.determinant(), 1, 1e-12);
  EXPECT_GT(mirrored.rms_mm, 1);
}

TEST(PathComparison, AlignmentIsTheBestOfManyRotations) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Track reference = helix(25);
  Track other = moved(reference, turn(0.7, {0, 1, 1}), {3, 2, 1});
  for (Vec3& point : other.points) point += Vec3(normal(random), normal(random), normal(random));
  const double best = calibration::compare_paths(reference, other, calibration::Resampling::waypoint, true).rms_mm;
  const calibration::PathComparison found =
      calibration::compare_paths(reference, other, calibration::Resampling::waypoint, true);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 axis(normal(random), normal(random), normal(random));
    const Mat3 near = turn(0.02 * normal(random), axis) * found.rotation;
    const Vec3 shift = found.translation + 0.1 * Vec3(normal(random), normal(random), normal(random));
    EXPECT_GE(calibration::compare_paths(reference, moved(other, near, shift), calibration::Resampling::waypoint, false)
                  .rms_mm,
              best - 1e-12);
  }
}

TEST(PathComparison, AFlatTrackIsComparedAndAlignedInItsPlane) {
  const Track reference = helix(30);
  Track camera = reference;  // sees x and z, turned by 10 degrees and moved
  camera.axes = {true, false, true};
  const double c = std::cos(0.17), s = std::sin(0.17);
  for (Vec3& point : camera.points) point = {c * point.x() - s * point.z() + 5, 99, s * point.x() + c * point.z() - 8};
  const calibration::PathComparison found =
      calibration::compare_paths(reference, camera, calibration::Resampling::parameter, true);
  EXPECT_LT(found.largest_mm, 1e-9);
  EXPECT_FALSE(found.axes[1]);
  EXPECT_NEAR(found.rotation(1, 1), 1, 1e-12);
  EXPECT_NEAR(found.rotation.determinant(), 1, 1e-12);
  camera.points = reference.points;
  for (Vec3& point : camera.points) point.x() *= -1;  // a mirror image is not turned into the original
  EXPECT_GT(calibration::compare_paths(reference, camera, calibration::Resampling::parameter, true).rms_mm, 1);
}

TEST(PathComparison, ByTimeTheOtherTrackIsInterpolatedAndTheRestLeftOut) {
  const Track reference = helix(11);
  Track dense = helix(2001, 15);
  const calibration::PathComparison found =
      calibration::compare_paths(reference, dense, calibration::Resampling::parameter, false);
  EXPECT_EQ(found.waypoints.size(), 8U);  // 0, 2, ... 14 s
  EXPECT_EQ(found.left_out, 3U);
  EXPECT_LT(found.largest_mm, 1e-3);
  for (double& time : dense.parameter) time += 100;
  EXPECT_THROW((void)calibration::compare_paths(reference, dense, calibration::Resampling::parameter, false),
               InvalidInput);
}

TEST(PathComparison, ByArcTheSpeedDoesNotMatter) {
  const Track reference = helix(401);
  Track other{"slow.csv", {}, {true, true, true}, {}};
  for (int i = 0; i <= 900; ++i) {
    const double t = 20 * std::pow(i / 900.0, 2);
    other.points.emplace_back(30 * std::cos(0.3 * t), 30 * std::sin(0.3 * t), 2 * t);
  }
  EXPECT_EQ(calibration::natural_resampling(reference, other), calibration::Resampling::arc);
  EXPECT_LT(calibration::compare_paths(reference, other, calibration::Resampling::arc, false).largest_mm, 0.02);
  EXPECT_THROW((void)calibration::compare_paths(reference, other, calibration::Resampling::waypoint, false),
               InvalidInput);
  EXPECT_THROW((void)calibration::compare_paths(reference, other, calibration::Resampling::parameter, false),
               InvalidInput);
  other.points.assign(5, Vec3(1, 1, 1));
  EXPECT_THROW((void)calibration::compare_paths(reference, other, calibration::Resampling::arc, false), InvalidInput);
}

TEST(PathComparison, ALineLeavesTheRotationOpenAndSaysSo) {
  Track reference{"line", {}, {true, true, true}, {}};
  for (int i = 0; i < 6; ++i) reference.points.emplace_back(i, 2 * i, -i);
  const Track other = moved(reference, turn(1, {0, 0, 1}), {1, 1, 1});
  const calibration::PathComparison found =
      calibration::compare_paths(reference, other, calibration::Resampling::waypoint, true);
  EXPECT_LT(found.largest_mm, 1e-9);
  EXPECT_FALSE(found.unique);
}

TEST(Superposition, IsExactForALinearRobotAndInterpolatesBetween) {
  const Vec3 start(0, 0, 100), a(1, 2, 3), b(-4, 0, 1);
  std::vector<calibration::SingleSweep> sweeps(2);
  for (std::size_t s = 0; s < 2; ++s) {
    sweeps[s].name = s == 0 ? "a.json" : "b.json";
    for (const double command : {1.0, 1.25, 1.6}) {
      sweeps[s].commands.push_back(command);
      sweeps[s].points.emplace_back(start + (command - 1) * (s == 0 ? a : b));
    }
  }
  EXPECT_LT((calibration::superposed(sweeps, {1.4, 1.1}) - (start + 0.4 * a + 0.1 * b)).norm(), 1e-12);
  EXPECT_LT((calibration::superposed(sweeps, {1, 1}) - start).norm(), 1e-12);
  EXPECT_THROW((void)calibration::superposed(sweeps, {1.7, 1}), InvalidInput);
  sweeps[1].points[0] += Vec3(1, 0, 0);
  EXPECT_THROW((void)calibration::superposed(sweeps, {1, 1}), InvalidInput);
}

}  // namespace
}  // namespace softkin
