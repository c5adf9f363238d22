#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <softkin/energy/sheet.hpp>

/// Sheets in plane stress: derivatives by differences, and those that wrinkle against a search over all wrinkles.

namespace softkin::energy {

namespace {

SheetLaw orthotropic(double e1, double e2, double g12, double nu12, bool tension_only) {
  SheetLaw law;
  law.compliance << 1 / e1, -nu12 / e1, 0, -nu12 / e1, 1 / e2, 0, 0, 0, 1 / g12;
  law.stiffness = law.compliance.inverse();
  law.tension_only = tension_only;
  return law;
}

/// The least energy of strain + P, P = sum of two wrinkles across each other, over their direction and depths.
double min_energy(const SheetLaw& law, const Vec3& strain) {
  constexpr int directions = 2000;
  double least = strain.dot(law.stiffness * strain) / 2;
  for (int i = 0; i < directions; ++i) {
    const double c = std::cos(std::numbers::pi * i / directions), s = std::sin(std::numbers::pi * i / directions);
    Eigen::Matrix<double, 3, 2> wrinkles;
    wrinkles << c * c, s * s, s * s, c * c, 2 * c * s, -2 * c * s;
    // a convex quadratic in two depths of 0 or more: both, one or none
    const Eigen::Matrix2d second = wrinkles.transpose() * law.stiffness * wrinkles;
    const Eigen::Vector2d first = wrinkles.transpose() * law.stiffness * strain;
    const auto energy = [&](const Eigen::Vector2d& depth) {
      const Vec3 e = strain + wrinkles * depth;
      return e.dot(law.stiffness * e) / 2;
    };
    const Eigen::Vector2d both = -second.inverse() * first;
    if (both.minCoeff() >= 0) least = std::min(least, energy(both));
    for (int k = 0; k < 2; ++k)
      least = std::min(least, energy(std::max(0.0, -first[k] / second(k, k)) * Eigen::Vector2d::Unit(k)));
  }
  return least;
}

/// Those of the energy and, where nothing changes its state, of the stress against differences.
void expect_derivatives(const SheetLaw& law, const Vec3& strain, double tolerance) {
  constexpr double little = 1e-6;
  const SheetResponse at = sheet_response(law, strain);
  for (int k = 0; k < 3; ++k) {
    const auto high = sheet_response(law, strain + little * Vec3::Unit(k));
    const auto low = sheet_response(law, strain - little * Vec3::Unit(k));
    EXPECT_NEAR(at.stress[k], (high.energy - low.energy) / (2 * little), 1e-7);
    if (high.state == low.state) {
      EXPECT_LT((at.tangent.col(k) - (high.stress - low.stress) / (2 * little)).norm(), tolerance);
    }
  }
}

}  // namespace

TEST(Sheet, SmoothOnesBecomeThoseWithKinks) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> any(-0.1, 0.1);
  constexpr double little = 1e-5;
  for (const SheetLaw& law : {orthotropic(2, 2, 2 / 2.6, 0.3, true), orthotropic(20, 1, 0.3, 0.4, true)})
    for (int i = 0; i < 40; ++i) {
      const Vec3 strain(any(engine), any(engine), 2 * any(engine));
      const double size = (law.stiffness * strain).norm();
      for (const double barrier : {1e-4, 1e-8}) {
        const SheetResponse found = smooth_sheet_response(law, strain, barrier);
        EXPECT_GT(found.stress[0] * found.stress[1], found.stress[2] * found.stress[2]);
        EXPECT_GT(found.stress[0], 0);
        for (int k = 0; barrier > 1e-6 && k < 3; ++k) {
          const Vec3 step = little * Vec3::Unit(k);
          const SheetResponse high = smooth_sheet_response(law, strain + step, barrier),
                              low = smooth_sheet_response(law, strain - step, barrier);
          EXPECT_NEAR(found.stress[k], (high.energy - low.energy) / (2 * little), 1e-6 * size);
          EXPECT_LT((found.tangent.col(k) - (high.stress - low.stress) / (2 * little)).norm(),
                    1e-4 * law.stiffness(0, 0));
        }
      }
      const Vec3 sharp = smooth_sheet_response(law, strain, 1e-12).stress;
      EXPECT_LT((sharp - sheet_response(law, strain).stress).norm(), 1e-4 * size) << strain.transpose();
    }
}

TEST(Sheet, WrinklesToTheLeastEnergy) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> any(-0.1, 0.1);
  int seen[3] = {};
  for (const SheetLaw& law : {orthotropic(2, 2, 2 / 2.6, 0.3, true), orthotropic(20, 1, 0.3, 0.4, true)})
    for (int i = 0; i < 60; ++i) {
      const Vec3 strain(any(engine), any(engine), 2 * any(engine));
      const SheetResponse found = sheet_response(law, strain);
      const double plain = strain.dot(law.stiffness * strain) / 2;
      EXPECT_NEAR(found.energy, min_energy(law, strain), 2e-5 * plain) << strain.transpose();
      EXPECT_GE(found.energy, 0);
      ++seen[static_cast<int>(found.state)];
    }
  for (const int times : seen) EXPECT_GT(times, 5);
}

namespace {

SheetLaw rubber(const SheetRubber& constants, bool tension_only) {
  const double modulus = constants.youngs_modulus();
  SheetLaw law = orthotropic(modulus, modulus, modulus / 3, 0.5, tension_only);
  law.rubber = constants;
  return law;
}

/// By the principal stretches, the third of which keeps the volume.
double energy_of(const SheetRubber& rubber, double first, double second) {
  const double third = 1 / (first * second);
  const double i1 = first * first + second * second + third * third - 3;
  const double i2 = 1 / (first * first) + 1 / (second * second) + 1 / (third * third) - 3;
  return rubber.c10 * i1 + rubber.c01 * i2 + rubber.c20 * i1 * i1 + rubber.c30 * i1 * i1 * i1;
}

Vec3 strain_of(double first, double second, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const double e1 = (first * first - 1) / 2, e2 = (second * second - 1) / 2;
  return {c * c * e1 + s * s * e2, s * s * e1 + c * c * e2, 2 * c * s * (e1 - e2)};
}

}  // namespace

TEST(Sheet, RubberStoresTheLeastThatItsStretchesAllow) {
  std::mt19937 engine(6);
  std::uniform_real_distribution<double> stretch(0.6, 1.8), angle(0, 3);
  int seen[3] = {};
  for (const SheetRubber& constants :
       {SheetRubber{0.2, 0, 0, 0}, SheetRubber{0.1, 0.05, 0, 0}, SheetRubber{0.15, 0, -0.002, 0.0004}})
    for (int i = 0; i < 60; ++i) {
      const double a = stretch(engine), b = stretch(engine), at = angle(engine);
      const double first = std::max(a, b), second = std::min(a, b);
      const double plain = energy_of(constants, first, second);
      const Vec3 strain = strain_of(first, second, at);
      EXPECT_NEAR(sheet_response(rubber(constants, false), strain).energy, plain, 1e-12);
      double least = plain;  // over all wider shapes, of which the wrinkles take what is too much
      for (double wide = second; wide < 2; wide += 1e-4) {
        least = std::min(least, energy_of(constants, first, wide));
        if (first < 1) least = 0;
      }
      const SheetResponse found = sheet_response(rubber(constants, true), strain);
      EXPECT_NEAR(found.energy, least + 1e-6 * (plain - least), 1e-6) << first << ' ' << second;
      ++seen[static_cast<int>(found.state)];
    }
  for (const int times : seen) EXPECT_GT(times, 5);
}

TEST(Sheet, DerivativesOfRubberAreThoseOfItsEnergy) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> stretch(0.6, 1.8), angle(0, 3);
  for (const bool tension_only : {false, true})
    for (int i = 0; i < 100; ++i) {
      const SheetLaw law = rubber({0.1, 0.04, -0.001, 0.0003}, tension_only);
      const Vec3 strain = strain_of(stretch(engine), stretch(engine), angle(engine));
      expect_derivatives(law, strain, 1e-6);
    }
  const SheetLaw law = rubber({0.1, 0.04, 0, 0}, false);
  EXPECT_LT((sheet_response(law, Vec3::Zero()).tangent - law.stiffness).norm(), 1e-12);
  EXPECT_FALSE(std::isfinite(sheet_response(law, Vec3(0.1, -0.5, 0)).energy));
}

TEST(Sheet, DerivativesAreThoseOfTheEnergy) {
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> any(-0.1, 0.1);
  for (const bool tension_only : {false, true})
    for (int i = 0; i < 100; ++i) {
      const SheetLaw law = orthotropic(8, 1.5, 0.6, 0.35, tension_only);
      const Vec3 strain(any(engine), any(engine), 2 * any(engine));
      expect_derivatives(law, strain, 1e-5);
      EXPECT_GE(Eigen::SelfAdjointEigenSolver<Mat3>(sheet_response(law, strain).tangent).eigenvalues().minCoeff(),
                -1e-9);
    }
}

}  // namespace softkin::energy
