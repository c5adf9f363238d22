#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <softkin/runs/chamber_json.hpp>

namespace softkin::runs {
namespace {

/// 2 and 3 mL on one pipe with 1 mL of tubes and a syringe of 4 mL.
Actuator two_chambers() {
  Actuator actuator;
  actuator.name = "air";
  actuator.control = Control::filling;
  actuator.rest_measure = 5000;
  actuator.drive = ChamberDrive{
      .filling =
          Filling{.pushed = true, .atmosphere_MPa = 0.1, .dead_mm3 = 1000, .syringe_mm3 = 4000, .chamber_mm3 = 5000},
      .connected = {{"left", 12}, {"right", 24}}};
  return actuator;
}

}  // namespace

/// As Boyle has it: 10 mL at 100 kPa are 8 mL at 125 kPa, whatever is where.
TEST(ChamberJson, VolumesAndAmountsThere) {
  const Actuator air = two_chambers();
  ActuatorRecord record{3.5, 1.3};
  record.multiplier = 25;
  record.volumes_mL = {2.5, 4.0};
  const Json json = chamber_json(air, record);
  EXPECT_DOUBLE_EQ(json.at("volume_mL"), 6.5);
  EXPECT_DOUBLE_EQ(json.at("amount_mL"), 10);
  EXPECT_EQ(json.at("volumes_mL"), Json::parse(R"({"left": 2.5, "right": 4.0})"));
  ActuatorRecord read;
  read_chamber(air, json, read);
  EXPECT_EQ(read.volumes_mL, record.volumes_mL);
  Actuator amount = air;
  Filling& filling = *std::get<ChamberDrive>(amount.drive).filling;
  filling.pushed = false;
  filling.syringe_mm3 = 0;
  EXPECT_DOUBLE_EQ(chamber_json(amount, record).at("amount_mL"), (6.5 + 1) * 1.25);
}

TEST(ChamberJson, WhatIsNotKnownIsNull) {
  ActuatorRecord record{3.5, std::numeric_limits<double>::quiet_NaN()};
  record.volumes_mL = {2.5, std::numeric_limits<double>::quiet_NaN()};
  const Json json = chamber_json(two_chambers(), record);
  EXPECT_TRUE(json.at("volume_mL").is_null());
  EXPECT_TRUE(json.at("volumes_mL").at("right").is_null());
  Actuator by_volume;
  by_volume.drive = ChamberDrive{};
  EXPECT_TRUE(chamber_json(by_volume, record = {1.2, 1.2}).empty()) << "nothing of others";
}

}  // namespace softkin::runs
