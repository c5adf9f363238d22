#include <gtest/gtest.h>

#include "elastic_samples.hpp"

namespace softkin::energy {

namespace {

template <class ElementKind>
class ElasticProjected : public ::testing::Test {};
using Kinds = testing::Types<Kind<4, 1>, Kind<10, 4>, Kind<6, 6>>;
TYPED_TEST_SUITE(ElasticProjected, Kinds);

/// d^2W/dF^2 (entry (i, k) of F at 3 k + i), from the exact stiffness of the tetrahedron whose slopes at nodes 1 to 3
/// are the unit vectors.
Eigen::MatrixXd second_derivative(const LawBlock& law, const Mat3& f) {
  Nodes<4> unit;
  unit << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  Sample<4, 1> sample;
  sample.block.law = law;
  for (int l = 0; l < lanes; ++l) sample.set(l, unit, unit * f.transpose());
  return 6 * stiffness_of(sample.block, sample.current)[0].bottomRightCorner<9, 9>();
}

Eigen::MatrixXd nearest_semidefinite(const Eigen::MatrixXd& a, bool& definite) {
  const SymmetricEigen eigen = symmetric_eigen(a);
  definite = definite && eigen.values[0] >= 0;
  return eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() * eigen.vectors.transpose();
}

/// The projected stiffness by brute force; definite: nothing was projected.
template <int K, int Q>
Eigen::MatrixXd brute_force(const Sample<K, Q>& sample, int lane, bool& definite) {
  const ElasticRest<K, Q> rest = elastic_rest(sample.rest[lane]);
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * K, 3 * K);
  definite = true;
  for (int q = 0; q < Q; ++q) {
    const Mat3 f = sample.current[lane].transpose() * rest.slope[q];
    Eigen::MatrixXd by_nodes = Eigen::MatrixXd::Zero(9, 3 * K);
    for (int a = 0; a < K; ++a)
      for (int j = 0; j < 3; ++j) by_nodes.block<3, 3>(3 * j, 3 * a) = rest.slope[q](a, j) * Mat3::Identity();
    const Eigen::MatrixXd a = nearest_semidefinite(second_derivative(sample.block.law, f), definite);
    k += rest.volume[q] * by_nodes.transpose() * a * by_nodes;
  }
  return k;
}

/// Every third element is compressed, every second is inverted if `mirrored`, the others are stretched.
template <int K, int Q>
Sample<K, Q> mixed_sample(Law law, Random& random, bool mirrored) {
  auto sample = random_sample<K, Q>(law, random, mirrored, 0.02);
  for (int l = 0; l < lanes; l += 3)
    sample.current[l] =
        sample.rest[l] * Vec3(0.5, 0.6, 0.75).asDiagonal() * random.rotation() + 0.02 * random.matrix<Nodes<K>>();
  for (int l = 1; l < lanes; l += 3)
    sample.current[l] =
        sample.rest[l] * Vec3(1.02, 1.03, 1.05).asDiagonal() * random.rotation() + 0.002 * random.matrix<Nodes<K>>();
  return sample;
}

}  // namespace

TYPED_TEST(ElasticProjected, IsTheNearestSemidefiniteOneAtEveryPoint) {
  constexpr int K = TypeParam::K;
  Random random(1);
  for (const Law law : all_laws) {
    int projected_lanes = 0, exact_lanes = 0;
    for (int round = 0; round < 6; ++round) {
      const auto sample = mixed_sample<K, TypeParam::Q>(law, random, round % 2 && !forbids_inversion(law));
      const auto exact = stiffness_of(sample.block, sample.current);
      const auto projected = stiffness_of(sample.block, sample.current, true);
      for (int l = 0; l < lanes; ++l) {
        bool definite;
        const Eigen::MatrixXd expected = brute_force(sample, l, definite);
        EXPECT_LT((projected[l] - expected).norm(), 1e-11 * expected.norm()) << "law " << static_cast<int>(law);
        ++(definite ? exact_lanes : projected_lanes);
        if (definite) {
          EXPECT_LT((projected[l] - exact[l]).norm(), 1e-12 * exact[l].norm());
        } else {
          EXPECT_GT((projected[l] - exact[l]).norm(), 1e-6 * exact[l].norm());
        }
      }
    }
    EXPECT_GT(projected_lanes, 5);
    EXPECT_GT(exact_lanes, 5);
  }
}

TYPED_TEST(ElasticProjected, HasNoNegativeEigenvalue) {
  constexpr int K = TypeParam::K;
  Random random(2);
  for (const Law law : all_laws) {
    double worst_exact = 0;
    for (int round = 0; round < 4; ++round) {
      const auto sample = mixed_sample<K, TypeParam::Q>(law, random, round % 2 && !forbids_inversion(law));
      const auto exact = stiffness_of(sample.block, sample.current);
      const auto projected = stiffness_of(sample.block, sample.current, true);
      for (int l = 0; l < lanes; ++l) {
        const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(projected[l]);
        EXPECT_GT(eigenvalues[0], -1e-13 * eigenvalues[3 * K - 1]);
        worst_exact = std::min(worst_exact, symmetric_eigenvalues(exact[l])[0]);
      }
    }
    EXPECT_LT(worst_exact, -0.01);  // there was something to project
  }
}

}  // namespace softkin::energy
