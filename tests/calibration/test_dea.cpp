#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <softkin/calibration/actuator_curves.hpp>
#include <softkin/calibration/actuator_samples.hpp>
#include <softkin/calibration/dielectric_elastomer.hpp>
#include <softkin/core/error.hpp>

namespace softkin {
namespace {

calibration::Dielectric acrylic() {
  return {calibration::DielectricLaw::neo_hookean, 0.07, 4.4, 0.5, 1, 0};
}

/// Strain energy per rest volume [MPa] at equal-biaxial stretch.
double energy(const calibration::Dielectric& d, double l) {
  const double invariant = 2 * l * l + std::pow(l, -4) - 3;
  if (d.law == calibration::DielectricLaw::neo_hookean) return d.shear_modulus_MPa / 2 * invariant;
  return -d.shear_modulus_MPa * d.stretch_limit / 2 * std::log(1 - invariant / d.stretch_limit);
}

/// The voltage that makes the stretch stationary in the free energy W - eps E^2/2 (with the work of the voltage) and of
/// the edge forces, by finite differences of W: 2 s l is their work per rest volume.
double stationary_voltage(const calibration::Dielectric& d, double l) {
  const double h = 1e-5, eps = d.relative_permittivity * 8.8541878128e-12 * 1e6;  // MPa per (kV/mm)^2
  const auto slope = [&](double at) { return (energy(d, at + h) - energy(d, at - h)) / (2 * h); };
  const double force = slope(d.prestretch);                          // dW/dl at rest, which the forces balance
  const double square = (slope(l) - force) / (2 * eps * l * l * l);  // d/dl of eps/2 (l^2 U/H)^2 is 2 eps l^3 (U/H)^2
  return d.thickness_mm * std::sqrt(square);
}

using calibration::Dielectric;
using calibration::DielectricLaw;
using calibration::DielectricLoading;

/// Strain energy per rest volume [MPa] at two stretches in the plane.
double plane_energy(const Dielectric& d, double l, double m) {
  const double invariant = l * l + m * m + 1 / (l * l * m * m) - 3;
  if (d.law == DielectricLaw::neo_hookean) return d.shear_modulus_MPa / 2 * invariant;
  return -d.shear_modulus_MPa * d.stretch_limit / 2 * std::log(1 - invariant / d.stretch_limit);
}

/// Gradient of that energy by finite differences.
std::array<double, 2> plane_stress(const Dielectric& d, double l, double m) {
  const double h = 1e-5;
  return {(plane_energy(d, l + h, m) - plane_energy(d, l - h, m)) / (2 * h),
          (plane_energy(d, l, m + h) - plane_energy(d, l, m - h)) / (2 * h)};
}

/// In both directions what the elastomer and the edge forces leave is the pull of the charges, eps (U/H)^2 l1 l2 times
/// the other stretch; of fibres only along the force.
TEST(Dielectric, BothDirectionsAreInBalance) {
  for (const DielectricLaw law : {DielectricLaw::neo_hookean, DielectricLaw::gent})
    for (const DielectricLoading loading : {DielectricLoading::uniaxial, DielectricLoading::constrained})
      for (const double prestretch : {1.0, 1.5, 3.0}) {
        const Dielectric d{law, 0.07, 4.4, 0.5, prestretch, 60, loading, 2};
        const bool free = loading == DielectricLoading::uniaxial;
        const double across = free ? 1 / std::sqrt(prestretch) : 2, grows = free ? across : prestretch;
        const std::array<double, 2> rest = plane_stress(d, prestretch, across);
        EXPECT_NEAR(free ? rest[1] : 0, 0, 1e-9);
        EXPECT_NEAR(calibration::plane_stretch(d, grows).along, prestretch, 1e-9);
        EXPECT_NEAR(calibration::plane_stretch(d, grows).across, across, 1e-9);
        for (const double more : {1.05, 1.3, 1.6}) {
          const auto [l, m] = calibration::plane_stretch(d, more * grows);
          const double nominal = calibration::voltage_of(d, more * grows) / d.thickness_mm;  // [kV/mm]
          const double pull = d.relative_permittivity * 8.8541878128e-6 * nominal * nominal;
          const std::array<double, 2> stress = plane_stress(d, l, m);
          EXPECT_NEAR(stress[0] - rest[0], pull * l * m * m, 1e-6 * stress[0]);
          EXPECT_NEAR(free ? stress[1] - pull * l * l * m : m - 2, 0, 1e-6 * stress[0]);
        }
      }
}

TEST(Dielectric, WithoutForcesOneDirectionIsAsGoodAsBoth) {
  for (const DielectricLaw law : {DielectricLaw::neo_hookean, DielectricLaw::gent}) {
    Dielectric both{law, 0.07, 4.4, 0.5, 1, 30}, one = both;
    one.loading = DielectricLoading::uniaxial;
    EXPECT_NEAR(calibration::pull_in(one)->voltage_kV, calibration::pull_in(both)->voltage_kV, 1e-9);
    EXPECT_NEAR(calibration::pull_in(one)->area_ratio, std::pow(calibration::pull_in(both)->stretch, 2), 1e-7);
  }
}

/// Of a neo-hookean elastomer eps (U/H)^2 q^2 / mu is 1 - s / l - l^-4 q^-2: it only rises.
TEST(Dielectric, FibresTakeThePullInAway) {
  Dielectric d{DielectricLaw::neo_hookean, 0.07, 4.4, 0.5, 1.5, 0, DielectricLoading::constrained, 2};
  EXPECT_FALSE(calibration::pull_in(d).has_value());
  const double force = 1.5 - std::pow(1.5, -3) / 4, root = std::sqrt(0.07 / (4.4 * 8.8541878128e-6));
  const calibration::DielectricCurve curve = calibration::dielectric_curve(d, 20);
  EXPECT_NEAR(curve.area_ratios.back(), 5, 1e-12);
  const double end = 5 * 1.5;
  EXPECT_NEAR(curve.voltages.back(), 0.5 / 2 * root * std::sqrt(1 - force / end - std::pow(end, -4) / 4), 1e-9);
  d.loading = DielectricLoading::uniaxial;
  EXPECT_TRUE(calibration::pull_in(d).has_value());
}

TEST(Dielectric, PullInUnderOneForceIsTheFirstMaximumThatAFineTableHas) {
  for (const DielectricLaw law : {DielectricLaw::neo_hookean, DielectricLaw::gent})
    for (const DielectricLoading loading : {DielectricLoading::uniaxial, DielectricLoading::constrained}) {
      const Dielectric d{law, 0.07, 4.4, 0.5, 1.2, 100, loading, 1};
      const std::optional<calibration::PullIn> found = calibration::pull_in(d);
      double highest = 0, at = 0;
      for (double l = loading == DielectricLoading::uniaxial ? 1 / std::sqrt(1.2) : 1.2; l < 8; l += 1e-4) {
        const double voltage = calibration::voltage_of(d, l);
        if (voltage < highest) break;
        highest = voltage;
        at = l;
      }
      if (at > 7.9) {
        EXPECT_FALSE(found.has_value());
        continue;
      }
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->stretch, at, 3e-4);
    }
}

/// The end of a curve without pull-in is where the chains are at 95 % of their limit, in every loading.
TEST(Dielectric, ChainsEndTheCurveWhateverPulls) {
  for (const DielectricLoading loading :
       {DielectricLoading::equal_biaxial, DielectricLoading::uniaxial, DielectricLoading::constrained}) {
    Dielectric d{DielectricLaw::gent, 0.07, 4.4, 0.5, 3.5, 20, loading, 1.5};
    if (loading == DielectricLoading::equal_biaxial) d.prestretch = 3;
    ASSERT_FALSE(calibration::pull_in(d).has_value());
    const double ratio = calibration::dielectric_curve(d, 5).area_ratios.back();
    // the stretches of that area by bisection along the balance
    double low = loading == DielectricLoading::uniaxial ? 1 / std::sqrt(d.prestretch) : d.prestretch, high = 10;
    const double rest = calibration::plane_stretch(d, low).area();
    for (int i = 0; i < 100; ++i) {
      const double l = (low + high) / 2;
      (calibration::plane_stretch(d, l).area() < ratio * rest ? low : high) = l;
    }
    const auto [l, m] = calibration::plane_stretch(d, low);
    EXPECT_NEAR(l * l + m * m + 1 / (l * l * m * m) - 3, 0.95 * 20, 1e-6);
  }
}

TEST(Dielectric, PullInOfANeoHookeanElastomerIsTheAnalyticOne) {
  const calibration::Dielectric d = acrylic();
  const std::optional<calibration::PullIn> found = calibration::pull_in(d);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->stretch, std::cbrt(2.0), 1e-9);
  const double root = std::sqrt(0.07e6 / (4.4 * 8.8541878128e-12)) * 1e-6;  // sqrt(mu / eps) [kV/mm]
  const double nominal = std::sqrt(std::pow(2, -2.0 / 3) - std::pow(2, -8.0 / 3));
  EXPECT_NEAR(nominal, 0.687, 5e-4);
  EXPECT_NEAR(found->voltage_kV / d.thickness_mm, nominal * root, 1e-9 * root);
  EXPECT_NEAR(found->field_kV_mm, std::pow(2, 2.0 / 3) * nominal * root, 1e-9 * root);
}

TEST(Dielectric, VoltageIsStationaryInTheFreeEnergy) {
  calibration::Dielectric d = acrylic();
  for (const double prestretch : {1.0, 1.5, 3.0})
    for (const calibration::DielectricLaw law :
         {calibration::DielectricLaw::neo_hookean, calibration::DielectricLaw::gent}) {
      d.law = law;
      d.prestretch = prestretch;
      d.stretch_limit = 60;
      for (const double more : {1.02, 1.1, 1.3}) {
        const double expected = stationary_voltage(d, more * prestretch);
        EXPECT_NEAR(calibration::voltage_of(d, more * prestretch), expected, 1e-5 * expected);
      }
      EXPECT_NEAR(calibration::voltage_of(d, prestretch), 0, 1e-6);
    }
}

TEST(Dielectric, PullInIsTheFirstMaximumThatAFineTableHas) {
  for (const double prestretch : {1.0, 1.2, 2.0})
    for (const double limit : {0.0, 20.0, 100.0}) {
      calibration::Dielectric d = acrylic();
      d.prestretch = prestretch;
      if (limit > 0) d.law = calibration::DielectricLaw::gent;
      d.stretch_limit = limit;
      const std::optional<calibration::PullIn> found = calibration::pull_in(d);
      double highest = 0, at = 0;
      const double step = 1e-5 * prestretch, end = limit > 0 ? std::sqrt(0.95 * limit / 2 + 1.4) : 6 * prestretch;
      for (double l = prestretch; l < end; l += step) {
        const double voltage = calibration::voltage_of(d, l);
        if (voltage < highest) break;
        highest = voltage;
        at = l;
      }
      if (at + 2 * step >= end) {
        EXPECT_FALSE(found.has_value()) << prestretch << " " << limit;
        continue;
      }
      ASSERT_TRUE(found.has_value()) << prestretch << " " << limit;
      EXPECT_NEAR(found->stretch, at, 3 * step) << prestretch << " " << limit;
      EXPECT_NEAR(found->voltage_kV, highest, 1e-7);
    }
}

TEST(Dielectric, PrestretchRemovesThePullInOfAGentElastomer) {
  calibration::Dielectric d = acrylic();
  d.law = calibration::DielectricLaw::gent;
  d.stretch_limit = 100;
  EXPECT_TRUE(calibration::pull_in(d).has_value());
  d.prestretch = 5;
  EXPECT_FALSE(calibration::pull_in(d).has_value());
  const calibration::DielectricCurve curve = calibration::dielectric_curve(d, 40);
  EXPECT_FALSE(curve.pull_in.has_value());
  for (std::size_t i = 1; i < curve.voltages.size(); ++i) EXPECT_GT(curve.voltages[i], curve.voltages[i - 1]);
}

TEST(Dielectric, CurveEndsAtPullInOrAtBreakdown) {
  const calibration::Dielectric d = acrylic();
  const calibration::DielectricCurve curve = calibration::dielectric_curve(d, 65);
  EXPECT_NEAR(curve.area_ratios.back(), std::pow(2, 2.0 / 3), 1e-6);
  const MonotoneCurve ratio(curve.voltages, curve.area_ratios);
  for (double fraction = 0.05; fraction < 0.995; fraction += 0.01) {  // between its points against the equation itself
    const double voltage = fraction * curve.voltages.back(), stretch = std::sqrt(ratio.value(voltage));
    EXPECT_NEAR(calibration::voltage_of(d, stretch), voltage, 2e-4 * curve.voltages.back());
  }
  const double half = 0.5 * curve.end_field_kV_mm;
  const calibration::DielectricCurve broken = calibration::dielectric_curve(d, 65, half);
  EXPECT_TRUE(broken.broken_down);
  EXPECT_NEAR(broken.end_field_kV_mm, half, 1e-6 * half);
  EXPECT_FALSE(calibration::dielectric_curve(d, 65, 2 * curve.end_field_kV_mm).broken_down);
}

TEST(Dielectric, RefusesWhatIsNoElastomer) {
  for (const auto& spoil : {+[](calibration::Dielectric& d) { d.shear_modulus_MPa = 0; },
                            +[](calibration::Dielectric& d) { d.thickness_mm = -1; },
                            +[](calibration::Dielectric& d) { d.prestretch = 0.9; },
                            +[](calibration::Dielectric& d) { d.prestretch_across = 0.9; },
                            +[](calibration::Dielectric& d) { d.relative_permittivity = NAN; },
                            +[](calibration::Dielectric& d) {
                              d.law = calibration::DielectricLaw::gent;
                              d.stretch_limit = 0;
                            },
                            +[](calibration::Dielectric& d) {
                              d.law = calibration::DielectricLaw::gent;
                              d.stretch_limit = 20;
                              d.prestretch = 4;
                            }}) {
    calibration::Dielectric d = acrylic();
    spoil(d);
    EXPECT_THROW((void)calibration::pull_in(d), InvalidInput);
  }
  EXPECT_THROW((void)calibration::dielectric_curve(acrylic(), 2), InvalidInput);
  EXPECT_THROW((void)calibration::dielectric_curve(acrylic(), 9, -1), InvalidInput);
}

TEST(Voltage, AreasAreOverThatWithoutVoltageAndBranchesApart) {
  VoltageRun run{"skin.csv", "run 1", {}};
  for (int i = 0; i <= 16; ++i) {
    const double kV = 0.5 * (i <= 8 ? i : 16 - i), s = kV / 4;
    run.rows.push_back({kV, 0.7 * (1 + 0.3 * s * s + (i > 8 ? 0.1 * s * (1 - s) : 0)), 0});
  }
  const calibration::VoltageSamples samples = calibration::voltage_samples({run});
  EXPECT_NEAR(samples.rest_ratios.at(0), 0.7, 1e-12);
  const calibration::CurveFit fit = calibration::fit_curve(samples.samples);
  ASSERT_TRUE(fit.unloading.has_value());
  EXPECT_NEAR(fit.loading.ratio.value(2), 1.075, 1e-12);
  EXPECT_NEAR(fit.unloading->ratio.value(2), 1.1, 1e-12);
  run.rows.erase(run.rows.begin());
  EXPECT_THROW((void)calibration::voltage_samples({run}), InvalidInput);
}

}  // namespace
}  // namespace softkin
