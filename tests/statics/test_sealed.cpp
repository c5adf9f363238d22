#include <cmath>
#include <functional>
#include <softkin/model/joined.hpp>

#include "statics/contact_scenes.hpp"
#include "statics/sensitivity_samples.hpp"

/// Chambers that are sealed with gas or liquid: their laws, how they act with load, several that are connected.

namespace softkin {

namespace {

using namespace testing;

constexpr double atmosphere = 101.325;  // [kPa]

ActuatorSpec sealed(ActuatorSpec spec, const FillingSpec& filling = {}, double low = 0.01, double high = 1000) {
  spec.control = Control::filling;
  spec.as<PneumaticSpec>()->filling = filling;
  spec.low = low;
  spec.high = filling.syringe_mL ? std::min(high, *filling.syringe_mL) : high;
  return spec;
}

/// The same robot with its first actuator sealed.
RobotSpec with_sealed(RobotSpec spec, const FillingSpec& filling = {}, double low = 0.01) {
  spec.actuators[0] = sealed(spec.actuators[0], filling, low);
  return spec;
}

FillingSpec syringe(double mL, double dead_mL, double exponent = 1) {
  FillingSpec filling;
  filling.syringe_mL = mL;
  filling.dead_mL = dead_mL;
  filling.exponent = exponent;
  return filling;
}

FillingSpec water(double bulk_modulus_MPa) {
  FillingSpec filling;
  filling.liquid = true;
  filling.compressibility = 1 / bulk_modulus_MPa;
  return filling;
}

/// Present volume as it is measured [mL].
double volume_of(const Model& model, const Equilibrium& found, std::size_t actuator = 0) {
  const Actuator& chamber = model.actuators[actuator];
  return achieved_ratio(model, chamber, found.state.positions) * chamber.rest_measure / 1000;
}

/// The same shape and pressure by a robot whose chamber is held to that volume.
void expect_as_by_volume(const RobotSpec& by_volume, const Equilibrium& found, double tolerance = 1e-6) {
  const Model model = compile(by_volume);
  const Statics statics(model);
  Actuation requested = found.actuation;
  requested[0] = achieved_ratio(model, model.actuators[0], found.state.positions);
  const Equilibrium same = statics.solve(requested, statics.rest(), tight());
  ASSERT_EQ(same.report.status, Status::converged) << same.report.remark;
  EXPECT_NEAR(found.state.multipliers[0], same.state.multipliers[0],
              tolerance * std::abs(same.state.multipliers[0]) + 1e-8);
  EXPECT_LT(distance(found.state.positions, same.state.positions), tolerance * model.diagonal_mm);
}

/// Two balls of rubber that do not touch, around one gas: their hollows are connected.
RobotSpec two_balloons(const RobotSpec& balloon) {
  RobotSpec alone = balloon;
  alone.actuators.clear();
  Placement beside;
  beside.translation = {60, 0, 0};
  RobotSpec pair = joined({{"a", alone, {}, {}}, {"b", alone, beside, {}}}, {"pair", {}, {}, {}});
  ActuatorSpec gas = sealed(actuator("gas", PneumaticSpec{.connected = {"a.hollow", "b.hollow"}}, 0, 1, true));
  pair.actuators = {gas};
  return pair;
}

RobotSpec balloon() {
  RobotSpec spec = hollow_ball(4, 30, 10);
  spec.materials[0].elastic = elastic(Law::mooney_rivlin, 0.03, 0.45);
  spec.actuators = {air("hollow", 0.5, 40)};
  return spec;
}

}  // namespace

/// p_abs V stays what it was, to the last digits of the measured volume; and the equilibrium is that by volume.
TEST(Sealed, BoylesLaw) {
  const RobotSpec spec = bending_finger();
  const Model model = compile(with_sealed(spec));
  const Statics statics(model);
  const double rest = model.actuators[0].rest;
  EXPECT_NEAR(rest, model.actuators[0].rest_measure / 1000, 1e-15);
  EXPECT_LT(distance(solve_converged(statics, values({rest})).state.positions, model.rest), 1e-12);
  for (const double fraction : {0.5, 1.5, 3.0, 6.0}) {
    const Equilibrium found = solve_converged(statics, values({fraction * rest}), {});
    const double absolute = found.state.multipliers[0] + atmosphere;
    EXPECT_NEAR(absolute * volume_of(model, found) / (atmosphere * fraction * rest), 1, 1e-9) << fraction;
    expect_as_by_volume(spec, solve_converged(statics, values({fraction * rest})));
  }
}

/// Of several exponents, with dead volume, by amount and by what a syringe has pushed.
TEST(Sealed, PolytropesWithASyringe) {
  const RobotSpec spec = bending_finger();
  for (const double exponent : {1.0, 1.2, 1.4}) {
    const Model pushed = compile(with_sealed(spec, syringe(3, 0.4, exponent), -1));
    FillingSpec tubes;
    tubes.dead_mL = 0.4;
    tubes.exponent = exponent;
    const Model amount = compile(with_sealed(spec, tubes));
    const double rest = pushed.actuators[0].rest_measure / 1000;
    EXPECT_EQ(pushed.actuators[0].rest, 0);
    EXPECT_NEAR(amount.actuators[0].rest, rest + 0.4, 1e-15);
    for (const double push : {-0.5, 0.7, 2.0, 2.9}) {
      const Statics statics(pushed);
      const Equilibrium found = solve_converged(statics, values({push}));
      const double all = rest + 0.4 + 3, whole = volume_of(pushed, found) + 0.4 + 3 - push;
      const double ratio = (found.state.multipliers[0] + atmosphere) / atmosphere;
      EXPECT_NEAR(ratio * std::pow(whole / all, exponent), 1, 1e-9);
      EXPECT_GT(push * found.state.multipliers[0], 0);
      expect_as_by_volume(spec, found);
      // as much gas as is then in the chamber and the tubes
      const double inside = (volume_of(pushed, found) + 0.4) * std::pow(ratio, 1 / exponent);
      const Equilibrium same = solve_converged(Statics(amount), values({inside}));
      EXPECT_NEAR(same.state.multipliers[0], found.state.multipliers[0], 1e-7);
      EXPECT_LT(distance(same.state.positions, found.state.positions), 1e-7);
    }
  }
}

/// A liquid holds its volume but for its compressibility; one that has none as a volume that is commanded.
TEST(Sealed, Liquid) {
  const RobotSpec spec = bending_finger();
  for (const double modulus : {0.5, 2200.0}) {
    const Model model = compile(with_sealed(spec, water(modulus)));
    const Statics statics(model);
    const double rest = model.actuators[0].rest;
    for (const double fraction : {0.8, 1.6}) {
      const Equilibrium found = solve_converged(statics, values({fraction * rest}));
      const double pressure = 1e3 * modulus * std::log(fraction * rest / volume_of(model, found));
      EXPECT_NEAR(found.state.multipliers[0], pressure, 1e-6 * std::abs(pressure)) << modulus;
      expect_as_by_volume(spec, found);
    }
  }
  FillingSpec stiff = water(1);
  stiff.compressibility = 0;
  const Model model = compile(with_sealed(spec, stiff));
  const Equilibrium found = solve_converged(Statics(model), values({1.6 * model.actuators[0].rest}));
  EXPECT_NEAR(volume_of(model, found), 1.6 * model.actuators[0].rest, 1e-9);
  expect_as_by_volume(spec, found);
}

TEST(Sealed, DerivativesByTheCommand) {
  const Steps steps{5e-4, 1e-3, 1e-3};  // [-, N, mL]
  for (const double amount : {0.5, 0.8, 1.6})
    expect_differences_at(with_sealed(bending_finger()), values({amount}), 1e-6, steps);
  for (const double push : {0.0, 1.5})
    expect_differences_at(with_sealed(bending_finger(), syringe(3, 0.4, 1.4), -1), values({push}), 1e-6, steps);
  expect_differences_at(with_sealed(bending_finger(), water(2.5)), values({1.1}), 1e-6, steps);
  RobotSpec crowd = crowded_robot();
  crowd.actuators[0] = sealed(crowd.actuators[0]);
  expect_differences_at(crowd, values({0.9, 20, 1.1, 0.97, 0.1}), 1e-6, steps);
  RobotSpec bag = robot_with_bags({"bag"});
  expect_differences_at(with_sealed(bag), values({1.4}), 1e-6, steps);
}

/// By its numbers: of chambers that are sealed with a syringe, Perturbations against equilibria of other robots.
TEST(Sealed, DerivativesByNumbers) {
  RobotSpec spec = with_sealed(bending_finger(), syringe(3, 0.4, 1.3), -1);
  spec.actuators[0].high = 2.5;
  const std::vector<std::pair<double, std::function<double&(RobotSpec&)>>> numbers{
      {0.4, [](RobotSpec& s) -> double& { return s.actuators[0].as<PneumaticSpec>()->filling->dead_mL; }},
      {3, [](RobotSpec& s) -> double& { return *s.actuators[0].as<PneumaticSpec>()->filling->syringe_mL; }},
      {1.3, [](RobotSpec& s) -> double& { return s.actuators[0].as<PneumaticSpec>()->filling->exponent; }},
      {100, [](RobotSpec& s) -> double& { return s.actuators[0].as<PneumaticSpec>()->filling->atmosphere_kPa; }},
      {1, [](RobotSpec& s) -> double& { return *s.materials[0].elastic->youngs_modulus; }}};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.8}), tight(1e-10));
  const auto changed = [&](const auto& number, double by) {
    RobotSpec other = spec;
    number(other) += by;
    return compile(other);
  };
  for (const auto& [size, number] : numbers) {
    const Model more = changed(number, 1e-5 * size), less = changed(number, -1e-5 * size);
    const ParameterSensitivity slopes =
        Perturbations(statics, {{more, less, 2e-5 * size}}).at(found.state, {}, 1e-8, false);
    ASSERT_TRUE(slopes.regular);
    const double step = 2e-3 * size;
    Points positions = Points::Zero(model.rest.rows(), 3);
    double pressure = 0;
    for (const auto& [steps, weight] :
         {std::pair{-2, 1.0}, std::pair{-1, -8.0}, std::pair{1, 8.0}, std::pair{2, -1.0}}) {
      const Model other = changed(number, steps * step);
      State start;
      start.positions = found.state.positions;  // whose pressure and amount are not known
      const Equilibrium there = Statics(other).solve(found.actuation, start, tight(1e-10));
      ASSERT_EQ(there.report.status, Status::converged) << there.report.remark;
      positions += weight / (12 * step) * there.state.positions;
      pressure += weight / (12 * step) * there.state.multipliers[0];
    }
    EXPECT_LT(off_by(slopes.positions[0], positions), 1e-6) << size;
    EXPECT_NEAR(slopes.multipliers(0, 0), pressure, 1e-6 * std::abs(pressure)) << size;
  }
}

/// A plate presses a block with a sealed chamber: its pressure rises, and with it the force of the plate, as those of a
/// chamber that is held to the volume which the plate leaves it.
TEST(Sealed, PressedByAPlate) {
  RobotSpec spec = physical_robot(block_mesh({4, 4, 4}, {20, 20, 20}));
  add_volume_region(spec.mesh, "chamber",
                    [](const Vec3& p) { return (p - Vec3::Constant(10)).cwiseAbs().maxCoeff() < 5; });
  spec.fixed = {plane_support(spec.mesh.vertices, 2, 0), plane_support(spec.mesh.vertices, 0, 0),
                plane_support(spec.mesh.vertices, 1, 0)};
  spec.actuators = {air("chamber")};
  spec.contact = contact_below(0.05);
  spec.contact->obstacles.push_back({"plate", Halfspace{{0, 0, 20.1}, {0, 0, -1}}, std::nullopt, {}});
  spec.contact->obstacles.back().motion = {false, false, true};
  const Model model = compile(with_sealed(spec));
  const Statics statics(model);
  const double rest = model.actuators[0].rest;
  const auto force = [](const Model& robot, const Equilibrium& at) {
    return reaction_of(robot, Statics(robot), at, 0)[2];
  };
  double last = 0;
  State state = statics.rest();
  for (const double press : {0.0, -1.0, -3.0}) {
    const Equilibrium found = statics.solve(values({rest, press}), state, tight());
    ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
    state = found.state;
    const double absolute = state.multipliers[0] + atmosphere;
    EXPECT_NEAR(absolute * volume_of(model, found), atmosphere * rest, 1e-9 * atmosphere * rest);
    if (press == 0) {
      EXPECT_NEAR(state.multipliers[0], 0, 1e-7);
      continue;
    }
    EXPECT_GT(state.multipliers[0], last + 1);
    last = state.multipliers[0];
    const Model enclosure = compile(spec);
    const Equilibrium held = Statics(enclosure).solve(
        values({achieved_ratio(model, model.actuators[0], state.positions), press}), {enclosure.rest}, tight());
    ASSERT_EQ(held.report.status, Status::converged) << held.report.remark;
    EXPECT_NEAR(state.multipliers[0], held.state.multipliers[0], 1e-6 * held.state.multipliers[0]);
    EXPECT_NEAR(force(model, found), force(enclosure, held), 1e-6 * std::abs(force(enclosure, held)));
  }
}

/// With a tendon with friction, a sealed chamber takes few iterations to the equilibrium under volume control.
TEST(Sealed, BesideATendonThatRubs) {
  RobotSpec spec = bending_finger();
  spec.actuators.push_back(by_load(cable("tendon", {{0, 6, 15}, {15, 6, 15}, {30, 6, 15}, {45, 6, 15}, {60, 6, 15}})));
  spec.actuators[1].as<CableSpec>()->friction = 0.4;
  const Model model = compile(with_sealed(spec)), enclosure = compile(spec);
  const Equilibrium found = solve_converged(Statics(model), values({1.8, 0.5}));
  EXPECT_LE(found.report.iterations, 60);
  EXPECT_NEAR((found.state.multipliers[0] + atmosphere) * volume_of(model, found), atmosphere * 1.8,
              1e-9 * atmosphere * 1.8);
  State start = found.state;
  start.actuation[0] = achieved_ratio(model, model.actuators[0], found.state.positions);
  const Equilibrium held = Statics(enclosure).solve(start.actuation, start, tight());
  ASSERT_EQ(held.report.status, Status::converged) << held.report.remark;
  EXPECT_NEAR(held.state.multipliers[0], found.state.multipliers[0], 1e-6 * found.state.multipliers[0]);
  EXPECT_LT(distance(held.state.positions, found.state.positions), 1e-6);
}

/// Two equal balloons on one pipe stay equal until the pressure of one has its maximum, whatever the state of their
/// gas. Then they have one unstable mode and move to where both have one pressure, one before its maximum and one
/// beyond it.
TEST(Sealed, TwoBalloonsOnOnePipe) {
  const RobotSpec one = balloon();
  const Model single = compile(one);
  const Statics alone(single);
  const auto pressure = [&](double ratio) { return solve_converged(alone, values({ratio})).state.multipliers[0]; };
  // the maximum, by golden sections
  double low = 1.2, high = 8;
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 30; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (pressure(a) < pressure(b) ? low : high) = pressure(a) < pressure(b) ? a : b;
  }
  const double limit_point = 0.5 * (low + high), most = pressure(limit_point),
               volume = single.actuators[0].rest_measure / 1000;
  ASSERT_LT(pressure(1.3 * limit_point), 0.999 * most);
  const Model model = compile(two_balloons(one));
  const Statics statics(model);
  const double rest = model.actuators[0].rest, limit = 2 * volume * limit_point * (most + atmosphere) / atmosphere;
  EXPECT_NEAR(rest, 2 * volume, 1e-12);
  const auto ratios = [&](const Equilibrium& found) {
    std::vector<double> all = connected_volumes(model.actuators[0], found.state.positions);
    for (double& each : all) each /= 1000 * volume;
    return all;
  };
  const Equilibrium below = solve_converged(statics, values({0.9995 * limit}));
  EXPECT_EQ(below.report.physical.unstable_modes, 0);
  EXPECT_NEAR(ratios(below)[0], ratios(below)[1], 1e-6);
  const Equilibrium above = solve_converged(statics, values({1.0005 * limit}));
  EXPECT_EQ(above.report.physical.unstable_modes, 1) << above.report.remark;
  EXPECT_NEAR(ratios(above)[0], ratios(above)[1], 1e-6);
  // with the default tolerance, too, whose last steps are of a factor that is of another shape
  EXPECT_EQ(statics.solve(values({0.999 * limit}), statics.rest(), {}).report.physical.unstable_modes, 0);
  for (const double amount : {1.002, 1.01, 1.03})
    EXPECT_EQ(statics.solve(values({amount * limit}), statics.rest(), {}).report.physical.unstable_modes, 1) << amount;
  StaticsOptions stable;
  stable.stable = true;
  const Equilibrium unequal = statics.solve(values({1.1 * limit}), statics.rest(), stable);
  ASSERT_EQ(unequal.report.status, Status::converged) << unequal.report.remark;
  EXPECT_EQ(unequal.report.physical.unstable_modes, 0);
  const std::vector<double> both = ratios(unequal);
  EXPECT_LT(std::min(both[0], both[1]), limit_point - 0.1);
  EXPECT_GT(std::max(both[0], both[1]), limit_point + 0.1);
  for (const double ratio : both)
    EXPECT_NEAR(pressure(ratio), unequal.state.multipliers[0], 1e-6 * unequal.state.multipliers[0]);
  EXPECT_NEAR((unequal.state.multipliers[0] + atmosphere) * (both[0] + both[1]) * volume, atmosphere * 1.1 * limit,
              1e-9 * atmosphere * limit);
}

/// A gas takes a single balloon through the maximum of its pressure.
TEST(Sealed, PassesTheMaximumOfAPressure) {
  const RobotSpec one = balloon();
  const Model model = compile(with_sealed(one));
  const Statics statics(model);
  const double rest = model.actuators[0].rest;
  double most = 0, last = 0;
  State state = statics.rest();
  for (const double fraction : {2.0, 4.0, 6.0, 9.0, 15.0}) {
    const Equilibrium found = statics.solve(values({fraction * rest}), state, tight());
    ASSERT_EQ(found.report.status, Status::converged) << fraction << ": " << found.report.remark;
    EXPECT_EQ(found.report.physical.unstable_modes, 0);
    state = found.state;
    last = state.multipliers[0];
    most = std::max(most, last);
    expect_as_by_volume(one, found);
  }
  EXPECT_LT(last, 0.95 * most);
}

/// In a large vessel a gas hardly differs from a constant pressure, and its amount has a limit point, too: where the
/// pressure of the balloon falls faster than that of the gas. The limit is reported.
TEST(Sealed, AmountThatHasItsMaximum) {
  FillingSpec vessel;
  vessel.dead_mL = 20000;
  RobotSpec spec = with_sealed(balloon(), vessel);
  spec.actuators[0].high = 1e5;
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve(values({1.08 * model.actuators[0].rest}), statics.rest());
  EXPECT_GT(found.report.reached, 0.8);
  EXPECT_EQ(found.report.status, Status::limit);
  EXPECT_NE(found.report.remark.find("where what fills a chamber has its maximum"), std::string::npos)
      << found.report.remark;
}

}  // namespace softkin
