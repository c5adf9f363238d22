#include <cmath>
#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

constexpr double chamber = 192, tube = 20, syringe = 600, atmosphere = 100;  // the block's; mm^3, kPa

double loading(double gauge) {
  const double s = gauge / 80;
  return 1 + 0.5 * (0.3 * s + 0.7 * s * s);
}

double unloading(double gauge) {
  const double s = gauge / 80;
  return loading(gauge) + 0.16 * s * (1 - s);
}

/// Delta V_sy [mm^3] by the gas law.
double pushed(double gauge, double ratio) {
  const double closed = atmosphere * (chamber + tube + syringe);
  return ratio * chamber + syringe + tube - closed / (atmosphere + gauge);
}

/// Up to 80 kPa and down again; offset: what the column's pressures are above gauge.
std::string cycle(const std::string& header, double offset, double volume_factor = 1) {
  std::string text = header + "\n";
  for (int i = 0; i <= 32; ++i) {
    const double gauge = 5.0 * (i <= 16 ? i : 32 - i);
    const double volume = volume_factor * pushed(gauge, i <= 16 ? loading(gauge) : unloading(gauge));
    text += std::to_string(gauge + offset) + "," + std::to_string(volume) + "\n";
  }
  return text;
}

const std::vector<std::string> volumes{"--syringe-volume", "600mm3", "--tube-volume", "0.02mL"};

ProgramResult calibrate(const std::vector<std::string>& files, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"calibrate", "pressure"};
  arguments.insert(arguments.end(), files.begin(), files.end());
  arguments.insert(arguments.end(), volumes.begin(), volumes.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

void expect_bad(const BlockFolder& folder, const ProgramResult& result, const std::vector<std::string>& words) {
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
  expect_words(result.errors, words);
  EXPECT_FALSE(std::filesystem::exists(folder / "air.yaml"));
}

/// The block with a curve for its chamber.
std::string curved(const std::string& curve = "curve: air.yaml") {
  return replaced(block_scene(), "range: [1.0, 2.0]", "range: [1.0, 2.0], " + curve);
}

json fk_report(const std::string& scene, const std::vector<std::string>& options) {
  std::vector<std::string> all = options;
  all.push_back("--json");
  const ProgramResult result = run_fk(scene, all);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return result.exit_code == 0 ? json::parse(result.output) : json();
}

TEST(CalibratePressure, CurveOfATestDrivesTheSceneInKilopascals) {
  const BlockFolder folder;
  const std::string test = folder.write("test.csv", cycle("p_abs_kPa,dv_sy_mL", 100, 0.001));
  const ProgramResult result = calibrate({test}, {"--scene", folder.scene, "-o", folder / "air.yaml", "--plot",
                                                  folder / "air.svg", "--table", folder / "rows.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  expect_words(result.output,
               {"chamber 192 mm^3 at rest (actuator air of", "tube 20 mm^3", "syringe 600 mm^3", "100 kPa (default",
                "absolute pressures", "loading: 1 sweep", "unloading: 1 sweep", "repeatability is not known"});
  EXPECT_TRUE(std::filesystem::exists(folder / "air.svg"));
  EXPECT_EQ(read_text(folder / "rows.csv").rfind("p_gauge_kpa,p_abs_kpa,ratio", 0), 0U);

  const std::string scene = folder.write("curved.yaml", curved());
  for (const auto& [setting, ratio] : {std::pair<std::string, double>{"air=40kPa", loading(40)},
                                       {"air=140 kPa_abs", loading(40)},
                                       {"air=40kPa:unloading", unloading(40)},
                                       {"air=1.25", 1.25},
                                       {"air=0kPa", 1}}) {
    const json report = fk_report(scene, {"--set", setting});
    EXPECT_NEAR(report["steps"][0]["actuation"]["air"].get<double>(), ratio, 0.002 * ratio) << setting;
  }
  const json report = fk_report(scene, {"--set", "air=40kPa"});
  EXPECT_NEAR(report["steps"][0]["actuators"]["air"]["curve_pressure_kPa"].get<double>(), 40, 1e-6);
  EXPECT_EQ(report["actuators"]["air"]["curve"]["branch"], "loading");
  const ProgramResult text = run_fk(scene, {"--set", "air=40kPa:unloading"});
  expect_words(text.output, {"air: 40 kPa (gauge), unloading branch of", "by curve [kPa]"});

  const ProgramResult ik = run_program({"ik", scene, "--target", "tip=20.2,,", "--start", "air=40kPa"});
  expect_words(ik.output, {"air: 40 kPa (gauge), loading branch of", "by curve", " kPa\n"});

  const std::string back = folder.write("back.yaml", curved("curve: {file: air.yaml, branch: unloading}"));
  const std::string path = folder.write("path.csv", "air_kPa\n10\n20\n");
  const json steps = fk_report(back, {"--path", path})["steps"];
  EXPECT_NEAR(steps[1]["actuation"]["air"].get<double>(), unloading(20), 0.002);
  expect_refused(folder, {"--set", "air=40kPa"}, "needs a curve");
  const BlockFolder with(curved());
  with.write("air.yaml", read_text(folder / "air.yaml"));
  expect_refused(with, {"--set", "air=95kPa"}, "outside the loading branch of curve");
  expect_refused(with, {"--set", "air=40bar"}, "50kPa (gauge), 150kPa_abs");
  with.write("path.csv", "air_kPa\n10\n200\n");
  expect_refused(with, {"--path", with / "path.csv"}, "path.csv:3: column 'air_kPa'");
}

TEST(CalibratePressure, RunsOfBothScalesAreJoinedAndTheWrongOneIsNamed) {
  const BlockFolder folder;
  const std::string absolute = folder.write("a.csv", cycle("p_abs_kpa,dv_sy_mm3", 100));
  const std::string gauge = folder.write("g.csv", cycle("p_gauge_kpa,dv_sy_mm3", 0));
  const ProgramResult both = calibrate({absolute, gauge}, {"--chamber-volume", "192mm3", "--json"});
  ASSERT_EQ(both.exit_code, 0) << both.errors;
  const json curve = json::parse(both.output);
  EXPECT_EQ(curve["loading"]["sweeps"], 2);
  const auto& pressures = curve["loading"]["gauge_pressure_kPa"];
  for (std::size_t i = 0; i < pressures.size(); ++i) {
    const double expected = loading(pressures[i].get<double>());
    EXPECT_NEAR(curve["loading"]["ratio"][i].get<double>(), expected, 0.005 * expected);
  }
  const std::string wrong = folder.write("w.csv", cycle("p_abs_kpa,dv_sy_mm3", 0));
  const std::vector<std::string> scene{"--scene", folder.scene, "-o", folder / "air.yaml"};
  expect_bad(folder, calibrate({absolute, wrong}, scene),
             {"w.csv", "gauge pressures, given as absolute", "said to be of gauge pressures"});
  const std::string turned = folder.write("t.csv", cycle("p_gauge_kpa,dv_sy_mm3", 100));
  expect_bad(folder, calibrate({turned}, scene), {"t.csv", "absolute pressures, given as gauge"});
}

TEST(CalibratePressure, RefusesBadRowsByLineAndUnitsByName) {
  const BlockFolder folder;
  const std::vector<std::string> scene{"--scene", folder.scene, "-o", folder / "air.yaml"};
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words,
                          const std::vector<std::string>& more = {}) {
    std::vector<std::string> options = scene;
    options.insert(options.end(), more.begin(), more.end());
    expect_bad(folder, calibrate({folder.write("bad.csv", text)}, options), words);
  };
  refuse("p_abs_bar,dv_sy_ml\n1,0\n", {"bad.csv:1", "p_abs_bar", "kPa"});
  refuse("p_abs_kpa,dv_sy_l\n100,0\n", {"bad.csv:1", "dv_sy_l", "dv_sy_mm3 or dv_sy_ml"});
  refuse("p_kpa,dv_sy_ml\n100,0\n", {"bad.csv:1", "p_abs_kpa", "pressure: absolute or gauge"});
  refuse("p_gauge_kpa,dv_sy_ml\n0,0\n", {"bad.csv:1", "is not of absolute pressures"}, {"--pressure", "absolute"});
  refuse("p_abs_kpa,p_gauge_kpa,dv_sy_ml\n100,0,0\n", {"bad.csv:1", "which one counts"});
  refuse("p_abs_kpa,dv_sy_mm3\n100,0\n120,abc\n", {"bad.csv:3", "dv_sy_mm3", "abc"});
  refuse("p_abs_kpa,dv_sy_mm3\n100,0\n120,nan\n", {"bad.csv:3", "finite"});
  refuse("p_abs_kpa,dv_sy_ml\n100,0\n120,1e308\n", {"bad.csv:3", "dv_sy_ml", "1e+308"});
  refuse("p_abs_kpa,dv_sy_mm3,run\n100,0,1\n120,100,1.5\n", {"bad.csv:3", "run"});
  refuse("p_abs_kpa,dv_sy_mm3,t_s\n100,0,1\n120,100,1\n", {"bad.csv:3", "t_s", "ascend"});
  refuse("p_abs_kpa,dv_sy_mm3\n100,0\n120,700\n", {"bad.csv:3", "cannot give"});
  refuse("p_abs_kpa,dv_sy_mm3,temperature\n100,0,20\n", {"bad.csv:1", "unknown column 'temperature'"});
  const std::string good = folder.write("good.csv", cycle("p_abs_kpa,dv_sy_mm3", 100));
  expect_bad(folder, calibrate({good}, {"-o", folder / "air.yaml"}), {"--scene", "--chamber-volume"});
  expect_bad(folder, calibrate({good}, {"--chamber-volume", "192"}), {"--chamber-volume", "with its unit"});
  expect_bad(folder, calibrate({good}, {"--chamber-volume", "1e308mL"}), {"--chamber-volume", "with its unit"});
  expect_bad(folder, calibrate({good}, {"--chamber-volume", "192mm3", "--predict"}), {"--predict", "--scene"});
  expect_bad(folder, calibrate({good}, {"--scene", folder.scene, "--actuator", "ari"}),
             {"no pneumatic actuator 'ari'", "air"});
  expect_bad(folder, calibrate({good}, {"--scene", folder.scene, "--atmosphere", "-3"}), {"--atmosphere"});
  expect_bad(folder, calibrate({good}, {"--scene", folder.scene, "-o", folder / "air.txt"}), {".yaml"});
  expect_bad(folder, run_program({"calibrate", "pressure", good, "--scene", folder.scene}), {"--syringe-volume"});
}

TEST(CalibratePressure, PhysicalFormulationGivesTheFactorOfYoungsModulus) {
  const BlockFolder folder(physical_scene());
  // what the robot itself answers with, its tendon at rest as in the test, times 1.3
  std::string path = "air\n";
  for (int i = 0; i <= 10; ++i) path += std::to_string(1 + 0.02 * i) + "\n";
  const json steps = fk_report(folder.scene, {"--path", folder.write("path.csv", path)})["steps"];
  std::string text = "p_gauge_kpa,dv_sy_mm3\n";
  for (const json& step : steps) {
    const double gauge = 1.3 * step["actuators"]["air"]["pressure_kPa"].get<double>();
    const double ratio = step["actuation"]["air"].get<double>(), closed = atmosphere * (chamber + tube + 3000);
    text += std::to_string(gauge) + "," +
            std::to_string(ratio * chamber + 3000 + tube - closed / (atmosphere + gauge)) + "\n";
  }
  const std::string test = folder.write("test.csv", text);
  const ProgramResult result = run_program({"calibrate", "pressure", test, "--scene", folder.scene, "--syringe-volume",
                                            "3mL", "--tube-volume", "20mm3", "--predict", "--threads", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  expect_words(result.output, {"predicted [kPa]", "loading: measured = 1.3", "youngs_modulus 1 -> 1.3"});
  const ProgramResult numbers = run_program({"calibrate", "pressure", test, "--scene", folder.scene, "--syringe-volume",
                                             "3mL", "--tube-volume", "20mm3", "--predict", "--threads", "1", "--json"});
  EXPECT_NEAR(json::parse(numbers.output)["physical"]["loading"]["factor"].get<double>(), 1.3, 0.01);
}

TEST(CurveFile, RefusesWithTheLineOfTheSceneAndOfTheFile) {
  const auto refuse = [](const std::string& curve, const std::string& message,
                         const std::string& key = "curve: air.yaml") {
    const BlockFolder folder(curved(key));
    folder.write("air.yaml", curve);
    expect_refused(folder, {"--set", "air=1.2"}, message);
  };
  const std::string head = "softkin_curve: 1\ninput: gauge_pressure_kPa\n";
  refuse(head + "loading:\n  - [0, 1]\n  - [10, 1]\n", "air.yaml:5: entry 2 of 'loading'");
  refuse(head + "loading:\n  - [0, 1]\n", "at least two points");
  refuse(head + "loading:\n  - [0, 1, 0.1]\n  - [10, 1.1]\n", "air.yaml:5: either every point");
  refuse("softkin_curve: 1\ninput: pressure_bar\nloading: [[0, 1], [1, 2]]\n", "air.yaml:2: 'input' must be one of");
  refuse("softkin_curve: 1\ninput: voltage_kV\nloading: [[0, 1], [1, 2]]\n", "is one of voltages");
  refuse("softkin_curve: 2\n", "air.yaml:1: this version of softkin reads curves of version 1");
  refuse("loading: []\n", "softkin_curve");
  refuse(head + "loading: [[0, 1], [1, 2]]\nlaoding: 3\n", "unknown key 'laoding'");
  refuse(head + "loading: [[0, 1], [1, 2]]\n", "has none", "curve: {file: air.yaml, branch: unloading}");
  refuse(head + "loading: [[0, 1], [1, 2]]\n", "block.yaml:5: ", "curve: absent.yaml");
}

}  // namespace
