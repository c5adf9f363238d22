#include <gtest/gtest.h>

#include <softkin/model/growth.hpp>

#include "io/text_mesh_files.hpp"
#include "scene_fixtures.hpp"

namespace softkin {

namespace {

RobotSpec growing_scene(const std::string& actuator) {
  return parse_scene(
      "softkin: 1\nunits: {length: m}\nmesh: {file: finger.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: "
      "0.4}]\nactuators:\n  - {name: grow, kind: growth, " +
          actuator + "}\n",
      "robots/finger.yaml", fake_files());
}

std::string refusal_of_growth(const std::string& actuator) {
  try {
    (void)growing_scene(actuator);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(SceneGrowth, ByStretchAlongDirections) {
  const ActuatorSpec all = growing_scene("region: body, range: [0.9, 1.2]").actuators.at(0);
  EXPECT_TRUE(all.is<GrowthSpec>());
  EXPECT_EQ(all.control, Control::ratio);
  EXPECT_EQ(all.low, 0.9);
  EXPECT_EQ(all.rest, 1);
  EXPECT_EQ(all.as<GrowthSpec>()->parts.at(0).region, "body");
  EXPECT_FALSE(all.as<GrowthSpec>()->parts[0].direction);
  const ActuatorSpec along =
      growing_scene("region: a, range: [1, 2], direction: [0, 0, 2], keeps_volume: true, also: [{region: b}]")
          .actuators[0];
  EXPECT_EQ(along.as<GrowthSpec>()->parts[0].direction->uniform, Vec3(0, 0, 2));
  EXPECT_TRUE(along.as<GrowthSpec>()->parts[0].keeps_volume);
  EXPECT_EQ(along.as<GrowthSpec>()->parts.at(1).region, "b");
  const DirectionSpec around =
      *growing_scene(
           "region: a, range: [1, 2], "
           "direction: {circumferential: {center: [0, 0.1, 0], axis: [1, 0, 0], degrees: 54.7}}")
           .actuators[0]
           .as<GrowthSpec>()
           ->parts[0]
           .direction;
  EXPECT_EQ(around.kind, DirectionSpec::Kind::circumferential);
  EXPECT_EQ(around.center, Vec3(0, 100, 0));
  EXPECT_EQ(around.degrees, 54.7);
  const DirectionSpec samples =
      *growing_scene("region: a, range: [1, 2], direction: {places: [[0, 0, 0.002]], samples: [[1, 2, 3]]}")
           .actuators[0]
           .as<GrowthSpec>()
           ->parts[0]
           .direction;
  EXPECT_EQ(samples.kind, DirectionSpec::Kind::samples);
  EXPECT_EQ(samples.places(0, 2), 2);
  EXPECT_EQ(samples.samples(0, 1), 2);
}

TEST(SceneGrowth, ByTemperature) {
  const ActuatorSpec warm = growing_scene(
                                "region: a, range: [20, 90], temperature: {reference_C: 25, expansion_per_K: 3.1e-4}, "
                                "also: [{region: b, temperature: {table: [[20, 1], [90, 1.1]]}}]")
                                .actuators[0];
  EXPECT_EQ(warm.control, Control::load);
  EXPECT_EQ(warm.rest, 25);
  EXPECT_EQ(warm.as<GrowthSpec>()->parts[0].temperature->expansion_per_K, 3.1e-4);
  EXPECT_EQ(warm.as<GrowthSpec>()->parts.at(1).temperature->reference_C, 25);
  EXPECT_EQ(warm.as<GrowthSpec>()->parts[1].temperature->table.at(1)[1], 1.1);
  EXPECT_EQ(growing_scene("region: a, range: [-5, 0], temperature: {expansion_per_K: -1e-3}").actuators[0].rest, 20);
}

TEST(SceneGrowth, DirectionsFromAFile) {
  const text_mesh_tests::MeshFolder folder;
  const FieldSamples samples =
      read_directions(folder.write("fibres.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n1,2,3,0,1,0\n4,5,6,0,0,-1\n"));
  EXPECT_EQ(samples.values(1, 2), -1);
  EXPECT_EQ(samples.places(1, 0), 4);
  EXPECT_THROW((void)read_directions(folder.write("odd.csv", "x_mm,y_mm,z_mm,bx_mT,dy,dz\n1,2,3,0,1,0\n")),
               InvalidInput);
}

TEST(SceneGrowth, Refusals) {
  const std::pair<const char*, const char*> cases[] = {
      {"range: [1, 2]", "needs key 'region'"},
      {"region: a, range: [0, 2]", "must be greater than 0, not 0"},
      {"region: a, range: [2, 1]", "must be [low, high], but 2 is above 1"},
      {"region: a, range: [1, 2], weight: 3", "key 'weight' does not belong to kind 'growth'"},
      {"region: a, range: [1, 2], control: volume", "key 'control' does not belong to kind 'growth'"},
      {"region: a, range: [1, 2], points: [[0, 0, 0]]", "key 'points' does not belong to kind 'growth'"},
      {"region: a, range: [1, 2], keeps_volume: true", "'keeps_volume' needs a 'direction'"},
      {"region: a, range: [1, 2], direction: [0, 0, 0]", "'direction' must not be zero"},
      {"region: a, range: [1, 2], direction: {radial: {center: [0, 0, 0]}}", "needs key 'axis'"},
      {"region: a, range: [1, 2], direction: {radial: {center: [0, 0, 0], axis: [0, 0, 1], degrees: 3}}", "degrees"},
      {"region: a, range: [1, 2], direction: {file: F.csv, places: [[0, 0, 0]], samples: [[1, 0, 0]]}", "exclude"},
      {"region: a, range: [1, 2], temperature: {}", "needs one of 'expansion_per_K', 'table'"},
      {"region: a, range: [1, 2], temperature: {table: [[1, 2]]}", "needs at least two points"},
      {"region: a, range: [1, 2], temperature: {table: [[1, 2], [1, 3]]}", "must ascend"},
      {"region: a, range: [1, 2], also: [{region: b, temperature: {expansion_per_K: 1}}]", "takes no 'temperature'"},
      {"region: a, range: [1, 2], temperature: {expansion_per_K: 1}, also: [{region: b}]", "needs 'temperature'"},
      {"region: a, range: [1, 2], temperature: {expansion_per_K: 1}, "
       "also: [{region: b, temperature: {reference_C: 3, expansion_per_K: 1}}]",
       "reference_C"},
  };
  for (const auto& [text, fragment] : cases) {
    const std::string refusal = refusal_of_growth(text);
    EXPECT_NE(refusal.find(fragment), std::string::npos) << text << "\n" << refusal;
    EXPECT_NE(refusal.find("finger.yaml:"), std::string::npos) << refusal;
  }
}

}  // namespace softkin
