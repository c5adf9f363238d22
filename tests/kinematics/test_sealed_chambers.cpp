#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map_build.hpp>

#include "statics/physical_samples.hpp"

/// What is sealed in chambers as what inverse kinematics chooses and maps take.

namespace softkin {

namespace {

using namespace testing;

/// A finger on a syringe of 3 mL.
RobotSpec finger_on_a_syringe() {
  RobotSpec spec = bending_finger();
  spec.materials[0].elastic->youngs_modulus = 0.3;
  ActuatorSpec& air = spec.actuators[0];
  air.control = Control::filling;
  air.as<PneumaticSpec>()->filling = FillingSpec{};
  air.as<PneumaticSpec>()->filling->syringe_mL = 3;
  air.as<PneumaticSpec>()->filling->dead_mL = 0.2;
  air.low = 0;
  air.high = 2.5;
  return spec;
}

}  // namespace

TEST(SealedKinematics, InverseKinematicsFindsWhatIsPushed) {
  const Model model = compile(finger_on_a_syringe());
  const Statics statics(model);
  const Vec3 target = marker_at(model, solve_converged(statics, values({1.7})));
  const InverseResult result = solve_inverse(statics, {{PositionGoal{0, target}}}, statics.rest());
  EXPECT_EQ(result.status, InverseStatus::reached) << result.remark;
  EXPECT_NEAR(result.equilibrium.actuation[0], 1.7, 0.05);
  EXPECT_LT((marker_at(model, result.equilibrium) - target).norm(), 0.05);
}

/// In mL to places, the pressure and the volume.
TEST(SealedKinematics, AMapTellsPressureAndVolume) {
  const Model model = compile(finger_on_a_syringe());
  MapOptions options;
  options.accuracy_mm = 1e-3;
  options.checks = 5;
  const MapResult result = build_map(model, options).value();
  ASSERT_EQ(result.data.inputs.size(), 1u);
  EXPECT_EQ(result.data.inputs[0].unit, "mL");
  ASSERT_EQ(result.data.outputs.size(), 5u);
  EXPECT_EQ(result.data.outputs[3].name, "chamber_pressure");
  EXPECT_EQ(result.data.outputs[4].name, "chamber_ratio");
  const KinematicMap map(result.data);
  const Statics statics(model);
  const Equilibrium there = solve_converged(statics, values({1.234}));
  const double command = 1.234;
  Eigen::VectorXd found(5);
  ASSERT_TRUE(map.evaluate(&command, found.data()));
  EXPECT_LT((found.head<3>() - marker_at(model, there)).norm(), 2e-3);
  EXPECT_NEAR(found[3], there.state.multipliers[0], 1e-3 * there.state.multipliers[0]);
  EXPECT_NEAR(found[4], achieved_ratio(model, model.actuators[0], there.state.positions), 1e-4);
}

}  // namespace softkin
