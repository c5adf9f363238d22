#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/walk.hpp>

#include "statics/magnetic_samples.hpp"

/// Fields as what inverse kinematics chooses, maps take and workspaces vary.

namespace softkin {

namespace {

using namespace testing;

/// A strip magnetised along itself in a field of two components, and a coil beside it.
RobotSpec steered_strip(bool coil) {
  RobotSpec spec = physical_robot(block_mesh({10, 2, 1}, {30, 4, 2}));
  spec.materials[0].elastic->youngs_modulus = 0.3;
  magnetise(spec, {120, 0, 0});
  add_field(spec, {"uniform", UniformField{}}, {FieldCommand::flux_density_y, FieldCommand::flux_density_z}, 6);
  if (coil)
    add_field(spec, {"coil", CoilField{{{Vec3(40, 2, 15), Vec3(0, 0, 1), 20, 50}}}}, {FieldCommand::current}, 1);
  spec.markers = {{"tip", {std::string("x_high"), {}}}};
  return spec;
}

}  // namespace

TEST(MagneticKinematics, InverseKinematicsFindsTheField) {
  const Model model = compile(steered_strip(true));
  const Statics statics(model);
  const Vec3 target = marker_at(model, solve_converged(statics, values({2, -4, 0.5})));
  const InverseResult result = solve_inverse(statics, {{PositionGoal{0, target}}}, statics.rest());
  EXPECT_EQ(result.status, InverseStatus::reached) << result.remark;
  EXPECT_LT((marker_at(model, result.equilibrium) - target).norm(), 0.05);
  for (Index a = 0; a < 3; ++a) EXPECT_LE(std::abs(result.equilibrium.actuation[a]), model.actuators[a].high);
}

TEST(MagneticKinematics, AMapTakesFieldsAsItsInputs) {
  const Model model = compile(steered_strip(false));
  MapOptions options;
  options.accuracy_mm = 1e-2;
  options.checks = 10;
  const MapResult result = build_map(model, options).value();
  ASSERT_EQ(result.data.inputs.size(), 2u);
  EXPECT_EQ(result.data.inputs[0].unit, "mT");
  EXPECT_EQ(result.data.outputs.size(), 3u);  // no load, no ratio
  const KinematicMap map(result.data);
  const Statics statics(model);
  const Eigen::Vector2d commands(3, -4.5);
  Eigen::VectorXd found(3);
  ASSERT_TRUE(map.evaluate(commands.data(), found.data()));
  EXPECT_LT((found - marker_at(model, solve_converged(statics, values({3, -4.5})))).norm(), 0.02);
}

/// A coil pulls along the direction of travel.
TEST(MagneticKinematics, WalksAreInUniformFields) {
  for (const bool coil : {false, true}) {
    RobotSpec spec = steered_strip(coil);
    spec.markers.push_back({"base", {std::string("x_low"), {}}});
    spec.feet = {{"base", 1, 1, {}}, {"tip", 1, 1, {}}};
    const Model model = compile(spec);
    if (coil)
      EXPECT_THROW(Walker(model, {}), InvalidInput);
    else
      EXPECT_NO_THROW(Walker(model, {}));
  }
}

}  // namespace softkin
