#include <gtest/gtest.h>

#include "elastic_samples.hpp"

namespace softkin::energy {

namespace {

template <class ElementKind>
class ElasticDerivatives : public ::testing::Test {};
using Kinds = testing::Types<Kind<4, 1>, Kind<10, 4>, Kind<6, 6>>;
TYPED_TEST_SUITE(ElasticDerivatives, Kinds);

/// Central differences of the energy, all lanes at once.
template <int K, int Q>
std::vector<Nodes<K>> differences_of_energy(const Sample<K, Q>& sample, double step) {
  std::vector<Nodes<K>> result(lanes);
  for (int a = 0; a < K; ++a)
    for (int i = 0; i < 3; ++i) {
      std::vector<Nodes<K>> ahead = sample.current, behind = sample.current;
      for (int l = 0; l < lanes; ++l) ahead[l](a, i) += step, behind[l](a, i) -= step;
      const Pack up = force_of(sample.block, ahead).energy, down = force_of(sample.block, behind).energy;
      for (int l = 0; l < lanes; ++l) result[l](a, i) = (up[l] - down[l]) / (2 * step);
    }
  return result;
}

template <int K, int Q>
std::vector<Eigen::MatrixXd> differences_of_gradient(const Sample<K, Q>& sample, double step) {
  std::vector<Eigen::MatrixXd> result(lanes, Eigen::MatrixXd::Zero(3 * K, 3 * K));
  for (int a = 0; a < K; ++a)
    for (int i = 0; i < 3; ++i) {
      std::vector<Nodes<K>> ahead = sample.current, behind = sample.current;
      for (int l = 0; l < lanes; ++l) ahead[l](a, i) += step, behind[l](a, i) -= step;
      const ElasticForce<K> up = force_of(sample.block, ahead), down = force_of(sample.block, behind);
      for (int l = 0; l < lanes; ++l)
        for (int b = 0; b < K; ++b)
          result[l].block<3, 1>(3 * b, 3 * a + i) =
              (get_lane(up.gradient[b], l) - get_lane(down.gradient[b], l)) / (2 * step);
    }
  return result;
}

template <int K, int Q>
void expect_consistent(const Sample<K, Q>& sample) {
  const int law = static_cast<int>(sample.block.law.law);
  const ElasticForce<K> force = force_of(sample.block, sample.current);
  const auto gradient = differences_of_energy(sample, 1e-5);
  const auto exact = stiffness_of(sample.block, sample.current);
  const auto stiffness = differences_of_gradient(sample, 1e-5);
  for (int l = 0; l < lanes; ++l) {
    const Nodes<K> g = gradient_of(force, l);
    EXPECT_GT(g.norm(), 1e-2);
    EXPECT_LT((g - gradient[l]).norm(), 2e-8 * (1 + g.norm())) << "law " << law << " lane " << l;
    EXPECT_LT((exact[l] - stiffness[l]).norm(), 2e-8 * exact[l].norm()) << "law " << law << " lane " << l;
  }
}

}  // namespace

TYPED_TEST(ElasticDerivatives, AreThoseOfTheEnergyAtLargeDeformations) {
  Random random(1);
  for (const Law law : all_laws)
    for (int round = 0; round < 5; ++round) expect_consistent(random_sample<TypeParam::K, TypeParam::Q>(law, random));
}

TYPED_TEST(ElasticDerivatives, AreThoseOfTheEnergyOfInvertedElements) {
  Random random(2);
  for (const Law law : all_laws)
    for (int round = 0; round < 5 && !forbids_inversion(law); ++round) {
      const auto sample = random_sample<TypeParam::K, TypeParam::Q>(law, random, true, 0.02);
      const auto force = force_of(sample.block, sample.current);
      for (int l = 0; l < lanes; ++l) EXPECT_EQ(force.inverted[l] != 0, l % 2 == 1);
      expect_consistent(sample);
    }
}

TYPED_TEST(ElasticDerivatives, StiffnessIsSymmetricAndTranslationsCostNothing) {
  constexpr int K = TypeParam::K;
  Random random(3);
  for (const Law law : all_laws) {
    const auto sample = random_sample<K, TypeParam::Q>(law, random);
    const ElasticForce<K> force = force_of(sample.block, sample.current);
    for (const bool projected : {false, true}) {
      const auto k = stiffness_of(sample.block, sample.current, projected);
      for (int l = 0; l < lanes; ++l) {
        EXPECT_LT((k[l] - k[l].transpose()).norm(), 1e-13 * k[l].norm());
        Eigen::Matrix<double, 3 * K, 3> translations = Mat3::Identity().template replicate<K, 1>();
        EXPECT_LT((k[l] * translations).norm(), 1e-13 * k[l].norm());
        EXPECT_LT(gradient_of(force, l).colwise().sum().norm(), 1e-13 * gradient_of(force, l).norm());
      }
    }
  }
}

}  // namespace softkin::energy
