#include <gtest/gtest.h>

#include <cmath>

#include "elastic_samples.hpp"

namespace softkin::energy {

namespace {

/// The tetrahedron whose nodes 1 to 3 are the unit vectors: their slopes too, so that the gradient at node a is
/// column a of P / 6.
Nodes<4> unit_tetrahedron() {
  Nodes<4> p;
  p << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  return p;
}

/// Cauchy stress P F^T / J [MPa] of a law at F, from the gradient of the unit tetrahedron.
Mat3 stress_at(const ElasticLaw& law, const Mat3& f) {
  Sample<4, 1> sample;
  set_law(sample.block.law, law);
  for (int l = 0; l < lanes; ++l) sample.set(l, unit_tetrahedron(), unit_tetrahedron() * f.transpose());
  const Nodes<4> gradient = gradient_of(force_of(sample.block, sample.current), 3);
  const Mat3 nominal = 6 * gradient.bottomRows<3>().transpose();
  return nominal * f.transpose() / f.determinant();
}

/// Stiffness of linear elasticity, sum of volume B^T D B in Voigt's notation.
template <int K, int Q>
Eigen::MatrixXd linear_stiffness(const ElasticRest<K, Q>& rest, double youngs_modulus, double poisson_ratio) {
  const double e = youngs_modulus, nu = poisson_ratio;
  Eigen::Matrix<double, 6, 6> d = Eigen::Matrix<double, 6, 6>::Zero();
  d.topLeftCorner<3, 3>().setConstant(nu);
  for (int i = 0; i < 3; ++i) d(i, i) = 1 - nu, d(3 + i, 3 + i) = (1 - 2 * nu) / 2;
  d *= e / ((1 + nu) * (1 - 2 * nu));
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * K, 3 * K);
  for (int q = 0; q < Q; ++q) {
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(6, 3 * K);
    for (int a = 0; a < K; ++a) {
      const auto g = rest.slope[q].row(a);
      for (int i = 0; i < 3; ++i) b(i, 3 * a + i) = g[i];
      b(3, 3 * a) = g[1], b(3, 3 * a + 1) = g[0];
      b(4, 3 * a + 1) = g[2], b(4, 3 * a + 2) = g[1];
      b(5, 3 * a) = g[2], b(5, 3 * a + 2) = g[0];
    }
    k += rest.volume[q] * b.transpose() * d * b;
  }
  return k;
}

template <class ElementKind>
class ElasticLaws : public ::testing::Test {};
using Kinds = testing::Types<Kind<4, 1>, Kind<10, 4>, Kind<6, 6>>;
TYPED_TEST_SUITE(ElasticLaws, Kinds);

}  // namespace

TYPED_TEST(ElasticLaws, RestStateWhereverItIsTurnedHasNoEnergyAndNoForce) {
  constexpr int K = TypeParam::K;
  Random random(1);
  for (const Law law : all_laws) {
    auto sample = random_sample<K, TypeParam::Q>(law, random);
    for (int l = 0; l < lanes; ++l) sample.current[l] = sample.rest[l] * random.rotation().transpose();
    const ElasticForce<K> force = force_of(sample.block, sample.current);
    for (int l = 0; l < lanes; ++l) {
      EXPECT_NEAR(force.energy[l], 0, 1e-13);
      EXPECT_LT(gradient_of(force, l).norm(), 1e-13);
      EXPECT_FALSE(force.inverted[l]);
    }
  }
}

TYPED_TEST(ElasticLaws, RigidMotionKeepsTheEnergyAndTurnsForceAndStiffness) {
  constexpr int K = TypeParam::K;
  Random random(2);
  for (const Law law : all_laws) {
    const auto sample = random_sample<K, TypeParam::Q>(law, random);
    auto moved = sample;
    const Mat3 r = random.rotation();
    for (int l = 0; l < lanes; ++l)
      moved.current[l] = (sample.current[l] * r.transpose()).rowwise() + Eigen::RowVector3d(30, -20, 50);
    const ElasticForce<K> before = force_of(sample.block, sample.current), after = force_of(moved.block, moved.current);
    const auto stiff = stiffness_of(sample.block, sample.current), turned = stiffness_of(moved.block, moved.current);
    Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(3 * K, 3 * K);
    for (int a = 0; a < K; ++a) turn.block<3, 3>(3 * a, 3 * a) = r;
    for (int l = 0; l < lanes; ++l) {
      EXPECT_NEAR(after.energy[l], before.energy[l], 1e-11 * before.energy[l]);
      const Nodes<K> expected = gradient_of(before, l) * r.transpose();
      EXPECT_LT((gradient_of(after, l) - expected).norm(), 1e-11 * expected.norm());
      EXPECT_LT((turned[l] - turn * stiff[l] * turn.transpose()).norm(), 1e-11 * stiff[l].norm());
    }
  }
}

TYPED_TEST(ElasticLaws, StiffnessAtRestIsThatOfLinearElasticity) {
  constexpr int K = TypeParam::K;
  const double e = sample_mu * (3 * sample_lambda + 2 * sample_mu) / (sample_lambda + sample_mu);
  const double nu = sample_lambda / (2 * (sample_lambda + sample_mu));
  Random random(3);
  for (const Law law : all_laws) {
    const auto sample = random_sample<K, TypeParam::Q>(law, random);
    for (const bool projected : {false, true}) {
      const auto k = stiffness_of(sample.block, sample.rest, projected);
      for (int l = 0; l < lanes; ++l) {
        const Eigen::MatrixXd expected = linear_stiffness(elastic_rest(sample.rest[l]), e, nu);
        EXPECT_LT((k[l] - expected).norm(), 1e-13 * expected.norm()) << "law " << static_cast<int>(law);
      }
    }
  }
}

/// An element's lane and its neighbours: the other seven must not matter.
TYPED_TEST(ElasticLaws, ResultsAreTheSameInEveryLane) {
  constexpr int K = TypeParam::K;
  Random random(4);
  for (const Law law : all_laws) {
    const bool mirrored = !forbids_inversion(law);
    auto all = random_sample<K, TypeParam::Q>(law, random, mirrored, 0.02);
    const Nodes<K> rest = all.rest[1], current = all.current[1];
    const ElasticForce<K> force = force_of(all.block, all.current);
    const Eigen::MatrixXd stiffness = stiffness_of(all.block, all.current)[1];
    const Eigen::MatrixXd projected = stiffness_of(all.block, all.current, true)[1];
    for (int l = 0; l < lanes; ++l) {
      auto other = random_sample<K, TypeParam::Q>(law, random, mirrored, 0.02);
      other.set(l, rest, current);
      const ElasticForce<K> again = force_of(other.block, other.current);
      EXPECT_NEAR(again.energy[l], force.energy[1], 1e-13 * force.energy[1]);
      EXPECT_EQ(again.inverted[l], force.inverted[1]);
      EXPECT_LT((gradient_of(again, l) - gradient_of(force, 1)).norm(), 1e-13 * gradient_of(force, 1).norm());
      EXPECT_LT((stiffness_of(other.block, other.current)[l] - stiffness).norm(), 1e-13 * stiffness.norm());
      EXPECT_LT((stiffness_of(other.block, other.current, true)[l] - projected).norm(), 1e-13 * projected.norm());
    }
  }
}

/// Lanes without an element have volume and slopes 0.
TYPED_TEST(ElasticLaws, EmptyLanesGiveZero) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(5);
  for (const Law law : all_laws) {
    auto sample = random_sample<K, Q>(law, random);
    ElasticRest<K, Q> none;
    for (int q = 0; q < Q; ++q) none.slope[q].setZero(), none.volume[q] = 0;
    set_lane(sample.block, 6, none);
    LawBlock& constants = sample.block.law;
    for (Pack* p : {&constants.mu, &constants.lambda, &constants.c10, &constants.c01, &constants.bulk}) (*p)[6] = 0;
    const ElasticForce<K> force = force_of(sample.block, sample.current);
    EXPECT_EQ(force.energy[6], 0);
    EXPECT_EQ(gradient_of(force, 6).norm(), 0);
    EXPECT_FALSE(force.inverted[6]);
    for (const bool projected : {false, true})
      EXPECT_EQ(stiffness_of(sample.block, sample.current, projected)[6].norm(), 0);
  }
}

/// Flat, mirrored, collapsed to a line and to a point, and mirrored with the two smaller stretches equal.
TYPED_TEST(ElasticLaws, HopelessElementsAreMarkedAndFinite) {
  constexpr int K = TypeParam::K;
  const Vec3 stretches[] = {{1, 1, 0}, {1.2, 1, -0.7}, {1, 0, 0}, {0, 0, 0}, {1, 0.5, -0.5}, {-1, -1, -1}};
  Random random(6);
  for (const Law law : all_laws)
    for (const Vec3& s : stretches) {
      auto sample = random_sample<K, TypeParam::Q>(law, random);
      sample.current[2] = sample.rest[2] * s.asDiagonal();
      const ElasticForce<K> force = force_of(sample.block, sample.current);
      if (s.prod() < 0 || s.norm() == 0) {
        EXPECT_TRUE(force.inverted[2]);
        EXPECT_EQ(force.forbidden[2] != 0, forbids_inversion(law));
      }
      EXPECT_FALSE(force.inverted[3]);
      EXPECT_TRUE(std::isfinite(force.energy[2]));
      EXPECT_TRUE(gradient_of(force, 2).allFinite());
      EXPECT_TRUE(stiffness_of(sample.block, sample.current)[2].allFinite());
      EXPECT_TRUE(stiffness_of(sample.block, sample.current, true)[2].allFinite());
    }
}

/// Chains that are stretched out: bar I1 - 3 of the limit just below and at it, in an element that is not inverted.
TYPED_TEST(ElasticLaws, StretchBeyondItsLimitIsForbiddenAndFinite) {
  constexpr int K = TypeParam::K;
  Random random(8);
  auto sample = random_sample<K, TypeParam::Q>(Law::gent, random);
  const double limit = sample_law(Law::gent).jm;
  // uniaxial at constant volume: l^2 + 2 / l - 3 is the limit
  double stretch = std::sqrt(limit + 3);
  for (int i = 0; i < 60; ++i) stretch = std::sqrt(limit + 3 - 2 / stretch);
  for (const double fraction : {0.999, 1.001, 2.0, 50.0}) {
    const double l = fraction * stretch;
    sample.current[2] = sample.rest[2] * Vec3(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal();
    const ElasticForce<K> force = force_of(sample.block, sample.current);
    EXPECT_EQ(force.forbidden[2] != 0, fraction > 1) << fraction;
    EXPECT_FALSE(force.inverted[2]);
    EXPECT_FALSE(force.forbidden[3]);
    EXPECT_TRUE(std::isfinite(force.energy[2]));
    EXPECT_TRUE(gradient_of(force, 2).allFinite());
    EXPECT_TRUE(stiffness_of(sample.block, sample.current, true)[2].allFinite());
  }
}

/// Treloar's tests at constant volume: the difference of the principal stresses does not depend on the pressure.
TEST(ElasticStress, UniaxialAndBiaxialOfIncompressibleRubber) {
  for (const double stretch : {0.6, 0.9, 1.3, 2.0, 4.0})
    for (const bool biaxial : {false, true}) {
      const double across = biaxial ? 1 / (stretch * stretch) : 1 / std::sqrt(stretch);
      const Mat3 f = Vec3(stretch, biaxial ? stretch : across, across).asDiagonal();
      const double squares = stretch * stretch - across * across;
      const double first = f.squaredNorm(), i = first - 3;
      const double second_factor = biaxial ? stretch * stretch : 1 / stretch;  // dI2 / dI1

      const auto difference = [&](const ElasticLaw& law) {
        const Mat3 s = stress_at(law, f);
        return s(0, 0) - s(2, 2);
      };
      const ElasticLaw neo = sample_law(Law::neo_hookean), mooney = sample_law(Law::mooney_rivlin),
                       yeoh = sample_law(Law::yeoh);
      ElasticLaw gent = sample_law(Law::gent);
      gent.jm = 40;  // at a stretch of 4 in two directions I1 - 3 is 29
      const auto expect = [&](const ElasticLaw& law, double expected) {
        EXPECT_NEAR(difference(law), expected, 1e-12 * (1 + std::abs(expected))) << stretch << " " << biaxial;
      };
      expect(neo, neo.mu * squares);
      expect(mooney, 2 * squares * (mooney.c10 + second_factor * mooney.c01));
      expect(yeoh, 2 * squares * (yeoh.c10 + 2 * i * yeoh.c20 + 3 * i * i * yeoh.c30));
      expect(gent, gent.mu * squares * gent.jm / (gent.jm - i));  // Gent 1996
    }
}

/// Pressure of a ball that swells: dW/dJ along F = cbrt(J) I.
TEST(ElasticStress, Hydrostatic) {
  for (const double j : {0.5, 0.9, 1.1, 1.8}) {
    const double s = std::cbrt(j);
    const auto pressure = [&](Law law) {
      const Mat3 stress = stress_at(sample_law(law), s * Mat3::Identity());
      EXPECT_LT((stress - stress(0, 0) * Mat3::Identity()).norm(), 1e-13);
      return stress(0, 0);
    };
    const double strain = (s * s - 1) / 2, bulk = sample_lambda + 2 * sample_mu / 3;
    EXPECT_NEAR(pressure(Law::st_venant_kirchhoff), 3 * bulk * strain / s, 1e-13);
    EXPECT_NEAR(pressure(Law::corotational), 3 * bulk * (s - 1) / (s * s), 1e-13);
    EXPECT_NEAR(pressure(Law::neo_hookean), sample_mu / s - sample_mu + (sample_lambda + sample_mu) * (j - 1), 1e-13);
    EXPECT_NEAR(pressure(Law::mooney_rivlin), bulk * (j - 1), 1e-13);
    EXPECT_NEAR(pressure(Law::yeoh), bulk * (j - 1), 1e-13);
    EXPECT_NEAR(pressure(Law::gent), bulk * (j - 1), 1e-13);
  }
}

/// Every law as core/elastic_law.hpp states it, in the singular values of F (the last one negative where mirrored).
TEST(ElasticStress, EnergyFromThePrincipalStretches) {
  Random random(7);
  for (int round = 0; round < 20; ++round) {
    const bool mirrored = round % 2;
    const Vec3 s(random.between(1.1, 1.6), random.between(0.8, 1.0), random.between(0.3, 0.7) * (mirrored ? -1 : 1));
    const Mat3 f = random.rotation() * s.asDiagonal() * random.rotation();
    const double first = s.squaredNorm(), j = s.prod(), stretch_sum = s.sum() - 3;
    const Vec3 green = 0.5 * (s.array().square() - 1);
    const Vec3 linear = s.array() - 1;
    const auto expect = [&](const ElasticLaw& law, double expected) {
      Sample<4, 1> sample;
      set_law(sample.block.law, law);
      for (int l = 0; l < lanes; ++l) sample.set(l, unit_tetrahedron(), unit_tetrahedron() * f.transpose());
      EXPECT_NEAR(6 * force_of(sample.block, sample.current).energy[0], expected, 1e-13 * (1 + expected));
    };
    const double mu = sample_mu, lambda = sample_lambda;
    expect(sample_law(Law::st_venant_kirchhoff), mu * green.squaredNorm() + lambda / 2 * green.sum() * green.sum());
    expect(sample_law(Law::corotational), mu * linear.squaredNorm() + lambda / 2 * stretch_sum * stretch_sum);
    expect(sample_law(Law::neo_hookean), mu / 2 * (first - 3) - mu * (j - 1) + (lambda + mu) / 2 * (j - 1) * (j - 1));
    if (mirrored) continue;
    const double second = (first * first - s.array().pow(4).sum()) / 2;
    const double i1 = std::pow(j, -2.0 / 3) * first - 3, i2 = std::pow(j, -4.0 / 3) * second - 3;
    const ElasticLaw mooney = sample_law(Law::mooney_rivlin), yeoh = sample_law(Law::yeoh),
                     gent = sample_law(Law::gent);
    const double swelling = mooney.bulk / 2 * (j - 1) * (j - 1);
    expect(mooney, mooney.c10 * i1 + mooney.c01 * i2 + swelling);
    expect(yeoh, yeoh.c10 * i1 + yeoh.c20 * i1 * i1 + yeoh.c30 * i1 * i1 * i1 + swelling);
    expect(gent, -mu / 2 * gent.jm * std::log(1 - i1 / gent.jm) + swelling);
  }
}

}  // namespace softkin::energy
