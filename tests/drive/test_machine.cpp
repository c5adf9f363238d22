#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <softkin/drive/plan.hpp>
#include <softkin/io/scene/hardware.hpp>

#include "drive_samples.hpp"

namespace softkin::drive {
namespace {

using testing::two_commands;
using testing::two_motors;
using testing::two_tendons;

template <class Run>
void expect_refused(const Run& run, const std::string& part) {
  try {
    run();
    ADD_FAILURE() << "accepted; expected " << part;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

class HardwareFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  HardwareSpec read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return read_hardware(path_);
  }
  /// The message begins with file and line; what is wrong may stand behind the name of the key.
  void refused(const std::string& text, std::size_t line, const std::string& message) {
    expect_refused([&] { (void)read(text); }, path_.string() + ":" + std::to_string(line) + ": ");
    expect_refused([&] { (void)read(text); }, message);
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("softkin_hardware_" + std::to_string(::getpid()) + ".yaml");
};

TEST_F(HardwareFile, IsReadWhole) {
  const HardwareSpec spec = read(
      "softkin_hardware: 1\n"
      "board: {configure: false, approach_speed_mm_per_s: 3}\n"
      "tendons:\n"
      "  - {actuator: a, axis: Z, rest_length_mm: 41.5, drum_radius_mm: 6, steps_per_revolution: 6400,\n"
      "     steps_per_mm: 100, direction: -1, slack_offset_mm: 2, backlash_mm: 0.3, length_limits_mm: [20, 40],\n"
      "     max_speed_mm_per_s: 12, max_acceleration_mm_per_s2: 90}\n"
      "  - {actuator: b, axis: A}\n"
      "chambers: [{actuator: air, channel: pump1, limits_kPa: [-20, 80]}]\n"
      "atmosphere_kPa: 98.5\n"
      "syringes:\n"
      "  - {actuator: c, axis: B, chamber_mL: 19, syringe_mL: 60, dead_volume_mL: 1.5, plunger_area_mm2: 660,\n"
      "     lead_mm: 8, steps_per_revolution: 1600, steps_per_mm: 90, direction: -1, backlash_mm: 0.1,\n"
      "     travel_limits_mm: [-9, 80], limits_kPa: [-30, 150], max_speed_mm_per_s: 6, max_acceleration_mm_per_s2: "
      "70}\n"
      "  - {actuator: d, axis: C, syringe_mL: 20, mL_per_mm: 0.3}\n");
  EXPECT_EQ(spec.configure, false);
  EXPECT_EQ(spec.approach_speed_mm_per_s, 3);
  ASSERT_EQ(spec.tendons.size(), 2u);
  const TendonSpec& a = spec.tendons[0];
  EXPECT_EQ(a.actuator, "a");
  EXPECT_EQ(a.origin.line, 4u);
  EXPECT_EQ(a.axis, 'Z');
  EXPECT_EQ(a.rest_length_mm, 41.5);
  EXPECT_EQ(a.drum_radius_mm, 6);
  EXPECT_EQ(a.steps_per_revolution, 6400);
  EXPECT_EQ(a.steps_per_mm, 100);
  EXPECT_EQ(a.direction, -1);
  EXPECT_EQ(a.slack_offset_mm, 2);
  EXPECT_EQ(a.backlash_mm, 0.3);
  EXPECT_EQ((*a.length_limits_mm)[1], 40);
  EXPECT_EQ(a.max_speed_mm_per_s, 12);
  EXPECT_EQ(a.max_acceleration_mm_per_s2, 90);
  EXPECT_FALSE(spec.tendons[1].backlash_mm.has_value());
  ASSERT_EQ(spec.chambers.size(), 1u);
  EXPECT_EQ(spec.chambers[0].channel, "pump1");
  EXPECT_EQ((*spec.chambers[0].limits_kpa)[0], -20);
  EXPECT_EQ(spec.atmosphere_kPa, 98.5);
  ASSERT_EQ(spec.syringes.size(), 2u);
  const SyringeSpec& c = spec.syringes[0];
  EXPECT_EQ(c.actuator, "c");
  EXPECT_EQ(c.origin.line, 11u);
  EXPECT_EQ(c.axis, 'B');
  EXPECT_EQ(c.chamber_mL, 19);
  EXPECT_EQ(c.syringe_mL, 60);
  EXPECT_EQ(c.dead_volume_mL, 1.5);
  EXPECT_DOUBLE_EQ(c.mL_per_mm, 0.66);
  EXPECT_EQ(c.lead_mm, 8);
  EXPECT_EQ(c.steps_per_revolution, 1600);
  EXPECT_EQ(c.steps_per_mm, 90);
  EXPECT_EQ(c.direction, -1);
  EXPECT_EQ(c.backlash_mm, 0.1);
  EXPECT_EQ((*c.travel_limits_mm)[0], -9);
  EXPECT_EQ((*c.limits_kpa)[1], 150);
  EXPECT_EQ(c.max_speed_mm_per_s, 6);
  EXPECT_EQ(c.max_acceleration_mm_per_s2, 70);
  EXPECT_EQ(spec.syringes[1].mL_per_mm, 0.3);
  EXPECT_FALSE(spec.syringes[1].dead_volume_mL.has_value());
}

TEST_F(HardwareFile, RefusesSyringesByLine) {
  const std::string head = "softkin_hardware: 1\nsyringes:\n  - ";
  const auto syringe = [&](const std::string& more, const std::string& message) {
    refused(head + "{actuator: a, axis: X, " + more + "}\n", 3, message);
  };
  const std::string whole = "syringe_mL: 60, mL_per_mm: 0.6, ";
  syringe("mL_per_mm: 0.6", "needs key 'syringe_mL'");
  syringe("syringe_mL: 60", "needs key 'plunger_area_mm2' or 'mL_per_mm'");
  syringe(whole + "plunger_area_mm2: 600", "has both 'plunger_area_mm2' and 'mL_per_mm': give one of them");
  syringe("syringe_mL: 0, mL_per_mm: 0.6", "must be greater than 0");
  syringe("syringe_mL: 60, plunger_area_mm2: -3", "must be greater than 0");
  syringe(whole + "dead_volume_mL: -1", "must be 0 or more, not -1");
  syringe(whole + "dead_volume_ml: 1", "did you mean 'dead_volume_mL'?");
  syringe(whole + "steps_per_revolution: 3200", "steps_per_revolution needs lead_mm beside it");
  syringe(whole + "lead_mm: 0", "must be greater than 0");
  syringe(whole + "travel_limits_mm: [9, 0]", "must be [low, high], but 9 is above 0");
  syringe(whole + "limits_kPa: [9, 0]", "9 is above 0");
  syringe(whole + "chamber_mL: .inf", "must be a finite number");
  refused("softkin_hardware: 1\natmosphere_kPa: 0\n", 2, "must be greater than 0");
  refused("softkin_hardware: 1\ntendons: [{actuator: a, axis: X}]\nsyringes: [{actuator: b, axis: X, " + whole + "}]\n",
          3, "the name 'X' is taken; it is given in line 2");
  refused("softkin_hardware: 1\nchambers: [{actuator: a}]\nsyringes: [{actuator: b, axis: U, " + whole +
              "}, {actuator: c, axis: A, " + whole + "}]\n",
          3, "axes A and U");
  refused("softkin_hardware: 1\nsyringes: [{actuator: a, axis: X, " + whole + "}]\nchambers: [{actuator: a}]\n", 3,
          "the name 'a' is taken; it is given in line 2");
}

TEST_F(HardwareFile, RefusesByLine) {
  const std::string head = "softkin_hardware: 1\ntendons:\n  - ";
  const auto tendon = [&](const std::string& more, const std::string& message) {
    refused(head + "{actuator: a, axis: X, " + more + "}\n", 3, message);
  };
  refused("tendons: []\n", 1, "a hardware file needs key 'softkin_hardware'");
  refused("softkin_hardware: 2\n", 1, "this version of softkin reads hardware of version 1, not 2");
  refused("- 1\n", 1, "a hardware file must be a map");
  refused("softkin_hardware: 1\nmotors: []\n", 2, "unknown key 'motors'");
  tendon("drum_radius_cm: 0.6", "unknown key 'drum_radius_cm'");
  tendon("drum_radius_cm: 0.6", "did you mean 'drum_radius_mm'?");
  tendon("max_speed_mm_per_min: 600", "did you mean 'max_speed_mm_per_s'?");
  tendon("drum_radius_mm: 6mm", "'drum_radius_mm' must be a finite number, not '6mm'");
  tendon("drum_radius_mm: 0", "must be greater than 0");
  tendon("steps_per_revolution: 3200", "steps_per_revolution needs drum_radius_mm beside it");
  tendon("steps_per_mm: .nan", "must be a finite number");
  tendon("direction: 2", "must be 1 or -1, not 2");
  tendon("slack_offset_mm: -1", "must be 0 or more, not -1");
  tendon("backlash_mm: -0.1", "must be 0 or more, not -0.1");
  tendon("length_limits_mm: [40, 20]", "must be [low, high], but 40 is above 20");
  tendon("length_limits_mm: [0, 20]", "must be greater than 0");
  tendon("max_speed_mm_per_s: 0", "must be greater than 0");
  refused(head + "{actuator: a}\n", 3, "entry 1 of 'tendons' needs key 'axis'");
  refused(head + "{actuator: a, axis: E}\n", 3, "must not be E");
  refused(head + "{actuator: a, axis: XY}\n", 3, "must be one of the letters X, Y, Z, A, B, C, U, V, W, not 'XY'");
  refused(head + "{actuator: a, axis: X}\n  - {actuator: a, axis: Y}\n", 4,
          "the name 'a' is taken; it is given in line 3");
  refused(head + "{actuator: a, axis: X}\n  - {actuator: b, axis: X}\n", 4,
          "the name 'X' is taken; it is given in line 3");
  refused(head + "{actuator: a, axis: A}\n  - {actuator: b, axis: U}\n", 3, "axes A and U");
  refused("softkin_hardware: 1\nboard: {configure: maybe}\n", 2, "must be one of 'false', 'true', not 'maybe'");
  refused("softkin_hardware: 1\nchambers:\n  - {actuator: air, limits_psi: [0, 9]}\n", 3, "unknown key 'limits_psi'");
  refused("softkin_hardware: 1\nchambers:\n  - {actuator: air, limits_kPa: [9, 0]}\n", 3, "9 is above 0");
}

TEST(Machine, UsesDefaultsAndSaysSo) {
  const Machine machine = assemble(two_tendons(), two_motors(), two_commands({{1, 1}}));
  ASSERT_EQ(machine.tendons.size(), 2u);
  const Tendon& a = machine.tendons[0];
  EXPECT_EQ(a.rest_length_mm, 40);
  EXPECT_EQ(a.shortest_mm, 20);
  EXPECT_EQ(a.longest_mm, 40);
  EXPECT_EQ(a.max_speed_mm_per_s, 50);
  EXPECT_EQ(a.steps(10), 800);  // 80 steps per mm of cable
  ASSERT_EQ(machine.defaults.size(), 3u);
  EXPECT_EQ(machine.defaults[0], "board: configure true, approach_speed_mm_per_s 5");
  EXPECT_EQ(machine.defaults[1],
            "tendon 'a': rest_length_mm 40, steps_per_mm 80, drum_radius_mm none (a mm of the axis is a mm of cable), "
            "direction 1, slack_offset_mm 0, backlash_mm 0, length_limits_mm [20, 40] (the actuator's range), "
            "max_speed_mm_per_s 50, max_acceleration_mm_per_s2 500");
}

TEST(Machine, DrumsTurn) {
  HardwareSpec hardware = two_motors();
  hardware.tendons[0].drum_radius_mm = 6;
  hardware.tendons[0].steps_per_mm = 25;
  hardware.tendons[0].direction = -1;
  hardware.tendons[0].slack_offset_mm = 3;
  const Tendon a = assemble(two_tendons(), hardware, two_commands({{1, 1}})).tendons[0];
  EXPECT_DOUBLE_EQ(a.wound_mm(30), 13);  // 40 at rest, 3 slack
  const double turn_mm = 2 * std::numbers::pi * 6;
  EXPECT_NEAR(a.steps(turn_mm), -3200, 1e-9);  // whatever the board calls a mm
  EXPECT_NEAR(a.axis_mm_per_mm * turn_mm * 25, 3200, 1e-9);
}

TEST(Machine, RefusesWhatDoesNotFit) {
  const auto refused = [](const Model& model, const HardwareSpec& hardware, Commands commands,
                          const std::string& part) {
    expect_refused([&] { (void)assemble(model, hardware, commands); }, part);
  };
  const Commands commands = two_commands({{1, 1}});
  HardwareSpec hardware = two_motors();
  hardware.tendons[1].actuator = "bb";
  refused(two_tendons(), hardware, commands, "hardware.yaml:4: the scene has no actuator 'bb'; did you mean 'b'?");
  hardware.tendons.pop_back();
  refused(two_tendons(), hardware, commands,
          "hardware.yaml: actuator 'b', which commands.csv commands, has no entry in 'tendons'");
  Model model = two_tendons();
  model.actuators[0].control = Control::load;
  refused(model, two_motors(), commands, "commands.csv: cable 'a' is commanded by its tension");
  model.actuators[0].drive = DeaDrive{};
  refused(model, two_motors(), commands, "commands.csv: actuator 'a' is a dielectric elastomer");
  model.actuators[0] = two_tendons().actuators[0];
  model.actuators[0].drive = ChamberDrive{};
  refused(model, two_motors(), commands, "commands.csv: chamber 'a' is commanded by its volume");
  refused(model, two_motors(), commands, "'a_pressure_kPa'");
  model.actuators[0].control = Control::load;
  refused(model, two_motors(), commands, "hardware.yaml:3: actuator 'a' stands in 'tendons' but is no cable");
}

TEST(PressureSchedule, FollowsTheCommandsWithinLimits) {
  Model model;
  model.actuators.resize(2);
  for (Actuator& chamber : model.actuators) chamber.drive = ChamberDrive{};
  model.actuators[0].name = "air";
  model.actuators[0].control = Control::load;
  model.actuators[1].name = "tail";  // commanded by volume, its pressures known
  HardwareSpec hardware;
  hardware.file = "hardware.yaml";
  hardware.chambers = {{{"hardware.yaml", 3}, "air", "pump1", std::array<double, 2>{-10, 60}},
                       {{"hardware.yaml", 4}, "tail", {}, {}}};
  Commands commands{"commands.csv", {true, true}, {false, true}, {}};
  for (int i = 0; i < 3; ++i)
    commands.rows.push_back({Eigen::Vector2d(20 * i - 5, 1 + 0.1 * i), Eigen::Vector2d(0, 7.5 * i), 0.5 * i,
                             static_cast<std::size_t>(i + 2)});
  const Machine machine = assemble(model, hardware, commands);
  EXPECT_EQ(machine.defaults.back(), "chamber 'tail': channel 'tail', limits_kPa [0, 100]");
  EXPECT_EQ(schedule_csv(plan_pressures(machine, commands)), "t_s,pump1_kPa,tail_kPa\n0,-5,0\n0.5,15,7.5\n1,35,15\n");
  commands.rows[1].actuation[0] = 60.5;
  expect_refused([&] { (void)plan_pressures(machine, commands); },
                 "commands.csv:3: chamber 'air': pressure 60.5 kPa is above its limit of 60 kPa (hardware.yaml:3)");
  commands.rows[1].actuation[0] = -10.5;
  expect_refused([&] { (void)plan_pressures(machine, commands); }, "is below its limit of -10 kPa");
  for (CommandRow& row : commands.rows) row.time_s.reset();
  expect_refused([&] { (void)plan_pressures(machine, commands); }, "commands.csv: has no column t_s [s]");
}

}  // namespace
}  // namespace softkin::drive
