#include <cmath>
#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

const std::vector<std::string> acrylic{"calibrate",      "dea", "--law",       "neo-hookean", "--shear-modulus", "0.07",
                                       "--permittivity", "4.4", "--thickness", "0.5"};

ProgramResult with(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = acrylic;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

void expect_bad(const ProgramResult& result, const std::vector<std::string>& words) {
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_EQ(result.output, "");
  expect_words(result.errors, words);
}

TEST(CalibrateDea, EquationOfStateEndsAtTheAnalyticPullIn) {
  const ProgramResult result = with({"--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json curve = json::parse(result.output);
  const double root = std::sqrt(0.07e6 / (4.4 * 8.8541878128e-12)) * 1e-6;  // sqrt(mu / eps) [kV/mm]
  EXPECT_NEAR(curve["pull_in"]["stretch"].get<double>(), std::cbrt(2.0), 1e-6);
  EXPECT_NEAR(curve["pull_in"]["voltage_kV"].get<double>(), 0.5 * 0.6873 * root, 1e-3 * root);
  EXPECT_NEAR(curve["loading"]["voltage_kV"].back().get<double>(), curve["pull_in"]["voltage_kV"].get<double>(), 1e-9);
  EXPECT_EQ(curve["end"], "pull-in");
  const ProgramResult text = with({});
  expect_words(text.output, {"pull-in at", "prestretch 1 (default)", "no breakdown field given"});
  expect_words(with({"--breakdown-field", "20"}).output, {"breakdown field of 20 kV/mm reached at", "before pull-in"});
}

TEST(CalibrateDea, TellsWhatPulls) {
  expect_words(with({"--loading", "uniaxial", "--prestretch", "2"}).output,
               {"in tension along its length alone", "pull-in at", "a constant force along its length"});
  const ProgramResult kept = with({"--loading", "constrained", "--prestretch-across", "3"});
  expect_words(kept.output,
               {"that stiff fibres keep at a stretch of 3 across", "no pull-in", "5 times the prestretch"});
  EXPECT_EQ(json::parse(with({"--loading", "constrained", "--prestretch-across", "3", "--json"}).output)["end"],
            "the stretch to which it is computed");
}

TEST(CalibrateDea, CurveDrivesTheCrawlerInKilovolts) {
  const TemporaryFolder folder;
  ASSERT_EQ(with({"-o", folder / "skin.yaml", "--plot", folder / "skin.svg"}).exit_code, 0);
  const std::string example = std::string(SOFTKIN_SOURCE_DIR) + "/examples/dea_crawler/";
  std::string scene = read_text(example + "dea_crawler.yaml");
  scene = replaced(scene, "dea_crawler.msh", example + "dea_crawler.msh");
  scene = replaced(scene, "prestretch: 0.7", "prestretch: 0.7, curve: skin.yaml");
  const std::string file = folder.write("crawler.yaml", scene);
  const std::vector<std::string> fast{"--formulation", "target-shape", "--json"};
  std::vector<std::string> options{"--set", "skin=10kV"};
  options.insert(options.end(), fast.begin(), fast.end());
  const ProgramResult result = run_fk(file, options);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const double ratio = json::parse(result.output)["steps"][0]["actuation"]["skin"].get<double>();
  // the stretch at 10 kV by bisection of the equation of state, mu (l^2 - l^-4) = eps (l^2 U / H)^2
  double low = 1, high = std::cbrt(2.0);
  for (int i = 0; i < 80; ++i) {
    const double l = (low + high) / 2, field = l * l * 10 / 0.5 * 1e6;
    (0.07e6 * (l * l - std::pow(l, -4)) < 4.4 * 8.8541878128e-12 * field * field ? low : high) = l;
  }
  EXPECT_NEAR(ratio, 0.7 * low * low, 1e-4);
  EXPECT_GT(ratio, 0.75);
  for (const auto& [setting, word] : {std::pair{"skin=40kV", "it ends there by pull-in"},
                                      {"skin=5V", "such as 2.5kV"},
                                      {"skin=5kPa", "such as 2.5kV"},
                                      {"skin=5kV:unloading", "no unloading branch"}}) {
    const ProgramResult refused = run_fk(file, {"--set", setting});
    expect_bad(refused, {word});
  }
}

TEST(CalibrateDea, ATableGivesBothBranchesOverTheAreaWithoutVoltage) {
  const TemporaryFolder folder;
  std::string text = "run,voltage_v,stretch\n";
  for (int run = 1; run <= 2; ++run)
    for (int i = 0; i <= 20; ++i) {
      const double s = (i <= 10 ? i : 20 - i) / 10.0;
      const double area = 2 * (1 + 0.4 * s * s + (i > 10 ? 0.2 * s * (1 - s) : 0));
      text += std::to_string(run) + "," + std::to_string(4000 * s) + "," + std::to_string(std::sqrt(area)) + "\n";
    }
  const std::string table = folder.write("skin.csv", text);
  const ProgramResult result = run_program({"calibrate", "dea", table, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json curve = json::parse(result.output);
  for (std::size_t i = 0; i < curve["loading"]["ratio"].size(); ++i) {
    const double s = curve["loading"]["voltage_kV"][i].get<double>() / 4;
    EXPECT_NEAR(curve["loading"]["ratio"][i].get<double>(), 1 + 0.4 * s * s, 1e-5);
  }
  EXPECT_EQ(curve["unloading"]["sweeps"], 2);
  expect_words(run_program({"calibrate", "dea", table}).output, {"area ratio without voltage 2", "2 runs, 42 rows"});
}

TEST(CalibrateDea, RefusesBadRowsUnitsAndOptions) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words) {
    expect_bad(run_program({"calibrate", "dea", folder.write("bad.csv", text)}), words);
  };
  refuse("voltage_mv,area_ratio\n0,1\n", {"bad.csv:1", "kV or V"});
  refuse("voltage_kv,stretch_percent\n0,1\n", {"bad.csv:1", "ratios of lengths"});
  refuse("voltage_kv,area_ratio\n0,1\n1,0\n", {"bad.csv:3", "above 0"});
  refuse("voltage_kv,stretch\n0,1\n1,1e200\n", {"bad.csv:3", "stretch", "1e+200"});
  refuse("voltage_kv,area_ratio\n0,1\n-1,1.1\n", {"bad.csv:3", "below 0"});
  refuse("voltage_kv,area_ratio\n1,1\n2,1.1\n", {"bad.csv", "no row without voltage"});
  expect_bad(run_program({"calibrate", "dea"}), {"TESTS"});
  expect_bad(run_program({"calibrate", "dea", "--law", "gent"}), {"needs the elastomer's shear modulus"});
  expect_bad(with({"--stretch-limit", "10"}), {"--stretch-limit", "gent"});
  expect_bad(with({"--prestretch", "0.5"}), {"prestretch"});
  expect_bad(with({"--loading", "shear"}), {"--loading"});
  expect_bad(with({"--loading", "constrained"}), {"prestretch across, which its fibres keep"});
  expect_bad(with({"--prestretch-across", "2"}), {"--prestretch-across", "--loading constrained"});
  expect_bad(with({"--thickness", "-1"}), {"--thickness"});
  expect_bad(with({"-o", folder / "skin.txt"}), {".yaml"});
  expect_bad(run_program({"calibrate"}), {"a subcommand of calibrate"});
}

}  // namespace
