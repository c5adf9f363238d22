#include <gtest/gtest.h>

#include "scene_fixtures.hpp"

namespace softkin {

namespace {

constexpr const char* voltage_scene = R"(softkin: 1
mesh: {file: skin.msh}
materials:
  - {law: gent, shear_modulus: 0.045, jm: 120, poisson_ratio: 0.49, permittivity: 4.7}
actuators:
  - {name: left, kind: dea, region: left, control: voltage, range: [0, 6], prestretch: 0.25}
  - {name: right, kind: dea, region: right, control: voltage, range: [1, 5], voltage_share: shares/right.csv}
)";

/// Returns the scene with this text as the file of its voltage fractions.
RobotSpec with_fractions(const std::string& text) {
  SceneFiles files = fake_files();
  files.scene = [&](const std::filesystem::path& path) {
    EXPECT_EQ(path.string(), "robots/shares/right.csv");
    return text;
  };
  return parse_scene(voltage_scene, "robots/skin.yaml", files);
}

std::string refusal_of_fractions(const std::string& text) {
  try {
    (void)with_fractions(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(SceneVoltage, LayersAndTheirShares) {
  const RobotSpec spec = with_fractions("# by hand\nprism,share\n3,1\n\n1,0.25\n");
  EXPECT_EQ(spec.formulation, Formulation::physical);
  EXPECT_EQ(spec.materials.at(0).permittivity, 4.7);
  EXPECT_EQ(spec.materials.at(0).elastic->jm, 120);
  const ActuatorSpec &left = spec.actuators.at(0), &right = spec.actuators.at(1);
  EXPECT_EQ(left.control, Control::load);
  EXPECT_EQ(left.rest, 0);
  EXPECT_EQ(left.as<DeaSpec>()->prestretch, 0.25);
  EXPECT_FALSE(left.as<DeaSpec>()->fractions);
  EXPECT_EQ(right.as<DeaSpec>()->prestretch, 1);
  ASSERT_TRUE(right.as<DeaSpec>()->fractions);
  EXPECT_EQ(right.as<DeaSpec>()->fractions->prisms, (std::vector<Index>{3, 1}));
  EXPECT_EQ(right.as<DeaSpec>()->fractions->values, (std::vector<double>{1, 0.25}));
  EXPECT_EQ(right.as<DeaSpec>()->fractions->origins.at(1).text(), "robots/shares/right.csv:5");
}

TEST(SceneVoltage, FilesOfSharesThatAreRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"share,prism\n1,1\n", "robots/shares/right.csv:1: the columns must be prism,share"},
      {"prism,share\n1,half\n", "robots/shares/right.csv:2: column 'share' must hold a finite number, not 'half'"},
      {"prism,share\n0,1\n1.5,1\n", "right.csv:3: column 'prism' must hold a whole number from 0, not 1.5"},
      {"prism,share\n-1,1\n", "right.csv:2: column 'prism' must hold a whole number from 0, not -1"},
      {"prism,share\n", "no row follows the header"}};
  for (const auto& [text, message] : cases) {
    const std::string found = refusal_of_fractions(text);
    EXPECT_NE(found.find(message), std::string::npos) << found;
    EXPECT_EQ(found.find("robots/skin.yaml:7: "), 0u) << found;
  }
}

}  // namespace softkin
