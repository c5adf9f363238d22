#include <cmath>
#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

const std::string strip = std::string(SOFTKIN_SOURCE_DIR) + "/examples/acrylic_strip/";

ProgramResult relaxation(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"calibrate", "relaxation"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

void expect_refused(const ProgramResult& result, const std::vector<std::string>& words) {
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
  expect_words(result.errors, words);
}

/// Within three and a half of its deviations of what the shipped tests were made with.
void expect_known(const json& estimate, double made) {
  EXPECT_NEAR(estimate["value"].get<double>(), made, 3.5 * estimate["deviation"].get<double>());
  EXPECT_LT(estimate["deviation"].get<double>(), 0.15 * made);
}

void expect_vhb(const json& branches) {
  const double moduli[] = {0.02606, 0.02653, 0.01083}, times[] = {0.61, 6.56, 61.25};
  ASSERT_EQ(branches.size(), 3u);
  for (std::size_t b = 0; b < 3; ++b) {
    expect_known(branches[b]["modulus_MPa"], moduli[b]);
    expect_known(branches[b]["time_s"], times[b]);
  }
}

TEST(CalibrateRelaxation, ShippedCyclesAndCreepGiveTheBranchesThatTheyWereMadeWith) {
  const TemporaryFolder folder;
  const ProgramResult result = relaxation({strip + "cycles.csv", "--law", "gent", "--json", "-o", folder / "m.yaml",
                                           "--plot", folder / "p.svg", "--residuals", folder / "r.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json found = json::parse(result.output);
  expect_vhb(found["branches"]);
  expect_known(found["constants"]["shear_modulus_MPa"], 0.01536);
  expect_known(found["constants"]["jm"], 3 * (5.85 * 5.85 - 1));
  EXPECT_EQ(found["chosen_by"], "information");
  EXPECT_NEAR(found["tried"][3]["rms_stress_MPa"].get<double>(), 4e-4, 4e-5);
  EXPECT_NEAR(found["youngs_modulus_MPa"]["relaxed"].get<double>(), 3 * 0.01536, 0.001);
  const double at_once = found["youngs_modulus_MPa"]["at_once"];
  EXPECT_NEAR(at_once, 3 * (0.01536 + 0.02606 + 0.02653 + 0.01083), 0.01);
  EXPECT_LT(found["youngs_modulus_MPa"]["at_once_in_scene"].get<double>(), at_once);
  EXPECT_EQ(read_text(folder / "m.yaml"), found["materials_yaml"].get<std::string>());
  expect_words(read_text(folder / "m.yaml"),
               {"law: gent, shear_modulus: 0.015", "viscosity: [{modulus: 0.02", "time: 0.6"});
  expect_words(read_text(folder / "p.svg"), {"Cycles", "run 3", "stretch [-]"});
  expect_words(read_text(folder / "r.csv"), {"run,line,t_s,stretch,stress_mpa,fit_stress_mpa,fit_stretch,off"});

  const ProgramResult creep =
      relaxation({"--creep", strip + "creep.csv", "--law", "gent", "--constants", "jm=99.67", "--json"});
  ASSERT_EQ(creep.exit_code, 0) << creep.errors;
  expect_vhb(json::parse(creep.output)["branches"]);
  EXPECT_EQ(json::parse(creep.output)["constants"]["jm"], (json{{"value", 99.67}, {"deviation", nullptr}}));
  EXPECT_EQ(json::parse(creep.output)["runs"][0]["imposed"], "stress");
}

/// All column and unit conventions for the same test give the same numbers.
TEST(CalibrateRelaxation, ColumnsAndUnitsAreAllThatDiffers) {
  const TemporaryFolder folder;
  std::string tables[4] = {"t_s,stretch,stress_MPa\n", "run,t_s,strain,stress_kpa\n", "t_s,strain_percent,force_N\n",
                           "t_s,length_mm,force_n\n"};
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.1 * std::pow(10, i / 15.0), stress = 0.1 * (1.5 - 1 / 2.25) + 0.05 * std::exp(-t / 7);
    const auto text = [](double value) { return std::to_string(value); };
    tables[0] += text(t) + ",1.5," + text(stress) + "\n";
    tables[1] += "4," + text(t) + ",0.5," + text(1000 * stress) + "\n";
    tables[2] += text(t) + ",50," + text(20 * stress) + "\n";
    tables[3] += text(t) + ",75," + text(20 * stress) + "\n";
  }
  double first = 0;
  for (int k = 0; k < 4; ++k) {
    const std::string file = folder.write("test" + std::to_string(k) + ".csv", tables[k]);
    const ProgramResult result = relaxation({file, "--area", "20", "--length", "50", "--branches", "1", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const double time_s = json::parse(result.output)["branches"][0]["time_s"]["value"];
    if (k == 0) first = time_s;
    EXPECT_NEAR(time_s, first, 1e-3 * first) << k;
    EXPECT_EQ(json::parse(result.output)["chosen_by"], "asked");
  }
  expect_words(relaxation({folder / "test0.csv", "--branches", "0"}).output,
               {"neo-hookean with no branch: as requested", "youngs_modulus", "no run repeats another"});
  expect_words(relaxation({folder / "test0.csv", folder / "test1.csv"}).output, {"repeated runs differ by"});
}

TEST(CalibrateRelaxation, RefusesBadRowsUnitsAndOptionsAndWritesNothing) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words,
                          const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{folder.write("bad.csv", text), "-o", folder / "m.yaml", "--plot",
                                       folder / "p.svg"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(relaxation(arguments), words);
    EXPECT_FALSE(std::filesystem::exists(folder / "m.yaml"));
    EXPECT_FALSE(std::filesystem::exists(folder / "p.svg"));
  };
  refuse("t_s,strain,stress_pa\n0,0.1,1\n", {"bad.csv:1", "MPa or kPa"});
  refuse("t_min,strain,stress_mpa\n0,0.1,1\n", {"bad.csv:1", "a time is in s"});
  refuse("t_s,strain_permille,stress_mpa\n0,0.1,1\n", {"bad.csv:1", "strain_percent"});
  refuse("t_s,length_cm,stress_mpa\n0,0.1,1\n", {"bad.csv:1", "length_mm"});
  refuse("t_s,strain,force_kn\n0,0.1,1\n", {"bad.csv:1", "force_n"});
  refuse("t_s,strain\n0,0.1\n", {"bad.csv:1", "no column gives the stress"});
  refuse("t_s,strain,stretch,stress_mpa\n0,0.1,1.1,1\n", {"bad.csv:1", "which one counts"});
  refuse("strain,stress_mpa\n0.1,1\n", {"bad.csv:1", "'t_s' is missing"});
  refuse("t_s,strain,stress_mpa\n0,0.1,1\n2,0.1,1\n1,0.1,1\n", {"bad.csv:4", "times must ascend"});
  refuse("t_s,strain,stress_mpa\n0,0.1,1\n1,-1.1,1\n", {"bad.csv:3", "above 0"});
  refuse("t_s,strain,stress_mpa\n0,0.1,1\n1,50,1\n", {"bad.csv:3", "strain_percent"});
  refuse("t_s,strain,stress_mpa\n0,0.1,1\n1,0.1,1e300\n", {"bad.csv:3", "beyond all measure"});
  refuse("t_s,strain,force_n\n0,0.1,1\n1,0.1,1\n", {"bad.csv:1", "area", "mm^2"});
  refuse("t_s,length_mm,stress_mpa\n0,60,1\n1,60,1\n", {"bad.csv:1", "length at rest"});
  refuse("run,t_s,strain,stress_mpa\n1,0,0.1,1\n1,1,0.1,1\n2,0,0.1,1\n", {"bad.csv:4", "run 2 has one row"});
  refuse("t_s,strain,stress_mpa\n0,0,0\n1,0,1\n2,0,1\n", {"bad.csv", "no stretch differs from 1"});
  const std::string good = "t_s,strain,stress_mpa\n0,0.1,1\n1,0.1,0.9\n2,0.1,0.85\n4,0.1,0.82\n8,0.1,0.8\n";
  refuse(good, {"law 'hookean'", "neo-hookean"}, {"--law", "hookean"});
  refuse(good, {"no constant 'jm' of neo-hookean"}, {"--constants", "jm=3"});
  refuse(good, {"--constants", "NAME=NUMBER"}, {"--constants", "c10:3"});
  refuse(good, {"jm must be above"}, {"--law", "gent", "--constants", "jm=0.001"});
  refuse(good, {"the tests carry", "at most, not 9"}, {"--branches", "9"});
  refuse(good, {"--poisson-ratio"}, {"--poisson-ratio", "0.5"});
  refuse(good, {"--residuals", ".csv"}, {"--residuals", folder / "r.txt"});
  expect_refused(relaxation({}), {"TESTS or --creep"});
}

}  // namespace
