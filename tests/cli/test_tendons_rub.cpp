#include <cmath>
#include <nlohmann/json.hpp>

#include "fk_physical_samples.hpp"

/// Cables with friction, from scene to report.

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// The loaded block, whose tendon has a zigzag path and comes through a sheath.
std::string rubbing_scene(const std::string& keys = "friction: 0.4, sheath: {turns_degrees: 90, friction: 0.2}, ") {
  return replaced(loaded_scene(), "points: [[0, 6, 12], [20, 6, 12]]",
                  keys + "points: [[0, 6, 11], [7, 6, 9], [14, 6, 11], [20, 6, 11]]");
}

double tip_of(const json& step) {
  return step["markers"]["tip"][2];
}

TEST(TendonsRub, GoOnFromWhereTheyWere) {
  const BlockFolder folder(rubbing_scene());
  const std::string path = folder.write("path.csv", "tendon_N\n0\n2\n1.8\n");
  const std::string report = folder / "path.json", series = folder / "path.pvd";
  const ProgramResult followed = run_fk(folder.scene, {"--path", path, "--report", report, "-o", series});
  ASSERT_EQ(followed.exit_code, 0) << followed.errors;
  const json steps = json::parse(read_text(report))["steps"];
  const json& pulled = steps[1]["actuators"]["tendon"];
  // 0.2 pi / 2 in the sheath; 2 atan(2 / 7) and atan(2 / 7) before it deforms, by 0.4
  const double exponent = 0.1 * std::acos(-1) + 0.4 * 3 * std::atan(2.0 / 7);
  EXPECT_NEAR(pulled["end_tension_N"], 2 * std::exp(-exponent), 0.02);
  EXPECT_EQ(pulled["sticking"], 0.0);
  EXPECT_EQ(steps[2]["actuators"]["tendon"]["sticking"], 1.0);
  expect_words(followed.output,
               {"cable 'tendon' has friction: of 1.8 N at the motor ", " N are left at its far end; it sticks in 100"});
  EXPECT_LT(std::abs(tip_of(steps[2]) - tip_of(steps[1])), 0.1 * std::abs(tip_of(steps[1]) - tip_of(steps[0])));

  // from the written shape, and from the report with --resume
  const std::string bent = folder / "bent.vtu";
  ASSERT_EQ(run_fk(folder.scene, {"--set", "tendon=2", "-o", bent}).exit_code, 0);
  const json from_file = report_of(folder, {"--start", bent, "--set", "tendon=1.8"})["steps"][0];
  EXPECT_NEAR(tip_of(from_file), tip_of(steps[2]), 1e-5);
  const json from_rest = report_of(folder, {"--set", "tendon=1.8"})["steps"][0];
  EXPECT_GT(std::abs(tip_of(from_rest) - tip_of(steps[2])), 1e-3);
  folder.write("path.csv", "tendon_N\n0\n2\n1.8\n0.9\n");
  const ProgramResult resumed = run_fk(folder.scene, {"--path", path, "--report", report, "-o", series, "--resume"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  const json last = json::parse(read_text(report))["steps"][3];
  const std::string stuck = folder / "stuck.vtu";
  ASSERT_EQ(run_fk(folder.scene, {"--start", bent, "--set", "tendon=1.8", "-o", stuck}).exit_code, 0);
  EXPECT_NEAR(tip_of(report_of(folder, {"--start", stuck, "--set", "tendon=0.9"})["steps"][0]), tip_of(last), 1e-5);
}

TEST(TendonsRub, AreRefusedWithAReason) {
  const auto refused = [](const std::string& text, const std::vector<std::string>& options,
                          const std::string& message) {
    const BlockFolder folder(text);
    expect_refused(folder, options, message);
  };
  refused(rubbing_scene("friction: -0.1, "), {"--set", "air=0"}, "'friction' must be 0 or more, not -0.1");
  refused(rubbing_scene("sheath: {friction: 0.1}, "), {"--set", "air=0"}, "'turns_degrees'");
  refused(replaced(loaded_scene(), "region: chamber, ", "region: chamber, friction: 0.1, "), {"--set", "air=0"},
          "key 'friction' does not belong to kind 'pneumatic'");
  refused(replaced(physical_scene(), "points: [[0", "friction: 0.1, points: [[0"),
          {"--set", "air=1", "--formulation", "target-shape"},
          "takes no friction and no sheath: they belong to the physical formulation");
  const BlockFolder folder(rubbing_scene());
  const ProgramResult map = run_program({"map", folder.scene, "-o", folder / "block.skmap"});
  EXPECT_EQ(map.exit_code, 2);
  expect_words(map.errors, {"with friction shapes depend on the path"});
}

/// Poses that were taken one after another determine friction by their hysteresis.
TEST(TendonsRub, IsFittedToPosesInTheirOrder) {
  const BlockFolder folder(rubbing_scene("friction: 0.25, "));
  const std::string path = folder.write("path.csv", "tendon_N\n0\n2\n1.8\n1\n0.4\n1.2\n");
  const std::string report = folder / "made.json";
  ASSERT_EQ(run_fk(folder.scene, {"--path", path, "--report", report}).exit_code, 0);
  std::string text = "tendon_N,tip_x_mm,tip_z_mm\n";
  const json made = json::parse(read_text(report));
  for (const json& step : made["steps"])
    text += step["actuation"]["tendon"].dump() + "," + step["markers"]["tip"][0].dump() + "," +
            step["markers"]["tip"][2].dump() + "\n";
  const std::string poses = folder.write("poses.csv", text);
  const std::string start = folder.write("start.yaml", rubbing_scene("friction: 0.4, "));
  const auto fitted = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"calibrate", "robot", start, poses, "--fit", "actuators.tendon.friction=0.4,0,1",
                                   "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output);
  };
  const json ordered = fitted({"--ordered"});
  EXPECT_NEAR(ordered["numbers"][0]["value"].get<double>(), 0.25, 2e-3);
  EXPECT_LT(ordered["markers"]["rms_mm"].get<double>(), 1e-3);
  EXPECT_GT(fitted({})["markers"]["rms_mm"].get<double>(), 5 * ordered["markers"]["rms_mm"].get<double>());
}

}  // namespace
