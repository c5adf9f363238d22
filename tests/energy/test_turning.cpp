#include <gtest/gtest.h>

#include <softkin/energy/elastic.hpp>

#include "elastic_samples.hpp"

namespace softkin::energy {

namespace {

template <class ElementKind>
class Turning : public ::testing::Test {};
using Kinds = testing::Types<Kind<4, 1>, Kind<10, 4>, Kind<6, 6>>;
TYPED_TEST_SUITE(Turning, Kinds);

template <int K, int Q>
std::vector<Nodes<K>> pull_of(const ElasticBlock<K, Q>& block, const std::vector<Nodes<K>>& current,
                              const std::vector<Nodes<K>>& step) {
  Shape<K> shape, moves, pull;
  pack_nodes<K>(current, shape);
  pack_nodes<K>(step, moves);
  turning_pull<K, Q>(block, shape, moves, pull);
  std::vector<Nodes<K>> result(lanes);
  for (int l = 0; l < lanes; ++l)
    for (int a = 0; a < K; ++a) result[l].row(a) = get_lane(pull[a], l).transpose();
  return result;
}

template <int K>
std::vector<Nodes<K>> random_steps(Random& random, double size) {
  std::vector<Nodes<K>> steps;
  for (int l = 0; l < lanes; ++l) steps.push_back(size * random.matrix<Nodes<K>>());
  return steps;
}

/// Volume slope_a . slope_b summed over the points: what turns a field of displacements into pulls.
template <int K, int Q>
Nodes<K> pull_of_field(const ElasticBlock<K, Q>& block, int lane, const Nodes<K>& field) {
  Nodes<K> pull = Nodes<K>::Zero();
  for (int q = 0; q < Q; ++q) {
    Mat3 gradient = Mat3::Zero();
    for (int a = 0; a < K; ++a) gradient += field.row(a).transpose() * get_lane(block.slope[q][a], lane).transpose();
    for (int a = 0; a < K; ++a)
      pull.row(a) += block.volume[q][lane] * (gradient * get_lane(block.slope[q][a], lane)).transpose();
  }
  return pull;
}

}  // namespace

/// What the linear step lacks is of second order: it falls with the square of the step.
TYPED_TEST(Turning, IsOfSecondOrder) {
  Random random(1);
  const auto sample = random_sample<TypeParam::K, TypeParam::Q>(Law::neo_hookean, random);
  const auto steps = random_steps<TypeParam::K>(random, 0.02);
  std::vector<Nodes<TypeParam::K>> half;
  for (const auto& step : steps) half.push_back(0.5 * step);
  const auto whole = pull_of(sample.block, sample.current, steps), less = pull_of(sample.block, sample.current, half);
  for (int l = 0; l < lanes; ++l) {
    EXPECT_GT(whole[l].norm(), 1e-6);
    EXPECT_NEAR(less[l].norm() / whole[l].norm(), 0.25, 0.02) << "lane " << l;
  }
}

/// The tangent of a turn is led to the turn itself, however far: what it lacks is what the turned element has more than
/// the enlarged one.
TYPED_TEST(Turning, ARigidTurnIsExact) {
  constexpr int K = TypeParam::K;
  Random random(2);
  const auto sample = random_sample<K, TypeParam::Q>(Law::neo_hookean, random);
  for (const double angle : {0.1, 1.0, 2.5}) {
    std::vector<Nodes<K>> steps, expected;
    for (int l = 0; l < lanes; ++l) {
      const Vec3 axis = random.matrix<Vec3>().normalized();
      Mat3 cross;
      cross << 0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0;
      steps.push_back(angle * sample.current[l] * cross.transpose());
      const Nodes<K> turned = sample.current[l] * Eigen::AngleAxisd(angle, axis).toRotationMatrix().transpose();
      expected.push_back(pull_of_field(sample.block, l, Nodes<K>(turned - sample.current[l] - steps[l])));
    }
    const auto pulls = pull_of(sample.block, sample.current, steps);
    for (int l = 0; l < lanes; ++l)
      EXPECT_LT((pulls[l] - expected[l]).norm(), 1e-10 * (1 + expected[l].norm())) << "lane " << l;
  }
}

/// A pure stretch turns nothing.
TYPED_TEST(Turning, AStretchLacksNothing) {
  constexpr int K = TypeParam::K;
  Random random(3);
  Sample<K, TypeParam::Q> sample;
  std::vector<Nodes<K>> steps;
  for (int l = 0; l < lanes; ++l) {
    const Nodes<K> rest = sample_rest<K>(random, 0.04);
    sample.set(l, rest, rest);
    const Vec3 stretch(random.between(-0.4, 0.8), random.between(-0.4, 0.8), random.between(-0.4, 0.8));
    steps.push_back(rest * stretch.asDiagonal());
  }
  for (const auto& pull : pull_of(sample.block, sample.current, steps)) EXPECT_LT(pull.norm(), 1e-11);
}

TYPED_TEST(Turning, TurnsWithTheElement) {
  constexpr int K = TypeParam::K;
  Random random(4);
  const auto sample = random_sample<K, TypeParam::Q>(Law::neo_hookean, random);
  const auto steps = random_steps<K>(random, 0.5);
  const Mat3 r = random.rotation();
  std::vector<Nodes<K>> turned, turned_steps;
  for (int l = 0; l < lanes; ++l) {
    turned.push_back((sample.current[l] * r.transpose()).rowwise() + Eigen::RowVector3d(3, -7, 11));
    turned_steps.push_back(steps[l] * r.transpose());
  }
  const auto a = pull_of(sample.block, sample.current, steps), b = pull_of(sample.block, turned, turned_steps);
  for (int l = 0; l < lanes; ++l) EXPECT_LT((b[l] - a[l] * r.transpose()).norm(), 1e-9 * (1 + a[l].norm()));
}

/// Mirrored and flat elements too give finite numbers.
TYPED_TEST(Turning, FiniteForAnyShape) {
  constexpr int K = TypeParam::K;
  Random random(5);
  auto sample = random_sample<K, TypeParam::Q>(Law::neo_hookean, random, true);
  sample.current[0].col(2).setZero();                                      // flat
  sample.current[2].col(2).setZero(), sample.current[2].col(1).setZero();  // a line
  sample.current[4].setZero();                                             // a point
  for (const double size : {0.1, 10.0})
    for (const auto& pull : pull_of(sample.block, sample.current, random_steps<K>(random, size)))
      EXPECT_TRUE(pull.allFinite());
}

}  // namespace softkin::energy
