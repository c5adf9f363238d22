#include <softkin/statics/electric_layer.hpp>

#include "statics/sensitivity_samples.hpp"

/// Layers of dielectric elastomer under voltage.

namespace softkin {

namespace {

using namespace testing;

constexpr double thickness_mm = 0.5, permittivity = 4.7, shear_MPa = 0.08;
constexpr double vacuum_MPa = 8.8541878128e-6;  // per (kV/mm)^2
constexpr int column = 4, row = 3;

ElasticSpec gent(double jm, double nu) {
  ElasticSpec spec;
  spec.law = Law::gent;
  spec.shear_modulus = shear_MPa;
  spec.jm = jm;
  spec.poisson_ratio = nu;
  return spec;
}

ElasticSpec neo_hookean(double nu) {
  return elastic(Law::neo_hookean, 2 * (1 + nu) * shear_MPa, nu);
}

ActuatorSpec electrode(const std::string& name, const std::string& region, double high = 20) {
  ActuatorSpec skin = actuator(name, DeaSpec{.region = region}, 0, high, true);
  skin.control = Control::load;
  skin.rest = 0;
  return skin;
}

/// A sheet of prisms, held by three vertices so that it may grow freely.
RobotSpec free_sheet(const ElasticSpec& material) {
  const std::array<int, 3> cells{column, row, 1};
  RobotSpec spec = physical_robot(block_mesh(cells, {8, 6, thickness_mm}, Split::prisms));
  spec.materials[0].elastic = material;
  spec.materials[0].permittivity = permittivity;
  spec.fixed = {{{VertexList{{0}}, {}}, {true, true, true}},
                {{VertexList{{grid_vertex(cells, column, 0, 0)}}, {}}, {false, true, true}},
                {{VertexList{{grid_vertex(cells, 0, row, 0)}}, {}}, {false, false, true}}};
  spec.actuators = {electrode("skin", "all")};
  return spec;
}

/// Slopes of the energy of equal-biaxial stretch l and stretch t across [MPa].
struct Slopes {
  double along = 0, across = 0;
};

Slopes slopes_of(const ElasticLaw& law, double l, double t) {
  const double j = l * l * t;
  if (law.law == Law::neo_hookean) {
    const double by_j = -law.mu + (law.lambda + law.mu) * (j - 1);
    return {2 * law.mu * l + 2 * by_j * l * t, law.mu * t + by_j * l * l};
  }
  const double scale = std::pow(j, -2.0 / 3), barred = scale * (2 * l * l + t * t);
  const double slope = law.mu / 2 / (1 - (barred - 3) / law.jm), by_j = law.bulk * (j - 1);
  return {slope * (4 * scale * l - 4.0 / 3 * barred / l) + 2 * by_j * l * t,
          slope * (2 * scale * t - 2.0 / 3 * barred / t) + by_j * l * l};
}

/// The state of a free sheet at a stretch: the energy W(l, l, t) - eps/2 (V/H)^2 l^2 / t has no slope.
struct SheetState {
  double stretch = 1, across = 1, voltage_kV = 0;
};

SheetState sheet_at(const ElasticLaw& law, double l) {
  double low = 0.2 / (l * l), high = 3 / (l * l);
  for (int i = 0; i < 200; ++i) {
    const double t = (low + high) / 2;
    const Slopes slopes = slopes_of(law, l, t);
    (l * slopes.along + 2 * t * slopes.across > 0 ? high : low) = t;
  }
  const double square = slopes_of(law, l, low).along * low / (vacuum_MPa * permittivity * l);
  return {l, low, thickness_mm * std::sqrt(std::max(0.0, square))};
}

/// The first maximum of the voltage.
SheetState pull_in_of(const ElasticLaw& law) {
  SheetState best = sheet_at(law, 1);
  for (double l = 1.00001; l < 2; l += 0.00001) {
    const SheetState next = sheet_at(law, l);
    if (next.voltage_kV < best.voltage_kV) return best;
    best = next;
  }
  return best;
}

SheetState sheet_under(const ElasticLaw& law, double voltage_kV, double end) {
  double low = 1, high = end;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (sheet_at(law, middle).voltage_kV < voltage_kV ? low : high) = middle;
  }
  return sheet_at(law, low);
}

}  // namespace

TEST(PhysicalVoltage, AFreeSheetFollowsItsClosedCurve) {
  for (const ElasticSpec& material : {neo_hookean(0.4), neo_hookean(0.499), gent(40, 0.4), gent(40, 0.499)}) {
    const Model model = compile(free_sheet(material));
    const Statics statics(model);
    const ElasticLaw& law = model.elements.materials[0].elastic;
    const SheetState end = pull_in_of(law);
    for (const double fraction : {0.2, 0.5, 0.8, 0.9, 0.99}) {
      const double voltage = fraction * end.voltage_kV;
      const SheetState expected = sheet_under(law, voltage, end.stretch);
      const Equilibrium found = solve_converged(statics, values({voltage}));
      const Vec3 stretch(expected.stretch, expected.stretch, expected.across);
      const double moved = distance(model.rest * stretch.asDiagonal(), model.rest);
      EXPECT_LT(distance(found.state.positions, model.rest * stretch.asDiagonal()), 1e-3 * moved) << fraction;
      EXPECT_EQ(found.state.multipliers[0], voltage);
    }
  }
}

/// The path stops at the maximum of the voltage and reports it.
TEST(PhysicalVoltage, PullInIsALimit) {
  for (const ElasticSpec& material : {neo_hookean(0.4), neo_hookean(0.499), gent(40, 0.4), gent(8, 0.499)}) {
    const Model model = compile(free_sheet(material));
    const Statics statics(model);
    const SheetState end = pull_in_of(model.elements.materials[0].elastic);
    const Equilibrium found = statics.solve(values({20}), statics.rest());
    EXPECT_EQ(found.report.status, Status::limit);
    EXPECT_NEAR(found.state.actuation[0], end.voltage_kV, 5e-3 * end.voltage_kV);
    EXPECT_LE(found.state.actuation[0], 1.0001 * end.voltage_kV);
    EXPECT_EQ(found.state.multipliers[0], found.state.actuation[0]);
    EXPECT_NE(found.report.remark.find("the voltage of dea 'skin' has its maximum there"), std::string::npos)
        << found.report.remark;
  }
}

namespace {

/// A strip that is clamped at one end, its upper half two layers side by side with electrodes of their own.
RobotSpec two_electrodes() {
  Mesh mesh = block_mesh({10, 2, 2}, {20, 6, 1}, Split::prisms);
  add_volume_region(mesh, "left", [](const Vec3& p) { return p.z() > 0.5 && p.y() < 3; });
  add_volume_region(mesh, "right", [](const Vec3& p) { return p.z() > 0.5 && p.y() > 3; });
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.materials[0].elastic = neo_hookean(0.4);
  spec.materials[0].permittivity = permittivity;
  spec.actuators = {electrode("left", "left", 10), electrode("right", "right", 10)};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

}  // namespace

/// The charge is minus the derivative of the equilibrium's energy by the voltage.
TEST(PhysicalVoltage, ChargeIsTheDerivativeOfTheEnergy) {
  const Model model = compile(free_sheet(neo_hookean(0.4)));
  const Statics statics(model);
  const double voltage = 9, step = 1e-3;
  const Equilibrium at = solve_converged(statics, values({voltage}));
  const ElectricLayer layer = electric_layer(model, 0, at.state.positions, voltage);
  const double change = solve_converged(statics, values({voltage + step})).report.energy -
                        solve_converged(statics, values({voltage - step})).report.energy;
  EXPECT_NEAR(layer.charge_nC, -1e3 * change / (2 * step), 1e-5 * layer.charge_nC);  // mJ per kV are uC
  EXPECT_NEAR(layer.charge_nC, layer.capacitance_pF * voltage, 1e-9 * layer.charge_nC);
  // a flat capacitor
  const SheetState state = sheet_under(model.elements.materials[0].elastic, voltage, 1.2);
  const double area = 48 * state.stretch * state.stretch, thickness = thickness_mm * state.across;
  EXPECT_NEAR(layer.capacitance_pF, 8.8541878128e-3 * permittivity * area / thickness, 1e-6 * layer.capacitance_pF);
  EXPECT_NEAR(layer.field_kV_mm, voltage / thickness, 1e-6 * layer.field_kV_mm);
  EXPECT_NEAR(layer.thickness_mm, thickness, 1e-6 * thickness);
}

/// A layer that nothing holds carries no stress: that of the rubber and Maxwell's cancel.
TEST(PhysicalVoltage, AFreeLayerHasNoTotalStress) {
  const Model model = compile(free_sheet(gent(40, 0.45)));
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({10}));
  const ElementDeformation deformation = statics.measured(at.state);
  for (const double stress : deformation.stress.von_mises) EXPECT_LT(stress, 1e-9);
  for (const auto& stress : deformation.stress.principal)
    for (const double value : stress) EXPECT_LT(std::abs(value), 1e-9);
}

TEST(PhysicalVoltage, SensitivitiesAreThoseOfTheEquilibria) {
  Steps steps;
  steps.pressure = 0.01;  // kV
  expect_differences_at(two_electrodes(), values({3, 1}), 1e-6, steps);
}

/// Several electrodes on one membrane, each with its voltage: mirrored ones mirror the shape, equal ones do not twist
/// it, and the layer that is charged makes the strip bend away.
TEST(PhysicalVoltage, ElectrodesOfOneMembraneHaveVoltagesOfTheirOwn) {
  const Model model = compile(two_electrodes());
  const Statics statics(model);
  const auto tip = [&](double left, double right) {
    return marker_at(model, solve_converged(statics, values({left, right})));
  };
  const Vec3 one = tip(3, 0), other = tip(0, 3), both = tip(3, 3);
  EXPECT_LT(one[2], 0.45);
  EXPECT_LT(both[2], one[2]);
  EXPECT_GT(std::abs(one[1] - 3), 0.01);
  EXPECT_NEAR(one[2], other[2], 0.05 * std::abs(one[2] - 0.5));  // the mesh's diagonals are not mirrored
  EXPECT_NEAR(both[1], 3, 0.2 * std::abs(one[1] - 3));
}

/// A uniform fraction of the voltage acts as a lower voltage; prisms without any are passive.
TEST(PhysicalVoltage, SharesOfTheVoltage) {
  RobotSpec spec = free_sheet(neo_hookean(0.4));
  const std::size_t count = spec.mesh.prisms.size();
  PrismValues fractions;
  for (std::size_t e = count; e-- > 0;) {
    fractions.prisms.push_back(e);
    fractions.values.push_back(0.5);
    fractions.origins.push_back({});
  }
  spec.actuators[0].as<DeaSpec>()->fractions = fractions;
  const Model halved = compile(spec);
  const Model model = compile(free_sheet(neo_hookean(0.4)));
  const Points expected = solve_converged(Statics(model), values({6})).state.positions;
  EXPECT_LT(distance(solve_converged(Statics(halved), values({12})).state.positions, expected), 1e-8);

  for (double& fraction : spec.actuators[0].as<DeaSpec>()->fractions->values) fraction = 0;
  const Model passive = compile(spec);
  EXPECT_LT(distance(solve_converged(Statics(passive), values({20})).state.positions, passive.rest), 1e-12);
}

/// A prestretched layer is one whose mesh was drawn stretched: under voltage it comes to the shape of the same layer
/// that was drawn as it is without force.
TEST(PhysicalVoltage, APrestretchedLayerIsDrawnStretched) {
  const double ratio = 0.7;
  RobotSpec drawn = free_sheet(gent(40, 0.4)), stretched = drawn;
  stretched.actuators[0].as<DeaSpec>()->prestretch = ratio;
  drawn.mesh.vertices *= Vec3(std::sqrt(ratio), std::sqrt(ratio), 1 / ratio).asDiagonal();
  const Model model = compile(stretched), unstretched = compile(drawn);
  const Statics of_stretched(model), of_drawn(unstretched);
  for (const double voltage : {0.0, 8.0, 16.0}) {
    const Equilibrium at = solve_converged(of_stretched, values({voltage}));
    EXPECT_LT(distance(at.state.positions, solve_converged(of_drawn, values({voltage})).state.positions), 1e-8);
    for (const double stress : of_stretched.measured(at.state).stress.von_mises) EXPECT_LT(stress, 1e-8);
  }
}

TEST(PhysicalVoltage, EquilibriumFromAStartThatTellsItsVoltage) {
  const Model model = compile(two_electrodes());
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({3, 1}));
  State reported;
  reported.positions = at.state.positions;
  reported.multipliers = at.state.multipliers;  // and no actuation
  const Equilibrium again = statics.solve(values({3, 1}), reported, tight());
  EXPECT_EQ(again.report.status, Status::converged);
  EXPECT_LT(distance(again.state.positions, at.state.positions), 1e-9);
  EXPECT_LE(again.report.iterations, 3);
}

}  // namespace softkin
