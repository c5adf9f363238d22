#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/statics.hpp>

#include "model/block_mesh.hpp"

namespace softkin {
namespace {

template <class Stress>
TensileCurve curve_of(double end, int points, const Stress& stress, double noise = 0) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal(0, 1);
  TensileCurve curve;
  for (int i = 0; i < points; ++i) {
    const double strain = end * i / (points - 1);
    curve.strain.push_back(strain);
    curve.stress.push_back(stress(strain) + (i > 0 && noise > 0 ? noise * normal(engine) : 0));
  }
  return curve;
}

/// Energy of an incompressible law under tension [MPa].
double energy_density(const calibration::IncompressibleLaw& law, double strain) {
  const double s = 1 + strain, e1 = s * s + 2 / s - 3, e2 = 2 * s + 1 / (s * s) - 3;
  return law.c10 * e1 + law.c01 * e2 + law.c20 * e1 * e1 + law.c30 * e1 * e1 * e1;
}

/// The mean nominal stress of a block that Statics stretches, its sides free.
double stretched_block(const ElasticSpec& elastic, double strain) {
  constexpr double side = 10;
  RobotSpec spec = testing::block_robot(testing::block_mesh({2, 2, 2}, {side, side, side}));
  spec.formulation = Formulation::physical;
  spec.materials[0].shape_ratio.reset();
  spec.materials[0].elastic = elastic;
  spec.fixed.clear();
  for (int axis = 0; axis < 3; ++axis) {
    FixedSpec low{{std::string(1, "xyz"[axis]) + "_low", {}}};
    low.axes = {axis == 0, axis == 1, axis == 2};
    spec.fixed.push_back(low);
  }
  FixedSpec high{{std::string("x_high"), {}}};
  high.axes = {true, false, false};
  high.displacement = {strain * side, 0, 0};
  spec.fixed.push_back(high);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve(Actuation(0), statics.rest());
  EXPECT_EQ(found.report.status, Status::converged);
  const physical::Body body(model);
  auto scratch = body.make_scratch();
  Points gradient(model.rest.rows(), 3);
  Team alone(1);
  (void)body.force({Actuation(0)}, found.state.positions, scratch, gradient, alone);
  double force = 0;
  for (Index v = 0; v < model.rest.rows(); ++v)
    if (model.rest(v, 0) > side - 1e-9) force += gradient(v, 0);
  return force / (side * side);
}

}  // namespace

TEST(Uniaxial, StressIsTheSlopeOfTheEnergy) {
  for (const calibration::IncompressibleLaw& law : {calibration::IncompressibleLaw{Law::neo_hookean, 2, 0, 0, 0},
                                                    calibration::IncompressibleLaw{Law::mooney_rivlin, 1, 0.7, 0, 0},
                                                    calibration::IncompressibleLaw{Law::yeoh, 2, 0, -0.3, 0.05}})
    for (const double strain : {-0.4, 0.1, 0.8, 2.0}) {
      const double h = 1e-5;
      EXPECT_NEAR(calibration::uniaxial_stress(law, strain),
                  (energy_density(law, strain + h) - energy_density(law, strain - h)) / (2 * h), 1e-6);
      EXPECT_NEAR(calibration::uniaxial_stress(law, 1e-7) / 1e-7, law.youngs_modulus(), 1e-5);
    }
}

TEST(Uniaxial, LawsOfScenesStretchAsTheirBodies) {
  for (const calibration::IncompressibleLaw& law : {calibration::IncompressibleLaw{Law::neo_hookean, 2, 0, 0, 0},
                                                    calibration::IncompressibleLaw{Law::mooney_rivlin, 1, 0.7, 0, 0},
                                                    calibration::IncompressibleLaw{Law::yeoh, 2, 0, -0.3, 0.05}})
    for (const double nu : {0.3, 0.45})
      for (const double strain : {1e-3, 0.3, 0.8}) {
        const ElasticSpec spec = calibration::scene_constants(law, nu);
        const double stress = calibration::uniaxial_stress(elastic_law(spec, "block", {}), strain);
        EXPECT_NEAR(stretched_block(spec, strain) / stress, 1, 1e-6) << nu << " " << strain;
        if (strain < 0.01) {
          EXPECT_NEAR(stress / strain / law.youngs_modulus(), 1, 0.01);
        }
      }
  EXPECT_THROW((void)calibration::uniaxial_stress(ElasticLaw{}, -0.1), InvalidInput);
  EXPECT_THROW((void)calibration::uniaxial_stress(ElasticLaw{Law::corotational, 1, 1}, 0.1), InvalidInput);
}

/// Near incompressibility the scene's law is the incompressible one.
TEST(Uniaxial, GoesOverIntoTheIncompressibleLaw) {
  const calibration::IncompressibleLaw law{Law::yeoh, 2, 0, -0.3, 0.05};
  const ElasticLaw scene = elastic_law(calibration::scene_constants(law, 0.49999), "material", {});
  for (const double strain : {0.1, 0.5, 1.5})
    EXPECT_NEAR(calibration::uniaxial_stress(scene, strain) / calibration::uniaxial_stress(law, strain), 1, 2e-4);
}

TEST(TensileFit, RecoversConstants) {
  const calibration::IncompressibleLaw yeoh{Law::yeoh, 2, 0, -0.25, 0.03}, mooney{Law::mooney_rivlin, 0.4, 0.9, 0, 0};
  const calibration::LawFit a = calibration::fit_law(
      curve_of(1.5, 31, [&](double e) { return calibration::uniaxial_stress(yeoh, e); }), Law::yeoh);
  EXPECT_NEAR(a.law.c10, 2, 1e-9);
  EXPECT_NEAR(a.law.c20, -0.25, 1e-9);
  EXPECT_NEAR(a.law.c30, 0.03, 1e-9);
  EXPECT_LT(a.quality.rms_mpa, 1e-12);
  EXPECT_NEAR(a.quality.r_squared, 1, 1e-12);
  const calibration::LawFit b = calibration::fit_law(
      curve_of(1.5, 31, [&](double e) { return calibration::uniaxial_stress(mooney, e); }), Law::mooney_rivlin);
  EXPECT_NEAR(b.law.c10, 0.4, 1e-9);
  EXPECT_NEAR(b.law.c01, 0.9, 1e-9);
  const TensileCurve noisy = curve_of(
      1.5, 200, [&](double e) { return calibration::uniaxial_stress(yeoh, e); }, 0.05);
  const calibration::LawFit c = calibration::fit_law(noisy, Law::yeoh);
  EXPECT_NEAR(c.law.c10, 2, 0.03);
  EXPECT_NEAR(c.quality.rms_mpa, 0.05, 0.01);
  EXPECT_EQ(calibration::fit_law(noisy, Law::neo_hookean, 0.5).points, 67u);
}

/// The constrained optimum against brute force over c10 + c01 = bound and beyond.
TEST(TensileFit, HoldsTheInitialModulusAboveZero) {
  const TensileCurve curve = curve_of(1.0, 21, [](double e) { return e * e * e; });
  const calibration::LawFit fit = calibration::fit_law(curve, Law::mooney_rivlin);
  EXPECT_TRUE(fit.at_bound);
  EXPECT_GT(fit.law.c10 + fit.law.c01, 0);
  const auto squares = [&](double c10, double c01) {
    double sum = 0;
    for (std::size_t i = 0; i < curve.strain.size(); ++i)
      sum += std::pow(calibration::uniaxial_stress(calibration::IncompressibleLaw{Law::mooney_rivlin, c10, c01, 0, 0},
                                                   curve.strain[i]) -
                          curve.stress[i],
                      2);
    return sum;
  };
  const double bound = fit.law.c10 + fit.law.c01, found = squares(fit.law.c10, fit.law.c01);
  for (int i = -200; i <= 200; ++i)
    for (const double more : {0.0, 0.01, 0.1}) {
      const double c10 = fit.law.c10 + 0.01 * i;
      EXPECT_GE(squares(c10, bound + more - c10), found - 1e-12);
    }
  EXPECT_FALSE(calibration::fit_law(curve_of(1, 21, [](double e) { return 3 * e; }), Law::mooney_rivlin).at_bound);
}

TEST(TensileFit, SaysWhereAMaterialBecomesUnstable) {
  const calibration::IncompressibleLaw soft{Law::yeoh, 2, 0, -0.9, 0};  // its stress has a maximum
  double pulled = 0, pressed = 0;
  while (calibration::uniaxial_stress(soft, pulled + 1e-4) > calibration::uniaxial_stress(soft, pulled)) pulled += 1e-4;
  while (calibration::uniaxial_stress(soft, pressed - 1e-4) < calibration::uniaxial_stress(soft, pressed))
    pressed -= 1e-4;
  const calibration::LawFit fit = calibration::fit_law(
      curve_of(2.0, 41, [&](double e) { return calibration::uniaxial_stress(soft, e); }), Law::yeoh);
  ASSERT_TRUE(fit.falls_at);
  EXPECT_NEAR(*fit.falls_at, pulled < -pressed ? pulled : pressed, 0.01);
  const calibration::IncompressibleLaw firm{Law::neo_hookean, 2, 0, 0, 0};
  EXPECT_FALSE(calibration::fit_law(curve_of(2.0, 41, [&](double e) { return calibration::uniaxial_stress(firm, e); }),
                                    Law::neo_hookean)
                   .falls_at);
}

TEST(LinearRange, EndsWhereTheCurveLeavesTheLine) {
  const auto knee = [](double e) { return e <= 0.2 ? 45 * e : 9 + 10 * (e - 0.2); };
  const TensileCurve curve = curve_of(0.5, 501, knee);
  const calibration::LinearRange found = calibration::linear_range(curve, 0.02);
  EXPECT_NEAR(found.modulus_mpa, 45, 0.6);
  EXPECT_NEAR(found.end_strain, 0.2, 0.01);
  EXPECT_FALSE(found.whole);
  const calibration::LinearRange line = calibration::linear_range(curve_of(0.2, 50, [](double e) { return 7 * e; }));
  EXPECT_NEAR(line.modulus_mpa, 7, 1e-12);
  EXPECT_TRUE(line.whole);
  EXPECT_NEAR(line.quality.r_squared, 1, 1e-12);
  // the criterion itself, by brute force
  for (std::size_t n = found.points; n <= curve.strain.size(); ++n) {
    double xx = 0, xy = 0, off = 0;
    for (std::size_t i = 0; i < n; ++i) {
      xx += curve.strain[i] * curve.strain[i];
      xy += curve.strain[i] * curve.stress[i];
    }
    for (std::size_t i = 0; i < n; ++i) off = std::max(off, std::abs(curve.stress[i] - xy / xx * curve.strain[i]));
    EXPECT_EQ(off <= 0.02 * xy / xx * curve.strain[n - 1], n == found.points) << n;
  }
}

TEST(LinearRange, RefusesWhatHasNone) {
  EXPECT_THROW((void)calibration::linear_range(curve_of(0.2, 4, [](double e) { return e; })), InvalidInput);
  EXPECT_THROW((void)calibration::linear_range(curve_of(0.2, 20, [](double e) { return 1 + e; })),
               InvalidInput);  // not zeroed
  EXPECT_THROW((void)calibration::linear_range(curve_of(0.2, 20, [](double e) { return -e; })), InvalidInput);
  const calibration::LinearRange offset =
      calibration::linear_range(curve_of(0.2, 20, [](double e) { return 0.3 + 10 * e; }), 0.2);
  EXPECT_NEAR(offset.offset_mpa, 0.3, 1e-9);
}

TEST(TensileFit, RefusesWhatCannotBeFitted) {
  EXPECT_THROW((void)calibration::fit_law(curve_of(1, 20, [](double e) { return -e; }), Law::neo_hookean),
               InvalidInput);
  EXPECT_THROW((void)calibration::fit_law(curve_of(1, 20, [](double e) { return e; }), Law::corotational),
               InvalidInput);
  EXPECT_THROW((void)calibration::fit_law({{0.0, 0.5}, {0.0, 1.0}, {}}, Law::yeoh), InvalidInput);
  EXPECT_THROW((void)calibration::fit_law({{0.0, 0.5, 0.5}, {0.0, 1.0, 1.0}, {}}, Law::mooney_rivlin), InvalidInput);
}

}  // namespace softkin
