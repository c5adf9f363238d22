#include <softkin/calibration/pressure_check.hpp>

#include "statics/reference_cases.hpp"

namespace softkin {
namespace {

using namespace testing;

/// The finger of the reference, its chamber driven by volume.
Model finger() {
  RobotSpec spec = reference_robot("finger_5k", false);
  spec.materials = {reference_material("body", ReferenceLaw::lin, 12, 0.4)};
  spec.fixed.push_back({{std::string("fixed"), {}}});
  ActuatorSpec air;
  air.name = "air";
  air.drive = PneumaticSpec{.region = "chamber"};
  air.low = 1;
  air.high = 2;
  spec.actuators.push_back(air);
  return compile(spec);
}

TEST(PressureCheck, PressuresOfAnotherProgramGiveAFactorOfOne) {
  const ReferenceTable table("finger_5k_c3d4_lin.csv");
  std::vector<double> ratios, measured, predicted;
  for (std::size_t row = 4; row < table.rows() && table.at(row, "alpha") < 1.3; row += 4) {
    ratios.push_back(table.at(row, "alpha"));
    measured.push_back(1000 * table.at(row, "pressure_MPa"));
  }
  ASSERT_GE(ratios.size(), 3U);
  for (const auto& pressure : calibration::predicted_pressures(finger(), 0, ratios, 1))
    predicted.push_back(pressure.value());
  const calibration::ModulusCheck check = calibration::check_modulus(measured, predicted);
  std::printf("factor %.5f, misfit %.4f %%\n", check.factor, 100 * check.misfit_after);
  EXPECT_NEAR(check.factor, 1, 1e-3);
  EXPECT_LT(check.misfit_after, 1e-3);
}

}  // namespace
}  // namespace softkin
