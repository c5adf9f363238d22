#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <softkin/kinematics/maps/fit.hpp>

namespace softkin::maps {
namespace {

Eigen::VectorXd random_point(Index variables, std::mt19937& engine) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd x(variables);
  for (Index j = 0; j < variables; ++j) x[j] = uniform(engine);
  return x;
}

Polynomials random_polynomials(Index variables, Index terms, Index count, std::mt19937& engine) {
  std::normal_distribution<double> normal;
  const Terms chosen = min_terms(Eigen::VectorXd::LinSpaced(variables, 1, 1.7), terms);
  RowMatrix coefficients(chosen.rows(), count);
  for (Index t = 0; t < coefficients.rows(); ++t)
    for (Index q = 0; q < count; ++q) coefficients(t, q) = normal(engine);
  return {chosen, coefficients};
}

/// cos(n arccos x)
double chebyshev_by_cosine(int degree, double x) {
  return std::cos(degree * std::acos(x));
}

TEST(MapFit, TermsAreThoseOfLeastSumWithAllBelowThem) {
  Eigen::VectorXd decay(2);
  decay << 1, 2;
  const Terms terms = min_terms(decay, 6);  // sums 0, 1, 2, 2, 3, 3
  ASSERT_EQ(terms.rows(), 6);
  const std::vector<std::array<int, 2>> expected{{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 0}, {3, 0}};
  for (Index t = 0; t < 6; ++t) {
    EXPECT_EQ(terms(t, 0), expected[t][0]);
    EXPECT_EQ(terms(t, 1), expected[t][1]);
  }
}

TEST(MapFit, SumsAreThoseOfCosines) {
  std::mt19937 engine(1);
  for (const Index variables : {1, 2, 3, 5}) {
    const Polynomials polynomials = random_polynomials(variables, 40, 7, engine);
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::VectorXd x = random_point(variables, engine);
      Eigen::VectorXd expected = Eigen::VectorXd::Zero(7), values(7);
      for (Index t = 0; t < polynomials.terms().rows(); ++t) {
        double product = 1;
        for (Index j = 0; j < variables; ++j) product *= chebyshev_by_cosine(polynomials.terms()(t, j), x[j]);
        expected += product * polynomials.coefficients().row(t).transpose();
      }
      polynomials.evaluate(x.data(), values.data());
      EXPECT_LT((values - expected).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

TEST(MapFit, SlopesAreDifferences) {
  std::mt19937 engine(2);
  for (const Index variables : {1, 2, 4}) {
    const Polynomials polynomials = random_polynomials(variables, 30, 40, engine);
    const Eigen::VectorXd x = 0.9 * random_point(variables, engine);
    Eigen::VectorXd values(40), before(40), after(40);
    RowMatrix slopes(variables, 40);
    polynomials.evaluate(x.data(), values.data(), slopes.data());
    constexpr double step = 1e-5;
    for (Index j = 0; j < variables; ++j) {
      const Eigen::VectorXd e = step * Eigen::VectorXd::Unit(variables, j), low = x - e, high = x + e;
      polynomials.evaluate(low.data(), before.data());
      polynomials.evaluate(high.data(), after.data());
      const Eigen::VectorXd expected = (after - before) / (2 * step);
      EXPECT_LT((slopes.row(j).transpose() - expected).cwiseAbs().maxCoeff(), 1e-6 * (1 + expected.norm()));
    }
  }
}

/// As many numbers as there are terms: values and slopes at points that are chosen for them.
TEST(MapFit, FindsPolynomialsAgainFromValuesAndSlopes) {
  std::mt19937 engine(3);
  for (const Index variables : {1, 2, 3}) {
    const Polynomials made = random_polynomials(variables, 24, 3, engine);
    const Eigen::VectorXd decay = Eigen::VectorXd::Constant(variables, 1.6);
    const Index points = 2 + static_cast<Index>(made.terms().rows()) / (1 + variables);
    const RowMatrix at = worst_known(made.terms(), decay, RowMatrix(0, variables), points);
    std::vector<Observation> observations;
    for (Index i = 0; i < points; ++i) {
      Observation each{at.row(i), Eigen::VectorXd(3), RowMatrix(variables, 3)};
      made.evaluate(each.x.data(), each.values.data(), each.slopes.data());
      observations.push_back(each);
    }
    const Polynomials found = fit(made.terms(), observations, decay);
    EXPECT_LT((found.coefficients() - made.coefficients()).cwiseAbs().maxCoeff(), 1e-5) << variables;
  }
}

TEST(MapFit, DecayIsThatOfTheFunction) {
  // 1 / (1.25 - x) in x: coefficients fall by 2 per degree; exp in y: faster and faster
  std::mt19937 engine(4);
  const Terms terms = min_terms(Eigen::Vector2d(0.7, 1.5), 60);
  std::vector<Observation> observations;
  for (int i = 0; i < 60; ++i) {
    const Eigen::VectorXd x = random_point(2, engine);
    Observation each{x, Eigen::VectorXd(1), RowMatrix(2, 1)};
    each.values[0] = 1000 * std::exp(0.5 * x[1]) / (1.25 - x[0]);
    each.slopes << each.values[0] / (1.25 - x[0]), 0.5 * each.values[0];
    observations.push_back(each);
  }
  const Eigen::VectorXd decay = decay_of(fit(terms, observations, Eigen::Vector2d(0.7, 1.5)));
  EXPECT_NEAR(decay[0], std::log(2), 0.1);
  EXPECT_GT(decay[1], 1.5);
}

/// Otherwise the fit would take more and more terms of high degree, which do not improve it.
TEST(MapFit, WhatDoesNotFallAnyMoreIsNoDecay) {
  RowMatrix coefficients(21, 1);
  for (int k = 0; k <= 20; ++k) coefficients(k, 0) = std::max(1000 * std::exp(-2.5 * k), k % 3 == 0 ? 0.04 : 0.02);
  const Terms terms = min_terms(Eigen::VectorXd::Ones(1), 21);
  EXPECT_NEAR(decay_of(Polynomials(terms, coefficients))[0], 2.5, 0.2);
}

/// The next point is that of the greatest unexplained variance, found by inverting the normal matrix.
TEST(MapFit, NextPointIsTheWorstKnown) {
  std::mt19937 engine(5);
  const Eigen::VectorXd decay = Eigen::VectorXd::Constant(2, 1.6);
  const Terms terms = min_terms(decay, 15);
  RowMatrix known(4, 2);
  for (Index i = 0; i < 4; ++i) known.row(i) = random_point(2, engine);
  const RowMatrix chosen = worst_known(terms, decay, known, 2), first = worst_known(terms, decay, known, 1);
  EXPECT_EQ(chosen.row(0), first.row(0));
  RowMatrix more(5, 2);
  more << known, first;
  EXPECT_EQ(worst_known(terms, decay, more, 1).row(0), chosen.row(1));  // as if the first had been made
}

}  // namespace
}  // namespace softkin::maps
