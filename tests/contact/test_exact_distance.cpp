#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "contact/contact_samples.hpp"

namespace softkin::contact {

namespace {

using namespace testing;

__extension__ typedef __int128 Wide;
using WholePoint = std::array<Wide, 3>;
using WholePoints = std::array<WholePoint, 4>;  // coordinates up to 2^18: numerators below 2^126

WholePoint minus(const WholePoint& a, const WholePoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Wide dot(const WholePoint& a, const WholePoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

WholePoint cross(const WholePoint& a, const WholePoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

class Least {
 public:
  void take(Wide numerator, Wide denominator) {
    min_ = std::min(min_, static_cast<long double>(numerator) / static_cast<long double>(denominator));
  }
  void take_points(const WholePoint& a, const WholePoint& b) { take(dot(minus(a, b), minus(a, b)), 1); }
  void take_point_edge(const WholePoint& p, const WholePoint& from, const WholePoint& to) {
    take_points(p, from);
    take_points(p, to);
    const WholePoint e = minus(to, from), w = minus(p, from);
    const Wide along = dot(e, w), length = dot(e, e);
    if (along > 0 && along < length) take(dot(cross(e, w), cross(e, w)), length);
  }
  /// Where start + a u + b v is shortest, if the weights are inside.
  template <class Inside>
  void take_crossing(const WholePoint& start, const WholePoint& u, const WholePoint& v, const Inside& inside) {
    const WholePoint normal = cross(u, v);
    const Wide size = dot(normal, normal), height = dot(start, normal);
    if (size != 0 && inside(-dot(cross(start, v), normal), -dot(cross(u, start), normal), size))
      take(height * height, size);
  }
  [[nodiscard]] long double value() const { return min_; }

 private:
  long double min_ = std::numeric_limits<long double>::infinity();
};

FourPoints to_points(const WholePoints& x) {
  FourPoints out;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) out(k, i) = static_cast<double>(x[i][k]);
  return out;
}

/// d^2 by brute force over all features, each as a fraction of whole numbers without any rounding; rounded at the end.
long double exact_squared(Kind kind, const WholePoints& x) {
  Least least;
  if (kind == Kind::vertex_triangle) {
    for (std::size_t i = 1; i < 4; ++i) least.take_point_edge(x[0], x[i], x[i % 3 + 1]);
    least.take_crossing(minus(x[0], x[1]), minus(x[1], x[2]), minus(x[1], x[3]),
                        [](Wide a, Wide b, Wide size) { return a >= 0 && b >= 0 && a + b <= size; });
    return least.value();
  }
  for (std::size_t i = 0; i < 2; ++i) {
    least.take_point_edge(x[i], x[2], x[3]);
    least.take_point_edge(x[2 + i], x[0], x[1]);
  }
  least.take_crossing(minus(x[0], x[2]), minus(x[1], x[0]), minus(x[2], x[3]),
                      [](Wide a, Wide b, Wide size) { return a >= 0 && a <= size && b >= 0 && b <= size; });
  return least.value();
}

/// Error bound, relative to the largest length.
constexpr double rounding = 4e-15;

void expect_exact(Kind kind, const WholePoints& whole) {
  const FourPoints x = to_points(whole);
  const Separation found = separation(kind, x);
  const double size = (x.colwise() - x.col(0)).colwise().norm().maxCoeff();
  const auto distance = static_cast<double>(std::sqrt(exact_squared(kind, whole)));
  // d^2 below (rounding size)^2 is rounding itself: two edges that cross
  EXPECT_NEAR(std::sqrt(found.squared), distance, rounding * size) << name_of(kind) << "\n" << x;
  EXPECT_NEAR(found.vector.norm(), distance, rounding * size) << name_of(kind) << "\n" << x;
  EXPECT_NEAR((x * found.weights - found.vector).norm(), 0, 10 * rounding * size) << name_of(kind) << "\n" << x;
}

void expect_weights(Kind kind, const FourPoints& x) {
  const Separation found = separation(kind, x);
  const Eigen::Vector4d& c = found.weights;
  int used = 0;
  for (int i = 0; i < 4; ++i) {
    const bool positive = kind == Kind::vertex_triangle ? i == 0 : i < 2;
    EXPECT_GE(positive ? c[i] : -c[i], 0) << name_of(kind) << "\n" << x;
    const bool takes_part = (found.nodes >> i & 1) != 0;
    EXPECT_TRUE(takes_part || c[i] == 0);
    used += takes_part;
  }
  EXPECT_EQ(used, found.free + 2);
  EXPECT_NEAR(c.sum(), 0, 1e-15);
  EXPECT_NEAR(c.cwiseAbs().sum(), 2, 4e-15);
  Hessian h;
  squared_hessian(found, h);
  EXPECT_TRUE(h.allFinite() && squared_gradient(found).allFinite()) << name_of(kind) << "\n" << x;
}

WholePoint random_point(Random& random, int range) {
  return {random.whole(-range, range), random.whole(-range, range), random.whole(-range, range)};
}

}  // namespace

/// Small numbers: every second pair is degenerate, parallel or touches.
TEST(ExactDistance, OfRandomAndDegeneratePairs) {
  Random random(1);
  for (const Kind kind : kinds)
    for (const int range : {1, 2, 4, 30, 1000, 100000})
      for (int i = 0; i < 10000; ++i) {
        WholePoints x;
        for (WholePoint& p : x) p = random_point(random, range);
        expect_exact(kind, x);
        expect_weights(kind, to_points(x));
        if (HasFailure()) return;
      }
}

/// Edges and triangles' sides that are one step of the grid away from parallel, down to angles of 1e-5.
TEST(ExactDistance, OfNearlyParallelPairs) {
  Random random(2);
  for (const Kind kind : kinds)
    for (const int range : {10, 300, 100000})
      for (int i = 0; i < 10000; ++i) {
        WholePoints x;
        for (WholePoint& p : x) p = random_point(random, 3);
        const WholePoint along = random_point(random, range);
        const std::size_t from = kind == Kind::vertex_triangle ? 1 : 0, to = kind == Kind::vertex_triangle ? 2 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
          x[to][k] += x[from][k] + along[k];
          x[3][k] += x[2][k] + (kind == Kind::vertex_triangle ? -1 : 1) * along[k];
        }
        expect_exact(kind, x);
        expect_weights(kind, to_points(x));
        if (HasFailure()) return;
      }
}

/// Far below what whole numbers reach: edges at an angle of 1e-3 to 1e-16 whose distance is known.
TEST(ExactDistance, OfEdgesParallelToRounding) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double angle = std::pow(10, random.uniform(-16, -3)), height = random.uniform(0, 1);
    FourPoints x;
    x << -1, 1, -std::cos(angle), std::cos(angle), 0, 0, -std::sin(angle), std::sin(angle), 0, 0, height, height;
    EXPECT_NEAR(std::sqrt(edge_edge(x).squared), height, 1e-13) << angle;
    expect_weights(Kind::edge_edge, x);
  }
}

TEST(ExactDistance, WithoutAnyLengthThereIsNoNaN) {
  for (const Kind kind : kinds)
    for (const double size : {0.0, 1e-320, 1e-160, 1e-30, 1e30})
      for (int pattern = 0; pattern < 4096; ++pattern) {
        FourPoints x;
        for (int k = 0; k < 12; ++k) x(k % 3, k / 3) = (pattern >> k & 1) * size;
        const Separation found = separation(kind, x);
        EXPECT_TRUE(std::isfinite(found.squared) && found.vector.allFinite()) << x;
        expect_weights(kind, x);
        if (HasFailure()) return;
      }
}

}  // namespace softkin::contact
