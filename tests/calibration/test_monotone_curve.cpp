#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/model/actuator_curve.hpp>

namespace softkin {
namespace {

std::vector<double> sampled(const std::vector<double>& x, double (*f)(double)) {
  std::vector<double> y;
  for (const double each : x) y.push_back(f(each));
  return y;
}

std::vector<double> even(double low, double high, int intervals) {
  std::vector<double> x;
  for (int i = 0; i <= intervals; ++i) x.push_back(low + (high - low) * i / intervals);
  return x;
}

double largest_error(int intervals, double (*f)(double)) {
  const std::vector<double> x = even(0, 2, intervals);
  const MonotoneCurve curve(x, sampled(x, f));
  double largest = 0;
  for (const double each : even(0, 2, 977)) largest = std::max(largest, std::abs(curve.value(each) - f(each)));
  return largest;
}

TEST(MonotoneCurve, FollowsAnAnalyticFunctionAndConverges) {
  const auto f = [](double x) { return std::exp(x); };
  const double coarse = largest_error(8, f), fine = largest_error(16, f);
  EXPECT_LT(coarse, 2e-2);
  EXPECT_LT(fine, coarse / 3.5);  // at least second order; four where the ends do not limit it
}

TEST(MonotoneCurve, GoesThroughItsPointsAndIsStraightWhereTheyAre) {
  const std::vector<double> x{-1, 0, 0.5, 4}, y{-2, 0, 1, 8};
  const MonotoneCurve curve(x, y);
  for (const double each : even(-1, 4, 50)) EXPECT_NEAR(curve.value(each), 2 * each, 1e-12);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_DOUBLE_EQ(curve.value(x[i]), y[i]);
}

TEST(MonotoneCurve, NeverOvershootsAndTheInverseInverts) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> x{0}, y{1};
    for (int i = 0; i < 9; ++i) {
      x.push_back(x.back() + 0.01 + uniform(random));
      y.push_back(y.back() + 1e-6 + std::pow(uniform(random), 8));  // steps of very different height
    }
    const MonotoneCurve curve(x, y);
    double before = curve.value(x.front());
    for (const double each : even(x.front(), x.back(), 300)) {
      const double value = curve.value(std::min(each, x.back()));
      EXPECT_GE(value, before - 1e-12);
      before = value;
    }
    for (const double fraction : {0.0, 0.1, 0.37, 0.5, 0.93, 1.0}) {
      const double value = y.front() + fraction * (y.back() - y.front());
      EXPECT_NEAR(curve.value(curve.inverse(value)), value, 1e-12);
    }
  }
}

TEST(MonotoneCurve, RefusesWhatDoesNotAscend) {
  EXPECT_THROW(MonotoneCurve({0}, {1}), InvalidInput);
  EXPECT_THROW(MonotoneCurve({0, 1}, {1, 2, 3}), InvalidInput);
  EXPECT_THROW(MonotoneCurve({0, 1, 1}, {1, 2, 3}), InvalidInput);
  EXPECT_THROW(MonotoneCurve({0, 1, 2}, {1, 2, 2}), InvalidInput);
  EXPECT_THROW(MonotoneCurve({0, 1, NAN}, {1, 2, 3}), InvalidInput);
  const MonotoneCurve curve({0, 1}, {1, 2});
  EXPECT_THROW((void)curve.value(1.0001), InvalidInput);
  EXPECT_THROW((void)curve.value(NAN), InvalidInput);
  EXPECT_THROW((void)curve.inverse(0.99), InvalidInput);
}

}  // namespace
}  // namespace softkin
