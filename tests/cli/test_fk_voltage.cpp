#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "run_program.hpp"

/// The shipped crawler, whose membrane is under voltage.

namespace softkin {
namespace {

using nlohmann::json;
using testing::number_after;
using testing::ProgramResult;
using testing::read_text;
using testing::run_program;
using testing::TemporaryFolder;

const std::string charged_crawler = std::string(SOFTKIN_SOURCE_DIR) + "/examples/dea_crawler/voltage/crawler.yaml";

/// As wide as under `skin=0.7` of the scene whose area is controlled.
double foot_at(const std::vector<std::string>& arguments) {
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return json::parse(result.output)["steps"][0]["markers"]["foot2"][0].get<double>();
}

}  // namespace

TEST(FkVoltage, ReportsWhatTheLayerHolds) {
  const ProgramResult result = run_program({"fk", charged_crawler, "--set", "skin=10kV", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report["actuators"]["skin"]["control"], "voltage");
  EXPECT_EQ(report["actuators"]["skin"]["unit"], "kV");
  EXPECT_EQ(report["materials"][3]["permittivity"], 4.7);
  const json skin = report["steps"][0]["actuators"]["skin"];
  std::vector<std::string> keys;
  for (const auto& [key, value] : skin.items()) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"achieved", "capacitance_pF", "charge_nC", "field_at_mm", "field_kV_mm",
                                            "requested", "thickness_mm", "voltage_kV"}));
  EXPECT_EQ(skin["voltage_kV"], 10.0);
  const double capacitance = skin["capacitance_pF"];
  EXPECT_NEAR(skin["charge_nC"], 10 * capacitance, 1e-6 * capacitance);
  // a flat capacitor of the mean area and the thickness that the volume of 2960 x 0.5 mm^3 leaves it
  const double area = 2960 * skin["achieved"].get<double>(), thickness = 2960 * 0.5 / area;
  EXPECT_NEAR(capacitance, 8.8541878128e-3 * 4.7 * area / thickness, 0.2 * capacitance);
  EXPECT_NEAR(skin["field_kV_mm"].get<double>() * skin["thickness_mm"].get<double>(), 10, 0.5);
}

TEST(FkVoltage, WithoutVoltageThePrestretchStays) {
  const std::string by_area = std::string(SOFTKIN_SOURCE_DIR) + "/examples/dea_crawler/dea_crawler.yaml";
  EXPECT_NEAR(foot_at({"fk", charged_crawler, "--json"}), foot_at({"fk", by_area, "--set", "skin=0.7", "--json"}),
              1e-4);
}

/// Charges are read again from a report.
TEST(FkVoltage, APathIsResumed) {
  const TemporaryFolder folder;
  const std::string path = folder.write("path.csv", "skin_kV\n0\n5\n9\n"), report = folder / "report.json";
  const std::vector<std::string> arguments{"fk",       charged_crawler, "--path", path,
                                           "--report", report,          "-o",     folder / "shape.pvd"};
  ASSERT_EQ(run_program(arguments).exit_code, 0);
  const std::string before = read_text(report);
  std::vector<std::string> again = arguments;
  again.push_back("--resume");
  const ProgramResult resumed = run_program(again);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.errors;
  EXPECT_EQ(json::parse(read_text(report))["steps"], json::parse(before)["steps"]);
}

/// The limit is found at the full prestretch, whether the prestretch precedes the voltage, as in a path, or both are
/// requested at once.
TEST(FkVoltage, TellsVoltageAndPlaceOfPullIn) {
  const TemporaryFolder folder;
  const std::string path = folder.write("path.csv", "skin_kV\n0\n25\n");
  const ProgramResult result = run_program({"fk", charged_crawler, "--set", "skin=25"}),
                      after = run_program({"fk", charged_crawler, "--path", path});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(after.exit_code, 1);
  // to 0.1 %; near its maximum the voltage hardly depends on the thickness of the layer
  const std::string maximum = "the voltage of dea 'skin' has its maximum there, ", thinnest = "and it is thinnest, ";
  const double most = number_after(after.errors, maximum);
  EXPECT_NEAR(most, 20.55, 0.02);
  EXPECT_NEAR(number_after(result.errors, maximum), most, 0.02);
  EXPECT_NEAR(number_after(result.errors, "limit: skin reached "), most, 0.02);
  EXPECT_NEAR(number_after(result.errors, thinnest), number_after(after.errors, thinnest), 0.02);
  EXPECT_NE(result.output.find("dea 'skin' holds "), std::string::npos) << result.output;
}

/// From 0 kV, where no shape changes with the voltage to first order.
TEST(FkVoltage, InverseKinematicsFindsAVoltage) {
  const ProgramResult result = run_program({"ik", charged_crawler, "--target", "foot2=81,,", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json step = json::parse(result.output)["steps"][0];
  EXPECT_NEAR(step["markers"]["foot2"][0], 81, 1e-3);
  EXPECT_NEAR(step["actuation"]["skin"], 10.29, 0.01);
}

TEST(FkVoltage, Refusals) {
  const auto refused = [](const std::vector<std::string>& more, const std::string& message) {
    std::vector<std::string> arguments{"fk", charged_crawler};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.errors.find(message), std::string::npos) << result.errors;
  };
  refused({"--set", "skin=26kV"}, "the voltage is outside its range, 0 to 25 kV");
  refused({"--set", "skin=1kPa"}, "the voltage must be a finite number in kV, such as 5 or 5kV");
  refused({"--formulation", "target-shape"}, "is controlled by its load: that needs the physical formulation");
}

}  // namespace softkin
