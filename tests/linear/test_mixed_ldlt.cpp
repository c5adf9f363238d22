#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <softkin/core/dense.hpp>
#include <softkin/linear/mixed_ldlt.hpp>

#include "symmetric_samples.hpp"

namespace softkin::linear {

namespace {

using namespace testing;
using Precision = MixedLdlt::Precision;

MixedLdlt factor_of(const Symmetric& sample) {
  return MixedLdlt(std::make_shared<const FrontTree>(make_front_tree(sample.pattern)));
}

Index negative_eigenvalues(const Symmetric& sample) {
  return (symmetric_eigenvalues(sample.dense).array() < 0).count();
}

/// Shifts it until its eigenvalue nearest 0 is so large.
Symmetric shifted_to(Symmetric sample, double nearest) {
  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(sample.dense);
  Index at = 0;
  eigenvalues.cwiseAbs().minCoeff(&at);
  const double shift = nearest - eigenvalues[at];
  const BlockColumns& p = sample.pattern;
  for (Index node = 0; node < p.nodes(); ++node)
    for (Index i = 0; i < p.width(node); ++i)
      sample.values[p.offsets[p.starts[node]] + i * (p.width(node) + 1)] += shift;
  sample.dense.diagonal().array() += shift;
  return sample;
}

Pivots factorise(MixedLdlt& factor, const Symmetric& sample, double least, Precision precision, Team& team) {
  Eigen::MatrixXd none(sample.pattern.size(), 0);
  return factor.factorise(sample.values, least, precision, none, team);
}

double error_of(MixedLdlt& factor, const Symmetric& sample, Index columns, Team& team) {
  const Eigen::MatrixXd right = random_matrix(sample.pattern.size(), columns);
  const Eigen::MatrixXd expected = sample.dense.ldlt().solve(right);
  Eigen::MatrixXd solution = right;
  factor.solve(solution, team);
  return (solution - expected).norm() / expected.norm();
}

}  // namespace

TEST(MixedLdlt, SinglePrecisionServesWhereItContracts) {
  Team alone(1);
  for (const double negative_fraction : {0.0, 0.3})
    for (const Symmetric& sample : samples(negative_fraction)) {
      MixedLdlt factor = factor_of(sample);
      EXPECT_EQ(factorise(factor, sample, 1e-12, Precision::enough, alone).negative, negative_eigenvalues(sample));
      EXPECT_FALSE(factor.in_double());
      for (const Index columns : {1, 5}) EXPECT_LT(error_of(factor, sample, columns, alone), 0.03);
      const double bytes = factor.bytes();
      EXPECT_EQ(factorise(factor, sample, 1e-12, Precision::twice, alone).negative, negative_eigenvalues(sample));
      EXPECT_TRUE(factor.in_double());
      EXPECT_LT(error_of(factor, sample, 2, alone), 1e-11);
      EXPECT_GT(factor.bytes(), 2 * bytes);
    }
}

/// The sign of the eigenvalue nearest 0 is detected, whatever its size, and solutions have the promised accuracy.
TEST(MixedLdlt, WhatIsNearlySingularIsFactorisedInDouble) {
  Team alone(1);
  for (const double negative_fraction : {0.0, 0.3}) {
    const Symmetric sample = make_sample(mixed_widths(60, 1), grid_links(5, 4, 3), negative_fraction, 7);
    int single = 0, twice = 0;
    for (double nearest = 1; nearest > 1e-10; nearest /= 4)
      for (const double sign : {1, -1})
        for (const auto& [precision, error] : {std::pair(Precision::enough, 0.5), std::pair(Precision::good, 0.3)}) {
          const Symmetric shifted = shifted_to(sample, sign * nearest);
          MixedLdlt factor = factor_of(shifted);
          EXPECT_EQ(factorise(factor, shifted, 1e-15, precision, alone).negative, negative_eigenvalues(shifted))
              << sign * nearest;
          ++(factor.in_double() ? twice : single);
          EXPECT_TRUE(nearest > 1e-8 || factor.in_double());
          EXPECT_LT(error_of(factor, shifted, 2, alone), error) << sign * nearest;
        }
    EXPECT_GT(single, 20);
    EXPECT_GT(twice, 10);
  }
}

/// Where only the sign matters, single precision suffices for indefinite matrices, and is reported as a guess.
TEST(MixedLdlt, ASignNeedsNoDouble) {
  Team alone(1);
  for (const double negative_fraction : {0.0, 0.3}) {
    const Symmetric sample =
        shifted_to(make_sample(mixed_widths(60, 1), grid_links(5, 4, 3), negative_fraction, 7), 1e-10);
    MixedLdlt factor = factor_of(sample);
    const Index negative = factorise(factor, sample, 1e-15, Precision::sign, alone).negative;
    const bool guessed = !factor.in_double();  // so near 0 rounding may turn what is definite into what is not
    EXPECT_TRUE(guessed || negative_fraction == 0);
    EXPECT_NE(factor.trusted(), guessed);
    EXPECT_EQ(guessed, negative > 0);
    EXPECT_EQ(factorise(factor, sample, 1e-15, Precision::enough, alone).negative, negative_eigenvalues(sample));
    EXPECT_TRUE(factor.in_double() && factor.trusted());
  }
}

/// After a failure single precision is left alone for a while, the longer the more often it fails; as new after forget.
TEST(MixedLdlt, SinglePrecisionIsTriedAgain) {
  Team alone(1);
  const Symmetric good = make_sample(std::vector<Index>(60, 3), grid_links(5, 4, 3), 0, 7),
                  bad = shifted_to(good, 1e-12);
  MixedLdlt factor = factor_of(good);
  const auto in_double = [&](const Symmetric& sample) {
    (void)factorise(factor, sample, 1e-15, Precision::enough, alone);
    return factor.in_double();
  };
  EXPECT_FALSE(in_double(good));
  EXPECT_TRUE(in_double(bad));   // tried
  EXPECT_TRUE(in_double(good));  // waits
  EXPECT_TRUE(in_double(bad));   // tried
  EXPECT_TRUE(in_double(good));
  EXPECT_TRUE(in_double(good));
  EXPECT_FALSE(in_double(good));
  EXPECT_TRUE(in_double(bad));
  factor.forget();
  EXPECT_FALSE(in_double(good));
}

TEST(MixedLdlt, NoNumberIsToldAsSuch) {
  Team alone(1);
  Symmetric sample = make_sample(std::vector<Index>(12, 3), grid_links(3, 2, 2), 0, 7);
  sample.values[0] = std::numeric_limits<double>::quiet_NaN();
  MixedLdlt factor = factor_of(sample);
  EXPECT_GT(factorise(factor, sample, 1e-12, Precision::enough, alone).replaced, 0);
  EXPECT_TRUE(factor.in_double());
}

TEST(SubtractProduct, IsThatOfTheDenseMatrix) {
  Team alone(1), pair(2);
  for (const Symmetric& sample : samples(0.3)) {
    const Eigen::MatrixXd x = random_matrix(sample.pattern.size(), 3), begin = 2 * x;
    Eigen::MatrixXd left = begin, other = begin;
    subtract_product(sample.pattern, sample.values, x, left, alone);
    EXPECT_LT((left - (begin - sample.dense * x)).norm(), 1e-13 * (begin.norm() + sample.dense.norm() * x.norm()));
    subtract_product(sample.pattern, sample.values, x, other, pair);
    EXPECT_EQ(left, other);
  }
}

}  // namespace softkin::linear
