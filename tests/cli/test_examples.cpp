#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/io/table/csv.hpp>
#include <tuple>

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

/// Of what closes on something: the ends of its ranges are far inside of that, and target shapes touch nothing. And of
/// what is sealed, which target shapes do not know either.
bool is_of_two_fingers(const fs::path& folder) {
  return folder.filename() == "two_finger_gripper" || folder.filename() == "sealed_fingers";
}

/// Every examples/NAME/SCENE.yaml but those of two fingers, sorted.
std::vector<fs::path> scenes() {
  std::vector<fs::path> found;
  for (const auto& folder : fs::directory_iterator(examples())) {
    if (!folder.is_directory() || is_of_two_fingers(folder.path())) continue;
    for (const auto& file : fs::directory_iterator(folder))
      if (file.path().extension() == ".yaml" && file.path().stem().extension() != ".hardware")
        found.push_back(file.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Commanded by fields or pressures, which target shapes do not know.
bool is_loaded(const fs::path& scene) {
  return scene.stem().string().starts_with("magnetic") || scene.stem() == "fibre_actuator" ||
         scene.stem() == "bilayer" || scene.stem() == "paper_finger" || scene.stem() == "mckibben" ||
         scene.stem() == "pouch_motor" || scene.parent_path().filename() == "estimate";
}

/// Scenes and formulations.
std::vector<std::tuple<fs::path, std::string>> solved_scenes() {
  std::vector<std::tuple<fs::path, std::string>> cases;
  for (const fs::path& scene : scenes())
    for (const char* formulation : {"physical", "target-shape"})
      if (!is_loaded(scene) || formulation == std::string("physical")) cases.emplace_back(scene, formulation);
  return cases;
}

std::string test_name(const ::testing::TestParamInfo<std::tuple<fs::path, std::string>>& info) {
  const auto& [scene, formulation] = info.param;
  std::string name = scene.parent_path().filename().string();
  if (scene.stem() != name) name += "_" + scene.stem().string();
  name += "_" + formulation;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

class Example : public ::testing::TestWithParam<std::tuple<fs::path, std::string>> {
 protected:
  static const fs::path& scene() { return std::get<0>(GetParam()); }

  /// Solves the scene and expects sound shapes, as many as steps. One thread, since other tests run beside this one.
  static void expect_solved(std::vector<std::string> arguments, std::size_t steps) {
    const std::string& formulation = std::get<1>(GetParam());
    arguments.insert(arguments.begin(),
                     {"fk", scene().string(), "--json", "--threads", "1", "--formulation", formulation});
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.errors << result.output;
    const json report = json::parse(result.output);
    EXPECT_EQ(report["formulation"], formulation);
    EXPECT_EQ(report["steps"].size(), steps);
    EXPECT_EQ(report["warnings"].size(), 0u) << report["warnings"];
    expect_noted(report["notes"], formulation == "physical");
    for (const json& step : report["steps"]) expect_sound(step, formulation == "physical");
  }

 private:
  static void expect_sound(const json& step, bool physical) {
    SCOPED_TRACE(step["actuation"].dump());
    EXPECT_EQ(step["status"], "converged");
    EXPECT_EQ(step["inverted_elements"], 0);
    expect_plausible(step, physical);
    EXPECT_FALSE(step["markers"].empty());
    for (const auto& [name, actuator] : step["actuators"].items()) expect_exact(name, actuator, physical);
    for (const auto& [name, point] : step["markers"].items()) {
      SCOPED_TRACE(name);
      ASSERT_EQ(point.size(), 3U);
      for (const json& coordinate : point)
        EXPECT_TRUE(coordinate.is_number() && std::isfinite(coordinate.get<double>())) << coordinate;
    }
  }

  /// Checks that walls of one linear element are noted in the two examples whose READMEs mention them (order: 1).
  static void expect_noted(const json& notes, bool physical) {
    const bool locks =
        physical && (scene().stem() == "three_chamber_actuator" || scene().parent_path().filename() == "estimate");
    EXPECT_EQ(notes.dump().find("are about 1.0 elements thick") != std::string::npos, locks) << notes;
  }

  /// No false alarm of units, nor of shapes that pass through themselves: of them but the fingertips of the one whose
  /// cables close its notches farther than they are wide.
  static void expect_plausible(const json& step, bool physical) {
    EXPECT_LT(step["strain"]["greatest"], 5);
    const double rest = scene().stem() == "bilayer" ? 20 : is_loaded(scene()) ? 0 : 1;  // of it degrees C
    bool changes = false;
    for (const auto& [name, value] : step["actuation"].items())
      changes = changes || (value != rest && name != "field_x");  // a field along magnets at rest turns nothing
    EXPECT_TRUE(!changes || step["largest_displacement_mm"] > 1e-3);
    const bool closes = !physical && scene().stem() == "three_tendon_finger";
    EXPECT_TRUE(closes || step["self_overlap"]["points"] == 0) << step["self_overlap"];
  }

  /// Volumes and lengths are constraints of the physical formulation; a dea is an active stretch, which the body
  /// resists.
  static void expect_exact(const std::string& name, const json& actuator, bool physical) {
    const bool constrained = actuator.contains("pressure_kPa") || actuator.contains("tension_N");
    if (!physical || !constrained || is_loaded(scene())) return;
    const double achieved = actuator["achieved"].get<double>(), requested = actuator["requested"].get<double>();
    if (actuator.value("slack", false)) {
      EXPECT_LT(achieved, requested) << name;
    } else {
      EXPECT_NEAR(achieved, requested, 1e-6) << name;
    }
  }
};

TEST_P(Example, SolvesAlongItsPath) {
  const fs::path path = scene().parent_path() / "path.csv";
  if (fs::exists(path))
    expect_solved({"--path", path.string()}, read_csv(path).rows.size());
  else
    expect_solved({}, 1);
}

TEST_P(Example, SolvesAtBothEndsOfEveryRange) {
  for (const ActuatorSpec& actuator : read_scene(scene()).actuators)
    for (const double ratio : {actuator.low, actuator.high}) {
      const std::string setting = actuator.name + "=" + json(ratio).dump();
      SCOPED_TRACE(setting);
      expect_solved({"--set", setting}, 1);
    }
}

/// Every corner of the ranges with more than one actuator away from rest, in one step.
TEST_P(Example, SolvesAtEveryCornerOfTheRanges) {
  const std::vector<ActuatorSpec> actuators = read_scene(scene()).actuators;
  for (unsigned corner = 0; corner < 1U << actuators.size(); ++corner) {
    if (std::popcount(corner) < 2) continue;
    std::vector<std::string> settings;
    for (std::size_t a = 0; a < actuators.size(); ++a) {
      const ActuatorSpec& actuator = actuators[a];
      const bool low_is_rest = actuator.low == 1;
      const double end = ((corner >> a & 1U) != 0) == low_is_rest ? actuator.high : actuator.low;
      settings.insert(settings.end(), {"--set", actuator.name + "=" + json(end).dump()});
    }
    SCOPED_TRACE(json(settings).dump());
    expect_solved(settings, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Example, ::testing::ValuesIn(solved_scenes()), test_name);

TEST(Examples, EveryFolderHasAScene) {
  std::vector<fs::path> with_scene;
  for (const fs::path& scene : scenes()) with_scene.push_back(scene.parent_path());
  std::size_t folders = 0;
  for (const auto& entry : fs::directory_iterator(examples())) {
    const fs::path name = entry.path().filename();
    if (!entry.is_directory() || name == "cpp" || name == "python" || is_of_two_fingers(name) ||
        name == "acrylic_strip")
      continue;
    if (name == "paper" || name == "real") continue;  // their meshes are brought or made by the user
    ++folders;
    EXPECT_NE(std::find(with_scene.begin(), with_scene.end(), entry.path()), with_scene.end()) << entry.path();
  }
  EXPECT_GE(folders, 7U);
}

json solved_step(const fs::path& scene, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"fk", scene.string(), "--json", "--threads", "1"});
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return json::parse(result.output)["steps"][0];
}

/// Eq. (16) as evaluated in the README: the ratio of the moduli, and that of 6 R / (2 + R) for the two shape ratios.
TEST(Examples, BarGivesTheElasticityRatioOfItsMaterials) {
  const auto stiffness = [](double shape_ratio) { return 6 * shape_ratio / (2 + shape_ratio); };
  const fs::path scene = examples() / "two_material_bar/two_material_bar.yaml";
  for (const auto& [formulation, expected, tolerance] :
       {std::tuple{"physical", 45.0 / 12, 0.01}, std::tuple{"target-shape", stiffness(1.0) / stiffness(0.195), 0.04}}) {
    SCOPED_TRACE(formulation);
    const json markers = solved_step(scene, {"--formulation", formulation})["markers"];
    const double whole = markers["free_end"][0].get<double>() - 100, of_a = markers["interface"][0].get<double>() - 50;
    EXPECT_NEAR(whole, 2, 1e-9);
    EXPECT_NEAR((whole - of_a) / of_a, expected, tolerance * expected);
  }
}

/// In every scene of two materials the shape ratios agree with the moduli.
TEST(Examples, ShapeRatiosAndModuliTellTheSameStory) {
  for (const std::string name : {"two_material_bar/two_material_bar.yaml", "cable_gripper_two_materials/a.yaml",
                                 "cable_gripper_two_materials/b.yaml"}) {
    SCOPED_TRACE(name);
    const std::vector<MaterialSpec> materials = read_scene(examples() / name).materials;
    const auto ratio_of = [](const MaterialSpec& m) { return 6 * *m.shape_ratio / (2 + *m.shape_ratio); };
    const double per_modulus = ratio_of(materials[0]) / *materials[0].elastic->youngs_modulus;
    for (const MaterialSpec& material : materials)
      EXPECT_NEAR(ratio_of(material) / *material.elastic->youngs_modulus, per_modulus, 0.01 * per_modulus);
  }
}

/// Fig. 11: the same cable bends the two layouts of material differently.
TEST(Examples, TwoLayoutsOfMaterialBendDifferently) {
  for (const char* formulation : {"physical", "target-shape"}) {
    SCOPED_TRACE(formulation);
    std::vector<double> heights;
    for (const std::string layout : {"a", "b"}) {
      const json step = solved_step(examples() / "cable_gripper_two_materials" / (layout + ".yaml"),
                                    {"--set", "cable=0.9", "--formulation", formulation});
      heights.push_back(step["markers"]["first"][2].get<double>());
    }
    EXPECT_GT(heights[0], 1.9 * heights[1]);  // behind the knuckle at the base, stiff in layout b
  }
}

/// Both fingers press with equal force on opposite sides of the cube, which stays in place; the report separates robot
/// and support.
TEST(Examples, GripperHoldsItsCubeBetweenItsFingers) {
  const json step = solved_step(examples() / "two_finger_gripper" / "two_finger_gripper.yaml",
                                {"--set", "left.air=1.2", "--set", "right.air=1.2"});
  EXPECT_EQ(step["status"], "converged");
  EXPECT_EQ(step["inverted_elements"], 0);
  std::map<std::string, double> across;  // force on the cube along z, by robot [N]
  for (const json& pair : step["contacts"]) {
    const double force = pair["force_N"][2];
    if (pair["by"] == "cube") across[pair["on"]] -= force;
    if (pair["on"] == "cube") across[pair["by"]] += force;
  }
  ASSERT_EQ(across.size(), 2u) << step["contacts"];
  EXPECT_LT(across["left"], -0.1);
  EXPECT_NEAR(across["right"], -across["left"], 0.05 * std::abs(across["left"]));
}

/// The strip is turned by the torque that its base holds against; the field as a whole does not pull.
TEST(Examples, MagneticCantileverReportsItsTorque) {
  const fs::path scene = examples() / "magnetic_cantilever/magnetic_cantilever.yaml";
  const json step = solved_step(scene, {"--set", "field=9.44mT"});
  const json& load = step["magnetic"];
  EXPECT_EQ(step["actuators"]["field"]["achieved"], 9.44);
  EXPECT_LT(load["moment_N_mm"][1].get<double>(), -0.01);
  for (const json& force : load["force_N"]) EXPECT_NEAR(force.get<double>(), 0, 1e-12);
  const json& base = step["reactions"][0];
  EXPECT_NEAR(base["moment_N_mm"][1].get<double>() + load["moment_N_mm"][1].get<double>(), 0, 1e-6);
  const ProgramResult refused = run_program({"fk", scene.string(), "--formulation", "target-shape"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("needs the physical formulation"), std::string::npos) << refused.errors;
}

/// The field turns once in a cycle, and the crawler goes forward by as much in every one.
TEST(Examples, MagneticCrawlerWalksInARotatingField) {
  const fs::path folder = examples() / "magnetic_crawler";
  const testing::TemporaryFolder out;
  const ProgramResult result =
      run_program({"walk", (folder / "magnetic_crawler.yaml").string(), (folder / "gait.csv").string(), "--cycles", "3",
                   "-o", out / "walk", "--threads", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json steps = json::parse(testing::read_text(out / "walk/report.json"))["steps"];
  std::map<int, double> travel;  // at the end of each cycle
  for (const json& step : steps) {
    EXPECT_EQ(step["status"], "converged");
    travel[step["walk"]["cycle"].get<int>()] = step["walk"]["travel_mm"];
  }
  ASSERT_EQ(travel.size(), 4u);
  EXPECT_GT(travel[2] - travel[1], 1);
  EXPECT_NEAR(travel[3] - travel[2], travel[2] - travel[1], 1e-3);
}

/// A weight at the tip of the bent finger pulls it down, and its chamber, of the same volume, answers with another
/// pressure.
TEST(Examples, PayloadMovesTheFinger) {
  const fs::path scene = examples() / "pneumatic_finger/pneumatic_finger.yaml";
  const json free = solved_step(scene, {"--set", "air=1.2"});
  const json loaded = solved_step(scene, {"--set", "air=1.2", "--force", "payload=0,0,-1"});
  EXPECT_LT(loaded["markers"]["tip"][2].get<double>(), free["markers"]["tip"][2].get<double>() - 1);
  EXPECT_GT(std::abs(loaded["actuators"]["air"]["pressure_kPa"].get<double>() -
                     free["actuators"]["air"]["pressure_kPa"].get<double>()),
            1);
}

/// Boyle's law for the air of both, whatever pushes one of them; that one loses air to the other.
TEST(Examples, SealedFingersShareTheirAir) {
  const auto air = [](const std::string& push) {
    const fs::path scene = examples() / "sealed_fingers" / "sealed_fingers.yaml";
    const ProgramResult result = run_program(
        {"fk", scene.string(), "--json", "--threads", "1", "--set", "air=12 mL", "--force", "push=0,0," + push});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    const json reported = json::parse(result.output)["steps"][0]["actuators"]["air"];
    const double absolute = reported["pressure_kPa"].get<double>() + 101.325, volume = reported["volume_mL"];
    const double amount = reported["amount_mL"];
    EXPECT_NEAR(absolute * (volume + 2 + 20 - 12) / (101.325 * amount), 1, 1e-9);
    EXPECT_NEAR(
        reported["volumes_mL"]["left.chamber"].get<double>() + reported["volumes_mL"]["right.chamber"].get<double>(),
        volume, 1e-9);
    return reported;
  };
  const json free = air("0"), pushed = air("2");
  const auto left = [](const json& reported) { return reported["volumes_mL"]["left.chamber"].get<double>(); };
  const auto right = [](const json& reported) { return reported["volumes_mL"]["right.chamber"].get<double>(); };
  EXPECT_NEAR(left(free), right(free), 1e-6);
  EXPECT_LT(left(pushed), left(free) - 0.1);
  EXPECT_GT(right(pushed), right(free) + 0.01);
  EXPECT_GT(pushed["pressure_kPa"].get<double>(), free["pressure_kPa"].get<double>() + 0.1);
}

}  // namespace
}  // namespace softkin
