#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <softkin/calibration/ratio_fit.hpp>

#include "statics/reference_cases.hpp"

namespace softkin {
namespace {

struct Bar {
  const char* name;
  double ratio, poisson_ratio;
};

std::string table_of(const Bar& bar, const std::string& test) {
  return std::string("bar/bar_L1_50_c3d10_") + bar.name + "_" + test + ".csv";
}

StretchedSpecimen specimen_of(const testing::ReferenceTable& table, std::size_t row) {
  StretchedSpecimen specimen;
  specimen.length_mm = 100;
  specimen.interface_mm = 50;
  specimen.stretch_mm = table.at(row, "imposed_dL_mm");
  specimen.interface_moved_mm = table.at(row, "dL1_mean_mm");
  return specimen;
}

StretchedSpecimen stretched_by(const testing::ReferenceTable& table, double stretch_mm) {
  for (std::size_t row = 0; row < table.rows(); ++row)
    if (std::abs(table.at(row, "imposed_dL_mm") - stretch_mm) < 1e-6) return specimen_of(table, row);
  throw InvalidInput("the reference has no such row");
}

/// The row with this imposed twist [degrees].
TwistedSpecimen twist_of(const testing::ReferenceTable& table, double twist_deg) {
  TwistedSpecimen specimen;
  specimen.length_mm = 100;
  specimen.interface_mm = 50;
  specimen.twist_deg = twist_deg;
  for (std::size_t row = 0; row < table.rows(); ++row)
    if (std::abs(table.at(row, "imposed_twist_deg") - twist_deg) < 1e-6)
      specimen.interface_deg = table.at(row, "interface_rot_deg");
  EXPECT_TRUE(specimen.interface_deg) << "no such row";
  return specimen;
}

}  // namespace

/// Quadratic tetrahedra of another program, St. Venant-Kirchhoff. Eq. (16) alone is 2.5 % off at 0.1 % of elongation
/// (the jaws) and 16 % at 10 %; the simulation of the same test is not.
TEST(MaterialReference, RecoversTheBarOfTwoMaterials) {
  for (const Bar& bar : {Bar{"Rm3p75_nu45", 3.75, 0.45}, Bar{"Rm5p68_nu30", 5.68, 0.30}}) {
    const testing::ReferenceTable stretch(table_of(bar, "clamped")), twist(table_of(bar, "twist"));
    const std::vector<StretchedSpecimen> specimens{stretched_by(stretch, 1), stretched_by(stretch, 10)};
    calibration::SpecimenOptions options;
    options.law = Law::st_venant_kirchhoff;
    options.poisson_ratio = bar.poisson_ratio;
    options.cells = 2;
    const calibration::RatioFit fit = calibration::fit_ratio(specimens, options, Formulation::physical);
    ASSERT_EQ(fit.status, Status::converged);
    const TwistedSpecimen turned = twist_of(twist, 20);
    const calibration::SpecimenResponse response =
        calibration::predict(std::vector{turned}, options, Formulation::physical, std::log(fit.estimate.ratio)).front();
    ASSERT_EQ(response.status, Status::converged);
    std::printf("  %s: E_A / E_B %.4f (Eq. (16): %.3f and %.3f), twist %.4f of %.4f degrees\n", bar.name,
                fit.estimate.ratio, calibration::elasticity_ratio(specimens[0]),
                calibration::elasticity_ratio(specimens[1]), response.turned_deg, *turned.interface_deg);
    EXPECT_NEAR(fit.estimate.ratio / bar.ratio, 1, 0.005);
    for (std::size_t i = 0; i < specimens.size(); ++i)
      EXPECT_NEAR(fit.specimens[i].response.moved_mm / specimens[i].interface_moved_mm, 1, 0.003);
    EXPECT_NEAR(response.turned_deg / *turned.interface_deg, 1, 0.005);
  }
}

/// Table II: target shapes fitted to the same tension. With R_omega = 1 in the stiffer part they have its Poisson's
/// ratio wrong, and so the shear; with the R_omega of its Poisson's ratio they twist as the reference does.
TEST(MaterialReference, TargetShapesTwistAsTheReferenceWithThePoissonRatioOfTheStiffer) {
  struct Case {
    Bar bar;
    double found, printed;  // R_A / R_B: of the simulation with R_A = 1, and of Table II
    double found_off, printed_off, with_poisson_off;
  };
  for (const Case& c : {Case{{"Rm3p75_nu45", 3.75, 0.45}, 4.96, 7.08, -0.19, -0.39, 0.03},
                        Case{{"Rm5p68_nu45", 5.68, 0.45}, 7.78, 10.30, -0.22, -0.38, 0.04}}) {
    const testing::ReferenceTable stretch(table_of(c.bar, "clamped")), twist(table_of(c.bar, "twist"));
    const std::vector<StretchedSpecimen> specimens{stretched_by(stretch, 1)};
    const std::vector<TwistedSpecimen> twisted{twist_of(twist, 20)};
    calibration::SpecimenOptions options;
    const auto off = [&](double ratio) {
      const auto found = calibration::predict(twisted, options, Formulation::target_shape, std::log(ratio));
      return found.front().turned_deg / *twisted[0].interface_deg - 1;
    };
    const calibration::RatioFit stiff = calibration::fit_ratio(specimens, options, Formulation::target_shape);
    ASSERT_EQ(stiff.status, Status::converged);
    const double converged = off(stiff.estimate.ratio), printed = off(c.printed);
    options.stiffer_shape_ratio = calibration::shape_ratio_of_poisson_ratio(0.45);
    const calibration::RatioFit right = calibration::fit_ratio(specimens, options, Formulation::target_shape);
    ASSERT_EQ(right.status, Status::converged);
    const double with_poisson = off(right.estimate.ratio);
    std::printf("  R_A / R_B %.3f: twist off by %.1f %%; %.2f: %.1f %%; %.3f with R_A %.3f: %.1f %%\n",
                stiff.estimate.ratio, 100 * converged, c.printed, 100 * printed, right.estimate.ratio,
                options.stiffer_shape_ratio, 100 * with_poisson);
    EXPECT_NEAR(stiff.estimate.ratio, c.found, 0.02);
    for (const calibration::RatioFit& fit : {stiff, right})
      EXPECT_NEAR(fit.specimens[0].response.moved_mm / specimens[0].interface_moved_mm, 1, 1e-4);
    EXPECT_LT(std::abs(with_poisson), c.with_poisson_off);
    EXPECT_NEAR(converged, c.found_off, 0.01);
    EXPECT_NEAR(printed, c.printed_off, 0.01);
  }
}

}  // namespace softkin
