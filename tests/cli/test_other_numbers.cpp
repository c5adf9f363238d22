#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

// --material, --change, and messages about numbers in other units.

namespace {

using namespace softkin::testing;
using nlohmann::json;

const std::string low_loads = replaced(loaded_scene(), "range: [-100, 3000]", "range: [0, 200]");

/// The report is that of a scene with the numbers in it, except for the changes and times that it contains.
TEST(OtherNumbers, AreThoseOfASceneThatHasThem) {
  const BlockFolder folder(physical_scene());
  const std::string other = folder.write(
      "other.yaml",
      replaced(replaced(physical_scene(), "youngs_modulus: 1", "youngs_modulus: 0.8"), "[0.5, 3]", "[0.5, 2]"));
  const std::vector<std::string> set{"--set", "air=1.2", "--json"};
  std::vector<std::string> changed = set;
  changed.insert(changed.end(), {"--material", "all.youngs_modulus = 0.8", "--change", "actuators.air.range.2=2"});
  const ProgramResult by_option = run_fk(folder.scene, changed), by_scene = run_fk(other, set);
  ASSERT_EQ(by_option.exit_code, 0) << by_option.errors;
  ASSERT_EQ(by_scene.exit_code, 0) << by_scene.errors;
  json found = json::parse(by_option.output), expected = json::parse(by_scene.output);
  EXPECT_EQ(found.at("robot_fingerprint"), expected.at("robot_fingerprint"));
  EXPECT_EQ(found["steps"][0]["markers"], expected["steps"][0]["markers"]);
  EXPECT_EQ(found["steps"][0]["actuators"], expected["steps"][0]["actuators"]);
  const json notes = found.at("notes");
  EXPECT_NE(std::find(notes.begin(), notes.end(), "Changed in the scene: --material all.youngs_modulus = 0.8"),
            notes.end())
      << notes;
  const json as_it_is = json::parse(run_fk(folder.scene, set).output);
  EXPECT_NE(found["steps"][0]["actuators"]["air"]["pressure_kPa"],
            as_it_is["steps"][0]["actuators"]["air"]["pressure_kPa"]);
}

TEST(OtherNumbers, OfEveryCommandThatSolves) {
  for (const char* command : {"fk", "ik", "follow", "walk", "grasp", "map", "workspace", "view"}) {
    const ProgramResult help = run_program({command, "--help"});
    expect_words(help.output, {"--material R.K=V", "--change PATH=V"});
  }
}

TEST(OtherNumbers, WrongNamesAreRefusedWithTheNearest) {
  const BlockFolder folder(physical_scene());
  expect_refused(folder, {"--material", "al.youngs_modulus=1"}, "did you mean 'all'?");
  expect_refused(folder, {"--material", "all.youngs_moduls=1"}, "did you mean 'youngs_modulus'?");
  expect_refused(folder, {"--material", "all.youngs_modulus=0"}, "must be greater than 0, not 0");
  expect_refused(folder, {"--change", "actuators.ar.range.2=9"}, "did you mean 'air'?");
}

TEST(OtherNumbers, BlanksInSettingsArePassedOver) {
  const BlockFolder folder(low_loads);
  const auto air = [&](const std::string& setting) {
    const ProgramResult result = run_fk(folder.scene, {"--set", setting, "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output)["steps"][0]["actuators"]["air"]["requested"].get<double>();
  };
  for (const char* setting : {"air=5", "air = 5", " air =5kPa ", "air= 5 kPa"}) EXPECT_EQ(air(setting), 5) << setting;
}

TEST(OtherNumbers, OtherUnitsAreConverted) {
  const BlockFolder folder(low_loads);
  expect_refused(folder, {"--set", "air=0.5bar"}, "0.5bar is 50kPa");
  expect_refused(folder, {"--set", "air=50000Pa"}, "50000Pa is 50kPa");
  expect_refused(folder, {"--set", "air=10 psi"}, "10 psi is 68.9476kPa");
  expect_refused(folder, {"--set", "tendon=300mN"}, "300mN is 0.3N");
  expect_refused(folder, {"--set", "air=50000"}, "is it in Pa? That would be 50kPa");
  const BlockFolder volumes(physical_scene());
  for (const char* pressure : {"air=50kPa", "air=0.5bar", "air=5e4Pa"})
    expect_refused(volumes, {"--set", pressure},
                   "'air' is commanded by its volume: a pressure needs a curve in the scene");
}

TEST(OtherNumbers, RangesOfPressureInPascalAreDoubted) {
  const BlockFolder folder(replaced(low_loads, "[0, 200]", "[0, 60000]"));
  const ProgramResult result = run_fk(folder.scene, {});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  expect_words(result.output, {"warning: The range of chamber 'air' goes to 60000 kPa",
                               "taken as Pa it would be 60 kPa", "1 bar is 100 kPa"});
  const BlockFolder usual(low_loads);
  EXPECT_EQ(run_fk(usual.scene, {}).output.find("The range of chamber"), std::string::npos);
}

TEST(OtherNumbers, SurfacesAreNoMeshes) {
  const BlockFolder folder(replaced(physical_scene(), "block.msh", "block.stl"));
  expect_refused(folder, {}, "block.stl: a .stl is a surface, and a robot's mesh has elements inside");
  const BlockFolder model(replaced(physical_scene(), "block.msh", "block.STEP"));
  expect_refused(model, {}, "python -m softkin mesh generate --body F");
}

TEST(OtherNumbers, AHalfspaceThatIsTurnedRoundIsSaidToBe) {
  const std::string floor =
      "contact: {distance: 0.05}\nobstacles: [{name: floor, halfspace: {point: [0, 0, -1], normal: ";
  const BlockFolder folder(physical_scene(floor + "[0, 0, -1]}}]\n")), right(physical_scene(floor + "[0, 0, 1]}}]\n"));
  expect_refused(folder, {}, "lies behind it at rest: its normal points out of the solid");
  expect_refused(folder, {}, "'normal: [0, 0, 1]'");
  EXPECT_EQ(run_fk(right.scene, {}).exit_code, 0);
}

}  // namespace
