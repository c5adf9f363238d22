#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/runs/map_file.hpp>

#include "map_samples.hpp"
#include "start_program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;

struct MapFolder : BlockFolder {
  std::string map = *this / "block.skmap";

  MapFolder() : BlockFolder(scene_to_map()) {}

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
  const auto reported = nlohmann::json::parse(result.output);
  const softkin::MapData data = softkin::runs::read_map(folder.map);
  EXPECT_EQ(reported.at("equilibria"), data.equilibria);
  EXPECT_EQ(reported.at("outputs").size(), data.outputs.size());
  EXPECT_EQ(reported.at("outputs")[0].at("largest_error"), data.check.largest[0]);
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

/// The block with a map of it.
struct MappedFolder : MapFolder {
  MappedFolder() { EXPECT_EQ(run().exit_code, 0); }

  [[nodiscard]] static nlohmann::json report_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--json", "--threads", "1"});
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return nlohmann::json::parse(result.output);
  }
  /// One line on standard error, exit code 2.
  static void refused(const std::vector<std::string>& arguments, const std::string& message) {
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    expect_words(result.errors, {message});
  }
};

double distance(const nlohmann::json& a, const nlohmann::json& b) {
  double squares = 0;
  for (std::size_t i = 0; i < 3; ++i) squares += std::pow(a.at(i).get<double>() - b.at(i).get<double>(), 2);
  return std::sqrt(squares);
}

TEST(MapUse, AnswersTellTheMapAndNoFiguresOfASolver) {
  const MappedFolder folder;
  const ProgramResult reported =
      run_program({"fk", folder.scene, "--set", "air=1.3", "--set", "tendon=0.9", "--map", folder.map});
  EXPECT_EQ(reported.exit_code, 0) << reported.errors;
  expect_words(reported.output, {"physical formulation (neo-hookean)\n", "\nanswered by the map " + folder.map + ": ",
                                 "; checked at 10 points, largest errors: markers "});
  for (const char* of_solver : {"solver newton", "last step", "out of balance", "diverged"})
    EXPECT_EQ(reported.output.find(of_solver), std::string::npos) << reported.output;
  const std::vector<std::string> requested{"fk", folder.scene, "--set", "air=1.3", "--set", "tendon=0.9"};
  std::vector<std::string> by_map = requested;
  by_map.insert(by_map.end(), {"--map", folder.map});
  const auto answered = MappedFolder::report_of(by_map), solved = MappedFolder::report_of(requested);
  const softkin::MapData data = softkin::runs::read_map(folder.map);
  const auto& solver = answered.at("solver");
  EXPECT_EQ(solver.at("name"), "map");
  EXPECT_EQ(solver.at("map").at("file"), folder.map);
  EXPECT_EQ(solver.at("map").at("equilibria"), data.equilibria);
  EXPECT_EQ(solver.at("map").at("largest_error").at("tip_x_mm"), data.check.largest[0]);
  const auto &here = answered.at("steps").at(0), &there = solved.at("steps").at(0);
  for (const char* key :
       {"step_mm", "residual", "tolerance_mm", "estimated_error_mm", "residual_N", "pull_N", "energy"}) {
    EXPECT_TRUE(here.at(key).is_null()) << key;
    EXPECT_TRUE(there.at(key).is_number()) << key;
  }
  EXPECT_LT(distance(here.at("markers").at("tip"), there.at("markers").at("tip")), 0.05);
  EXPECT_EQ(here.at("actuators").at("air").at("achieved"), 1.3);  // exactly, as by the solver
}

TEST(MapUse, InverseKinematicsIsPolishedWithFewEquilibria) {
  const MappedFolder folder;
  const std::vector<std::string> there{"fk", folder.scene, "--set", "air=1.4", "--set", "tendon=0.9"};
  const auto target = MappedFolder::report_of(there).at("steps").at(0).at("markers").at("tip");
  std::vector<std::string> ik{"ik", folder.scene, "--target",
                              "tip=" + softkin::exact(target.at(0)) + ",," + softkin::exact(target.at(2))};
  const auto alone = MappedFolder::report_of(ik);
  ik.insert(ik.end(), {"--map", folder.map});
  const auto by_map = MappedFolder::report_of(ik);
  ik.emplace_back("--polish");
  const auto polished = MappedFolder::report_of(ik);
  EXPECT_LE(polished.at("ik").at("equilibria"), 3);
  EXPECT_GT(alone.at("ik").at("equilibria"), 3);
  EXPECT_LE(polished.at("ik").at("error_mm"), 1e-3);
  EXPECT_EQ(polished.at("solver").at("name"), "newton");
  EXPECT_EQ(polished.at("solver").at("begun_from_map").at("file"), folder.map);
  EXPECT_TRUE(polished.at("steps").at(0).at("residual_N").is_number());
  EXPECT_EQ(by_map.at("solver").at("name"), "map");
  for (const char* actuator : {"air", "tendon"}) {
    const auto command = [&](const nlohmann::json& report) {
      return report.at("steps").at(0).at("actuation").at(actuator).get<double>();
    };
    EXPECT_NEAR(command(polished), command(alone), 1e-3) << actuator;
    EXPECT_NEAR(command(by_map), command(alone), 0.01) << actuator;
  }
  EXPECT_LT(
      distance(polished.at("steps").at(0).at("markers").at("tip"), alone.at("steps").at(0).at("markers").at("tip")),
      2e-3);
}

TEST(MapUse, OutsideTheMapOnlyTheSolverHasAnswers) {
  const MappedFolder folder;
  cut_map(folder.map, 1.1, false);  // without the rest
  const ProgramResult fk = run_program({"fk", folder.scene, "--map", folder.map});
  EXPECT_EQ(fk.exit_code, 1);
  EXPECT_EQ(fk.errors, "softkin: limit: the actuation is outside the map; the shape is the last one\n");
  std::vector<std::string> ik{"ik", folder.scene, "--target", "tip=20.4,,6", "--threads", "1"};
  const ProgramResult alone = run_program(ik);
  EXPECT_EQ(alone.exit_code, 0) << alone.errors;
  ik.insert(ik.end(), {"--map", folder.map});
  const ProgramResult by_map = run_program(ik);
  EXPECT_EQ(by_map.exit_code, 1);
  EXPECT_EQ(by_map.errors, "softkin: the start has no equilibrium: the actuation is outside the map\n");
  ik.emplace_back("--polish");
  const ProgramResult polished = run_program(ik);
  EXPECT_EQ(polished.exit_code, 0) << polished.errors;
}

TEST(MapUse, FollowsPathsAndTellsSo) {
  const MappedFolder folder;
  const std::string path = folder.write("path.csv", "x_mm,z_mm\n20.5,6\n20.6,5.9\n");
  const auto follow = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"follow", folder.scene, path, "--marker", "tip", "-o", folder / "out"};
    all.insert(all.end(), more.begin(), more.end());
    return run_program(all);
  };
  const ProgramResult reported = follow({"--map", folder.map});
  expect_words(reported.output, {"answered by the map " + folder.map + ": "});
  EXPECT_EQ(reported.output.find("solver newton"), std::string::npos) << reported.output;
  const auto report = nlohmann::json::parse(read_text(folder / "out/report.json"));
  EXPECT_EQ(report.at("solver").at("map").at("file"), folder.map);
  const ProgramResult other = follow({"--resume"});  // it would mix answers of two kinds
  EXPECT_EQ(other.exit_code, 2);
  expect_words(other.errors, {"it was made with other solver options"});
}

TEST(MapUse, RefusesWhatAMapCannotTell) {
  const MappedFolder folder;
  const std::vector<std::string> fk{"fk", folder.scene, "--map", folder.map};
  const auto with = [](std::vector<std::string> all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  MappedFolder::refused({"fk", folder.scene, "--polish"}, "it needs --map F.skmap");
  MappedFolder::refused(with(fk, {"--solver-tolerance", "1e-3"}), "needs --polish");
  MappedFolder::refused(with(fk, {"--force", "payload=0,0,-1"}), "is not of this robot");
  const std::string plain = folder / "plain.skmap";
  ASSERT_EQ(run_program({"map", folder.scene, "-o", plain, "--check", "1", "--shape-accuracy", "0"}).exit_code, 0);
  MappedFolder::refused({"fk", folder.scene, "--map", plain}, "without the robot's shape");
}

TEST(MapCommand, RefusesWhatDoesNotFit) {
  const MapFolder folder;
  EXPECT_EQ(run_program({"map", folder.scene, "-o", folder / "map.csv"}).exit_code, 2);
  EXPECT_EQ(folder.run({"--accuracy", "0"}).exit_code, 2);
  softkin::write_file(folder.map + ".run", "softkin map journal of another run\n");
  const ProgramResult unfinished = folder.run();
  EXPECT_EQ(unfinished.exit_code, 2);
  EXPECT_NE(unfinished.errors.find("--resume"), std::string::npos) << unfinished.errors;
  const ProgramResult other = folder.run({"--resume"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_FALSE(fs::exists(folder.map));
}

}  // namespace
