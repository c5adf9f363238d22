#include <gtest/gtest.h>

#include <cmath>
#include <softkin/calibration/actuator_curves.hpp>
#include <softkin/calibration/actuator_samples.hpp>
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
  for (double share = 0.05; share < 0.995; share += 0.01) {  // between its points against the equation itself
    const double voltage = share * curve.voltages.back(), stretch = std::sqrt(ratio.value(voltage));
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
