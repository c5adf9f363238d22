#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// The block, its loads commanded, that is pushed at its tip.
std::string pushed_scene() {
  const std::string forces = "forces: [{name: payload, region: tip, force: [0, 0, 0]}", end = "]\n";
  return replaced(loaded_scene(), forces + end,
                  forces + ", {name: push, region: tip, range: [[0, 0], [-0.2, 0.2], [-0.2, 0.2]]}" + end) +
         "sensors: [{name: strain, kind: length, points: [[1, 6, 1], [19, 6, 1]]}]\n";
}

/// Readings of three poses, made up by fk.
struct PushedBlock : BlockFolder {
  explicit PushedBlock(const std::string& text_of_scene = pushed_scene()) : BlockFolder(text_of_scene) {
    const std::string path = write("path.csv", "air_kPa,push_fy_N,push_fz_N\n0,0,0.02\n50,0.03,-0.05\n100,-0.1,0\n");
    const ProgramResult made = run_fk(scene, {"--path", path, "--report", *this / "made.json"});
    EXPECT_EQ(made.exit_code, 0) << made.errors;
    const json report = json::parse(read_text(*this / "made.json"));
    std::string text = "t_s,air_kPa,tip_x_mm,tip_y_mm,tip_z_mm,corner_x_mm,corner_y_mm,corner_z_mm\n";
    int row = 0;
    for (const json& step : report["steps"]) {
      text += std::to_string(row++) + "," + step["actuation"]["air"].dump();
      for (const char* marker : {"tip", "corner"})
        for (const json& coordinate : step["markers"][marker]) text += "," + coordinate.dump();
      text += "\n";
    }
    readings = write("readings.csv", text);
  }

  [[nodiscard]] ProgramResult estimate(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"estimate", scene, readings, "--threads", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  std::string readings;
};

TEST(EstimateCommand, TellsThePushOfEveryRow) {
  const PushedBlock folder;
  const std::string report = folder / "told.json", table = folder / "told.csv";
  const std::vector<std::string> requested{"--unknown", "push", "--deviation", "0.001",
                                           "--report",  report, "--table",     table};
  const ProgramResult reported = folder.estimate(requested);
  ASSERT_EQ(reported.exit_code, 0) << reported.errors << reported.output;
  expect_words(reported.output,
               {"line 2, 0 s: push_fy ", " N; push_fz 0.02", "3 of 3 rows fit the model", "chi-square"});
  const json found = json::parse(read_text(report));
  EXPECT_EQ(found["softkin_estimate"], 1);
  ASSERT_EQ(found["rows"].size(), 3u);
  const double expected[3][2] = {{0, 0.02}, {0.03, -0.05}, {-0.1, 0}};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t n = 0; n < 2; ++n)
      EXPECT_NEAR(found["rows"][r]["numbers"][n]["value"].get<double>(), expected[r][n], 1e-4);
  expect_words(read_text(table), {"reading,line,t_s,push_fy_N,push_fy_deviation_N,push_fz_N"});
  EXPECT_EQ(folder.estimate(requested).exit_code, 0) << "what it wrote it replaces";
  const ProgramResult fading =
      folder.estimate({"--unknown", "push:place", "--deviation", "0.001", "--fade", "5", "--json"});
  ASSERT_EQ(fading.exit_code, 0) << fading.errors << fading.output;
  EXPECT_EQ(json::parse(fading.output)["rows"][2]["places"].size(), 1u);
}

/// A tip marker is off by 3 mm and one other marker is read: the command reports that one of them is wrong, although it
/// cannot determine which.
TEST(EstimateCommand, ReadingsThatDoNotFitAreSaidByTheExitCode) {
  const PushedBlock folder;
  const std::string text = read_text(folder.readings);
  const std::string line = text.substr(0, text.find('\n')) + "\n0,0,23,6,6,20,12,15\n";
  const std::string wrong = folder.write("wrong.csv", line);
  const ProgramResult reported =
      run_program({"estimate", folder.scene, wrong, "--unknown", "push", "--deviation", "0.01", "--keep-all"});
  EXPECT_EQ(reported.exit_code, 1);
  expect_words(reported.output, {"the readings do not fit the model", "0 of 1 row fit the model"});
}

/// Beside its two markers the block has a strain sensor that was not read, and its surface.
TEST(EstimateCommand, PlansWhatToReadFurther) {
  const PushedBlock folder;
  const std::string report = folder / "planned.json";
  const ProgramResult reported = folder.estimate(
      {"--unknown", "push", "--deviation", "0.001", "--deviation-length", "0.0001", "--plan", "3", "--report", report});
  ASSERT_EQ(reported.exit_code, 0) << reported.errors << reported.output;
  expect_words(reported.output,
               {"the most informative readings, one after the other", " bits; push_fy +- ", " N; push_fz +- "});
  const json plan = json::parse(read_text(report))["plan"];
  ASSERT_EQ(plan.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(plan[i]["bits"].get<double>(), 0);
    if (plan[i]["name"] == "marker") {
      EXPECT_EQ(plan[i]["at_rest_mm"].size(), 3u);
      EXPECT_TRUE(plan[i].contains("vertex"));
    }
    if (i > 0) {
      EXPECT_LT(plan[i]["deviations"]["push_fz_N"].get<double>(), plan[i - 1]["deviations"]["push_fz_N"].get<double>());
    }
  }
  const ProgramResult none = folder.estimate({"--unknown", "push", "--deviation", "0.001", "--plan", "0"});
  EXPECT_EQ(none.exit_code, 2);
  expect_words(none.errors, {"--plan: Value 0 not in range", "100"});
}

/// A map of the block gives the same estimates as the block, to the map's accuracy.
TEST(EstimateCommand, ByAMapTellsTheSame) {
  const PushedBlock folder(replaced(replaced(pushed_scene(), "[-100, 3000]", "[0, 120]"), "[0, 100]", "[0, 0.5]"));
  const std::string map = folder / "block.skmap";
  const ProgramResult made = run_program({"map", folder.scene, "-o", map, "--accuracy", "0.0005"});
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  const std::vector<std::string> requested{"--unknown", "push", "--deviation", "0.002", "--json"};
  std::vector<std::string> by_map = requested;
  by_map.insert(by_map.end(), {"--map", map});
  const ProgramResult reported = folder.estimate(by_map), expected = folder.estimate(requested);
  ASSERT_EQ(reported.exit_code, 0) << reported.errors << reported.output;
  ASSERT_EQ(expected.exit_code, 0) << expected.errors;
  const json rows = json::parse(reported.output)["rows"], others = json::parse(expected.output)["rows"];
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t r = 0; r < 3; ++r) {
    EXPECT_EQ(rows[r]["equilibria"], 0);
    for (std::size_t n = 0; n < 2; ++n) {
      const json &one = rows[r]["numbers"][n], &other = others[r]["numbers"][n];
      EXPECT_EQ(one["name"], other["name"]);
      const double deviation = other["deviation"];
      EXPECT_NEAR(one["value"].get<double>(), other["value"].get<double>(), 0.3 * deviation);
      EXPECT_NEAR(one["deviation"].get<double>(), deviation, 0.05 * deviation);
    }
    EXPECT_EQ(rows[r]["readings"].size(), others[r]["readings"].size());
  }
  for (const auto& [more, why] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--unknown", "push:place", "--deviation", "1"}, "a map has forces at known places"},
           {{"--unknown", "push", "--deviation", "1", "--fade", "2"}, "a map estimates each row by itself"},
           {{"--unknown", "materials.all.stiffness=1+-0.1", "--deviation", "1"}, "is no input of the map"}}) {
    std::vector<std::string> words = more;
    words.insert(words.end(), {"--map", map});
    const ProgramResult refused = folder.estimate(words);
    EXPECT_EQ(refused.exit_code, 2);
    expect_words(refused.errors, {why});
  }
}

TEST(EstimateCommand, Refusals) {
  const PushedBlock folder;
  const auto refused = [&](const std::vector<std::string>& more, const std::string& why) {
    const ProgramResult reported = folder.estimate(more);
    EXPECT_EQ(reported.exit_code, 2) << why;
    EXPECT_NE(reported.errors.find(why), std::string::npos) << reported.errors;
  };
  refused({"--deviation", "1"}, "--unknown");
  refused({"--unknown", "pull", "--deviation", "1"}, "the scene has no command of that name");
  refused({"--unknown", "push"}, "needs the deviation of a coordinate: --deviation in mm");
  refused({"--unknown", "air", "--deviation", "1"}, "a column commands 'air', which is to be estimated");
  refused({"--unknown", "push:there", "--deviation", "1"}, "can only be 'place'");
  refused({"--unknown", "push=0+-0", "--deviation", "1"}, "the deviation must be above 0");
}

}  // namespace
