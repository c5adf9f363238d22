#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <softkin/energy/viscous.hpp>

#include "elastic_samples.hpp"

namespace softkin::energy {
namespace {

/// A block of one element in every lane, without an elastic law's energy, and branches with a past.
template <int K, int Q>
struct Sample {
  static constexpr int branches = 2;
  ElasticBlock<K, Q> block;
  Nodes<K> rest, current;
  Pack modulus[branches], kept[branches];
  std::vector<double> strains = std::vector<double>(std::size_t{6} * lanes * branches * Q);

  Sample(Random& random, double share) {
    rest = sample_rest<K>(random);
    const ElasticRest<K, Q> shape = elastic_rest(rest);
    for (int q = 0; q < Q; ++q) {
      block.volume[q] = pack(shape.volume[q]);
      for (int a = 0; a < K; ++a)
        for (int l = 0; l < lanes; ++l) set_lane(block.slope[q][a], l, shape.slope[q].row(a).transpose());
    }
    current = rest * random.deformation(false).transpose() + 0.05 * random.matrix<Nodes<K>>();
    for (int i = 0; i < branches; ++i) {
      modulus[i] = pack(0.3 + 0.4 * i);
      kept[i] = pack(std::pow(share, i + 1));
    }
    for (int point = 0; point < Q * branches; ++point) {
      const Mat3 f = random.deformation(false);
      const Mat3 c = f.transpose() * f / std::pow(f.determinant(), 2.0 / 3);
      put(point, c);
    }
  }
  void put(int point, const Mat3& c) {
    const double entries[6] = {c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(1, 2), c(0, 2)};
    for (int e = 0; e < 6; ++e)
      for (int l = 0; l < lanes; ++l) strains[static_cast<std::size_t>((6 * point + e) * lanes + l)] = entries[e];
  }
  [[nodiscard]] Mat3 strain(int point, const std::vector<double>& of) const {
    const auto e = [&](int entry) { return of[static_cast<std::size_t>((6 * point + entry) * lanes)]; };
    Mat3 c;
    c << e(0), e(3), e(5), e(3), e(1), e(4), e(5), e(4), e(2);
    return c;
  }
  [[nodiscard]] ViscousBlock viscous() const { return {branches, modulus, kept, strains.data()}; }
  void load(const Nodes<K>& nodes, Shape<K>& shape) const {
    for (int a = 0; a < K; ++a)
      for (int l = 0; l < lanes; ++l) set_lane(shape[a], l, nodes.row(a).transpose());
  }
  [[nodiscard]] std::pair<double, Nodes<K>> force(const Nodes<K>& nodes) const {
    Shape<K> shape;
    load(nodes, shape);
    ElasticForce<K> out{};
    add_viscous_force<K, Q>(block, viscous(), shape, out);
    Nodes<K> gradient;
    for (int a = 0; a < K; ++a) gradient.row(a) << out.gradient[a].x[0], out.gradient[a].y[0], out.gradient[a].z[0];
    return {out.energy[0], gradient};
  }
  [[nodiscard]] Eigen::MatrixXd stiffness(bool projected) const {
    Shape<K> shape;
    load(current, shape);
    ElasticStiffness<K> out{};
    add_viscous_stiffness<K, Q>(block, viscous(), shape, projected, out);
    Eigen::MatrixXd k(3 * K, 3 * K);
    for (int a = 0; a < K; ++a)
      for (int b = 0; b <= a; ++b)
        for (int r = 0; r < 3; ++r) {
          const Pack3& row = out.block[a * (a + 1) / 2 + b].row[r];
          k.block<1, 3>(3 * a + r, 3 * b) << row.x[0], row.y[0], row.z[0];
          k.block<3, 1>(3 * b, 3 * a + r) = k.block<1, 3>(3 * a + r, 3 * b).transpose();
        }
    return k;
  }
};

template <class Kind>
class Viscous : public testing::Test {};
using Kinds = testing::Types<Kind<4, 1>, Kind<10, 4>, Kind<6, 6>>;
TYPED_TEST_SUITE(Viscous, Kinds);

TYPED_TEST(Viscous, ForcesAndStiffnessAreTheDerivativesOfTheEnergy) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(3);
  for (const double share : {1.0, 1 - 1e-9, 0.7, 0.05, 0.0}) {
    const Sample<K, Q> sample(random, share);
    const Nodes<K> gradient = sample.force(sample.current).second;
    const Eigen::MatrixXd k = sample.stiffness(false);
    const double step = 1e-5, largest = std::max(0.1, k.cwiseAbs().maxCoeff());
    for (int a = 0; a < K; ++a)
      for (int axis = 0; axis < 3; ++axis) {
        Nodes<K> below = sample.current, above = sample.current;
        below(a, axis) -= step;
        above(a, axis) += step;
        const auto low = sample.force(below), high = sample.force(above);
        EXPECT_NEAR((high.first - low.first) / (2 * step), gradient(a, axis), 1e-8 * largest) << share;
        const Nodes<K> change = (high.second - low.second) / (2 * step);
        for (int b = 0; b < K; ++b)
          for (int other = 0; other < 3; ++other)
            EXPECT_NEAR(change(b, other), k(3 * a + axis, 3 * b + other), 1e-8 * largest) << share;
      }
    if (share == 0.0) {
      EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-14);  // relaxed
      EXPECT_NEAR(sample.force(sample.current).first, 0, 1e-14);
    }
    const Eigen::MatrixXd projected = sample.stiffness(true);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected).eigenvalues().minCoeff(), -1e-12 * largest);
  }
}

/// The step in C_v against the equation that it integrates, by Runge and Kutta's method in many small steps, while the
/// strain is held; and its energy against the definition.
TYPED_TEST(Viscous, FlowsAsTheBranchEquationSays) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(5);
  const double kept = std::exp(-1e-4);  // a short step: of first order
  Sample<K, Q> sample(random, kept);
  Shape<K> shape;
  sample.load(sample.current, shape);
  std::vector<double> after = sample.strains;
  (void)flow<K, Q>(sample.block, sample.viscous(), shape, after.data());
  const ElasticRest<K, Q> rest = elastic_rest(sample.rest);
  double energy = 0;
  for (int q = 0; q < Q; ++q) {
    const Mat3 f = sample.current.transpose() * rest.slope[q];
    const Mat3 bar = f.transpose() * f / std::pow(f.determinant(), 2.0 / 3);
    for (int i = 0; i < 2; ++i) {
      const Mat3 before = sample.strain(2 * q + i, sample.strains), now = sample.strain(2 * q + i, after);
      EXPECT_NEAR(now.determinant(), 1, 1e-12);
      const double duration = 1e-4 * (i + 1);  // over the relaxation time
      const Mat3 rate = bar - (bar * before.inverse()).trace() / 3 * before;
      EXPECT_LT((now - before - duration * rate).norm(), 3 * duration * duration * rate.norm() * bar.norm()) << i;
      energy += rest.volume[q] * 0.5 * sample.modulus[i][0] * ((bar * before.inverse()).trace() - 3);
    }
  }
  Sample<K, Q> instant = sample;
  for (Pack& k : instant.kept) k = pack(1);
  EXPECT_NEAR(instant.force(sample.current).first, energy, 1e-12 * energy);
}

/// What a branch pulls with after the step is the pull of a spring from the C_v that it comes to.
TYPED_TEST(Viscous, AStepEndsWhereTheNextBegins) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(7);
  Sample<K, Q> sample(random, 0.4);
  Shape<K> shape;
  sample.load(sample.current, shape);
  const Nodes<K> gradient = sample.force(sample.current).second;
  std::vector<double> after = sample.strains;
  const Pack lost = flow<K, Q>(sample.block, sample.viscous(), shape, after.data());
  EXPECT_GT(lost[0], 0);
  Sample<K, Q> next = sample;
  next.strains = after;
  for (Pack& k : next.kept) k = pack(1);
  EXPECT_LT((next.force(sample.current).second - gradient).norm(), 1e-12 * gradient.norm());
  Sample<K, Q> before = sample;
  for (Pack& k : before.kept) k = pack(1);
  EXPECT_NEAR(before.force(sample.current).first - next.force(sample.current).first, lost[0],
              1e-11 * before.force(sample.current).first);
}

/// Rotation of the shape rotates forces; rotation of rest, shape and memory changes nothing.
TYPED_TEST(Viscous, IsObjective) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(11);
  const Sample<K, Q> sample(random, 0.5);
  const auto [energy, gradient] = sample.force(sample.current);
  const Mat3 r = random.rotation();
  const auto turned = sample.force(sample.current * r.transpose());
  EXPECT_NEAR(turned.first, energy, 1e-12 * energy);
  EXPECT_LT((turned.second - gradient * r.transpose()).norm(), 1e-12 * gradient.norm());
}

/// Random strain histories: a branch never gives back what it lost, and what is put in is not less than what is stored.
TEST(Viscous, LosesEnergyOverAnyHistory) {
  Random random(13);
  for (int run = 0; run < 1000; ++run) {
    Sample<4, 1> sample(random, random.between(0, 1));
    for (int point = 0; point < 2; ++point) sample.put(point, Mat3::Identity());
    double lost = 0;
    for (int step = 0; step < 10; ++step) {
      for (Pack& k : sample.kept) k = pack(random.between(0, 1));
      const Nodes<4> nodes = sample.rest * random.deformation(false).transpose();
      Shape<4> shape;
      sample.load(nodes, shape);
      std::vector<double> after = sample.strains;
      const Pack each = flow<4, 1>(sample.block, sample.viscous(), shape, after.data());
      ASSERT_GE(each[0], 0) << run;
      lost += each[0];
      sample.strains = after;
    }
    ASSERT_GT(lost, 0) << run;
  }
}

}  // namespace
}  // namespace softkin::energy
