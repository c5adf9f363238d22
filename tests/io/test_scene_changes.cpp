#include <gtest/gtest.h>

#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/scene/changes.hpp>
#include <softkin/io/scene/silicones.hpp>

#include "scene_fixtures.hpp"

namespace softkin {
namespace {

const std::string arm =
    "softkin: 1\nmesh: {file: a.msh}\n"
    "materials:\n  - &soft {region: body, youngs_modulus: 1, poisson_ratio: 0.4}\n"
    "  - {region: left.rib, youngs_modulus: 2, poisson_ratio: 0.3}\n  - {youngs_modulus: 3, poisson_ratio: 0.3}\n"
    "  - *soft\n"
    "gravity: [0, 0, -9.81]\n"
    "fixed: [{region: base}]\n"
    "actuators: [{name: air, kind: pneumatic, region: void, control: pressure, range: [0, 60]}]\n";

RobotSpec with(const std::string& text, const std::vector<std::string>& changes) {
  auto root = scene::parse_yaml(text, "arm.yaml");
  for (const std::string& each : changes) root = scene::changed(root, "--change", each, "");
  return parse_scene(*root, "arm.yaml", fake_files());
}

std::string change_refusal(const std::string& change, const std::string& within = "") {
  try {
    const auto root = scene::changed(scene::parse_yaml(arm, "arm.yaml"), "--change", change, within);
    (void)parse_scene(*root, "arm.yaml", fake_files());
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_change_refused(const std::string& change, const std::vector<std::string>& words) {
  const std::string text = change_refusal(change);
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
}

TEST(SceneChanges, NumbersByTheirPath) {
  EXPECT_EQ(with(arm, {"materials.all.youngs_modulus=0.8"}).materials[2].elastic->youngs_modulus, 0.8);
  EXPECT_EQ(with(arm, {"materials.left.rib.youngs_modulus = 5"}).materials[1].elastic->youngs_modulus, 5);
  EXPECT_EQ(with(arm, {"materials.2.poisson_ratio=0.1"}).materials[1].elastic->poisson_ratio, 0.1);
  EXPECT_EQ(with(arm, {"gravity.3=-1.62"}).loads.gravity, Vec3(0, 0, -1.62));
  EXPECT_EQ(with(arm, {"gravity=[1, 2, 3]"}).loads.gravity, Vec3(1, 2, 3));
  EXPECT_EQ(with(arm, {"gravity=[3, 2, 3]", "gravity.3=5"}).loads.gravity, Vec3(3, 2, 5));  // numbers are no names
  EXPECT_EQ(with(arm, {"actuators.air.range.2=90"}).actuators[0].high, 90);
  EXPECT_EQ(with(arm, {"materials.2.density=1070"}).materials[1].density, 1070);  // a key that was not there
  const RobotSpec both = with(arm, {"materials.2.youngs_modulus=4", "materials.2.poisson_ratio=0.2"});
  EXPECT_EQ(both.materials[1].elastic->youngs_modulus, 4);
  EXPECT_EQ(both.materials[1].elastic->poisson_ratio, 0.2);
}

/// An alias has its anchor's values; a change of one leaves the other as it is.
TEST(SceneChanges, AliasesKeepTheirOwn) {
  const RobotSpec spec = with(arm, {"materials.1.youngs_modulus=9"});
  EXPECT_EQ(spec.materials[0].elastic->youngs_modulus, 9);
  EXPECT_EQ(spec.materials[3].elastic->youngs_modulus, 1);
}

TEST(SceneChanges, WrongPathsNameTheNearest) {
  expect_change_refused("materials.bady.youngs_modulus=1", {"--change 'materials.bady.youngs_modulus=1'",
                                                            "no 'bady' in 'materials'", "did you mean 'body'?"});
  expect_change_refused("materals.all.youngs_modulus=1", {"no 'materals' in the scene", "did you mean 'materials'?"});
  expect_change_refused("materials.all.youngs_moduls=1", {"--change 'materials.all.youngs_moduls=1'",
                                                          "unknown key 'youngs_moduls'", "'youngs_modulus'"});
  expect_change_refused("materials.body.youngs_modulus=1",
                        {"several of the name 'body'", "number of the one that is meant"});
  expect_change_refused("materials.all.youngs_modulus.x=1", {"'youngs_modulus' has no parts"});
  expect_change_refused("materials.all=1", {"say which number", "materials.all.KEY=VALUE"});
  expect_change_refused("materials.all.youngs_modulus=-1", {"--change", "must be greater than 0, not -1"});
  expect_change_refused("materials.all.youngs_modulus=soft", {"--change", "must be a finite number"});
  expect_change_refused("materials.all.youngs_modulus=", {"the value is missing"});
  expect_change_refused("materials.all.youngs_modulus", {"expected PATH=VALUE"});
  expect_change_refused("gravity.4=1", {"no '4' in 'gravity'"});
  EXPECT_NE(change_refusal("bady.youngs_modulus=1", "materials").find("did you mean 'body'?"), std::string::npos);
}

/// Nominal stress [MPa] of the scene's neo-hookean law in simple tension: the sides are free, which fixes their
/// stretch.
double stress_in_tension(const ElasticSpec& spec, double stretch) {
  const double e = *spec.youngs_modulus, nu = *spec.poisson_ratio;
  const double mu = e / (2 * (1 + nu)), lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
  const auto slope = [&](double side, double across) {  // dW/d(stretch) is across: that of the other two directions
    return -mu * across + (lambda + mu) * (side - 1) * across;
  };
  double low = 0.1, high = 1.5;  // of the sides' stretch s: mu s + (...) = 0
  for (int i = 0; i < 200; ++i) {
    const double s = 0.5 * (low + high);
    (mu * s + slope(stretch * s * s, stretch * s) > 0 ? high : low) = s;
  }
  const double s = 0.5 * (low + high);
  return mu * stretch + slope(stretch * s * s, s * s);
}

/// The constants reproduce the makers' data, and scenes accept them.
TEST(Silicones, StressAtTwiceTheLengthIsThatOfTheDataSheet) {
  ASSERT_EQ(silicones().size(), 12u);
  std::size_t compared = 0;
  for (const Silicone& each : silicones()) {
    const RobotSpec spec = with("softkin: 1\nmesh: {file: a.msh}\nmaterials: [{material: " + each.name + "}]\n", {});
    ASSERT_TRUE(spec.materials[0].elastic);
    EXPECT_EQ(spec.formulation, Formulation::physical);
    EXPECT_EQ(spec.materials[0].density, each.density);
    EXPECT_FALSE(each.source.empty());
    if (each.stress_100_psi == 0) continue;
    const double reported = each.stress_100_psi * 6894.757e-6;
    EXPECT_NEAR(stress_in_tension(*spec.materials[0].elastic, 2), reported, 0.03 * reported) << each.name;
    ++compared;
  }
  EXPECT_EQ(compared, 11u);
  EXPECT_NEAR(*silicone("sylgard-184", {}).elastic(0.4999).youngs_modulus, 1.32, 1e-3);
}

TEST(Silicones, StandBesideDensityAndPoissonRatioAlone) {
  const auto parse = [](const std::string& keys) {
    return with("softkin: 1\nmesh: {file: a.msh}\nmaterials: [{" + keys + "}]\n", {}).materials[0];
  };
  const MaterialSpec material = parse("material: dragon-skin-10, density: 1000, poisson_ratio: 0.45, shape_ratio: 1");
  EXPECT_EQ(material.density, 1000);
  EXPECT_EQ(material.elastic->poisson_ratio, 0.45);
  EXPECT_EQ(material.shape_ratio, 1);
  const auto refused = [&](const std::string& keys, const std::string& words) {
    try {
      (void)parse(keys);
      ADD_FAILURE() << keys;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused("material: dragon-skin-10, set: yeo", "did you mean 'yeoh'?");
  refused("material: sylgard-184, set: yeoh", "softkin has no set 'yeoh' of sylgard-184; known: datasheet");
  refused("material: ecoflex-0030", "did you mean 'ecoflex-00-30'?");
  refused("material: dragon-skin-10, youngs_modulus: 1", "key 'youngs_modulus' does not go with 'material'");
  refused("material: dragon-skin-10, law: yeoh", "key 'law' does not go with 'material'");
}

TEST(Silicones, TakeTheSetThatTheSceneNames) {
  const auto material = [](const std::string& keys) {
    return with("softkin: 1\nmesh: {file: a.msh}\nmaterials: [{material: dragon-skin-30" + keys + "}]\n", {})
        .materials[0];
  };
  const MaterialSpec sheet = material(""), fitted = material(", set: ogden");
  EXPECT_EQ(sheet.named->set, "datasheet");
  EXPECT_NEAR(*sheet.elastic->youngs_modulus, 1.01, 0.01);
  EXPECT_EQ(fitted.elastic->law, Law::ogden);
  EXPECT_EQ(fitted.density, sheet.density);
  EXPECT_EQ(fitted.named->sets.size(), 5u);
  EXPECT_EQ(material(", set: yeoh, poisson_ratio: 0.45").elastic->poisson_ratio, 0.45);
}

}  // namespace
}  // namespace softkin
