#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "fk_physical_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// More pressure than there is an equilibrium for.
const std::vector<std::string> too_much{"--set", "air=3000"};

TEST(FkLimit, IsToldWithTheLastGoodShape) {
  const BlockFolder folder(loaded_scene());
  std::vector<std::string> options = too_much;
  options.insert(options.end(), {"--report", folder / "a.json", "-o", folder / "a.vtu", "--image", folder / "a.png"});
  const ProgramResult result = run_fk(folder.scene, options);
  EXPECT_EQ(result.exit_code, 1);
  const json step = json::parse(read_text(folder / "a.json"))["steps"][0];
  EXPECT_EQ(step["status"], "limit");
  const double reached = step["shape_actuation"]["air"];
  EXPECT_GT(reached, 100);
  EXPECT_LT(reached, 2900);
  EXPECT_NEAR(step["reached"], reached / 3000, 1e-12);
  EXPECT_EQ(step["actuation"]["air"], 3000.0);
  EXPECT_EQ(step["actuators"]["air"]["requested"], 3000.0);
  EXPECT_NEAR(step["actuators"]["air"]["pressure_kPa"], reached, 1e-9 * reached);
  std::ostringstream rounded;
  rounded << reached;
  const std::string reported = "softkin: limit: air reached " + rounded.str() +
                               " kPa of 3000 kPa: the pressure of chamber 'air' has its maximum there, ";
  EXPECT_EQ(result.errors.rfind(reported, 0), 0u) << result.errors;
  const json& worst = step["limit"];
  const std::string where = "; the shape is the last good one. Deformed most is tetrahedron " +
                            std::to_string(worst["element"].get<int>()) + " (from 0) of region 'body' at (";
  EXPECT_NE(result.errors.find(where), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find(", next to " + worst["beside"].get<std::string>() + ": strain "), std::string::npos);
  EXPECT_NE(result.output.find("  limit\n"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("last step of the iteration"), std::string::npos) << "that is of another shape";
  EXPECT_NE(read_text(folder / "a.png"), "");

  // the shape is the equilibrium that the volume finds
  const BlockFolder ratios(replaced(loaded_scene(), "pressure, range: [-100, 3000]", "volume, range: [1, 50]"));
  const json same = step_of(ratios, {"--set", "air=" + text(step["actuators"]["air"]["achieved"])});
  EXPECT_NEAR(same["actuators"]["air"]["pressure_kPa"], reached, 1e-4 * reached);
  expect_same_markers(step, same, 1e-4);
}

TEST(FkLimit, GoesOnBeyondTheMaximum) {
  const BlockFolder folder(loaded_scene());
  std::vector<std::string> options = too_much;
  options.insert(options.end(), {"--report", folder / "a.json"});
  EXPECT_EQ(run_fk(folder.scene, options).exit_code, 1);
  const json limit_point = json::parse(read_text(folder / "a.json"))["steps"][0];
  const double ratio = 1.3 * limit_point["actuators"]["air"]["achieved"].get<double>();
  options.insert(options.end(), {"--beyond", text(ratio)});
  const ProgramResult result = run_fk(folder.scene, options);
  EXPECT_EQ(result.exit_code, 1);
  const json step = json::parse(read_text(folder / "a.json"))["steps"][0];
  EXPECT_NEAR(step["actuators"]["air"]["achieved"].get<double>(), ratio, 1e-6 * ratio);
  EXPECT_LT(step["actuators"]["air"]["pressure_kPa"], limit_point["actuators"]["air"]["pressure_kPa"]);
  EXPECT_NE(result.errors.find("; beyond it, at "), std::string::npos) << result.errors;
  EXPECT_NE(result.output.find("air by its volume [-]: 0 kPa at 1, "), std::string::npos) << result.output;
  const json& branch = step["branch"];
  EXPECT_EQ(branch["actuator"], "air");
  ASSERT_EQ(branch["ratio"].size(), branch["pressure_kPa"].size());
  EXPECT_GT(branch["ratio"].size(), 5u);
  EXPECT_NEAR(branch["ratio"].back().get<double>(), ratio, 1e-9 * ratio);
  EXPECT_NEAR(branch["pressure_kPa"].back().get<double>(), step["actuators"]["air"]["pressure_kPa"].get<double>(),
              1e-6);
}

TEST(FkLimit, BeyondNeedsALoadThatMayHaveAMaximum) {
  const BlockFolder folder(physical_scene());
  const ProgramResult result = run_fk(folder.scene, {"--set", "air=1.1", "--beyond", "3"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find("--beyond continues beyond the maximum of a pressure or tension"), std::string::npos)
      << result.errors;
  EXPECT_EQ(run_fk(folder.scene, {"--set", "air=1.1", "--beyond", "-3"}).exit_code, 2);
}

TEST(FkLimit, OfLoadsAndDisplacementsIsTold) {
  const BlockFolder folder(physical_scene());
  const ProgramResult result = run_fk(folder.scene, {"--force", "payload=-1000,0,0"});  // a column buckles
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors.rfind("softkin: limit: ", 0), 0u) << result.errors;
  EXPECT_NE(result.errors.find(" % of the loads and displacements were reached: "), std::string::npos) << result.errors;
}

TEST(FkLimit, TooFewIterationsAreNoLimit) {
  const BlockFolder folder(loaded_scene());
  const ProgramResult result =
      run_fk(folder.scene, {"--set", "air=3000", "--max-iterations", "3", "--report", folder / "a.json"});
  EXPECT_EQ(result.exit_code, 1);
  const json step = json::parse(read_text(folder / "a.json"))["steps"][0];
  EXPECT_EQ(step["status"], "not converged");
  EXPECT_LT(step["reached"], 1);
  EXPECT_EQ(result.errors.rfind("softkin: not converged: air reached ", 0), 0u) << result.errors;
  EXPECT_NE(
      result.errors.find(
          " kPa of 3000 kPa: the limit of 3 iterations (max_iterations) was reached; the shape is the last good one"),
      std::string::npos)
      << result.errors;
}

TEST(FkLimit, APathGoesOnFromTheLastGoodShape) {
  const BlockFolder folder(loaded_scene());
  const std::string path = folder.write("path.csv", "air_kPa\n50\n3000\n2000\n50\n");
  const ProgramResult result = run_fk(folder.scene, {"--path", path, "--report", folder / "a.json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors.rfind("softkin: limit in steps 1, 2; in the last of them air reached ", 0), 0u)
      << result.errors;
  EXPECT_NE(result.errors.find(" kPa of 2000 kPa: "), std::string::npos) << result.errors;
  const json steps = json::parse(read_text(folder / "a.json"))["steps"];
  for (const int i : {0, 3}) EXPECT_EQ(steps[i]["status"], "converged");
  for (const int i : {1, 2}) EXPECT_EQ(steps[i]["status"], "limit");
  expect_same_markers(steps[0], steps[3], 1e-5);
}

/// Compares up to rounding: a new solve has another factor for its predictor than one that continues.
void expect_same_step(const json& found, const json& expected) {
  SCOPED_TRACE(expected["actuation"].dump());
  EXPECT_EQ(found["status"], expected["status"]);
  expect_same_markers(found, expected, 1e-6);
  EXPECT_LE(std::abs(found["iterations"].get<int>() - expected["iterations"].get<int>()), 2);
  for (const auto& [name, values] : expected["actuators"].items())
    for (const auto& [key, value] : values.items()) {
      if (value.is_boolean()) {
        EXPECT_EQ(found["actuators"][name][key], value) << name;
        continue;
      }
      const double known = value.get<double>();
      EXPECT_NEAR(found["actuators"][name][key].get<double>(), known, 1e-6 * (1 + std::abs(known))) << name << key;
    }
  for (const auto& [name, value] : expected["shape_actuation"].items())
    EXPECT_NEAR(found["shape_actuation"][name].get<double>(), value.get<double>(), 1e-6 * value.get<double>()) << name;
}

TEST(FkLimit, ResumeGoesOnFromItsActuationAndMultipliers) {
  const BlockFolder folder(replaced(physical_scene(), "volume, range: [0.5, 3]", "pressure, range: [-100, 3000]"));
  const std::string path = folder.write("path.csv", "air_kPa,tendon\n50,1.1\n3000,0.95\n60,0.9\n70,1.2\n80,0.8\n");
  const std::vector<std::string> options{"--path", path, "--report", folder / "out/a.json", "-o", folder / "out/a.pvd"};
  EXPECT_EQ(run_fk(folder.scene, options).exit_code, 1);
  const auto steps = [&] { return json::parse(read_text(folder / "out/a.json"))["steps"]; };
  const json whole = steps();
  EXPECT_EQ(whole[1]["status"], "limit");
  std::vector<std::string> again = options;
  again.emplace_back("--resume");
  for (const int lost : {4, 3, 2, 1}) {
    std::filesystem::remove(folder / ("out/a_000" + std::to_string(lost) + ".vtu"));
    const ProgramResult result = run_fk(folder.scene, again);
    EXPECT_EQ(result.exit_code, 1) << "nothing is left, but not all is well";
    EXPECT_NE(result.output.find(std::to_string(lost) + " of 5 steps were done before"), std::string::npos)
        << result.output;
    const json resumed = steps();
    ASSERT_EQ(resumed.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) expect_same_step(resumed[i], whole[i]);
  }
}

}  // namespace
