#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <softkin/linear/krylov.hpp>

namespace softkin::linear {

namespace {

/// Multiplies by a matrix and counts the columns.
struct Counting {
  const Eigen::MatrixXd& matrix;
  int* columns;
  void operator()(const Eigen::MatrixXd& in, Eigen::MatrixXd& out) const {
    *columns += static_cast<int>(in.cols());
    out = matrix * in;
  }
};

Eigen::MatrixXd near_identity(int size, double apart) {
  std::srand(3);
  return Eigen::MatrixXd::Identity(size, size) + apart / std::sqrt(size) * Eigen::MatrixXd::Random(size, size);
}

}  // namespace

TEST(ConjugateResiduals, SolvesAsADenseFactorDoes) {
  for (const int size : {1, 6, 50})
    for (const double apart : {0.0, 0.1, 0.5}) {
      const Eigen::MatrixXd matrix = near_identity(size, apart), right = Eigen::MatrixXd::Random(size, 3);
      Eigen::MatrixXd left = right, x;
      int columns = 0;
      const Remainder remainder = conjugate_residuals(Counting{matrix, &columns}, 1e-12, 60, left, x);
      EXPECT_LE(remainder.left, 1e-12);
      EXPECT_LT((x - matrix.partialPivLu().solve(right)).norm(), 1e-11 * right.norm());
      EXPECT_LT((left - (right - matrix * x)).norm(), 1e-13 * right.norm());
      double most = 0;
      for (int i = 0; i < 3; ++i)
        most = std::max(most, (matrix * right.col(i) - right.col(i)).norm() / right.col(i).norm());
      EXPECT_NEAR(remainder.apart, most, 1e-14);
      if (apart == 0) {
        EXPECT_EQ(columns, 3);
      }
    }
}

/// Columns that are zero or done cost nothing, and each gains from the others' directions.
TEST(ConjugateResiduals, SharesDirections) {
  const Eigen::MatrixXd matrix = near_identity(40, 0.5);
  Eigen::MatrixXd right = Eigen::MatrixXd::Random(40, 3), x;
  right.col(1).setZero();
  right.col(2) = matrix * right.col(0);
  Eigen::MatrixXd left = right;
  int together = 0, alone = 0;
  EXPECT_LE(conjugate_residuals(Counting{matrix, &together}, 1e-12, 60, left, x).left, 1e-12);
  EXPECT_EQ(x.col(1).norm(), 0);
  EXPECT_LT((x.col(2) - right.col(0)).norm(), 1e-11);
  for (const int column : {0, 2}) {
    Eigen::MatrixXd one = right.col(column);
    EXPECT_LE(conjugate_residuals(Counting{matrix, &alone}, 1e-12, 60, one, x).left, 1e-12);
  }
  EXPECT_LT(together, 0.8 * alone);
}

/// What rounding leaves of columns that are multiples of each other is no direction.
TEST(ConjugateResiduals, ColumnsMayBeNearlyTheSame) {
  const Eigen::MatrixXd matrix = near_identity(40, 0.3);
  for (const double apart : {0.0, 1e-15, 1e-11, 1e-9, 1e-7, 1e-4}) {
    Eigen::MatrixXd right = Eigen::MatrixXd::Random(40, 3), x;
    right.col(1) = -70 * right.col(0) + apart * right.col(1);
    right.col(2) = 0.3 * right.col(0) + apart * right.col(2);
    Eigen::MatrixXd left = right;
    int columns = 0;
    EXPECT_LE(conjugate_residuals(Counting{matrix, &columns}, 1e-9, 60, left, x).left, 1e-9) << apart;
    for (int i = 0; i < 3; ++i)
      EXPECT_LT((right.col(i) - matrix * x.col(i)).norm(), 2e-9 * right.col(i).norm()) << apart;
  }
}

TEST(ConjugateResiduals, SaysSoWhereItFails) {
  Eigen::MatrixXd matrix = near_identity(20, 0.3), x;
  matrix.row(4).setZero();
  Eigen::MatrixXd left = Eigen::MatrixXd::Random(20, 2);
  int columns = 0;
  EXPECT_GT(conjugate_residuals(Counting{matrix, &columns}, 1e-10, 100, left, x).left, 1e-3);
  EXPECT_TRUE(x.allFinite());
  matrix(4, 4) = std::numeric_limits<double>::quiet_NaN();
  left.setRandom();
  const Remainder remainder = conjugate_residuals(Counting{matrix, &columns}, 1e-10, 100, left, x);
  EXPECT_FALSE(remainder.left <= 1e-10);
  EXPECT_TRUE(x.allFinite());
  // no rounds are wasted where they will not do
  const Eigen::MatrixXd hard = near_identity(400, 0.95);
  columns = 0;
  left = Eigen::MatrixXd::Random(400, 1);
  EXPECT_GT(conjugate_residuals(Counting{hard, &columns}, 1e-10, 20, left, x).left, 1e-10);
  EXPECT_LT(columns, 5);
}

}  // namespace softkin::linear
