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
  Pack modulus[branches], rate[branches];
  BranchFractions fractions[branches];
  std::vector<double> strains = std::vector<double>(std::size_t{6} * lanes * (branches + 1) * Q);
  mutable std::vector<double> begun = std::vector<double>(std::size_t{begun_entries} * lanes * branches * Q);

  /// time: over the relaxation time of the first branch, twice that of the second
  Sample(Random& random, double time) {
    rest = sample_rest<K>(random);
    const ElasticRest<K, Q> shape = elastic_rest(rest);
    for (int q = 0; q < Q; ++q) {
      block.volume[q] = pack(shape.volume[q]);
      for (int a = 0; a < K; ++a)
        for (int l = 0; l < lanes; ++l) set_lane(block.slope[q][a], l, shape.slope[q].row(a).transpose());
    }
    current = rest * random.deformation(false).transpose() + 0.05 * random.matrix<Nodes<K>>();
    for (int i = 0; i < branches; ++i) modulus[i] = pack(0.3 + 0.4 * i);
    set_time(time);
    for (int point = 0; point < Q * (branches + 1); ++point) {
      const Mat3 f = random.deformation(false);
      const Mat3 c = f.transpose() * f / std::pow(f.determinant(), 2.0 / 3);
      put(point, c);
    }
  }
  void set_time(double time) {
    for (int i = 0; i < branches; ++i) {
      const double x = time * (i + 1), mean = x > 0 ? -std::expm1(-x) / x : 1;
      fractions[i] = {pack(std::exp(-x)), pack(mean - std::exp(-x)), pack(1 - mean)};
      rate[i] = pack(x);
    }
  }
  /// Of the quadrature points, in their order: bar C, then C_v of the branches.
  void put(int point, const Mat3& c) {
    const double entries[6] = {c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(1, 2), c(0, 2)};
    for (int e = 0; e < 6; ++e)
      for (int l = 0; l < lanes; ++l) strains[(6 * point + e) * lanes + l] = entries[e];
  }
  [[nodiscard]] Mat3 strain(int point, const std::vector<double>& of) const {
    const auto e = [&](int entry) { return of[(6 * point + entry) * lanes]; };
    Mat3 c;
    c << e(0), e(3), e(5), e(3), e(1), e(4), e(5), e(4), e(2);
    return c;
  }
  [[nodiscard]] ViscousBlock viscous() const {
    ViscousBlock made{branches, modulus, fractions, strains.data()};
    begin_step<Q>(made, begun.data());
    made.begun = begun.data();
    return made;
  }
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
  for (const double time : {0.0, 1e-9, 0.3, 3.0, 700.0}) {
    const Sample<K, Q> sample(random, time);
    const Nodes<K> gradient = sample.force(sample.current).second;
    const Eigen::MatrixXd k = sample.stiffness(false);
    const double step = 1e-5, largest = std::max(0.1, k.cwiseAbs().maxCoeff());
    for (int a = 0; a < K; ++a)
      for (int axis = 0; axis < 3; ++axis) {
        Nodes<K> below = sample.current, above = sample.current;
        below(a, axis) -= step;
        above(a, axis) += step;
        const auto low = sample.force(below), high = sample.force(above);
        EXPECT_NEAR((high.first - low.first) / (2 * step), gradient(a, axis), 1e-8 * largest) << time;
        const Nodes<K> change = (high.second - low.second) / (2 * step);
        for (int b = 0; b < K; ++b)
          for (int other = 0; other < 3; ++other)
            EXPECT_NEAR(change(b, other), k(3 * a + axis, 3 * b + other), 1e-8 * largest) << time;
      }
    const Eigen::MatrixXd projected = sample.stiffness(true);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected).eigenvalues().minCoeff(), -1e-12 * largest);
  }
}

/// A step against the branch equation, by Runge and Kutta's method in many small ones while the strain changes evenly:
/// an error of second order in the step. And its energy against the definition.
TYPED_TEST(Viscous, FlowsAsTheBranchEquationSays) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  const auto barred = [](const Mat3& f) { return Mat3(f.transpose() * f / std::pow(f.determinant(), 2.0 / 3)); };
  Random random(5);
  Sample<K, Q> sample(random, 0);
  const ElasticRest<K, Q> rest = elastic_rest(sample.rest);
  const Nodes<K> from = sample.current, path = 0.05 * random.matrix<Nodes<K>>();
  const auto strain_at = [&](int q, double fraction) {
    return barred((from + fraction * path).transpose() * rest.slope[q]);
  };
  for (int q = 0; q < Q; ++q) sample.put(3 * q, strain_at(q, 0));
  const auto error_of = [&](double time) {
    sample.set_time(time);
    Shape<K> shape;
    sample.load(from + time * path, shape);
    std::vector<double> after = sample.strains;
    (void)flow<K, Q>(sample.block, sample.viscous(), sample.rate, shape, after.data());
    double error = 0;
    for (int q = 0; q < Q; ++q)
      for (int i = 0; i < 2; ++i) {
        Mat3 c = sample.strain(3 * q + 1 + i, sample.strains);
        const auto rate = [&](double fraction, const Mat3& v) {
          const Mat3 bar = strain_at(q, fraction * time);
          return Mat3((i + 1) * time * (bar - (bar * v.inverse()).trace() / 3 * v));
        };
        constexpr int steps = 40;
        for (int n = 0; n < steps; ++n) {
          const double h = 1.0 / steps, at = n * h;
          const Mat3 a = rate(at, c), b = rate(at + h / 2, c + h / 2 * a), d = rate(at + h / 2, c + h / 2 * b);
          c += h / 6 * (a + 2 * b + 2 * d + rate(at + h, c + h * d));
        }
        const Mat3 now = sample.strain(3 * q + 1 + i, after);
        EXPECT_NEAR(now.determinant(), 1, 1e-12);
        error = std::max(error, (now - c).norm());
      }
    return error;
  };
  const double coarse = error_of(2e-3), fine = error_of(1e-3);
  EXPECT_LT(fine, 0.3 * coarse);
  EXPECT_LT(fine, 1e-4);

  double energy = 0;
  for (int q = 0; q < Q; ++q)
    for (int i = 0; i < 2; ++i)
      energy += rest.volume[q] * 0.5 * sample.modulus[i][0] *
                ((strain_at(q, 0) * sample.strain(3 * q + 1 + i, sample.strains).inverse()).trace() - 3);
  sample.set_time(0);
  EXPECT_NEAR(sample.force(from).first, energy, 1e-11 * energy);
}

/// What a branch pulls with after the step is the pull of a spring from the C_v that it comes to; a strain that is held
/// makes it lose what it stores less.
TYPED_TEST(Viscous, AStepEndsWhereTheNextBegins) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(7);
  Sample<K, Q> sample(random, 0.8);
  Shape<K> shape;
  sample.load(sample.current, shape);
  const Nodes<K> gradient = sample.force(sample.current).second;
  std::vector<double> after = sample.strains;
  (void)flow<K, Q>(sample.block, sample.viscous(), sample.rate, shape, after.data());
  sample.strains = after;
  sample.set_time(0);
  const auto [stored, pull] = sample.force(sample.current);
  EXPECT_LT((pull - gradient).norm(), 1e-12 * gradient.norm());
  // small steps at a held strain; they change the energy by what is lost
  double left = stored, lost = 0;
  for (int step = 0; step < 400; ++step) {
    sample.set_time(0.005);
    lost += flow<K, Q>(sample.block, sample.viscous(), sample.rate, shape, after.data())[0];
    sample.strains = after;
    sample.set_time(0);
    left = sample.force(sample.current).first;
  }
  EXPECT_NEAR(lost, stored - left, 1e-3 * lost);
  EXPECT_LT(left, 0.1 * stored);
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

/// Random strain histories, closed ones: work is put in, never taken out, and what is lost is that work.
TEST(Viscous, LosesEnergyOverAnyHistory) {
  Random random(13);
  for (int run = 0; run < 1000; ++run) {
    Sample<4, 1> sample(random, 0);
    for (int point = 0; point < 3; ++point) sample.put(point, Mat3::Identity());
    const double time = std::pow(10, random.between(-2, 1));  // of a leg, over the relaxation time
    double work = 0, lost = 0;
    Nodes<4> from = sample.rest;
    constexpr int legs = 4, steps = 50;
    for (int leg = 0; leg < legs; ++leg) {
      const Nodes<4> to = leg + 1 < legs ? Nodes<4>(sample.rest * random.deformation(false).transpose()) : sample.rest;
      // a straight segment whose elements do not invert: the strain is close to the identity, or the leg is left out
      bool inverts = false;
      for (int step = 0; step <= steps; ++step) {
        const Nodes<4> nodes = from + (to - from) * step / steps;
        inverts |= !((nodes.transpose() * elastic_rest(sample.rest).slope[0]).determinant() > 0.05);
      }
      if (inverts) continue;
      for (int step = 0; step < steps; ++step) {
        const Nodes<4> begin = from + (to - from) * step / steps, end = from + (to - from) * (step + 1) / steps;
        sample.set_time(0);
        const Nodes<4> before = sample.force(begin).second;
        sample.set_time(time / steps);
        const Nodes<4> after = sample.force(end).second;
        work += 0.5 * (before + after).cwiseProduct(end - begin).sum();
        Shape<4> shape;
        sample.load(end, shape);
        std::vector<double> strains = sample.strains;
        const Pack each = flow<4, 1>(sample.block, sample.viscous(), sample.rate, shape, strains.data());
        ASSERT_GE(each[0], 0) << run;
        lost += each[0];
        sample.strains = strains;
      }
      from = to;
    }
    sample.set_time(0);
    const double stored = sample.force(from).first;
    ASSERT_GE(work - stored, -0.02 * std::abs(work) - 1e-12) << run;
    ASSERT_NEAR(work - stored, lost, 0.05 * lost + 1e-3) << run;
  }
}

}  // namespace
}  // namespace softkin::energy
