#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/runs/turns.hpp>

#include "small_runs.hpp"

namespace softkin::runs {
namespace {

constexpr double degree = std::numbers::pi / 180;

TEST(Turns, ALineTurnsBeyondHalfATurnAndBack) {
  TurnMeter meter(Vec3(2, 0, 0));
  for (const double angle : {0.0, 70.0, 130.0, 200.0, 300.0, 380.0, 250.0, 90.0})
    EXPECT_NEAR(meter.next(Vec3(5 * std::cos(angle * degree), 0, 5 * std::sin(angle * degree))), angle, 1e-9);
}

/// All of the robot turned about any axis and moved anywhere: every face has turned by that angle.
TEST(Turns, AFaceTurnsWithARigidMotion) {
  const Model model = testing::bending_model();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    const double angle = 90 * (1 + any(random));
    const Vec3 axis = Vec3(any(random), any(random), any(random)).normalized();
    const Vec3 shift = 50 * Vec3(any(random), any(random), any(random));
    const Mat3 rotation = Eigen::AngleAxisd(angle * degree, axis).toRotationMatrix();
    const Points moved = (model.rest * rotation.transpose()).rowwise() + shift.transpose();
    const std::vector<double> turns = marker_turns(model, moved);
    ASSERT_EQ(turns.size(), 2u);
    EXPECT_NEAR(turns[0], angle, 1e-5);
    EXPECT_TRUE(std::isnan(turns[1])) << "a point of an element has no orientation that users know";
  }
  EXPECT_EQ(oriented_markers(model), (std::vector<bool>{true, false}));
}

/// What a face that is stretched and sheared within its plane turns by is the angle of its plane's normal where it is
/// not turned within.
TEST(Turns, StretchingAFaceDoesNotTurnIt) {
  const Model model = testing::bending_model();
  Points stretched = model.rest;
  stretched.col(1) *= 1.4;
  stretched.col(2) *= 0.8;
  EXPECT_NEAR(marker_turns(model, stretched)[0], 0, 1e-5);
  const Mat3 rotation = Eigen::AngleAxisd(35 * degree, Vec3::UnitY()).toRotationMatrix();
  EXPECT_NEAR(marker_turns(model, stretched * rotation.transpose())[0], 35, 1e-5);
}

TEST(Turns, ALineIsOfTwoMarkersThatAreApart) {
  const Model model = testing::bending_model();
  EXPECT_FALSE(read_marker_line(model, {}).has_value());
  const MarkerLine line = read_marker_line(model, {"tip", "corner"}).value();
  EXPECT_EQ(line.from, 0);
  EXPECT_EQ(line.to, 1);
  EXPECT_LT((line.at_rest(model) - Vec3(0, 6, 6)).norm(), 1e-12);
  const auto refused = [&](const std::vector<std::string>& names, const std::string& why) {
    try {
      (void)read_marker_line(model, names);
      FAIL() << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  refused({"tip", "cornr"}, "--turn: there is no marker 'cornr'; did you mean 'corner'?");
  refused({"tip", "tip"}, "are at one place at rest");
}

}  // namespace
}  // namespace softkin::runs
