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

/// All of the robot turned about an axis through shape after shape.
std::vector<double> continued_turns(const Model& model, const Vec3& axis, const std::vector<double>& angles) {
  std::vector<double> turns, last(model.markers.size(), 0);
  Points before = model.rest;
  for (const double angle : angles) {
    const Points moved = model.rest * Eigen::AngleAxisd(angle * degree, axis).toRotationMatrix().transpose();
    last = continued_marker_turns(model, moved, last, before);
    before = moved;
    turns.push_back(last[0]);
  }
  return turns;
}

TEST(Turns, AFaceTurnsBeyondHalfATurnAndBackAndBelowZero) {
  const Model model = testing::bending_model();
  const std::vector<double> angles{5, 90, 172, 186, 226, 278, 370, 300, 200, 170, 20, 3, -4, -60, -190, -30};
  for (const Vec3& axis : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(1, 2, -0.5)}) {
    const std::vector<double> turns = continued_turns(model, axis.normalized(), angles);
    for (std::size_t i = 0; i < angles.size(); ++i) EXPECT_NEAR(turns[i], angles[i], 1e-4) << "step " << i;
  }
}

/// By the line and by the face alike, as both turn with the whole robot.
TEST(Turns, LinesBetweenAllMarkersTurnAsEachByItself) {
  const Model model = testing::bending_model();
  LineTurns all(model);
  const MarkerLine line{0, 1};
  TurnMeter one(line.at_rest(model));
  for (const double angle : {30.0, 120.0, 200.0, 310.0, 150.0}) {
    const Mat3 rotation = Eigen::AngleAxisd(angle * degree, Vec3(1, 0, 0)).toRotationMatrix();
    std::vector<Vec3> markers;
    for (const Marker& marker : model.markers) markers.emplace_back(rotation * marker.at(model.rest));
    const std::vector<double> turns = all.next(markers);
    ASSERT_EQ(turns.size(), 1u);
    EXPECT_EQ(turns.at(LineTurns::number(line)), one.next(line.in(markers)));
    EXPECT_EQ(LineTurns::number({1, 0}), LineTurns::number(line));
    EXPECT_NEAR(turns[0], angle, 1e-9);
  }
  EXPECT_TRUE(std::isnan(all.next({Vec3::Zero(), Vec3::Constant(std::nan(""))})[0]));
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
