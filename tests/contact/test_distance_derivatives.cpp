#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "contact/contact_samples.hpp"

namespace softkin::contact {

namespace {

using namespace testing;

using Vector12 = Eigen::Matrix<double, 12, 1>;

FourPoints moved(const FourPoints& x, int k, double step) {
  FourPoints out = x;
  out(k % 3, k / 3) += step;
  return out;
}

bool same_set(const Separation& a, const Separation& b) {
  return a.nodes == b.nodes && a.free == b.free;
}

/// Does the active set stay within `step` of every coordinate?
bool is_inside_set(Kind kind, const FourPoints& x, double step) {
  const Separation here = separation(kind, x);
  for (int k = 0; k < 12; ++k)
    if (!same_set(here, separation(kind, moved(x, k, step))) || !same_set(here, separation(kind, moved(x, k, -step))))
      return false;
  return true;
}

Vector12 gradient_by_differences(Kind kind, const FourPoints& x, double step) {
  Vector12 out;
  for (int k = 0; k < 12; ++k)
    out[k] = (separation(kind, moved(x, k, step)).squared - separation(kind, moved(x, k, -step)).squared) / (2 * step);
  return out;
}

Hessian hessian_by_differences(Kind kind, const FourPoints& x, double step) {
  Hessian out;
  for (int k = 0; k < 12; ++k)
    out.col(k) = (squared_gradient(separation(kind, moved(x, k, step))) -
                  squared_gradient(separation(kind, moved(x, k, -step)))) /
                 (2 * step);
  return out;
}

Hessian hessian_at(Kind kind, const FourPoints& x) {
  Hessian out;
  squared_hessian(separation(kind, x), out);
  return out;
}

void expect_derivatives(Kind kind, const FourPoints& x, double step, double tolerance) {
  const Vector12 gradient = squared_gradient(separation(kind, x));
  EXPECT_LT((gradient - gradient_by_differences(kind, x, step)).norm(), tolerance * (1 + gradient.norm()))
      << name_of(kind) << "\n"
      << x;
  const Hessian hessian = hessian_at(kind, x);
  EXPECT_LT((hessian - hessian_by_differences(kind, x, step)).norm(), tolerance * (1 + hessian.norm()))
      << name_of(kind) << "\n"
      << x;
  EXPECT_EQ(hessian, hessian.transpose());
}

/// How well derivatives are conditioned: sine of the angle between what is free.
double sine(const Separation& s) {
  if (s.free < 2) return 1;
  const Vec3 &a = s.moves[0].along, &b = s.moves[1].along;
  return a.cross(b).norm() / (a.norm() * b.norm());
}

FourPoints random_pair(Random& random) {
  FourPoints x = random.points();
  if (random.whole(0, 1) == 0) x.col(0) += 3 * random.vector();  // more corners
  return x;
}

}  // namespace

TEST(DistanceDerivatives, AgreeWithDifferencesInEveryActiveSet) {
  Random random(4);
  for (const Kind kind : kinds) {
    std::map<int, int> counts;
    for (int i = 0; i < 20000; ++i) {
      const FourPoints x = random_pair(random);
      const Separation s = separation(kind, x);
      if (!is_inside_set(kind, x, 1e-4) || sine(s) < 0.1) continue;
      if (++counts[s.nodes] > 200) continue;
      expect_derivatives(kind, x, 1e-5, 1e-6);
    }
    EXPECT_EQ(counts.size(), kind == Kind::vertex_triangle ? 7u : 9u);
    for (const auto& [nodes, count] : counts) EXPECT_GT(count, 100) << name_of(kind) << " " << nodes;
  }
}

/// On the line from a point of one active set to one of another.
TEST(DistanceDerivatives, HoldOnBothSidesOfASwitchAndTheGradientAcross) {
  Random random(5);
  for (const Kind kind : kinds) {
    std::map<std::pair<int, int>, int> switches;
    for (int i = 0; i < 4000; ++i) {
      const FourPoints begin = random_pair(random), end = random_pair(random);
      const auto at = [&](double t) -> FourPoints { return begin + t * (end - begin); };
      double low = 0, high = random.uniform(0.05, 0.3);
      const Separation first = separation(kind, begin), second = separation(kind, at(high));
      if (same_set(first, second)) continue;
      while (high - low > 1e-14) {
        const double middle = (low + high) / 2;
        (same_set(first, separation(kind, at(middle))) ? low : high) = middle;
      }
      if (sine(separation(kind, at(low))) < 0.1 || sine(separation(kind, at(high))) < 0.1) continue;
      const FourPoints x = at(low), y = at(high);
      const Separation sx = separation(kind, x), sy = separation(kind, y);
      EXPECT_LT((sx.vector - sy.vector).norm(), 1e-9) << name_of(kind) << "\n" << x;
      EXPECT_LT((squared_gradient(sx) - squared_gradient(sy)).norm(), 1e-9 * (1 + squared_gradient(sx).norm()));
      EXPECT_LT((squared_gradient(sx) - gradient_by_differences(kind, x, 1e-7)).norm(),
                1e-6 * (1 + hessian_at(kind, x).norm() + hessian_at(kind, y).norm()));
      for (const double off : {-1e-4, 1e-4})
        if (is_inside_set(kind, at(low + off), 2e-6)) {
          ++switches[{sx.free, sy.free}];
          expect_derivatives(kind, at(low + off), 1e-6, 1e-5);
        }
      if (HasFailure()) return;
    }
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 0), std::pair(1, 2), std::pair(2, 1)})
      EXPECT_GT((switches[{a, b}]), 10) << name_of(kind) << " " << a << b;
  }
}

TEST(DistanceDerivatives, DoNotDependOnTheFrame) {
  Random random(6);
  for (const Kind kind : kinds)
    for (int i = 0; i < 2000; ++i) {
      const FourPoints x = random_pair(random);
      const Separation s = separation(kind, x);
      if (!is_inside_set(kind, x, 1e-6) || sine(s) < 0.01) continue;
      const Mat3 turn = random.rotation();
      const FourPoints y = (turn * x).colwise() + random.vector();
      const Separation t = separation(kind, y);
      EXPECT_NEAR(s.squared, t.squared, 1e-12 * (1 + s.squared));
      EXPECT_NEAR((s.weights - t.weights).norm(), 0, 1e-10);
      EXPECT_NEAR((turn * s.vector - t.vector).norm(), 0, 1e-11);
      Hessian turns = Hessian::Zero();
      for (int k = 0; k < 4; ++k) turns.block<3, 3>(3 * k, 3 * k) = turn;
      EXPECT_NEAR((turns * hessian_at(kind, x) * turns.transpose() - hessian_at(kind, y)).norm(), 0,
                  1e-9 * hessian_at(kind, x).norm());
      // common motions and turns about the common centre cost nothing
      const Vector12 gradient = squared_gradient(s);
      const Vec3 axis = random.vector();
      Vector12 shift, spin;
      for (int k = 0; k < 4; ++k) {
        shift.segment<3>(3 * k) = axis;
        spin.segment<3>(3 * k) = axis.cross(Vec3(x.col(k)));
      }
      EXPECT_NEAR(gradient.dot(shift), 0, 1e-12 * (1 + gradient.norm() * shift.norm()));
      EXPECT_NEAR(gradient.dot(spin), 0, 1e-10 * (1 + gradient.norm() * spin.norm()));
      EXPECT_NEAR((hessian_at(kind, x) * shift).norm(), 0, 1e-11 * (1 + hessian_at(kind, x).norm() * shift.norm()));
    }
}

TEST(DistanceDerivatives, ReliefMakesUpTheHessianAndGoesWithTheFreeWeights) {
  Random random(7);
  for (const Kind kind : kinds)
    for (int i = 0; i < 500; ++i) {
      const FourPoints x = random_pair(random);
      const Separation s = separation(kind, x);
      if (sine(s) < 0.1) continue;
      const Relief z = relief(s);
      Hessian expected = -2 * z * z.transpose();
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
          expected.block<3, 3>(3 * a, 3 * b) += 2 * s.weights[a] * s.weights[b] * Mat3::Identity();
      EXPECT_LT((expected - hessian_at(kind, x)).norm(), 1e-13 * (1 + expected.norm()));
      for (int k = 0; k < 2; ++k) EXPECT_EQ(z.col(k).norm() > 0, k < s.free);
    }
}

namespace {

/// Edges at an angle, unit length and more.
FourPoints edges_at(double angle, Random& random) {
  FourPoints x;
  x.col(0) = random.vector();
  x.col(2) = random.vector();
  const Mat3 turn = random.rotation();
  x.col(1) = x.col(0) + random.uniform(1, 2) * turn * Vec3::UnitX();
  x.col(3) = x.col(2) + random.uniform(1, 2) * turn * Vec3(std::cos(angle), std::sin(angle), 0);
  return x;
}

}  // namespace

TEST(Mollifier, GoesSmoothlyFromZeroToOne) {
  Random random(8);
  FourPoints x = edges_at(0, random);
  EXPECT_NEAR(mollifier(x, mollifier_threshold(x)), 0, 1e-20);
  x = edges_at(0.04, random);  // sin^2 > 1e-3
  EXPECT_EQ(mollifier(x, mollifier_threshold(x)), 1);
  x = edges_at(std::asin(std::sqrt(0.5e-3)), random);  // half the threshold: q (2 - q) = 3/4
  EXPECT_NEAR(mollifier(x, mollifier_threshold(x)), 0.75, 1e-10);
  FourPoints flat = FourPoints::Zero();
  EXPECT_EQ(mollifier(flat, mollifier_threshold(flat)), 1);  // no length: nothing to be parallel
}

TEST(Mollifier, DerivativesAgreeWithDifferences) {
  Random random(9);
  int inside = 0;
  for (int i = 0; i < 300; ++i) {
    const double angle = random.uniform(0, 0.05);
    const FourPoints x = edges_at(angle, random), rest = edges_at(1, random);
    const double threshold = mollifier_threshold(rest), step = 1e-6;
    Vector12 gradient, differences, ahead, behind;
    Hessian hessian, unused, of_gradient;
    const double value = mollifier(x, threshold, gradient, hessian);
    EXPECT_EQ(value, mollifier(x, threshold));
    for (int k = 0; k < 12; ++k) {
      differences[k] =
          (mollifier(moved(x, k, step), threshold) - mollifier(moved(x, k, -step), threshold)) / (2 * step);
      mollifier(moved(x, k, step), threshold, ahead, unused);
      mollifier(moved(x, k, -step), threshold, behind, unused);
      of_gradient.col(k) = (ahead - behind) / (2 * step);
    }
    if (value > 0.9999) continue;  // the second derivative jumps at 1
    inside += value < 1;
    EXPECT_LT((gradient - differences).norm(), 1e-6 * (10 + gradient.norm())) << value;
    EXPECT_LT((hessian - of_gradient).norm(), 1e-6 * (1e4 + hessian.norm())) << value;
  }
  EXPECT_GT(inside, 100);
}

}  // namespace softkin::contact
