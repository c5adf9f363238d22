#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "statics/physical_samples.hpp"
#include "statics/runge_kutta.hpp"

/// A layer of dielectric elastomer that lags behind its voltage.

namespace softkin {

namespace {

using namespace testing;

constexpr double layer_mm = 0.5, layer_permittivity = 4.7, vacuum = 8.8541878128e-6;  // MPa per (kV/mm)^2
constexpr double gent_mu = 0.01536, gent_jm = 3 * (5.85 * 5.85 - 1);
const std::vector<ViscousBranch> acrylic{{0.02606, 0.61}, {0.02653, 6.56}, {0.01083, 61.25}};

RobotSpec acrylic_sheet() {
  const std::array<int, 3> cells{2, 2, 1};
  RobotSpec spec = physical_robot(block_mesh(cells, {6, 6, layer_mm}, Split::prisms));
  ElasticSpec law;
  law.law = Law::gent;
  law.shear_modulus = gent_mu;
  law.jm = gent_jm;
  law.bulk_modulus = 100;
  spec.materials[0].elastic = law;
  spec.materials[0].permittivity = layer_permittivity;
  spec.materials[0].viscosity = acrylic;
  spec.fixed = {{{VertexList{{0}}, {}}, {true, true, true}},
                {{VertexList{{grid_vertex(cells, 2, 0, 0)}}, {}}, {false, true, true}},
                {{VertexList{{grid_vertex(cells, 0, 2, 0)}}, {}}, {false, false, true}}};
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "all"}, 0, 10, true);
  skin.control = Control::load;
  skin.rest = 0;
  spec.actuators = {skin};
  return spec;
}

/// The incompressible sheet in equal-biaxial stretch l: l P_along - l^-2 P_across = eps (U / H)^2 l^4, and the branch
/// equations along the axes, by Runge and Kutta's method of fourth order.
class SheetApart {
 public:
  [[nodiscard]] double stretch_at(double voltage_kV) const { return stretch_at(voltage_kV, flowed_); }

  void advance(double from_kV, double to_kV, double time, int steps) {
    integrate(flowed_, from_kV, to_kV, time, steps, [this](double u, const Flowed& flowed) { return rate(u, flowed); });
  }

 private:
  using Flowed = std::vector<double>;  // of each branch C_v along the sheet; across it is 1 / square of that

  [[nodiscard]] Flowed rate(double voltage_kV, const Flowed& flowed) const {
    const double l = stretch_at(voltage_kV, flowed), along = l * l, across = 1 / (along * along);
    Flowed rates;
    for (std::size_t k = 0; k < flowed.size(); ++k) {
      const double c = flowed[k];
      rates.push_back((along - (2 * along / c + across * c * c) / 3 * c) / acrylic[k].time_s);
    }
    return rates;
  }
  [[nodiscard]] double stretch_at(double voltage_kV, const Flowed& flowed) const {
    const double field = voltage_kV / layer_mm;
    double low = 0.5, high = 2;
    for (int i = 0; i < 60; ++i) {
      const double l = (low + high) / 2, along = l * l, across = 1 / (along * along);
      double stress = gent_mu / (1 - (2 * along + across - 3) / gent_jm) * (along - across);
      for (std::size_t k = 0; k < flowed.size(); ++k)
        stress += acrylic[k].modulus_MPa * (along / flowed[k] - across * flowed[k] * flowed[k]);
      (stress > vacuum * layer_permittivity * field * field * along * along ? high : low) = l;
    }
    return (low + high) / 2;
  }

  Flowed flowed_ = Flowed(acrylic.size(), 1);
};

/// Stretches over a cycle to a voltage and back, by the solver and apart.
struct Cycle {
  std::vector<double> solved, apart;

  Cycle(double max_kV, double period_s, int steps) {
    const Model model = compile(acrylic_sheet());
    const Statics statics(model);
    SheetApart sheet;
    StaticsOptions options;
    State state = statics.rest();
    double before = 0;
    for (int i = 1; i <= steps; ++i) {
      const double voltage = max_kV * (2 * i <= steps ? 2.0 * i / steps : 2 - 2.0 * i / steps);
      options.elapsed_s = period_s / steps;
      const Equilibrium found = statics.solve(values({voltage}), state, options);
      EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
      state = found.state;
      options.history = statics.flow(state).history;
      sheet.advance(before, voltage, period_s / steps, 40);
      before = voltage;
      solved.push_back(state.positions.col(0).maxCoeff() / 6);
      apart.push_back(sheet.stretch_at(voltage));
    }
  }

  [[nodiscard]] double error() const {
    double worst = 0;
    for (std::size_t i = 0; i < apart.size(); ++i) worst = std::max(worst, std::abs(solved[i] - apart[i]));
    return worst / (*std::max_element(apart.begin(), apart.end()) - 1);
  }
};

}  // namespace

/// The stretch comes after the voltage, and what is left of it at 0 kV is what flowed.
TEST(ViscousLayer, StretchLagsBehindTheVoltage) {
  for (const double period : {4.0, 40.0}) {
    const Cycle coarse(6, period, 20), fine(6, period, 40);
    EXPECT_LT(fine.error(), 2e-3) << period;
    EXPECT_LT(fine.error(), 0.6 * coarse.error()) << period;
    for (std::size_t i = 0; i < 18; ++i)
      EXPECT_GT(fine.solved[38 - i], fine.solved[i] + 3e-4) << "at the same voltage, " << period << " s";
    EXPECT_GT(fine.solved.back(), 1.002);
  }
}

}  // namespace softkin
