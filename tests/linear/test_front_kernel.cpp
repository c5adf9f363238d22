#include <gtest/gtest.h>

#include <random>
#include <softkin/core/dense.hpp>
#include <softkin/linear/front_kernel.hpp>

namespace softkin::linear {

namespace {

Eigen::MatrixXd random_symmetric(Index size, bool positive, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd any = Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(engine); });
  // shifted, so that no pivot is small by chance
  if (positive) return any * any.transpose() / size + Eigen::MatrixXd::Identity(size, size);
  Eigen::MatrixXd sum = (any + any.transpose()) / std::sqrt(8.0 * size);
  for (Index i = 0; i < size; ++i) sum(i, i) += i % 3 == 0 ? -2 : 2;
  return sum;
}

struct Factored {
  Eigen::MatrixXd lower, schur;
  Eigen::VectorXd diagonal;
  Index negative = 0;
};

/// The upper triangle and what is left hold rubbish, as they do where fronts share memory.
template <class Number = double>
Factored factored(const Eigen::MatrixXd& matrix, Index pivots, double least, Team& team) {
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  const Index size = matrix.rows(), rest = size - pivots, head = left_head<Number>;
  Matrix own = Matrix::Constant(front_stride<Number>(size), pivots, 1e3);
  own.bottomRows(own.rows() - size).setZero();
  own.topRows(size).template triangularView<Eigen::Lower>() = matrix.leftCols(pivots).template cast<Number>();
  Matrix left = Matrix::Constant(left_stride<Number>(rest), rest, 1e3);
  std::vector<Number> diagonal(pivots);
  Factored result;
  FrontWork<Number> work;
  result.negative = factor_front<Number>({own.data(), left.data() + head, size, pivots}, static_cast<Number>(least),
                                         diagonal.data(), work, team);
  const Eigen::MatrixXd added = left.middleRows(head, rest).template cast<double>();
  result.diagonal = Eigen::Map<const Eigen::VectorX<Number>>(diagonal.data(), pivots).template cast<double>();
  result.lower = Eigen::MatrixXd::Zero(size, pivots);
  result.lower.triangularView<Eigen::StrictlyLower>() = own.topRows(size).template cast<double>();
  result.lower.diagonal().setOnes();
  result.schur = matrix.bottomRightCorner(rest, rest);
  result.schur += Eigen::MatrixXd(added.selfadjointView<Eigen::Lower>());
  return result;
}

}  // namespace

constexpr std::pair<Index, Index> sizes_and_pivots[] = {{1, 1},    {2, 1},     {7, 3},    {8, 8},   {13, 5},
                                                        {33, 24},  {64, 64},   {65, 65},  {70, 64}, {129, 128},
                                                        {150, 66}, {200, 200}, {211, 131}};

template <class Number>
void expect_factored(double rounding) {
  Team alone(1);
  for (const bool positive : {true, false})
    for (const auto& [size, pivots] : sizes_and_pivots) {
      const Eigen::MatrixXd matrix = random_symmetric(size, positive, static_cast<unsigned>(size));
      const Factored found = factored<Number>(matrix, pivots, 1e-12, alone);
      Eigen::MatrixXd product = found.lower * found.diagonal.asDiagonal() * found.lower.transpose();
      product.bottomRightCorner(size - pivots, size - pivots) += found.schur;
      EXPECT_LT((product - matrix).norm(), rounding * matrix.norm()) << size << " " << pivots;
      const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(matrix.topLeftCorner(pivots, pivots));
      EXPECT_EQ(found.negative, (eigenvalues.array() < 0).count()) << size << " " << pivots;
    }
}

/// L D L^T plus the Schur complement is the matrix; D has the signs of the eigenvalues where all is eliminated.
TEST(FrontKernel, FactorsAsTheMatrixSays) {
  expect_factored<double>(1e-11);
  expect_factored<float>(1e-3);
}

TEST(FrontKernel, ResultDoesNotDependOnThreads) {
  Team alone(1), pair(2), trio(3);
  const Eigen::MatrixXd matrix = random_symmetric(700, false, 5);
  const Factored one = factored(matrix, 500, 1e-12, alone);
  const Factored single = factored<float>(matrix, 500, 1e-12, alone);
  for (Team* team : {&pair, &trio}) {
    const Factored more = factored(matrix, 500, 1e-12, *team), less = factored<float>(matrix, 500, 1e-12, *team);
    EXPECT_EQ(one.lower, more.lower);
    EXPECT_EQ(one.diagonal, more.diagonal);
    EXPECT_EQ(one.schur, more.schur);
    EXPECT_EQ(single.lower, less.lower);
    EXPECT_EQ(single.schur, less.schur);
  }
}

/// A pivot that is too small becomes -least, is counted as negative, and nothing is divided by zero.
TEST(FrontKernel, SmallPivotsAreReplaced) {
  Team alone(1);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(5, 5);
  matrix.row(1) = matrix.row(0);
  matrix.col(1) = matrix.col(0);  // rank 4: the second pivot is 0
  const Factored found = factored(matrix, 5, 1e-6, alone);
  EXPECT_EQ(found.negative, 1);
  EXPECT_EQ(found.diagonal[1], -1e-6);
  EXPECT_TRUE(found.lower.allFinite());
  matrix(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(factored(matrix, 5, 1e-6, alone).diagonal[2], -1e-6);
}

}  // namespace softkin::linear
