#include <gtest/gtest.h>

#include <cmath>

#include "fk_physical_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// The block, whose base rotates about z, by 30 degrees where the scene sets no other angle.
std::string turning_scene(bool physical) {
  return replaced(physical ? physical_scene() : block_scene(), "{region: base}",
                  "{region: base, rotation: {axis: [0, 0, 1], degrees: 30}}");
}

void expect_turned(const json& markers, double degrees) {
  const double angle = degrees * std::acos(-1.0) / 180;
  EXPECT_NEAR(markers["tip"][0].get<double>(), 20 * std::cos(angle), 1e-5) << degrees;
  EXPECT_NEAR(markers["tip"][1].get<double>(), 6 + 20 * std::sin(angle), 1e-5) << degrees;
}

TEST(TurnedSupportCommand, IsInDegreesOnTheTerminalInReportsAndAlongAPath) {
  for (const bool physical : {true, false}) {
    const BlockFolder folder(turning_scene(physical));
    const json report = report_of(folder, {});
    EXPECT_EQ(report["actuators"]["base_turn"],
              json::parse(R"({"kind": "turn", "control": "turn", "unit": "deg", "range": [-3600.0, 3600.0]})"));
    expect_turned(report["steps"][0]["markers"], 30);
    expect_turned(step_of(folder, {"--set", "base_turn=-45"})["markers"], -45);

    (void)folder.write("turn.csv", "base_turn_deg\n0\n120\n240\n360\n");
    const ProgramResult path =
        run_fk(folder.scene, {"--path", folder / "turn.csv", "--report", folder / "report.json"});
    EXPECT_EQ(path.exit_code, 0) << path.errors;
    EXPECT_NE(path.output.find("support 'base' turned by base_turn [deg]"), std::string::npos) << path.output;
    EXPECT_NE(path.output.find("base_turn [deg]"), std::string::npos) << path.output;
    const json steps = json::parse(read_text(folder / "report.json"))["steps"];
    ASSERT_EQ(steps.size(), 4u);
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(steps[i]["actuators"]["base_turn"]["requested"], 120.0 * i);
      expect_turned(steps[i]["markers"], 120.0 * i);
    }
  }
}

/// The actuators reach the target; the angle stays the one of the scene.
TEST(TurnedSupportCommand, IsGivenToInverseKinematics) {
  const BlockFolder folder(turning_scene(true));
  const json at = step_of(folder, {"--set", "air=1.2", "--set", "tendon=0.98"});
  const auto coordinate = [&](int axis) { return text(at["markers"]["tip"][axis].get<double>()); };
  const ProgramResult found = run_program(
      {"ik", folder.scene, "--target", "tip=" + coordinate(0) + "," + coordinate(1) + "," + coordinate(2), "--json"});
  EXPECT_EQ(found.exit_code, 0) << found.errors;
  const json step = json::parse(found.output)["steps"][0];
  EXPECT_EQ(step["actuators"]["base_turn"]["requested"], 30.0);
}

TEST(TurnedSupportCommand, IsRefusedOutsideItsRangeAndInAnotherUnit) {
  const BlockFolder folder(turning_scene(true));
  const ProgramResult far = run_fk(folder.scene, {"--set", "base_turn=4000"});
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_NE(far.errors.find("base_turn=4000': the turn is outside its range, -3600 to 3600 deg"), std::string::npos)
      << far.errors;
  (void)folder.write("turn.csv", "base_turn_rad\n1\n");
  const ProgramResult radians = run_fk(folder.scene, {"--path", folder / "turn.csv"});
  EXPECT_EQ(radians.exit_code, 2);
  EXPECT_NE(radians.errors.find("base_turn_rad"), std::string::npos) << radians.errors;
}

}  // namespace
