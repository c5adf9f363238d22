#include <gtest/gtest.h>

#include <softkin/model/families.hpp>

#include "scene_fixtures.hpp"

/// Liquids around robots and families of fibres in materials.

namespace softkin {

namespace {

RobotSpec scene_with(const std::string& material, const std::string& top = "") {
  return parse_scene("softkin: 1\nunits: {length: m}\nmesh: {file: finger.msh}\n" + top +
                         "materials:\n  - {youngs_modulus: 1, poisson_ratio: 0.4, " + material + "}\n",
                     "robots/finger.yaml", fake_files());
}

std::string refusal_with(const std::string& material, const std::string& top = "") {
  try {
    (void)scene_with(material, top);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(SceneSubmerged, ByLevelAndBySurface) {
  const std::string gravity = "gravity: [0, 3, -4]\n";
  const LiquidAroundSpec level =
      *scene_with("", gravity + "submerged: {density: 1025, level: 0.5}\n").loads.liquid_around;
  EXPECT_EQ(level.density, 1025);
  EXPECT_LT((level.surface - Vec3(0, -300, 400)).norm(), 1e-9);
  const LiquidAroundSpec surface = *scene_with("", "submerged: {surface: [0.1, 0, 0.2]}\n").loads.liquid_around;
  EXPECT_EQ(surface.density, 1000);
  EXPECT_EQ(surface.surface, Vec3(100, 0, 200));
  EXPECT_FALSE(scene_with("").loads.liquid_around);
}

TEST(SceneSubmerged, Refusals) {
  const std::pair<const char*, const char*> cases[] = {
      {"submerged: {density: 1000}\n", "needs one of 'surface', 'level'"},
      {"gravity: [0, 0, -9.81]\nsubmerged: {level: 1, surface: [0, 0, 1]}\n", "both"},
      {"submerged: {level: 1}\n", "'level' is measured against 'gravity', which this scene does not have"},
      {"submerged: {density: 0, surface: [0, 0, 0]}\n", "must be greater than 0, not 0"},
      {"submerged: {depth: 3}\n", "depth"}};
  for (const auto& [text, fragment] : cases) {
    EXPECT_NE(refusal_with("", text).find(fragment), std::string::npos) << refusal_with("", text);
    EXPECT_NE(refusal_with("", text).find("finger.yaml:"), std::string::npos);
  }
}

TEST(SceneFamilies, WithTheirDirections) {
  const auto families =
      scene_with(
          "families: [{k1: 0.2, k2: 0, direction: [1, 0, 0]}, "
          "{k1: 3, k2: 4, dispersion: 0.2, direction: {radial: {center: [0, 0, 1], axis: [0, 1, 0]}}}]")
          .materials[0]
          .families;
  ASSERT_EQ(families->families.size(), 2u);
  EXPECT_EQ(families->families[0].k1_MPa, 0.2);
  EXPECT_EQ(families->families[0].dispersion, 0);
  EXPECT_EQ(families->families[1].k2, 4);
  EXPECT_EQ(families->families[1].dispersion, 0.2);
  EXPECT_EQ(families->families[1].direction.kind, DirectionSpec::Kind::radial);
  EXPECT_EQ(families->families[1].direction.center, Vec3(0, 0, 1000));
}

TEST(SceneFamilies, Refusals) {
  const std::pair<const char*, const char*> cases[] = {
      {"families: []", "'families' is empty"},
      {"families: [{k1: 0, k2: 1, direction: [1, 0, 0]}]", "must be greater than 0, not 0"},
      {"families: [{k1: 1, k2: -1, direction: [1, 0, 0]}]", "must be 0 or more, not -1"},
      {"families: [{k1: 1, k2: 1}]", "needs key 'direction'"},
      {"families: [{k1: 1, direction: [1, 0, 0]}]", "needs key 'k2'"},
      {"families: [{k1: 1, k2: 1, dispersion: 0.4, direction: [1, 0, 0]}]", "must be from 0 to 1/3"},
      {"families: [{k1: 1, k2: 1, angle: 3, direction: [1, 0, 0]}]", "angle"}};
  for (const auto& [text, fragment] : cases)
    EXPECT_NE(refusal_with(text).find(fragment), std::string::npos) << text << "\n" << refusal_with(text);
}

}  // namespace softkin
