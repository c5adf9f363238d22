#include <gtest/gtest.h>

#include <cmath>
#include <softkin/model/filling.hpp>
#include <softkin/model/names.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

/// The laws of what is sealed in a chamber, and what compile() makes of its description.

using namespace softkin;
using namespace softkin::testing;

namespace {

std::vector<Filling> fillings() {
  std::vector<Filling> all;
  for (const bool pushed : {false, true}) {
    for (const double exponent : {1.0, 1.4, 0.9})
      all.push_back(
          {.pushed = pushed, .exponent = exponent, .atmosphere_MPa = 0.1, .dead_mm3 = 300, .chamber_mm3 = 2000});
    all.push_back(
        {.liquid = true, .pushed = pushed, .compressibility = 0.5, .atmosphere_MPa = 0.1, .chamber_mm3 = 2000});
  }
  for (Filling& filling : all)
    if (filling.pushed) filling.syringe_mm3 = 1500;
  return all;
}

/// A cube of 30 mm around one of 10 mm, sealed.
RobotSpec sealed_cube() {
  RobotSpec spec = physical_robot(hollow_mesh());
  ActuatorSpec air = chamber("chamber");
  air.control = Control::filling;
  air.as<PneumaticSpec>()->filling = FillingSpec{};
  spec.actuators = {air};
  return spec;
}

}  // namespace

/// Volume, pressure and command from any two of them; derivatives and energy by differences.
TEST(Filling, LawsAndTheirDerivatives) {
  constexpr double h = 1e-5;
  for (const Filling& filling : fillings())
    for (const double command : {0.9, 1.3})
      for (const double pressure : {-0.04, 0.0, 0.15}) {
        const double volume = filling.volume(command, pressure);
        EXPECT_NEAR(filling.pressure(command, volume), pressure, 1e-12);
        EXPECT_NEAR(filling.command(volume, pressure), command, 1e-12);
        EXPECT_NEAR(filling.compliance(command, pressure),
                    -(filling.volume(command, pressure + h) - filling.volume(command, pressure - h)) / (2 * h),
                    1e-5 * filling.compliance(command, pressure));
        EXPECT_NEAR(filling.by_command(pressure),
                    (filling.volume(command + h, pressure) - filling.volume(command - h, pressure)) / (2 * h),
                    1e-6 * filling.by_command(pressure));
        const double step = 1e-3 * volume;
        EXPECT_NEAR((filling.energy(command, volume + step) - filling.energy(command, volume - step)) / (2 * step),
                    -pressure, 1e-5 * (filling.atmosphere_MPa + std::abs(pressure)));
        EXPECT_GE(filling.energy(command, volume), 0);
        const double all = filling.pushed ? (filling.liquid ? 3.5 : 3.8) : command;
        EXPECT_NEAR(filling.amount_mL(volume, pressure), all, 1e-12);
      }
}

TEST(Filling, NothingLeftAndAVacuum) {
  for (const Filling& filling : fillings()) {
    EXPECT_EQ(filling.exists(-0.11), filling.liquid);
    EXPECT_TRUE(filling.exists(-0.09));
    EXPECT_TRUE(std::isinf(filling.pressure(1, -1e4)));
    EXPECT_TRUE(std::isinf(filling.energy(1, -1e4)));
    EXPECT_NEAR(filling.volume(filling.rest(), 0), filling.chamber_mm3, 1e-9);
  }
}

/// At rest it has the amount that fills it; with a syringe nothing is pushed.
TEST(Filling, RestAndNames) {
  RobotSpec spec = sealed_cube();
  spec.actuators[0].as<PneumaticSpec>()->filling->dead_mL = 0.5;
  Model model = compile(spec);
  const Actuator& amount = model.actuators[0];
  EXPECT_NEAR(model.rest_actuation()[0], 1.5, 1e-12);
  EXPECT_EQ(std::string(control_name(amount)), "amount of gas");
  EXPECT_EQ(command_column(amount), "air_mL");
  EXPECT_EQ(command_text(amount, 2.5), "2.5 mL");
  EXPECT_EQ(multiplier_key(amount), "pressure_kPa");
  EXPECT_TRUE(answers_with_measure(amount));
  EXPECT_TRUE(answers_with_load(amount));
  ASSERT_FALSE(model.notes.empty());
  EXPECT_EQ(
      model.notes.back(),
      "Actuator 'air' is sealed at rest with 1.5 mL of gas under 101.325 kPa: 1 mL in its chamber, 0.5 mL of dead "
      "volume.");
  spec.actuators[0].as<PneumaticSpec>()->filling->syringe_mL = 4;
  model = compile(spec);
  EXPECT_EQ(std::string(control_name(model.actuators[0])), "pushed volume");
  EXPECT_EQ(model.rest_actuation()[0], 0.5) << "of its range, [0.5, 3]";
  EXPECT_NE(fingerprint_of(model), fingerprint_of(compile(sealed_cube())));
}

TEST(Filling, Refusals) {
  using Spec = RobotSpec&;
  expect_refused(
      sealed_cube(),
      {{"target shapes", [](Spec s) { s.formulation = Formulation::target_shape; }, "needs the physical formulation"},
       {"nothing in it", [](Spec s) { s.actuators[0].as<PneumaticSpec>()->filling.reset(); },
        "a chamber with a filling"},
       {"another control", [](Spec s) { s.actuators[0].control = Control::ratio; }, "takes nothing that fills it"},
       {"exponent", [](Spec s) { s.actuators[0].as<PneumaticSpec>()->filling->exponent = 0; },
        "an exponent of its gas above 0, not 0"},
       {"atmosphere", [](Spec s) { s.actuators[0].as<PneumaticSpec>()->filling->atmosphere_kPa = -1; },
        "an atmosphere above 0, not -1"},
       {"dead volume", [](Spec s) { s.actuators[0].as<PneumaticSpec>()->filling->dead_mL = NAN; },
        "a dead volume of 0 or more"},
       {"compressibility", [](Spec s) { s.actuators[0].as<PneumaticSpec>()->filling->compressibility = -1; },
        "a compressibility of 0"},
       {"syringe", [](Spec s) { s.actuators[0].as<PneumaticSpec>()->filling->syringe_mL = 0; },
        "a syringe's volume above 0"},
       {"no amount", [](Spec s) { s.actuators[0].low = 0; }, "0 < low <= high, not [0, 3]"},
       {"range", [](Spec s) { s.actuators[0].high = 0.1; }, "0 < low <= high, not [0.5, 0.1]"},
       {"too much", [](Spec s) { s.actuators[0].as<PneumaticSpec>()->filling->syringe_mL = 2; },
        "cannot push 3 mL out of a syringe of 2 mL"},
       {"factor", [](Spec s) { s.actuators[0].factor = 2; }, "takes no factor"},
       {"one chamber",
        [](Spec s) {
          s.actuators[0].as<PneumaticSpec>()->region.reset();
          s.actuators[0].as<PneumaticSpec>()->connected = {"chamber"};
        },
        "two connected chambers or more"},
       {"twice",
        [](Spec s) {
          s.actuators[0].as<PneumaticSpec>()->region.reset();
          s.actuators[0].as<PneumaticSpec>()->connected = {"chamber", "chamber"};
        },
        "has 'chamber' among its connected chambers twice"},
       {"both",
        [](Spec s) {
          s.actuators[0].as<PneumaticSpec>()->connected = {"x_low", "x_high"};
        },
        "one of them"},
       {"two atmospheres",
        [](Spec s) {
          s.actuators.push_back(s.actuators[0]);
          s.actuators[1].name = "other";
          s.actuators[1].as<PneumaticSpec>()->filling->atmosphere_kPa = 90;
        },
        "'other' is under an atmosphere of 90 kPa, actuator 'air' under one of 101.325 kPa"}});
}
