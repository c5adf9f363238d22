#include <gtest/gtest.h>

#include <softkin/core/error.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/map_robot.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

/// A thick ball whose pressure has a maximum, and a force on it that has none in its range.
RobotSpec ball_to_map(double max_kpa) {
  RobotSpec spec = hollow_ball(4, 40, 6);
  ActuatorSpec gas = by_load(air("hollow"), 0, max_kpa);
  gas.name = "gas";
  spec.actuators = {gas};
  spec.loads.forces.push_back(
      {"push", {Vec3(20, 0, 0), {}}, Vec3::Zero(), std::array<Vec3, 2>{Vec3(-0.02, 0, 0), Vec3(0.02, 0, 0)}});
  spec.markers.push_back({"side", {Vec3(20, 0, 0), {}}});
  return spec;
}

MapOptions few_checks() {
  MapOptions options;
  options.shape_accuracy_mm = 0;
  options.checks = 4;
  return options;
}

std::string refusal_of(const RobotSpec& spec) {
  Index solved = 0;
  try {
    (void)build_map(compile(spec), few_checks(), nullptr, [&](const MapProgress& at) {
      solved = std::max(solved, at.equilibria);
      return true;
    });
  } catch (const InvalidInput& error) {
    EXPECT_LE(solved, 30) << "it stops early";
    return error.what();
  }
  return "";
}

/// The largest pressure that a solve from rest reaches.
double largest_pressure(const RobotSpec& spec) {
  const Model model = compile(spec);
  const Statics statics(model);
  double low = 0, high = model.actuators[0].high;
  while (high - low > 0.01 * high) {
    Actuation actuation = model.rest_actuation();
    actuation[0] = 0.5 * (low + high);
    const bool exists = statics.solve(actuation, statics.rest()).report.status == Status::converged;
    (exists ? low : high) = actuation[0];
  }
  return low;
}

TEST(MapRanges, AnInputWhoseRangeIsFarTooLargeIsNamed) {
  const RobotSpec spec = ball_to_map(20000);
  const double largest = largest_pressure(spec);
  ASSERT_LT(largest, 10000);
  const std::string refusal = refusal_of(spec);
  ASSERT_NE(refusal.find("input 'gas'"), std::string::npos) << refusal;
  EXPECT_EQ(refusal.find("push"), std::string::npos) << refusal;
  double end = 0, low = -1, high = 0;
  ASSERT_EQ(std::sscanf(refusal.c_str() + refusal.find("end at "), "end at %lf kPa", &end), 1) << refusal;
  ASSERT_EQ(std::sscanf(refusal.c_str() + refusal.find('['), "[%lf, %lf]", &low, &high), 2) << refusal;
  EXPECT_NEAR(end, largest, 0.03 * largest);
  EXPECT_EQ(low, 0);
  EXPECT_GT(high, 0.7 * largest);
  EXPECT_LT(high, 0.85 * largest);
  const std::optional<MapResult> made = build_map(compile(ball_to_map(high)), few_checks());
  EXPECT_EQ(made->data.check.points, 4) << "the suggested range can be mapped";
}

}  // namespace
}  // namespace softkin
