#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "run_program.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// A bar of length 10 that turns in the plane x, z by so many degrees from step to step, its begin moving along x.
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
  for (const char* part : {"1: physical, newton", "1: air [kPa]", "2: begin off by [mm]", "12.50", "converged\n",
                           "2: limit\n", "3.00 s", "2.50 s", "not reached", "3.75 s"})
    EXPECT_NE(result.output.find(part), std::string::npos) << "no '" << part << "' in:\n" << result.output;
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
  json unmarked = report;
  for (json& step : unmarked["steps"]) step["markers"] = json::object();
  expect_refused({"compare", a}, {"two reports or more"});
  expect_refused({"compare", a, folder_ / "absent.json"}, {"absent.json"});
  expect_refused({"compare", a, longer}, {"longer.json", "3 steps", "has 2"});
  expect_refused({"compare", a, write("other.json", other)}, {"other.json", "step 1", "air = 2.5", "air = 2"});
  expect_refused({"compare", a, write("empty.json", empty)}, {"empty.json", "no steps"});
  expect_refused({"compare", a, write("unknown.json", unknown)}, {"unknown.json", "not a report"});
  expect_refused({"compare", a, folder_.write("text.json", "steps")}, {"text.json", "not a report"});
  expect_refused({"compare", write("unmarked.json", unmarked), a}, {"unmarked.json", "no markers"});
  expect_refused({"compare", a, a, "--marker", "emd"}, {"no marker 'emd'", "end"});
  expect_refused({"compare", a, a, "--turn", "end", "end"}, {"at one place"});
  expect_refused({"compare", a, a, "--poses", "90"}, {"--turn"});
  expect_refused({"compare", a, a, "--turn", "begin", "end", "--poses", "-90"}, {"--poses"});
}

}  // namespace
