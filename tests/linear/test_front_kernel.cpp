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

/// The upper triangle and the rows beyond `size` hold rubbish, as they do when fronts share their memory.
Factored factored(const Eigen::MatrixXd& matrix, Index pivots, double least, Team& team) {
  const Index size = static_cast<Index>(matrix.rows()), stride = front_stride(size);
  std::vector<double> front(static_cast<std::size_t>(stride) * size + front_slack, 1e3);
  Eigen::Map<Eigen::MatrixXd> view(front.data(), stride, size);
  view.topRows(size).triangularView<Eigen::Lower>() = matrix;
  Factored result;
  result.diagonal.resize(pivots);
  FrontWork work;
  result.negative = factor_front(front.data(), size, pivots, least, result.diagonal.data(), work, team);
  result.lower = Eigen::MatrixXd::Zero(size, pivots);
  result.lower.triangularView<Eigen::StrictlyLower>() = Eigen::MatrixXd(view.topLeftCorner(size, pivots));
  result.lower.diagonal().setOnes();
  result.schur = view.block(pivots, pivots, size - pivots, size - pivots).selfadjointView<Eigen::Lower>();
  return result;
}

}  // namespace

/// L D L^T plus the Schur complement is the matrix; D has the signs of the eigenvalues where all is eliminated.
TEST(FrontKernel, FactorsAsTheMatrixSays) {
  Team alone(1);
  for (const bool positive : {true, false})
    for (const auto& [size, pivots] : {std::pair<Index, Index>{1, 1},
                                       {2, 1},
                                       {7, 3},
                                       {8, 8},
                                       {13, 5},
                                       {33, 24},
                                       {64, 64},
                                       {65, 65},
                                       {70, 64},
                                       {129, 128},
                                       {150, 66},
                                       {200, 200},
                                       {211, 131},
                                       {90, 0}}) {
      const Eigen::MatrixXd matrix = random_symmetric(size, positive, static_cast<unsigned>(size));
      const Factored found = factored(matrix, pivots, 1e-12, alone);
      Eigen::MatrixXd product = found.lower * found.diagonal.asDiagonal() * found.lower.transpose();
      product.bottomRightCorner(size - pivots, size - pivots) += found.schur;
      EXPECT_LT((product - matrix).norm(), 1e-11 * matrix.norm()) << size << " " << pivots;
      if (pivots == 0) continue;
      const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(matrix.topLeftCorner(pivots, pivots));
      EXPECT_EQ(found.negative, (eigenvalues.array() < 0).count()) << size << " " << pivots;
    }
}

TEST(FrontKernel, ResultDoesNotDependOnThreads) {
  Team alone(1), pair(2), trio(3);
  const Eigen::MatrixXd matrix = random_symmetric(700, false, 5);
  const Factored one = factored(matrix, 500, 1e-12, alone);
  for (Team* team : {&pair, &trio}) {
    const Factored more = factored(matrix, 500, 1e-12, *team);
    EXPECT_EQ(one.lower, more.lower);
    EXPECT_EQ(one.diagonal, more.diagonal);
    EXPECT_EQ(one.schur, more.schur);
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
