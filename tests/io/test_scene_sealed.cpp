#include <gtest/gtest.h>

#include "scene_fixtures.hpp"

namespace softkin {

namespace {

RobotSpec sealed_scene(const std::string& actuator, const std::string& more = "") {
  return parse_scene("softkin: 1\nmesh: {file: finger.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.4}]\n" +
                         more + "actuators:\n  - {name: air, kind: pneumatic, " + actuator + "}\n",
                     "robots/finger.yaml", fake_files());
}

FillingSpec filling_by(const std::string& actuator) {
  return sealed_scene(actuator).actuators.at(0).as<PneumaticSpec>()->filling.value();
}

std::string refusal_of_sealed(const std::string& actuator, const std::string& more = "") {
  try {
    (void)sealed_scene(actuator, more);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(SceneSealed, GasWithAndWithoutASyringe) {
  const ActuatorSpec amount = sealed_scene("region: chamber, control: gas, range: [5, 30]").actuators.at(0);
  EXPECT_EQ(amount.control, Control::filling);
  ASSERT_TRUE(amount.as<PneumaticSpec>()->filling);
  EXPECT_FALSE(amount.as<PneumaticSpec>()->filling->liquid);
  EXPECT_FALSE(amount.as<PneumaticSpec>()->filling->syringe_mL);
  EXPECT_EQ(amount.as<PneumaticSpec>()->filling->exponent, 1);
  EXPECT_EQ(amount.as<PneumaticSpec>()->filling->atmosphere_kPa, 101.325);
  EXPECT_EQ(amount.low, 5);
  const ActuatorSpec pushed = sealed_scene(
                                  "connected: [a, b], control: gas, range: [-2, 15], "
                                  "source: {syringe_mL: 20, dead_mL: 2.5, process: adiabatic}",
                                  "atmosphere: 84\n")
                                  .actuators.at(0);
  EXPECT_EQ(pushed.as<PneumaticSpec>()->connected, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(pushed.as<PneumaticSpec>()->filling->syringe_mL, 20);
  EXPECT_EQ(pushed.as<PneumaticSpec>()->filling->dead_mL, 2.5);
  EXPECT_EQ(pushed.as<PneumaticSpec>()->filling->exponent, 1.4);
  EXPECT_EQ(pushed.as<PneumaticSpec>()->filling->atmosphere_kPa, 84);
  EXPECT_EQ(pushed.low, -2);
  EXPECT_EQ(filling_by("control: gas, range: [1, 2], source: {process: {exponent: 1.2}}").exponent, 1.2);
  EXPECT_EQ(filling_by("control: gas, range: [1, 2], source: {process: isothermal}").exponent, 1);
}

TEST(SceneSealed, Liquid) {
  const FillingSpec water = filling_by("control: liquid, range: [1, 2], liquid: {bulk_modulus: 2200}");
  EXPECT_TRUE(water.liquid);
  EXPECT_DOUBLE_EQ(water.compressibility, 1 / 2200.0);
  EXPECT_DOUBLE_EQ(filling_by("control: liquid, range: [1, 2], liquid: {compressibility: 0.45}").compressibility,
                   4.5e-4);
  EXPECT_EQ(filling_by("control: liquid, range: [1, 2], liquid: {compressibility: 0}").compressibility, 0);
}

TEST(SceneSealed, Refusals) {
  const std::pair<const char*, const char*> cases[] = {
      {"control: air, range: [1, 2]", "must be one of 'volume', 'pressure', 'gas', 'liquid', not 'air'"},
      {"control: gas, range: [0, 2]", "must be greater than 0, not 0"},
      {"control: gas, range: [1, 2], liquid: {bulk_modulus: 1}", "'liquid' belongs to 'control: liquid'"},
      {"control: liquid, range: [1, 2]", "needs key 'liquid'"},
      {"control: liquid, range: [1, 2], liquid: {}", "needs one of 'bulk_modulus', 'compressibility'"},
      {"control: liquid, range: [1, 2], liquid: {bulk_modulus: 1, compressibility: 1}", "both"},
      {"control: liquid, range: [1, 2], liquid: {bulk_modulus: 1}, source: {process: adiabatic}",
       "'process' is of a gas, not of a liquid"},
      {"control: gas, range: [1, 2], source: {process: slow}",
       "'process' must be one of 'isothermal', 'adiabatic', not 'slow'"},
      {"control: gas, range: [1, 2], source: {process: {exponent: 0}}", "must be greater than 0, not 0"},
      {"control: gas, range: [1, 2], source: {syringe_mL: 0}", "must be greater than 0, not 0"},
      {"control: gas, range: [1, 2], source: {dead_mL: -1}", "'dead_mL'"},
      {"control: gas, range: [1, 2], source: {volume: 1}", "unknown key 'volume'"},
      {"control: volume, range: [1, 2], source: {dead_mL: 1}",
       "'source' belongs to 'control: gas' and 'control: liquid'"},
      {"control: pressure, range: [1, 2], liquid: {bulk_modulus: 1}", "'liquid' belongs to 'control: liquid'"},
      {"control: gas, range: [1, 2], factor: 2", "'factor' belongs to 'control: tension' and 'control: pressure'"},
      {"control: gas, range: [1, 2], curve: air.yaml", "what fills the chamber is controlled here"},
      {"control: gas, range: [1, 2], connected: [a]", "must hold at least 2 regions"},
      {"control: gas, range: [1, 2], connected: [a, b], region: c", "'connected'"},
      {"control: gas, range: [1, 2], connected: [a, b], surface: c.stl", "'connected'"}};
  for (const auto& [actuator, message] : cases) {
    const std::string found = refusal_of_sealed(actuator);
    EXPECT_NE(found.find(message), std::string::npos) << actuator << ": " << found;
    EXPECT_EQ(found.find("robots/finger.yaml:5: "), 0u) << found;
  }
  EXPECT_NE(
      refusal_of_sealed("control: gas, range: [1, 2]", "atmosphere: 0\n").find("finger.yaml:4: 'atmosphere' must be"),
      std::string::npos);
  EXPECT_NE(refusal_of_sealed("control: gas, range: [1, 2]", "formulation: target-shape\n")
                .find("control 'gas' belongs to the physical formulation"),
            std::string::npos);
}

}  // namespace softkin
