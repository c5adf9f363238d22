#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <softkin/drive/use.hpp>

#include "../support/syringe_pump.hpp"
#include "drive_samples.hpp"

namespace softkin::drive {
namespace {

using testing::ClosedAir;

/// A chamber of 20 mL, ratios 0.5 to 2, commanded by its volume.
Model one_chamber() {
  Model model;
  Actuator actuator;
  actuator.name = "air";
  actuator.drive = ChamberDrive{};
  actuator.low = 0.5;
  actuator.high = 2;
  actuator.rest_measure = 20'000;
  model.actuators.push_back(actuator);
  return model;
}

/// 40 mL of 340 mm^2 on a tube of 5 mL, which leaves 117.6 mm of travel.
HardwareSpec one_syringe() {
  HardwareSpec hardware;
  hardware.file = "hardware.yaml";
  SyringeSpec syringe;
  syringe.origin = {"hardware.yaml", 3};
  syringe.actuator = "air";
  syringe.axis = 'Z';
  syringe.syringe_mL = 40;
  syringe.dead_volume_mL = 5;
  syringe.mL_per_mm = 0.34;
  syringe.max_speed_mm_per_s = 1000;
  syringe.max_acceleration_mm_per_s2 = 1e5;
  hardware.syringes.push_back(syringe);
  return hardware;
}

struct RatioAt {
  double ratio = 1, gauge_kpa = 0;
};

/// Lines 2, 3, ..., a second each.
Commands air_commands(const std::vector<RatioAt>& rows, bool known = true) {
  Commands commands{"commands.csv", {true}, {known}, {}};
  for (std::size_t i = 0; i < rows.size(); ++i)
    commands.rows.push_back({Eigen::VectorXd::Constant(1, rows[i].ratio),
                             Eigen::VectorXd::Constant(1, known ? rows[i].gauge_kpa : 0), static_cast<double>(i),
                             i + 2});
  return commands;
}

void expect_refused(const Model& model, const HardwareSpec& hardware, const Commands& commands,
                    const std::string& part) {
  try {
    (void)make_plan(model, hardware, commands, false);
    ADD_FAILURE() << "accepted; expected " << part;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

/// 65 mL of air at 100 kPa are 52 mL at 125 kPa: 24 mL in the chamber at 1.2, 5 mL in the tube, so that 23 of 40 mL are
/// left in the syringe: 17 mL are out, 50 mm of its plunger.
TEST(Syringe, StandsWhereTheGasLawSays) {
  const Machine machine = assemble(one_chamber(), one_syringe(), air_commands({{1, 0}}));
  const Syringe& syringe = machine.syringes.at(0);
  EXPECT_NEAR(syringe.plunger_mm(1.2, 25), 50, 1e-9 * 50);
  EXPECT_NEAR(syringe.ratio(50, 25), 1.2, 1e-9);
  EXPECT_EQ(syringe.plunger_mm(1, 0), 0);
  // 65 mL at 80 kPa are 81.25 mL; 18 in the chamber at 0.9, 5 in the tube: 58.25 in the syringe, 18.25 more than at
  // rest
  EXPECT_NEAR(syringe.plunger_mm(0.9, -20), -18.25 / 0.34, 1e-9 * 60);
  for (const double atmosphere : {80.0, 101.325})
    for (const double gauge : {-30.0, 7.0, 150.0})
      for (const double ratio : {0.7, 1.0, 1.9}) {
        HardwareSpec hardware = one_syringe();
        hardware.atmosphere_kPa = atmosphere;
        hardware.syringes[0].chamber_mL = 12.5;
        const Syringe other = assemble(one_chamber(), hardware, air_commands({{1, 0}})).syringes.at(0);
        const double air_ml = (12.5 + 5 + 40) * atmosphere / (atmosphere + gauge);
        const double left_ml = air_ml - ratio * 12.5 - 5;
        EXPECT_NEAR(other.plunger_mm(ratio, gauge) * 340, (40 - left_ml) * 1000, 1e-9 * 1e5);
      }
}

TEST(Syringe, UsesDefaultsAndSaysSo) {
  HardwareSpec hardware = one_syringe();
  hardware.syringes[0].dead_volume_mL.reset();
  hardware.syringes[0].max_speed_mm_per_s.reset();
  hardware.syringes[0].max_acceleration_mm_per_s2.reset();
  const Machine machine = assemble(one_chamber(), hardware, air_commands({{1, 0}}));
  EXPECT_EQ(machine.defaults.at(1), "air: atmosphere_kPa 100");
  EXPECT_EQ(
      machine.defaults.at(2),
      "syringe 'air': chamber_mL 20, dead_volume_mL 0, steps_per_mm 80, lead_mm none (a mm of the axis is a mm of "
      "plunger), direction 1, backlash_mm 0, travel_limits_mm [0, 117.647] (what the syringe holds), limits_kPa "
      "none, max_speed_mm_per_s 5, max_acceleration_mm_per_s2 50");
  EXPECT_EQ(machine.syringes[0].max_speed_mm_per_s, 5);
}

/// 50 mm are 6.25 turns of a screw of 8 mm: 20,000 of 3200 steps a turn, 200 mm of an axis of 100 steps a mm.
TEST(Syringe, ScrewsTurn) {
  HardwareSpec hardware = one_syringe();
  hardware.syringes[0].lead_mm = 8;
  hardware.syringes[0].steps_per_mm = 100;
  hardware.syringes[0].direction = -1;
  const Plan plan = make_plan(one_chamber(), hardware, air_commands({{1, 0}, {1.2, 25}, {1.2, 25}, {1, 0}}), false);
  ASSERT_EQ(plan.program.lines.size(), 3u);
  EXPECT_EQ(plan.program.axes, "Z");
  EXPECT_EQ(plan.program.lines[0].text, "G1 Z-200 F12000");
  EXPECT_EQ(plan.program.lines[1].text, "G4 P1000");
  EXPECT_EQ(plan.program.lines[2].text, "G1 Z0 F12000");
  const std::string text = gcode_text(plan.machine, plan.program);
  EXPECT_NE(text.find("; Home of a plunger: its chamber at rest"), std::string::npos) << text;
  EXPECT_NE(text.find("; Z: syringe 'air', 4 mm of axis per mm of plunger, 100 steps per mm of axis"),
            std::string::npos);
  EXPECT_NE(text.find("M92 Z100\nM201 Z400000\nM203 Z4000\n"), std::string::npos) << text;
  const SyringeUse use = use_of_syringe(plan, 0);
  EXPECT_EQ(use.lowest, -20'000);
  EXPECT_NEAR(*use.turns, 6.25, 1e-9);
  EXPECT_NEAR(use.fastest_mm_per_s, 50, 1e-9);
}

/// A cable and a plunger go in one G1 and arrive together.
TEST(Syringe, MovesBesideATendon) {
  Model model = testing::two_tendons();
  model.actuators[1] = one_chamber().actuators[0];
  HardwareSpec hardware = testing::two_motors();
  hardware.tendons.pop_back();
  hardware.syringes = one_syringe().syringes;
  Commands commands = testing::two_commands({{1, 1}, {0.5, 1.2}}, {0, 2});
  commands.pressure_known[1] = true;
  commands.rows[1].pressures_kpa[1] = 25;
  const Plan plan = make_plan(model, hardware, commands, false);
  EXPECT_EQ(plan.program.axes, "XZ");
  ASSERT_EQ(plan.program.lines.size(), 1u);
  // 20 mm of cable and 50 mm of plunger in 2 s
  EXPECT_EQ(plan.program.lines[0].text.rfind("G1 X20 Z50 F", 0), 0u) << plan.program.lines[0].text;
  EXPECT_NEAR(std::stod(plan.program.lines[0].text.substr(12)), 30 * std::hypot(20.0, 50.0), 1e-3);
}

/// What is pushed of a sealed chamber needs no pressure: 17 mL are 50 mm of 340 mm^2. Its air is the scene's.
TEST(Syringe, PushesWhatASealedChamberIsCommandedBy) {
  Model model = one_chamber();
  Actuator& air = model.actuators[0];
  air.control = Control::filling;
  air.low = -5;
  air.high = 40;
  Filling& filling = std::get<ChamberDrive>(air.drive).filling.emplace();
  filling = {
      .pushed = true, .atmosphere_MPa = 0.101325, .dead_mm3 = 5000, .syringe_mm3 = 40'000, .chamber_mm3 = 20'000};
  const Commands commands = air_commands({{0, 0}, {17, 0}, {-3.4, 0}}, false);
  HardwareSpec pulled = one_syringe();
  pulled.syringes[0].travel_limits_mm = {{-20, 100}};
  const Plan plan = make_plan(model, pulled, commands, false);
  ASSERT_EQ(plan.program.lines.size(), 2u);
  EXPECT_EQ(plan.program.lines[0].text.rfind("G1 Z50 F", 0), 0u) << plan.program.lines[0].text;
  EXPECT_EQ(plan.program.lines[1].text.rfind("G1 Z-10 F", 0), 0u) << plan.program.lines[1].text;
  const std::vector<PlungerRow> rows = plunger_rows(plan, 0);
  EXPECT_NEAR(rows[1].reached, 17, 1e-9);
  EXPECT_NEAR(use_of_syringe(plan, 0).error, 0, 1e-9);
  for (const std::string& line : plan.machine.defaults)
    EXPECT_EQ(line.find("atmosphere_kPa"), std::string::npos) << line;

  HardwareSpec other = one_syringe();
  other.syringes[0].syringe_mL = 50;
  expect_refused(model, other, commands,
                 "hardware.yaml:3: syringe 'air': syringe_mL is 50 mL, but 40 mL in the scene: give both the same");
  other = one_syringe();
  other.atmosphere_kPa = 100;
  expect_refused(model, other, commands, "atmosphere_kPa is 100 kPa, but 101.325 kPa in the scene");
  other = one_syringe();
  other.syringes[0].limits_kpa = {{-5, 20}};
  expect_refused(model, other, commands, "limits_kPa cannot be kept");
  filling.pushed = false;
  expect_refused(
      model, one_syringe(), commands,
      "commands.csv: chamber 'air' is commanded by its amount of gas, and a plunger sets what it has pushed");
  other = HardwareSpec();
  other.file = "hardware.yaml";
  expect_refused(model, other, commands, "a regulator sets pressures");
}

TEST(Syringe, RefusesRowsByLine) {
  HardwareSpec hardware = one_syringe();
  const Model model = one_chamber();
  hardware.syringes[0].travel_limits_mm = {{-10, 49}};
  expect_refused(model, hardware, air_commands({{1, 0}, {1.2, 25}}),
                 "commands.csv:3: syringe 'air': plunger 50 mm from home (ratio 1.2 at 25 kPa) is above its limit of "
                 "49 mm (hardware.yaml:3)");
  expect_refused(model, hardware, air_commands({{1, 0}, {0.9, -20}}), "is below its limit of -10 mm");
  hardware = one_syringe();
  hardware.syringes[0].limits_kpa = {{-5, 20}};
  expect_refused(model, hardware, air_commands({{1, 0}, {1.2, 25}}),
                 "commands.csv:3: syringe 'air': pressure 25 kPa is above its limit of 20 kPa (hardware.yaml:3)");
  expect_refused(model, hardware, air_commands({{1, -6}}), "pressure -6 kPa is below its limit of -5 kPa");
  hardware = one_syringe();
  expect_refused(model, hardware, air_commands({{1, -100}}),
                 "commands.csv:2: syringe 'air': pressure -100 kPa (gauge) is not above vacuum, which is -100 kPa");
  hardware.syringes[0].max_speed_mm_per_s = 49;
  expect_refused(model, hardware, air_commands({{1, 0}, {1.2, 25}}),
                 "commands.csv:3: syringe 'air': 50 mm/s to reach this row is above its limit of 49 mm/s");
  hardware = one_syringe();
  hardware.syringes[0].max_acceleration_mm_per_s2 = 40;
  expect_refused(model, hardware, air_commands({{1, 0}, {1.2, 25}}),
                 "takes 100 mm/s^2, above its limit of 40 mm/s^2 (hardware.yaml:3)");
  hardware = one_syringe();
  hardware.syringes[0].travel_limits_mm = {{0, 118}};
  expect_refused(model, hardware, air_commands({{1, 0}}),
                 "hardware.yaml:3: syringe 'air': a plunger at 118 mm would have pushed out more than the 40 mL of the "
                 "syringe, which end at 117.647 mm");
}

TEST(Syringe, RefusesChambersWithoutPressureOrVolume) {
  Model model = one_chamber();
  expect_refused(model, one_syringe(), air_commands({{1, 0}}, false),
                 "commands.csv: chamber 'air' is commanded by its volume, and its plunger's place depends on its "
                 "pressure, too: add a column 'air_pressure_kPa'");
  model.actuators[0].control = Control::load;
  expect_refused(model, one_syringe(), air_commands({{1, 0}}, false),
                 "chamber 'air' is commanded by its pressure, and its syringe needs its volume, too");
  model.actuators[0].drive = CableDrive{};
  model.actuators[0].control = Control::ratio;
  expect_refused(model, one_syringe(), air_commands({{1, 0}}, false),
                 "hardware.yaml:3: actuator 'air' stands in 'syringes' but is no chamber");
  HardwareSpec empty = one_syringe();
  empty.syringes.clear();
  expect_refused(one_chamber(), empty, air_commands({{1, 0}}), "has no entry in 'chambers' or 'syringes'");
}

ActuatorCurve straight_curve() {
  return {"air.yaml", CurveInput::pressure, 100, "", {MonotoneCurve({0, 50}, {1, 1.4}), {}}, {}};
}

/// At half the height of the curve the pressure is 25 kPa, and so the plunger is at 50 mm, whether the commands contain
/// the pressure or not.
TEST(Syringe, TakesMeasuredCurves) {
  Model model = one_chamber();
  model.actuators[0].curve = straight_curve();
  const Plan plan = make_plan(model, one_syringe(), air_commands({{1, 0}, {1.2, 0}}, false), false);
  EXPECT_NEAR(plan.commands.rows[1].pressures_kpa[0], 25, 1e-9);
  EXPECT_EQ(plan.program.lines.at(0).text, "G1 Z50 F3000");
  expect_refused(model, one_syringe(), air_commands({{1, 0}, {1.41, 0}}, false),
                 "commands.csv:3: chamber 'air': the loading branch of curve air.yaml does not reach ratio 1.41");
  // pressures of the commands take precedence
  const Plan reported = make_plan(model, one_syringe(), air_commands({{1, 0}, {1.2, 30}}), false);
  EXPECT_EQ(reported.commands.rows[1].pressures_kpa[0], 30);
}

/// Where the board leaves the axis after each line, read from the text alone.
std::vector<double> axis_after(const GcodeProgram& program) {
  std::vector<double> places;
  for (const GcodeLine& line : program.lines) {
    const std::size_t at = line.text.find(" Z");
    places.push_back(at == std::string::npos ? (places.empty() ? 0 : places.back())
                                             : std::stod(line.text.substr(at + 2)));
  }
  return places;
}

/// A simulated pump: the G-code's places, play in the screw, closed air with a dead volume and a chamber that stiffens.
/// The chamber reaches the commanded ratios within 0.1 % and those of the dry run; without the dead volume it does not.
TEST(Syringe, BringsAChamberToItsRatio) {
  const auto chamber_kpa = [](double ratio) { return 100 + 120 * (ratio - 1) + 300 * std::pow(ratio - 1, 3); };
  const ClosedAir air{20, 5, 40, 100};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0.95, 1.4);
  std::vector<RatioAt> rows{{1, 0}};
  while (rows.size() < 100) {
    rows.push_back({any(random), 0});
    rows.back().gauge_kpa = chamber_kpa(rows.back().ratio) - 100;
  }
  HardwareSpec hardware = one_syringe();
  hardware.syringes[0].backlash_mm = 0.7;
  hardware.syringes[0].lead_mm = 8;
  hardware.syringes[0].travel_limits_mm = {{-30, 110}};
  const auto worst_of = [&](const HardwareSpec& bench) {
    const Plan plan = make_plan(one_chamber(), bench, air_commands(rows), false);
    const std::vector<double> places = axis_after(plan.program);
    const std::vector<PlungerRow> reported = plunger_rows(plan, 0);
    EXPECT_EQ(places.size(), rows.size() - 1);
    double plunger = 0, worst = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double motor = places[i] / 5;  // 3200 steps of 1/80 mm a turn of 8 mm
      if (plunger < motor) plunger = motor;
      if (plunger > motor + 0.7) plunger = motor + 0.7;
      const double steady = testing::equilibrium_ratio(air, 0.34 * plunger, chamber_kpa, 0.5, 2);
      worst = std::max(worst, std::abs(steady / rows[i + 1].ratio - 1));
      EXPECT_NEAR(reported[i + 1].plunger_mm, plunger, 1e-9);
      EXPECT_NEAR(reported[i + 1].volume_mm3, 340 * plunger, 1e-6);
      // by Eq. (19) at the commanded pressure: a chamber stiffer than a free one stays nearer
      if (bench.syringes[0].dead_volume_mL) {
        EXPECT_NEAR(reported[i + 1].reached, steady, 1e-4);
      }
    }
    return worst;
  };
  EXPECT_LT(worst_of(hardware), 1e-3);
  EXPECT_LT(worst_of(hardware), 3e-5);  // half a step of 1/400 mm
  hardware.syringes[0].dead_volume_mL.reset();
  EXPECT_GT(worst_of(hardware), 1e-2);
}

/// Moves of fewer than 6 steps wait, and the dry run reports where the plunger then is.
TEST(Syringe, SaysWhereSmallMovesLead) {
  const Plan plan = make_plan(one_chamber(), one_syringe(), air_commands({{1, 0}, {1.0005, 0}, {1.2, 25}}), false);
  const std::vector<PlungerRow> rows = plunger_rows(plan, 0);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1].plunger_mm, 0);  // 10 mm^3 are 0.03 mm, 2 steps
  EXPECT_EQ(rows[1].reached, 1);
  EXPECT_EQ(rows[2].plunger_mm, 50);
  EXPECT_NEAR(use_of_syringe(plan, 0).error, 0.0005, 1e-12);
}

}  // namespace
}  // namespace softkin::drive
