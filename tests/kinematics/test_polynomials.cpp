#include <gtest/gtest.h>

#include <random>
#include <softkin/kinematics/maps/polynomials.hpp>

namespace softkin::maps {
namespace {

struct Case {
  Index variables, terms, sums;
};

class PolynomialSums : public ::testing::TestWithParam<Case> {
 protected:
  std::mt19937 generator{5};
  std::uniform_real_distribution<double> uniform{-1, 1};

  double random() { return uniform(generator); }
  Polynomials polynomials() {
    const auto [variables, count, sums] = GetParam();
    const Eigen::VectorXd decay = Eigen::VectorXd::LinSpaced(variables, 1, 1.5);
    const Terms terms = variables == 0 ? Terms(1, 0) : min_terms(decay, count);
    return {terms, RowMatrix::NullaryExpr(terms.rows(), sums, [&] { return random(); })};
  }
};

/// Term by term, by the cosine of multiples of an angle; slopes by differences.
TEST_P(PolynomialSums, AreThoseOfTheirTerms) {
  const Polynomials sums = polynomials();
  const Index d = sums.variables(), size = sums.count();
  const auto direct = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Eigen::VectorXd products = Eigen::VectorXd::Ones(sums.terms().rows());
    for (Index t = 0; t < std::ssize(products); ++t)
      for (Index j = 0; j < d; ++j) products[t] *= std::cos(sums.terms()(t, j) * std::acos(x[j]));
    return sums.coefficients().transpose() * products;
  };
  for (int n = 0; n < 20; ++n) {
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(d, [&] { return 0.99 * random(); });
    // memory behind the results is not written to
    Eigen::VectorXd values = Eigen::VectorXd::Constant(size + 1, 7), alone = values;
    Eigen::VectorXd slopes = Eigen::VectorXd::Constant(d * size + 1, 7);
    sums.evaluate(x.data(), values.data(), slopes.data());
    sums.evaluate(x.data(), alone.data());
    EXPECT_EQ(values, alone);
    EXPECT_EQ(values[size], 7);
    EXPECT_EQ(slopes[d * size], 7);
    EXPECT_LT((values.head(size) - direct(x)).cwiseAbs().maxCoeff(), 1e-11);
    constexpr double step = 1e-6;
    for (Index j = 0; j < d; ++j) {
      Eigen::VectorXd before = x, after = x;
      before[j] -= step;
      after[j] += step;
      const Eigen::VectorXd change = (direct(after) - direct(before)) / (2 * step);
      EXPECT_LT((slopes.segment(j * size, size) - change).cwiseAbs().maxCoeff(),
                1e-5 * (1 + change.cwiseAbs().maxCoeff()));
    }
  }
}

TEST_P(PolynomialSums, AreWhatEvaluateTermsGives) {
  const Polynomials sums = polynomials();
  if (sums.variables() == 0) return;
  const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(sums.variables(), [&] { return random(); });
  Eigen::VectorXd terms, values(sums.count());
  RowMatrix of_terms, slopes(sums.variables(), sums.count());
  evaluate_terms(sums.terms(), x, terms, &of_terms);
  sums.evaluate(x.data(), values.data(), slopes.data());
  EXPECT_LT((values - sums.coefficients().transpose() * terms).cwiseAbs().maxCoeff(), 1e-12);
  const RowMatrix wanted = of_terms * sums.coefficients();
  EXPECT_LT((slopes - wanted).cwiseAbs().maxCoeff(), 1e-12 * (1 + wanted.cwiseAbs().maxCoeff()));
}

// widths below, at and beyond the blocks in which they are added up
INSTANTIATE_TEST_SUITE_P(Maps, PolynomialSums,
                         ::testing::Values(Case{0, 1, 4}, Case{1, 1, 3}, Case{1, 20, 8}, Case{2, 60, 9},
                                           Case{3, 115, 6}, Case{3, 115, 16}, Case{4, 90, 17}, Case{3, 50, 32},
                                           Case{8, 200, 33}, Case{2, 30, 70}));

}  // namespace
}  // namespace softkin::maps
