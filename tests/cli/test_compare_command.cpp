#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "page_samples.hpp"
#include "run_program.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// A bar of length 10 that rotates in the plane x, z by given angles [degrees], its start moving along x.
json turning(const std::vector<double>& angles, double seconds) {
  json report{{"formulation", "target-shape"}, {"solver", {{"name", "newton"}}}, {"steps", json::array()}};
  for (const double angle : angles) {
    const double a = angle * std::numbers::pi / 180, x = static_cast<double>(report["steps"].size());
    report["steps"].push_back(
        {{"actuation", {{"air", 1 + x}}},
         {"status", "converged"},
         {"seconds", seconds},
         {"markers", {{"begin", {x, 0, 0}}, {"end", {x + 10 * std::cos(a), 0, 10 * std::sin(a)}}}},
         {"actuators", {{"air", {{"requested", 1 + x}, {"achieved", 1 + x}}}}}});
  }
  return report;
}

json with_pressure(json report) {
  report["formulation"] = "physical";
  for (json& step : report["steps"]) step["actuators"]["air"]["pressure_kPa"] = 12.5;
  return report;
}

class Compare : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const json& report) { return folder_.write(name, report.dump()); }

  static void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_EQ(result.output, "");
    for (const std::string& word : words) EXPECT_NE(result.errors.find(word), std::string::npos) << result.errors;
  }

  const TemporaryFolder folder_;
};

TEST_F(Compare, TurnsGoBeyondHalfATurnAndTimesAddUp) {
  const std::vector<double> there{0, 70, 130, 200, 300, 380, 250}, back{0, -30, -60, -90, -120, -150, -200};
  const std::string a = write("a.json", turning(there, 2)), b = write("b.json", turning(back, 0.5));
  const ProgramResult result =
      run_program({"compare", a, b, "--turn", "begin", "end", "--poses", "130", "350", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json reports = json::parse(result.output)["reports"];
  ASSERT_EQ(reports.size(), 2U);
  for (std::size_t i = 0; i < there.size(); ++i) {
    EXPECT_NEAR(reports[0]["turn_deg"][i].get<double>(), there[i], 1e-9);
    EXPECT_NEAR(reports[1]["turn_deg"][i].get<double>(), -back[i], 1e-9);  // each turns forwards at first
    EXPECT_NEAR(reports[0]["elapsed_s"][i].get<double>(), 2 * (static_cast<double>(i) + 1), 1e-12);
  }
  EXPECT_EQ(reports[0]["poses"][0]["seconds"], 6.0);
  EXPECT_EQ(reports[0]["poses"][1]["seconds"], 12.0);
  EXPECT_EQ(reports[1]["poses"][0]["seconds"], 3.0);
  EXPECT_TRUE(reports[1]["poses"][1]["seconds"].is_null());
}

TEST_F(Compare, DistancesAreThoseOfTheChosenMarker) {
  const std::string a = write("a.json", turning({0, 60}, 1)), b = write("b.json", turning({0, 120}, 1));
  for (const auto& [marker, distance] : {std::pair{"begin", 0.0}, std::pair{"end", 10.0}}) {
    const ProgramResult result = run_program({"compare", a, b, "--marker", marker, "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const json both = json::parse(result.output);
    EXPECT_EQ(both["marker"], marker);
    EXPECT_NEAR(both["reports"][0]["distance_mm"][1].get<double>(), 0, 1e-12);
    EXPECT_NEAR(both["reports"][1]["distance_mm"][1].get<double>(), distance, 1e-12);
  }
}

TEST_F(Compare, TableNamesLoadsAndWhatDidNotConverge) {
  json stopped = turning({0, 60, 90}, 1.25);
  stopped["steps"][2]["status"] = "limit";
  const std::string a = write("a.json", with_pressure(turning({0, 30, 60}, 1))), b = write("b.json", stopped);
  const ProgramResult result = run_program({"compare", a, b, "--turn", "begin", "end", "--poses", "55", "85"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* part : {"1: physical, newton", "a: air [kPa]", "b: begin off by [mm]", "12.50", "converged\n",
                           "b: limit\n", "3.00 s", "2.50 s", "not reached", "3.75 s"})
    EXPECT_NE(result.output.find(part), std::string::npos) << "no '" << part << "' in:\n" << result.output;
}

/// The ratio of an actuator under pressure control is shown, not its pressure again.
TEST_F(Compare, ShowsVolumesUnderPressureControl) {
  json report = with_pressure(turning({0, 30, 60}, 1));
  report["actuators"] = {{"air", {{"kind", "pneumatic"}, {"control", "pressure"}, {"unit", "kPa"}}}};
  for (std::size_t i = 0; i < 3; ++i) report["steps"][i]["actuators"]["air"]["achieved"] = 1.25 + 0.5 * double(i);
  const std::string a = write("soft.json", report), b = write("stiff.json", report), plot = folder_ / "c.svg";
  const ProgramResult result = run_program({"compare", a, b, "--plot", plot});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* part : {"soft: air volume [-]", "stiff: air volume [-]", "1.7500", "stiff: air [kPa]"})
    EXPECT_NE(result.output.find(part), std::string::npos) << "no '" << part << "' in:\n" << result.output;
  const std::string drawn = read_text(plot);
  for (const char* part : {">over that at rest [-]<", ">soft: air volume<", ">stiff: air volume<", ">stiff<"})
    EXPECT_NE(drawn.find(part), std::string::npos) << part;
  EXPECT_EQ(drawn.find(">load [kPa]<"), std::string::npos);
}

TEST_F(Compare, WritesAPage) {
  SKIP_WITHOUT_PAGE();
  const std::string a = write("a.json", turning({0, 20}, 2)), b = write("b.json", turning({0, 30}, 1));
  const std::string page = folder_ / "p.html", plot = folder_ / "p.svg";
  const ProgramResult result = run_program({"compare", a, b, "--turn", "begin", "end", "--html", page, "--plot", plot});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(reported_of_page(page)), std::string::npos) << result.output;
  const json shown = shown_by(page).at("comparison");
  EXPECT_EQ(shown.at("plot"), read_text(plot));
  const json& rows = shown.at("tables").at(0).at("rows");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows.at(2).at(2), "20.0");
  EXPECT_EQ(shown_by(page).at("command"),
            "softkin compare " + a + " " + b + " --turn begin end --html " + page + " --plot " + plot);
  const ProgramResult paths = run_program({"compare", a, b, "--marker", "end", "--by", "waypoint", "--html", page});
  ASSERT_EQ(paths.exit_code, 0) << paths.errors;
  EXPECT_EQ(shown_by(page).at("comparison").at("tables").size(), 2u);
}

TEST_F(Compare, RefusesWhatCannotBeCompared) {
  const json report = turning({0, 60}, 1);
  const std::string a = write("a.json", report), longer = write("longer.json", turning({0, 60, 90}, 1));
  json other = report;
  other["steps"][1]["actuation"]["air"] = 2.5;
  json empty = report;
  empty["steps"] = json::array();
  json unknown = report;
  unknown["steps"][1]["markers"]["end"][0] = nullptr;
  json damaged = with_pressure(report);
  damaged["steps"][1]["actuators"]["air"].erase("pressure_kPa");
  json more = report;
  more["steps"][1]["actuation"]["water"] = 1;
  json unmarked = report;
  for (json& step : unmarked["steps"]) step["markers"] = json::object();
  expect_refused({"compare", a}, {"two reports or more"});
  expect_refused({"compare", a, folder_ / "absent.json"}, {"absent.json"});
  expect_refused({"compare", a, longer}, {"longer.json", "3 steps", "has 2"});
  expect_refused({"compare", a, write("other.json", other)}, {"other.json", "step 1", "air = 2.5", "air = 2"});
  expect_refused({"compare", a, write("empty.json", empty)}, {"empty.json", "no steps"});
  expect_refused({"compare", a, write("unknown.json", unknown)}, {"unknown.json", "not a report"});
  expect_refused({"compare", a, folder_.write("text.json", "steps")}, {"text.json", "not a report"});
  for (const std::string& each : {write("damaged.json", damaged), write("more.json", more)})
    expect_refused({"compare", each, each, "--plot", folder_ / "c.svg"}, {each, "step 1", "other actuators"});
  expect_refused({"compare", write("unmarked.json", unmarked), a}, {"unmarked.json", "no markers"});
  expect_refused({"compare", a, a, "--marker", "emd"}, {"no marker 'emd'", "end"});
  expect_refused({"compare", a, a, "--turn", "end", "end"}, {"at one place"});
  expect_refused({"compare", a, a, "--poses", "90"}, {"--turn"});
  expect_refused({"compare", a, a, "--turn", "begin", "end", "--poses", "-90"}, {"--poses"});
}

/// A report of one or two actuators whose marker tip moves linearly with both, times 0, 1, 2 ...
json linear(const std::vector<std::pair<double, double>>& commands) {
  json report{{"formulation", "physical"}, {"solver", {{"name", "newton"}}}, {"steps", json::array()}};
  for (const auto& [a, b] : commands) {
    report["steps"].push_back({{"actuation", {{"air1", a}, {"air2", b}}},
                               {"status", "converged"},
                               {"seconds", 1},
                               {"time_s", report["steps"].size()},
                               {"markers", {{"tip", {10 * (a - 1), 20 * (b - 1), 100}}}},
                               {"actuators", {{"air1", json::object()}, {"air2", json::object()}}}});
  }
  return report;
}

const std::vector<std::pair<double, double>> both_move{{1, 1}, {1.2, 1}, {1.2, 1.3}, {1.5, 1.5}};

TEST_F(Compare, APathIsComparedWithACameraTrackByTime) {
  const std::string report = write("robot.json", linear(both_move));
  std::string text = "t_s,x_mm,y_mm\n";  // sees x and y, a tenth of a second a row, 0.5 mm beside
  for (int i = 0; i <= 30; ++i) {
    const double t = 0.1 * i;
    const auto k = static_cast<std::size_t>(std::min(2.0, std::floor(t)));
    const double fraction = t - static_cast<double>(k);
    const double a = both_move[k].first + fraction * (both_move[k + 1].first - both_move[k].first);
    const double b = both_move[k].second + fraction * (both_move[k + 1].second - both_move[k].second);
    text += std::to_string(t) + "," + std::to_string(10 * (a - 1) + 0.5) + "," + std::to_string(20 * (b - 1)) + "\n";
  }
  const std::string camera = folder_.write("camera.csv", text);
  const ProgramResult result = run_program(
      {"compare", report, camera, "--json", "-o", folder_ / "errors.csv", "--plot", folder_ / "errors.svg"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json track = json::parse(result.output)["tracks"][0];
  EXPECT_EQ(track["by"], "parameter");
  EXPECT_EQ(track["axes"], "xy");
  EXPECT_NEAR(track["largest_mm"].get<double>(), 0.5, 1e-5);
  EXPECT_NEAR(track["mean_mm"].get<double>(), 0.5, 1e-5);
  EXPECT_EQ(track["error_mm"].size(), 4U);
  EXPECT_EQ(read_text(folder_ / "errors.csv").rfind("track,waypoint,place", 0), 0U);
  EXPECT_NE(read_text(folder_ / "errors.csv").find(",error_mm,file\n"), std::string::npos);
  EXPECT_NE(read_text(folder_ / "errors.csv").find("," + camera + "\n"), std::string::npos);
  for (const char* part : {"<svg", ">robot<", ">camera<"})
    EXPECT_NE(read_text(folder_ / "errors.svg").find(part), std::string::npos) << part;
  const ProgramResult aligned = run_program({"compare", report, camera, "--align"});
  ASSERT_EQ(aligned.exit_code, 0) << aligned.errors;
  for (const char* part : {"compared by time", "along xy", "aligned: turned by", "largest [mm]", "0.000",
                           "camera: off by [mm]", "\ncamera  "})
    EXPECT_NE(aligned.output.find(part), std::string::npos) << "no '" << part << "' in:\n" << aligned.output;
}

TEST_F(Compare, AClockThatBeganEarlierIsSetBack) {
  const std::string robot = folder_.write("robot.csv", "t_s,x_mm,y_mm\n0,0,0\n1,10,0\n2,10,10\n");
  const std::string film = folder_.write("film.csv", "t_s,x_mm,y_mm\n0,0,0\n3.25,0,0\n4.25,10,0\n5.25,10,10\n");
  const auto track = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"compare", robot, film, "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return json::parse(run_program(arguments).output)["tracks"][0];
  };
  EXPECT_NEAR(track({})["largest_mm"].get<double>(), std::hypot(10, 10), 1e-9);
  EXPECT_NEAR(track({"--start", "3.25"})["largest_mm"].get<double>(), 0, 1e-9);
  EXPECT_NEAR(track({"--start", "3.15"})["largest_mm"].get<double>(), 1, 1e-9) << "0.1 s at 10 mm/s";
  EXPECT_EQ(track({"--start", "3.75"})["left_out"], 1) << "the film ends before";
  const std::string timeless = folder_.write("timeless.csv", "x_mm,y_mm\n0,0\n10,0\n10,10\n");
  expect_refused({"compare", robot, timeless, "--start", "1"}, {"timeless.csv", "no times", "a start"});
  expect_refused({"compare", timeless, film, "--start", "1"}, {"timeless.csv", "no times", "a start"});
  expect_refused({"compare", robot, film, "--start", "1", "--by", "arc"}, {"--start", "arc"});
  expect_refused({"compare", robot, film, "--start", "nan"}, {"--start"});
  const std::string report = write("robot.json", linear(both_move));
  expect_refused({"compare", report, report, "--start", "1"}, {"the start", "measured track"});
}

TEST_F(Compare, ALongTableSaysThatItIsCut) {
  for (const int count : {20, 21}) {
    std::string text = "x_mm,y_mm\n";
    for (int i = 0; i < count; ++i) text += std::to_string(i) + ",0\n";
    const std::string track = folder_.write("track.csv", text);
    const std::string output = run_program({"compare", track, track}).output;
    EXPECT_EQ(output.find("20 of 21 waypoints shown; all: -o F.csv\n") != std::string::npos, count == 21) << output;
    EXPECT_EQ(output.find("shown") != std::string::npos, count == 21) << output;
  }
}

TEST_F(Compare, PlanesMarkersAndParametersAreThoseAskedFor) {
  const std::string solid = folder_.write("solid.csv",
                                          "alpha,tip_x_mm,tip_y_mm,tip_z_mm,base_x_mm,base_y_mm\n"
                                          "1,0,5,0,9,9\n2,10,5,-4,9,9\n3,20,5,-8,9,9\n");
  const std::string flat = folder_.write("flat.csv", "alpha,x_mm,y_mm\n1,0,0\n1.5,5,2\n3,20,8\n");  // y down
  const ProgramResult result =
      run_program({"compare", solid + "@tip", flat, "--by", "alpha", "--plane", "x-z", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json track = json::parse(result.output)["tracks"][0];
  EXPECT_EQ(track["axes"], "xz");
  EXPECT_NEAR(track["largest_mm"].get<double>(), 0, 1e-12);
  expect_refused({"compare", solid, flat}, {"solid.csv:1", "several markers", "which one is meant"});
  expect_refused({"compare", solid + "@tpi", flat}, {"no marker 'tpi'", "tip"});
  expect_refused({"compare", solid + "@tip", flat, "--by", "beta"}, {"no column 'beta'"});
  expect_refused({"compare", solid + "@tip", flat, "--plane", "xx"}, {"the plane 'xx'"});
}

TEST_F(Compare, TheSumOfSingleActuatorsIsExactForALinearRobot) {
  const std::string robot = write("robot.json", linear(both_move));
  const std::string first = write("first.json", linear({{1, 1}, {1.3, 1}, {1.6, 1}}));
  const std::string second = write("second.json", linear({{1, 1}, {1, 1.25}, {1, 1.6}}));
  const ProgramResult result = run_program({"compare", robot, "--sum", first, second, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json track = json::parse(result.output)["tracks"][0];
  EXPECT_EQ(track["file"], "sum of single actuators");
  EXPECT_NEAR(track["largest_mm"].get<double>(), 0, 1e-9);
  const ProgramResult aligned = run_program({"compare", robot, "--align", "--json", "--sum", first, second});
  EXPECT_EQ(json::parse(aligned.output)["tracks"][0]["aligned"], false) << "both have the robot's axes";
  expect_refused({"compare", robot, "--sum", first}, {"'air2' moves", "no report of the sum"});
  expect_refused({"compare", robot, "--sum", first, first}, {"'air1' moves in"});
  expect_refused({"compare", robot, "--sum", robot}, {"both move"});
  const std::string narrow = write("narrow.json", linear({{1, 1}, {1.3, 1}}));
  expect_refused({"compare", robot, "--sum", narrow, second}, {"narrow.json", "1.5", "outside this sweep"});
  const std::string track_only = folder_.write("t.csv", "x_mm,y_mm\n0,0\n1,1\n");
  expect_refused({"compare", track_only, "--sum", first, second}, {"a sum needs a report"});
}

TEST_F(Compare, RefusesTracksByLineAndUnit) {
  const std::string good = folder_.write("good.csv", "t_s,x_mm,y_mm\n0,0,0\n1,1,0\n");
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words,
                          std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"compare", good, folder_.write("bad.csv", text)});
    expect_refused(more, words);
  };
  refuse("t_s,x_cm,y_cm\n0,0,0\n", {"bad.csv:1", "x_cm", "mm"});
  refuse("t_s,x,y\n0,0,0\n", {"bad.csv:1", "unit is missing", "x_mm"});
  refuse("t_ms,x_mm,y_mm\n0,0,0\n", {"bad.csv:1", "t_s"});
  refuse("t_s,x_mm,y_mm\n0,0,0\n0,1,1\n", {"bad.csv:3", "ascend"});
  refuse("t_s,x_mm,y_mm\n0,0,0\n1,one,1\n", {"bad.csv:3", "x_mm"});
  refuse("t_s,x_mm\n0,0\n", {"bad.csv:1", "two coordinates"});
  refuse("t_s,x_mm,y_mm\n5,0,0\n6,1,1\n", {"bad.csv", "no waypoint"});
  refuse("x_mm,y_mm\n0,0\n1,1\n2,2\n", {"bad.csv", "3 waypoints", "has 2"}, {"--by", "waypoint"});
  refuse("t_s,x_mm,y_mm\n0,0,0\n1,1,1\n", {"--turn"}, {"--turn", "a", "b"});
  refuse("t_s,x_mm,y_mm\n0,0,0\n1,1,1\n", {".csv"}, {"-o", folder_ / "out.txt"});
  expect_refused({"compare", good, good, "-o", good}, {"would replace a file that is read"});
}

}  // namespace
