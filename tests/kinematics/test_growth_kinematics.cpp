#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/model/growth.hpp>

#include "statics/physical_samples.hpp"

/// Growth as what inverse kinematics chooses and maps take.

namespace softkin {

namespace {

using namespace testing;

/// A bar of which the upper half expands where it is warm.
RobotSpec warm_bar() {
  RobotSpec spec = physical_robot(block_mesh({12, 2, 2}, {40, 4, 4}));
  spec.regions = {{"upper", Selector(Box{{-1, -1, 2}, {41, 5, 5}}), {}}};
  ActuatorSpec warm = actuator("warm", GrowthSpec{{{"upper", {}, false, TemperatureSpec{20, 2e-3, {}}}}}, 0, 100, true);
  warm.control = Control::load;
  warm.rest = 20;
  spec.actuators = {warm};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

}  // namespace

TEST(GrowthKinematics, InverseKinematicsFindsTheTemperature) {
  const Model model = compile(warm_bar());
  const Statics statics(model);
  const Vec3 target = marker_at(model, solve_converged(statics, values({71})));
  EXPECT_GT((target - Vec3(40, 2, 2)).norm(), 2);
  const InverseResult result = solve_inverse(statics, {{PositionGoal{0, target}}}, statics.rest());
  EXPECT_EQ(result.status, InverseStatus::reached) << result.remark;
  EXPECT_NEAR(result.equilibrium.actuation[0], 71, 0.5);
}

TEST(GrowthKinematics, AMapTakesDegrees) {
  const Model model = compile(warm_bar());
  MapOptions options;
  options.accuracy_mm = 1e-3;
  options.checks = 5;
  const MapResult result = build_map(model, options).value();
  ASSERT_EQ(result.data.inputs.size(), 1u);
  EXPECT_EQ(result.data.inputs[0].unit, "degC");
  ASSERT_EQ(result.data.outputs.size(), 3u);
  const Statics statics(model);
  const double command = 47.3;
  Eigen::VectorXd found(3);
  ASSERT_TRUE(KinematicMap(result.data).evaluate(&command, found.data()));
  EXPECT_LT((found - marker_at(model, solve_converged(statics, values({command})))).norm(), 2e-3);
}

}  // namespace softkin
