#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <softkin/io/file.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/runs/map_file.hpp>

#include "fk_samples.hpp"
#include "start_program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;

/// A block with a chamber and a cable, in ranges where both have equilibria.
struct MapFolder : BlockFolder {
  std::string map = *this / "block.skmap";

  MapFolder()
      : BlockFolder(replaced(replaced(physical_scene(), "range: [0.5, 3]", "range: [1, 1.6]"), "range: [0.5, 1.2]",
                             "range: [0.85, 1.1]")) {}

  [[nodiscard]] std::vector<std::string> arguments(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"map", scene, "-o", map, "--check", "10", "--threads", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] ProgramResult run(const std::vector<std::string>& more = {}) const {
    return run_program(arguments(more));
  }
};

TEST(MapCommand, WritesAMapAndTellsItsErrors) {
  const MapFolder folder;
  const ProgramResult result = folder.run();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("checked at 10 points, largest errors: markers "), std::string::npos) << result.output;
  EXPECT_FALSE(fs::exists(folder.map + ".run"));
  const softkin::KinematicMap map(softkin::runs::read_map(folder.map));
  EXPECT_EQ(map.inputs(), 2);
  EXPECT_EQ(map.data().check.points, 10);
}

TEST(MapCommand, JsonTellsTheSame) {
  const MapFolder folder;
  const ProgramResult result = folder.run({"--json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const auto told = nlohmann::json::parse(result.output);
  const softkin::MapData data = softkin::runs::read_map(folder.map);
  EXPECT_EQ(told.at("equilibria"), data.equilibria);
  EXPECT_EQ(told.at("outputs").size(), data.outputs.size());
  EXPECT_EQ(told.at("outputs")[0].at("largest_error"), data.check.largest[0]);
}

TEST(MapCommand, GoesOnWhereItWasKilled) {
  const MapFolder folder;
  ASSERT_EQ(folder.run().exit_code, 0);
  const std::string whole = read_text(folder.map);
  fs::remove(folder.map);
  int kills = 0;
  for (int milliseconds = 4; !fs::exists(folder.map) && kills < 100; milliseconds += 2, ++kills) {
    const bool begun = fs::exists(folder.map + ".run");
    const std::vector<std::string> more = begun ? std::vector<std::string>{"--resume"} : std::vector<std::string>{};
    StartedProgram program(folder, folder.arguments(more));
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    program.send(SIGKILL);
    (void)program.wait();
  }
  EXPECT_GE(kills, 2);
  EXPECT_EQ(read_text(folder.map), whole);
}

TEST(MapCommand, RefusesWhatDoesNotFit) {
  const MapFolder folder;
  EXPECT_EQ(run_program({"map", folder.scene, "-o", folder / "map.csv"}).exit_code, 2);
  EXPECT_EQ(folder.run({"--accuracy", "0"}).exit_code, 2);
  softkin::write_file(folder.map + ".run", "something\n");
  const ProgramResult unfinished = folder.run();
  EXPECT_EQ(unfinished.exit_code, 2);
  EXPECT_NE(unfinished.errors.find("--resume"), std::string::npos) << unfinished.errors;
  const ProgramResult other = folder.run({"--resume"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_FALSE(fs::exists(folder.map));
}

}  // namespace
