#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// The block by loads, its tendon's motor with a play of 2 N.
std::string playing_scene(const std::string& backlash = "2") {
  return replaced(loaded_scene(), "range: [0, 100]", "range: [0, 100], factor: 0.9, backlash: " + backlash);
}

json played_steps(const std::string& scene, const std::string& path, const std::string& report,
                  const std::vector<std::string>& more = {}) {
  std::vector<std::string> options{"--path", path, "--report", report};
  options.insert(options.end(), more.begin(), more.end());
  const ProgramResult made = run_fk(scene, options);
  EXPECT_EQ(made.exit_code, 0) << made.errors;
  return json::parse(read_text(report))["steps"];
}

const char* const motor_path = "tendon_N\n0\n5\n4\n1\n2\n3.5\n0\n";
const std::vector<double> acting_tensions{0, 5, 5, 3, 3, 3.5, 2};

/// A path of motor commands is, step by step, the path of the effective commands without backlash.
TEST(Backlash, APathOfTheMotorIsOneOfWhatActs) {
  const BlockFolder folder(playing_scene());
  const std::string exact = folder.write("exact.yaml", playing_scene("0"));
  std::string acting = "tendon_N\n";
  for (const double each : acting_tensions) acting += json(each).dump() + "\n";
  const json with = played_steps(folder.scene, folder.write("told.csv", motor_path), folder / "told.json"),
             without = played_steps(exact, folder.write("acts.csv", acting), folder / "acts.json");
  ASSERT_EQ(with.size(), acting_tensions.size());
  for (std::size_t i = 0; i < acting_tensions.size(); ++i) {
    EXPECT_EQ(with[i]["markers"], without[i]["markers"]) << i;
    EXPECT_NEAR(with[i]["actuators"]["tendon"]["tension_N"].get<double>(), 0.9 * acting_tensions[i], 1e-9);
    EXPECT_EQ(with[i]["shape_actuation"]["tendon"].get<double>(), acting_tensions[i]);
  }
  EXPECT_EQ(with[3]["actuation"]["tendon"], 1.0) << "what was requested";
  EXPECT_EQ(with[3]["actuators"]["tendon"]["requested"], 1.0);
}

/// The memory of a resumed run is in the path alone.
TEST(Backlash, IsRememberedByRunsThatGoOn) {
  const BlockFolder folder(playing_scene());
  const std::string report = folder / "part.json", shapes = folder / "part.pvd";
  const json all = played_steps(folder.scene, folder.write("whole.csv", motor_path), folder / "whole.json");
  const std::string path = folder.write("part.csv", "tendon_N\n0\n5\n4\n");
  EXPECT_EQ(played_steps(folder.scene, path, report, {"--output", shapes}).size(), 3u);
  folder.write("part.csv", motor_path);
  const json more = played_steps(folder.scene, path, report, {"--output", shapes, "--resume"});
  ASSERT_EQ(more.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(more[i]["shape_actuation"], all[i]["shape_actuation"]) << i;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(more[i]["markers"]["tip"][axis].get<double>(), all[i]["markers"]["tip"][axis].get<double>(), 1e-6);
  }
  const std::string other = folder.write("block.yaml", playing_scene("1"));
  const ProgramResult refused = run_fk(other, {"--path", path, "--report", report, "--output", shapes, "--resume"});
  EXPECT_EQ(refused.exit_code, 2);
  expect_words(refused.errors, {"part.json", "cannot go on"});
}

/// A shape in a file knows what acted.
TEST(Backlash, GoesOnFromAShape) {
  const BlockFolder folder(playing_scene());
  const json all = played_steps(folder.scene, folder.write("whole.csv", motor_path), folder / "whole.json",
                                {"--output", folder / "whole.pvd"});
  const std::string rest = folder.write("rest.csv", "tendon_N\n1\n2\n3.5\n0\n");
  const json more = played_steps(folder.scene, rest, folder / "rest.json", {"--start", folder / "whole_0002.vtu"});
  ASSERT_EQ(more.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(more[i]["shape_actuation"], all[i + 3]["shape_actuation"]) << i;
}

TEST(Backlash, IsRefusedWhereItIsNone) {
  expect_refused(BlockFolder(playing_scene("-1")), {}, "block.yaml:");
  expect_refused(BlockFolder(replaced(physical_scene(), "range: [0.5, 1.2]", "range: [0.5, 1.2], backlash: 1")), {},
                 "'backlash' belongs to 'control: tension' and 'control: pressure'");
}

}  // namespace
