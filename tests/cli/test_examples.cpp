#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/io/csv.hpp>
#include <softkin/io/scene.hpp>

#include "run_program.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ProgramResult;
using testing::run_program;

fs::path examples() {
  return fs::path(SOFTKIN_SOURCE_DIR) / "examples";
}

/// Every examples/NAME/SCENE.yaml, sorted.
std::vector<fs::path> scenes() {
  std::vector<fs::path> found;
  for (const auto& folder : fs::directory_iterator(examples())) {
    if (!folder.is_directory()) continue;
    for (const auto& file : fs::directory_iterator(folder))
      if (file.path().extension() == ".yaml") found.push_back(file.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string test_name(const ::testing::TestParamInfo<fs::path>& scene) {
  std::string name = scene.param.parent_path().filename().string();
  if (scene.param.stem() != name) name += "_" + scene.param.stem().string();
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

class Example : public ::testing::TestWithParam<fs::path> {
 protected:
  /// Solves the scene and expects sound shapes, as many as steps. One thread, since other tests run beside this one.
  static void expect_solved(std::vector<std::string> arguments, std::size_t steps) {
    arguments.insert(arguments.begin(), {"fk", GetParam().string(), "--json", "--threads", "1"});
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.errors << result.output;
    const json report = json::parse(result.output);
    EXPECT_EQ(report["steps"].size(), steps);
    for (const json& step : report["steps"]) expect_sound(step);
  }

 private:
  static void expect_sound(const json& step) {
    SCOPED_TRACE(step["actuation"].dump());
    EXPECT_EQ(step["status"], "converged");
    EXPECT_EQ(step["inverted_elements"], 0);
    EXPECT_FALSE(step["markers"].empty());
    for (const auto& [name, point] : step["markers"].items()) {
      SCOPED_TRACE(name);
      ASSERT_EQ(point.size(), 3U);
      for (const json& coordinate : point)
        EXPECT_TRUE(coordinate.is_number() && std::isfinite(coordinate.get<double>())) << coordinate;
    }
  }
};

TEST_P(Example, SolvesAlongItsPath) {
  const fs::path path = GetParam().parent_path() / "path.csv";
  if (fs::exists(path))
    expect_solved({"--path", path.string()}, read_csv(path).rows.size());
  else
    expect_solved({}, 1);
}

TEST_P(Example, SolvesAtBothEndsOfEveryRange) {
  for (const ActuatorSpec& actuator : read_scene(GetParam()).actuators)
    for (const double ratio : {actuator.low, actuator.high}) {
      const std::string setting = actuator.name + "=" + json(ratio).dump();
      SCOPED_TRACE(setting);
      expect_solved({"--set", setting}, 1);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Example, ::testing::ValuesIn(scenes()), test_name);

TEST(Examples, EveryFolderHasAScene) {
  std::vector<fs::path> with_scene;
  for (const fs::path& scene : scenes()) with_scene.push_back(scene.parent_path());
  std::size_t folders = 0;
  for (const auto& entry : fs::directory_iterator(examples())) {
    if (!entry.is_directory()) continue;
    ++folders;
    EXPECT_NE(std::find(with_scene.begin(), with_scene.end(), entry.path()), with_scene.end()) << entry.path();
  }
  EXPECT_GE(folders, 7U);
}

/// Eq. (16) as evaluated in the README: the ratio is that of 6 R / (2 + R) for the two shape ratios.
TEST(Examples, BarGivesTheElasticityRatioOfItsShapeRatios) {
  const ProgramResult result =
      run_program({"fk", (examples() / "two_material_bar/two_material_bar.yaml").string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json markers = json::parse(result.output)["steps"][0]["markers"];
  const double whole = markers["free_end"][0].get<double>() - 100, of_a = markers["interface"][0].get<double>() - 50;
  EXPECT_NEAR(whole, 2, 1e-9);
  const auto stiffness = [](double shape_ratio) { return 6 * shape_ratio / (2 + shape_ratio); };
  const double expected = stiffness(1.0) / stiffness(0.141);
  EXPECT_NEAR((whole - of_a) / of_a, expected, 0.03 * expected);
}

/// Fig. 11: the same cable bends the two layouts of material differently.
TEST(Examples, TwoLayoutsOfMaterialBendDifferently) {
  std::vector<double> heights;
  for (const std::string layout : {"a", "b"}) {
    const ProgramResult result =
        run_program({"fk", (examples() / "cable_gripper_two_materials" / (layout + ".yaml")).string(), "--set",
                     "cable=0.9", "--json", "--threads", "1"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    heights.push_back(json::parse(result.output)["steps"][0]["markers"]["first"][2].get<double>());
  }
  EXPECT_GT(heights[0], 2 * heights[1]);  // behind the knuckle at the base, stiff in layout b
}

}  // namespace
}  // namespace softkin
