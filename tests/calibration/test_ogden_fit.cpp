#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <cmath>
#include <random>
#include <softkin/calibration/constrained_fit.hpp>
#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/core/elastic_stability.hpp>

namespace softkin {
namespace {

using calibration::LawChoice;

template <class Stress>
TensileCurve sampled_curve(double end, int points, const Stress& stress) {
  TensileCurve curve;
  for (int i = 0; i < points; ++i) {
    curve.strain.push_back(end * i / (points - 1));
    curve.stress.push_back(stress(curve.strain.back()));
  }
  return curve;
}

double largest(const TensileCurve& curve) {
  return *std::max_element(curve.stress.begin(), curve.stress.end());
}

/// Treloar 1944, vulcanised rubber with 8 % sulphur in tension: stretch, nominal stress in kgf/cm^2.
TensileCurve treloar() {
  constexpr double data[][2] = {{1.02, 0.26}, {1.125, 1.37}, {1.24, 2.3},  {1.39, 3.23}, {1.585, 4.16}, {1.9, 5.1},
                                {2.18, 6.0},  {2.42, 6.9},   {3.02, 8.8},  {3.57, 10.7}, {4.03, 12.5},  {4.76, 16.2},
                                {5.36, 19.9}, {5.76, 23.6},  {6.16, 27.4}, {6.4, 31.0},  {6.62, 34.8},  {6.87, 38.5},
                                {7.05, 42.1}, {7.16, 45.8},  {7.27, 49.6}, {7.43, 53.3}, {7.5, 57.0},   {7.61, 64.4}};
  TensileCurve curve;
  for (const auto& [stretch, stress] : data) {
    curve.strain.push_back(stretch - 1);
    curve.stress.push_back(0.0980665 * stress);
  }
  return curve;
}

}  // namespace

/// Against brute force over the signs of every unknown.
TEST(ConstrainedFit, NonNegativeIsTheBestOfAllSubsets) {
  std::mt19937 engine(5);
  std::normal_distribution<double> normal(0, 1);
  for (int round = 0; round < 50; ++round) {
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(9, 4, [&] { return normal(engine); });
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(9, [&] { return normal(engine); });
    double best = b.squaredNorm();
    for (int subset = 1; subset < 16; ++subset) {
      std::vector<Eigen::Index> columns;
      for (int c = 0; c < 4; ++c)
        if (subset >> c & 1) columns.push_back(c);
      const Eigen::MatrixXd part = a(Eigen::all, columns);
      const Eigen::VectorXd x = (part.transpose() * part).ldlt().solve(part.transpose() * b);
      if (x.minCoeff() >= 0) best = std::min(best, (part * x - b).squaredNorm());
    }
    const Eigen::VectorXd x = calibration::non_negative_fit(a, b);
    EXPECT_GE(x.minCoeff(), 0);
    EXPECT_NEAR((a * x - b).squaredNorm(), best, 1e-10);
  }
}

/// In the plane, against a fine grid of the points that satisfy the conditions.
TEST(ConstrainedFit, StaysWithinItsConditions) {
  Eigen::MatrixXd a(3, 2), g(3, 2);
  a << 1, 0.2, 0.1, 1, 0.5, -0.3;
  g << 1, 0, 0, 1, -1, -1;
  const Eigen::Vector3d b(-1, 2, 0.5), h(0.1, 0.2, -1.5);
  const Eigen::VectorXd x = calibration::constrained_fit(a, b, g, h);
  EXPECT_GE((g * x - h).minCoeff(), -1e-9);
  double best = 1e9;
  for (double u = 0.1; u <= 1.5; u += 0.002)
    for (double v = 0.2; u + v <= 1.5; v += 0.002) best = std::min(best, (a * Eigen::Vector2d(u, v) - b).squaredNorm());
  EXPECT_LE((a * x - b).squaredNorm(), best + 1e-9);
  EXPECT_NEAR((a * x - b).squaredNorm(), best, 0.02);
}

TEST(OgdenFit, RecoversALawOfOneAndTwoTerms) {
  calibration::IncompressibleLaw made{Law::ogden};
  made.ogden[0] = {0.63, 1.3};
  const auto stress = [&](double e) { return calibration::uniaxial_stress(made, e); };
  const calibration::LawFit one = calibration::fit_law(sampled_curve(3, 80, stress), LawChoice{Law::ogden, 1});
  EXPECT_NEAR(one.law.ogden[0].alpha, 1.3, 2e-3);
  EXPECT_NEAR(one.law.ogden[0].mu, 0.63, 2e-3);
  made.ogden[1] = {0.0012, 5};
  const TensileCurve curve = sampled_curve(5, 120, stress);
  const calibration::LawFit two = calibration::fit_law(curve, LawChoice{Law::ogden, 2});
  EXPECT_LT(two.quality.rms_mpa, 1e-3 * largest(curve));
  EXPECT_NEAR(two.law.youngs_modulus(), made.youngs_modulus(), 0.01 * made.youngs_modulus());
}

/// The curve of rubber that is steep at first, flat in the middle and steep at the end, up to 660 %.
TEST(OgdenFit, FollowsTreloarsRubberAndIsStable) {
  const TensileCurve curve = treloar();
  const auto fitted = [&](int terms) { return calibration::fit_law(curve, LawChoice{Law::ogden, terms}); };
  const calibration::LawFit two = fitted(2), three = fitted(3);
  EXPECT_LT(two.quality.rms_mpa, 0.03 * largest(curve));
  EXPECT_LT(three.quality.rms_mpa, 0.03 * largest(curve));
  EXPECT_LE(three.quality.rms_mpa, two.quality.rms_mpa * (1 + 1e-6));
  for (const calibration::LawFit& fit : {fitted(1), two, three}) {
    for (const OgdenTerm& term : fit.law.ogden) EXPECT_GE(term.mu * term.alpha, 0);
    EXPECT_FALSE(stability_limit(calibration::isochoric(fit.law), 20));
    EXPECT_FALSE(fit.falls_at);
  }
}

TEST(TensileFit, GentRecoversItsLimit) {
  calibration::IncompressibleLaw made{Law::gent, 0.1, 0, 0, 0, 30};
  const calibration::LawFit fit = calibration::fit_law(
      sampled_curve(3, 60, [&](double e) { return calibration::uniaxial_stress(made, e); }), LawChoice{Law::gent});
  EXPECT_NEAR(fit.law.jm, 30, 1e-3);
  EXPECT_NEAR(fit.law.c10, 0.1, 1e-6);
}

/// A curve whose best mooney-rivlin and yeoh constants are of materials that no body is made of.
TEST(TensileFit, LawsStayStableUpToTheLargestStrain) {
  const auto stiffening = [](double e) { return 0.1 * e + 0.05 * e * e * e; };
  const auto softening = [](double e) { return e - 0.16 * e * e; };
  for (const TensileCurve& curve : {sampled_curve(3, 60, stiffening), sampled_curve(3, 60, softening)})
    for (const Law law : {Law::mooney_rivlin, Law::yeoh}) {
      const double stretch = 1 + curve.strain.back();
      const calibration::LawFit held = calibration::fit_law(curve, LawChoice{law}),
                                free = calibration::fit_law(curve, LawChoice{law, 0, false});
      EXPECT_FALSE(stability_limit(calibration::isochoric(held.law), 0.98 * stretch)) << static_cast<int>(law);
      EXPECT_GE(held.quality.rms_mpa, free.quality.rms_mpa * (1 - 1e-9));
      EXPECT_EQ(held.free_rms_mpa.has_value(),
                stability_limit(calibration::isochoric(free.law), 0.98 * stretch).has_value());
      if (held.free_rms_mpa) {
        EXPECT_NEAR(*held.free_rms_mpa, free.quality.rms_mpa, 1e-9);
      }
    }
}

TEST(TensileFit, OgdensLawOfASceneStretchesAsTheFit) {
  calibration::IncompressibleLaw made{Law::ogden};
  made.ogden[0] = {0.63, 1.3};
  made.ogden[1] = {-0.01, -2};
  const ElasticSpec spec = calibration::scene_constants(made, 0.4999);
  ASSERT_EQ(spec.ogden.size(), 2u);
  const TensileCurve curve = sampled_curve(2, 30, [&](double e) { return calibration::uniaxial_stress(made, e); });
  EXPECT_LT(calibration::scene_quality(curve, spec).rms_mpa, 2e-3 * largest(curve));
}

}  // namespace softkin
