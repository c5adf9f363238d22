#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "map_samples.hpp"
#include "page_samples.hpp"

namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;
using nlohmann::json;

TEST(HtmlOption, IsRefusedWhereItCannotBe) {
  const BlockFolder folder(physical_scene());
  expect_refused(folder, {"--html", folder / "page.htm"}, "--html: must end in .html, not " + (folder / "page.htm"));
  if (!softkin::runs::page_is_there()) {
    expect_refused(folder, {"--html", folder / "page.html"}, "this softkin was built without its page");
    return;
  }
  expect_refused(folder, {"--html", folder / "a.html", "--report", folder / "a.html"},
                 "--report " + (folder / "a.html") + ": must end in .json");
}

TEST(HtmlOption, FkWritesItsStepsIntoThePage) {
  SKIP_WITHOUT_PAGE();
  const BlockFolder folder(physical_scene());
  const std::string path = folder.write("path.csv", "t_s,air,tendon\n0,1,1\n1,1.1,0.98\n3,1.2,0.96\n");
  const std::string file = folder / "out/p.html";
  const ProgramResult result = run_fk(folder.scene, {"--path", path, "--html", file, "--report", folder / "r.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(reported_of_page(file)), std::string::npos) << result.output;
  EXPECT_NE(result.output.find(" MB; open it in a browser)"), std::string::npos) << result.output;
  const json page = shown_by(file), report = json::parse(read_text(folder / "r.json"));
  ASSERT_EQ(page.at("steps").size(), 3u);
  for (std::size_t s = 0; s < 3; ++s) {
    const json &shown = page.at("steps").at(s), &reported = report.at("steps").at(s);
    EXPECT_EQ(shown.at("markers").at(0), reported.at("markers").at("tip"));
    EXPECT_EQ(shown.at("commands").at(1), reported.at("actuation").at("tendon"));
    EXPECT_EQ(shown.at("loads").at(0), reported.at("actuators").at("air").at("pressure_kPa"));
    EXPECT_EQ(shown.at("time_s"), reported.at("time_s"));
  }
  EXPECT_EQ(page.at("command"), "softkin fk " + folder.scene + " --threads 1 --path " + path + " --html " + file +
                                    " --report " + (folder / "r.json"));
  EXPECT_TRUE(page.at("map").is_null());
}

TEST(HtmlOption, ResumedRunsShowAllSteps) {
  SKIP_WITHOUT_PAGE();
  const BlockFolder folder(physical_scene());
  const std::string path = folder.write("path.csv", "air\n1\n1.2\n1.4\n");
  std::vector<std::string> options{"--path",          path, "--html",        folder / "p.html", "--report",
                                   folder / "r.json", "-o", folder / "s.pvd"};
  ASSERT_EQ(run_fk(folder.scene, options).exit_code, 0);
  const json before = shown_by(folder / "p.html");
  json report = json::parse(read_text(folder / "r.json"));
  report["steps"].erase(2);
  folder.write("r.json", report.dump());
  options.emplace_back("--resume");
  ASSERT_EQ(run_fk(folder.scene, options).exit_code, 0);
  const json after = shown_by(folder / "p.html");
  ASSERT_EQ(after.at("steps").size(), 3u);
  for (std::size_t s = 0; s < 3; ++s)
    for (const char* key : {"positions", "fields", "commands", "markers"})
      EXPECT_EQ(after.at("steps").at(s).at(key), before.at("steps").at(s).at(key)) << s << " " << key;
}

TEST(HtmlOption, MapsAreInsideThePage) {
  SKIP_WITHOUT_PAGE();
  const BlockFolder folder(scene_to_map());
  const std::string map = folder / "block.skmap", page = folder / "p.html";
  ASSERT_EQ(run_program({"map", folder.scene, "-o", map, "--check", "10", "--threads", "1"}).exit_code, 0);
  ASSERT_EQ(run_fk(folder.scene, {"--map", map, "--set", "air=1.2", "--html", page}).exit_code, 0);
  const json shown = shown_by(page);
  EXPECT_EQ(shown.at("steps").size(), 1u);
  EXPECT_EQ(shown.at("map").at("inputs").size(), 2u);
  const std::size_t mean = shown.at("map").at("shapeTables").at("mean").get<std::string>().size();
  EXPECT_EQ(mean, shown.at("surface").at("rest").at("f32").get<std::string>().size());
}

TEST(HtmlOption, MapWritesAPageToBend) {
  SKIP_WITHOUT_PAGE();
  const BlockFolder folder(scene_to_map());
  const std::string map = folder / "block.skmap", page = folder / "p.html";
  std::vector<std::string> requested{"map", folder.scene, "-o", map, "--check", "10", "--threads", "1", "--html", page};
  const ProgramResult result = run_program(requested);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(reported_of_page(page)), std::string::npos) << result.output;
  const json shown = shown_by(page);
  EXPECT_EQ(shown.at("steps").size(), 0u);
  EXPECT_EQ(shown.at("map").at("inputs").at(0).at("name"), "air");
  requested.insert(requested.end(), {"--shape-accuracy", "0"});
  const ProgramResult shapeless = run_program(requested);
  EXPECT_EQ(shapeless.exit_code, 2);
  EXPECT_NE(shapeless.errors.find("--html bends the robot's shape"), std::string::npos) << shapeless.errors;
}

TEST(HtmlOption, FollowWritesItsWaypoints) {
  SKIP_WITHOUT_PAGE();
  const BlockFolder folder(physical_scene());
  const std::string path = folder.write("path.csv", "t_s,tip_x_mm\n0,20\n0.5,20.2\n"), page = folder / "p.html";
  const ProgramResult result =
      run_program({"follow", folder.scene, path, "-o", folder / "out", "--html", page, "--threads", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(reported_of_page(page)), std::string::npos) << result.output;
  const json shown = shown_by(page);
  ASSERT_EQ(shown.at("steps").size(), 2u);
  EXPECT_NEAR(shown.at("steps").at(1).at("markers").at(0).at(0).get<double>(), 20.2, 0.01);
  EXPECT_EQ(shown.at("steps").at(0).at("time_s"), 0.0);
  EXPECT_EQ(shown.at("steps").at(1).at("time_s"), 0.5);
}

}  // namespace
