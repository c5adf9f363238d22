#include <gtest/gtest.h>

#include <cmath>
#include <softkin/core/elastic_stability.hpp>

#include "elastic_samples.hpp"

namespace softkin::energy {

namespace {

ElasticLaw ogden_law(std::vector<OgdenTerm> terms, double bulk) {
  ElasticLaw law;
  law.law = Law::ogden;
  law.bulk = bulk;
  std::copy(terms.begin(), terms.end(), law.ogden);
  return law;
}

/// Ogden's law with exponents 2 and -2 is Mooney and Rivlin's with c10 = mu1 / 2, c01 = -mu2 / 2.
ElasticLaw mooney_of(const ElasticLaw& ogden) {
  ElasticLaw law;
  law.law = Law::mooney_rivlin;
  law.bulk = ogden.bulk;
  law.c10 = ogden.ogden[0].mu / 2;
  law.c01 = -ogden.ogden[1].mu / 2;
  return law;
}

/// Principal nominal stresses [MPa] of stretches, by the gradient of the unit tetrahedron in some frame.
Vec3 nominal_stress(const ElasticLaw& law, const Vec3& stretches) {
  Nodes<4> unit;
  unit << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  Sample<4, 1> sample;
  set_law(sample.block.law, law);
  for (int l = 0; l < lanes; ++l) sample.set(l, unit, unit * stretches.asDiagonal());
  const Nodes<4> gradient = gradient_of(force_of(sample.block, sample.current), 5);
  return 6 * gradient.bottomRows<3>().diagonal();
}

template <class ElementKind>
class OgdenLaw : public ::testing::Test {};
using OgdenKinds = testing::Types<Kind<4, 1>, Kind<10, 4>, Kind<6, 6>>;
TYPED_TEST_SUITE(OgdenLaw, OgdenKinds);

}  // namespace

TYPED_TEST(OgdenLaw, IsMooneyRivlinWithExponentsTwoAndMinusTwo) {
  constexpr int K = TypeParam::K;
  Random random(11);
  for (const double second : {0.0, -0.3}) {  // 0: neo-hookean in bar I1
    auto sample = random_sample<K, TypeParam::Q>(Law::ogden, random);
    auto other = sample;
    const ElasticLaw law = ogden_law({{0.8, 2}, {second, -2}}, 3);
    set_law(sample.block.law, law);
    set_law(other.block.law, mooney_of(law));
    const ElasticForce<K> force = force_of(sample.block, sample.current),
                          expected = force_of(other.block, other.current);
    for (const bool projected : {false, true}) {
      const auto stiffness = stiffness_of(sample.block, sample.current, projected);
      const auto same = stiffness_of(other.block, other.current, projected);
      for (int l = 0; l < lanes; ++l) EXPECT_LT((stiffness[l] - same[l]).norm(), 1e-11 * same[l].norm());
    }
    for (int l = 0; l < lanes; ++l) {
      EXPECT_NEAR(force.energy[l], expected.energy[l], 1e-12 * expected.energy[l]);
      EXPECT_LT((gradient_of(force, l) - gradient_of(expected, l)).norm(), 1e-12 * gradient_of(expected, l).norm());
    }
  }
}

/// Stretches that coincide or nearly so, where differences of powers over differences of stretches lose their digits.
TYPED_TEST(OgdenLaw, StiffnessIsThatOfTheForceWhereStretchesCoincide) {
  constexpr int K = TypeParam::K;
  Random random(12);
  for (const double apart : {0.0, 1e-12, 1e-8, 1e-5, 1e-3, 0.1, 0.9}) {
    auto sample = random_sample<K, TypeParam::Q>(Law::ogden, random);
    const Mat3 f = random.rotation() * Vec3(1.3, 1.3 + apart, 0.7).asDiagonal() * random.rotation();
    for (int l = 0; l < lanes; ++l) sample.current[l] = sample.rest[l] * f.transpose();
    const auto stiffness = stiffness_of(sample.block, sample.current);
    constexpr double h = 1e-5;
    for (int n = 0; n < 3 * K; ++n) {
      auto more = sample, less = sample;
      for (int l = 0; l < lanes; ++l) {
        more.current[l](n / 3, n % 3) += h;
        less.current[l](n / 3, n % 3) -= h;
      }
      const ElasticForce<K> up = force_of(more.block, more.current), down = force_of(less.block, less.current);
      for (int l = 0; l < lanes; l += 3) {
        const Nodes<K> slope = (gradient_of(up, l) - gradient_of(down, l)) / (2 * h);
        for (int a = 0; a < K; ++a)
          EXPECT_LT((stiffness[l].template block<3, 1>(3 * a, n) - slope.row(a).transpose()).norm(),
                    2e-8 * stiffness[l].norm())
              << apart;
      }
    }
  }
}

/// Closed forms of an incompressible material, by the difference of two principal stresses.
TEST(OgdenStress, UniaxialEquibiaxialAndPureShear) {
  const std::vector<std::vector<OgdenTerm>> laws{
      {{0.4, 2.5}}, {{0.63, 1.3}, {-0.01, -2}}, {{0.63, 1.3}, {0.0012, 5}, {-0.01, -2}}};  // the last: Ogden 1972
  for (const std::vector<OgdenTerm>& terms : laws)
    for (const double s : {0.6, 0.9, 1.2, 2.0, 4.0, 7.0}) {
      const ElasticLaw law = ogden_law(terms, 500);
      const auto expect = [&](const Vec3& stretches, double ratio, auto&& along) {
        const Vec3 p = nominal_stress(law, stretches);
        double expected = 0;
        for (const OgdenTerm& t : terms) expected += t.mu * along(t.alpha);
        // true stresses: the pressure that holds the volume is the same along all axes
        const Vec3 cauchy = p.cwiseProduct(stretches);
        EXPECT_NEAR((cauchy[0] - cauchy[2]) / s, expected, 1e-11 * (1 + std::abs(expected))) << s << " " << ratio;
      };
      expect({s, 1 / std::sqrt(s), 1 / std::sqrt(s)}, 1,
             [s](double a) { return std::pow(s, a - 1) - std::pow(s, -a / 2 - 1); });
      expect({s, s, 1 / (s * s)}, 2, [s](double a) { return std::pow(s, a - 1) - std::pow(s, -2 * a - 1); });
      expect({s, 1, 1 / s}, 3, [s](double a) { return std::pow(s, a - 1) - std::pow(s, -a - 1); });
    }
}

TEST(OgdenStress, EnergyFromThePrincipalStretches) {
  Random random(13);
  const ElasticLaw law = sample_law(Law::ogden);
  for (int round = 0; round < 20; ++round) {
    const Vec3 s(random.between(1.1, 1.6), random.between(0.8, 1.0), random.between(0.3, 0.7));
    const Mat3 f = random.rotation() * s.asDiagonal() * random.rotation();
    Nodes<4> unit;
    unit << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    Sample<4, 1> sample;
    set_law(sample.block.law, law);
    for (int l = 0; l < lanes; ++l) sample.set(l, unit, unit * f.transpose());
    const double j = s.prod();
    double expected = law.bulk / 2 * (j - 1) * (j - 1);
    for (const OgdenTerm& t : law.ogden)
      expected += t.mu / t.alpha * (std::pow(j, -t.alpha / 3) * s.array().pow(t.alpha).sum() - 3);
    EXPECT_NEAR(6 * force_of(sample.block, sample.current).energy[2], expected, 1e-12 * (1 + expected));
  }
}

/// Terms without an exponent store nothing, whatever their strength.
TEST(OgdenStress, FewerTermsAreTermsOfNoStrength) {
  const ElasticLaw one = ogden_law({{0.4, 2.5}}, 5);
  ElasticLaw three = one;
  three.ogden[1] = {0, 7};
  three.ogden[2] = {0, -3};
  EXPECT_LT((nominal_stress(one, {1.5, 0.9, 0.7}) - nominal_stress(three, {1.5, 0.9, 0.7})).norm(), 1e-15);
}

/// Where a law loses its stability, against the second difference of its energy in logarithms of stretches.
TEST(Stability, LimitIsWhereTheEnergyBendsDownwards) {
  ElasticLaw unstable = ogden_law({{1.0, 2}, {0.2, -1}}, 0);  // mu alpha < 0 of the second term
  const auto energy = [&](const Vec3& logs) {
    double w = 0;
    for (const OgdenTerm& t : unstable.ogden)
      if (t.alpha != 0) w += t.mu / t.alpha * (t.alpha * logs.array()).exp().sum();
    return w;
  };
  const auto bends_down = [&](StretchMode mode, double l) {
    const Vec3 logs = stretches_of(mode, l).array().log();
    for (int i = 0; i < 360; ++i) {
      const double angle = i * std::acos(-1.0) / 360, h = 1e-4;
      const Vec3 along = h * (std::cos(angle) * Vec3(1, -1, 0) + std::sin(angle) * Vec3(1, 1, -2) / std::sqrt(3.0));
      if (energy(logs + along) + energy(logs - along) - 2 * energy(logs) < 0) return true;
    }
    return false;
  };
  double expected = 100;
  for (const StretchMode mode : stretch_modes)
    for (double l = 1; l < expected; l *= 1.005)
      if (bends_down(mode, l)) expected = l;
  ASSERT_LT(expected, 10);
  const auto found = stability_limit(unstable, 10);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->stretch, expected, 0.02 * expected);
  for (const Law law : {Law::neo_hookean, Law::mooney_rivlin, Law::gent, Law::ogden})
    EXPECT_FALSE(stability_limit(sample_law(law), 3)) << static_cast<int>(law);
}

}  // namespace softkin::energy
