#include <gtest/gtest.h>

#include <limits>

#include <Eigen/Cholesky>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/linear/sparse_ldlt.hpp>

#include "symmetric_samples.hpp"

namespace softkin::linear {

namespace {

using namespace testing;

template <class Number>
void expect_solved(double rounding) {
  Team alone(1);
  for (const double negative_fraction : {0.0, 0.3})
    for (const Symmetric& sample : samples(negative_fraction)) {
      SparseLdltOf<Number> factor(sample.pattern);
      const Pivots pivots = factor.factorise(sample.values, 1e-12, alone);
      const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(sample.dense);
      EXPECT_EQ(pivots.negative, (eigenvalues.array() < 0).count());
      EXPECT_EQ(pivots.replaced, 0);
      for (const Index columns : {1, 2, 3, 4, 7}) {  // they are solved by fours
        const Eigen::MatrixXd right = random_matrix(sample.pattern.size(), columns);
        const Eigen::MatrixXd expected = sample.dense.ldlt().solve(right);
        Eigen::MatrixXd solution = right;
        factor.solve(solution, alone);
        EXPECT_LT((solution - expected).norm(), rounding * expected.norm()) << columns;
      }
    }
}

template <class Number>
void expect_the_same_from_any_team(const Symmetric& sample, double rounding) {
  Team alone(1), pair(2), trio(3);
  const Eigen::MatrixXd right = random_matrix(sample.pattern.size(), 2);
  Eigen::MatrixXd one = right;
  SparseLdltOf<Number> factor(sample.pattern);
  const Pivots pivots = factor.factorise(sample.values, 1e-12, alone);
  factor.solve(one, alone);
  EXPECT_LT((sample.dense * one - right).norm(), rounding * right.norm());
  for (Team* team : {&pair, &trio}) {
    Eigen::MatrixXd more = right;
    SparseLdltOf<Number> again(sample.pattern);
    EXPECT_EQ(again.factorise(sample.values, 1e-12, *team).negative, pivots.negative);
    again.solve(more, *team);
    EXPECT_EQ(one, more);
  }
}

}  // namespace

TEST(SparseLdlt, SolvesAndCountsAsADenseFactorDoes) {
  expect_solved<double>(1e-11);
  expect_solved<float>(1e-3);
}

/// Factorised again, nothing of the matrix before is left.
TEST(SparseLdlt, FactorisesAgain) {
  Team alone(1);
  const std::vector<Index> widths = mixed_widths(180, 1);
  const Symmetric first = make_sample(widths, grid_links(9, 5, 4), 0.3, 1),
                  second = make_sample(widths, grid_links(9, 5, 4), 0, 2);
  SparseLdlt used(first.pattern), fresh(first.pattern);
  (void)used.factorise(first.values, 1e-12, alone);
  EXPECT_EQ(used.factorise(second.values, 1e-12, alone).negative, 0);
  (void)fresh.factorise(second.values, 1e-12, alone);
  Eigen::MatrixXd a = random_matrix(first.pattern.size(), 2), b = a;
  used.solve(a, alone);
  fresh.solve(b, alone);
  EXPECT_EQ(a, b);
}

/// Memory that is lent, whatever stands in it, grows where it is too small and changes nothing.
TEST(SparseLdlt, WorksInMemoryThatIsLent) {
  Team alone(1);
  const Symmetric sample = make_sample(mixed_widths(180, 1), grid_links(9, 5, 4), 0.3, 1);
  SparseLdltOf<float> own(sample.pattern), lent(sample.pattern);
  (void)own.factorise(sample.values, 1e-12, alone);
  Eigen::MatrixXd expected = random_matrix(sample.pattern.size(), 2);
  const Eigen::MatrixXd right_sides = expected;
  own.solve(expected, alone);
  for (const std::size_t size : {std::size_t{0}, std::size_t{100}, std::size_t{1000000}}) {
    LargeVector<double> spare(size, std::numeric_limits<double>::quiet_NaN());
    (void)lent.factorise(sample.values, 1e-12, alone, &spare);
    EXPECT_GT(spare.size(), 100u);
    Eigen::MatrixXd found = right_sides;
    lent.solve(found, alone);
    EXPECT_EQ(found, expected);
    std::fill(spare.begin(), spare.end(), std::numeric_limits<double>::quiet_NaN());
    found = right_sides;
    lent.solve(found, alone);
    EXPECT_EQ(found, expected);
  }
  EXPECT_LT(lent.bytes(), own.bytes());
}

TEST(SparseLdlt, ResultDoesNotDependOnThreads) {
  const Symmetric sample = make_sample(mixed_widths(1500, 4), grid_links(25, 10, 6), 0.1, 11);
  ASSERT_GT(sample.pattern.pieces.size(), 1u);
  expect_the_same_from_any_team<double>(sample, 1e-10);
  expect_the_same_from_any_team<float>(sample, 1e-3);
}

/// A singular matrix: its pivot is replaced and counted, and solutions stay finite.
TEST(SparseLdlt, SmallPivotsAreReplaced) {
  Team alone(1);
  Symmetric sample = make_sample({2}, {}, 0, 5);
  std::fill(sample.values.begin(), sample.values.end(), 1.0);
  SparseLdlt factor(sample.pattern);
  const Pivots pivots = factor.factorise(sample.values, 1e-8, alone);
  EXPECT_EQ(pivots.replaced, 1);
  EXPECT_EQ(pivots.negative, 1);
  Eigen::MatrixXd x = random_matrix(2, 1);
  factor.solve(x, alone);
  EXPECT_TRUE(x.allFinite());
}

TEST(SparseLdlt, NothingToSolve) {
  Team alone(1);
  SparseLdlt factor{BlockColumns{}};
  EXPECT_EQ(factor.factorise({}, 1e-12, alone).negative, 0);
  Eigen::MatrixXd empty(0, 1);
  factor.solve(empty, alone);
}

TEST(SparseLdlt, AFactorThatDoesNotFitIsRefusedBeforeItIsBegun) {
  FrontTree tree = make_front_tree(BlockColumns{});
  EXPECT_NO_THROW(require_memory(tree, sizeof(double)));
  tree.arena_sizes.push_back(std::int64_t{1} << 50);
  try {
    require_memory(tree, sizeof(double));
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("takes 8388608.0 GiB of memory"), std::string::npos) << error.what();
  }
}

}  // namespace softkin::linear
