#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>
#include <softkin/kinematics/inverse_step.hpp>

namespace softkin {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

struct Program {
  Matrix h, rows;
  Vector g, bounds;

  [[nodiscard]] double value(const Vector& s) const { return 0.5 * s.dot(h * s) + g.dot(s); }
  [[nodiscard]] bool allows(const Vector& s) const { return ((rows * s - bounds).array() > -1e-9).all(); }
};

/// Of the minimisers on every face the best that is allowed.
double by_enumeration(const Program& p) {
  const auto n = p.h.rows();
  double best = HUGE_VAL;
  for (int chosen = 0; chosen < (1 << p.rows.rows()); ++chosen) {
    const auto count = __builtin_popcount(static_cast<unsigned>(chosen));
    if (count > n) continue;
    Matrix kkt = Matrix::Zero(n + count, n + count);
    Vector right = Vector::Zero(n + count);
    kkt.topLeftCorner(n, n) = p.h;
    right.head(n) = -p.g;
    for (Eigen::Index i = 0, at = n; i < p.rows.rows(); ++i)
      if (chosen >> i & 1) {
        kkt.block(at, 0, 1, n) = p.rows.row(i);
        kkt.block(0, at, n, 1) = -p.rows.row(i).transpose();
        right[at++] = p.bounds[i];
      }
    const Vector s = kkt.completeOrthogonalDecomposition().solve(right).head(n);
    if (p.allows(s)) best = std::min(best, p.value(s));
  }
  return best;
}

/// Rows through the start where slack is 0.
Program random_program(std::mt19937& engine, Eigen::Index size, Eigen::Index rows, double slack) {
  std::normal_distribution<double> normal;
  const auto any = [&](Eigen::Index r, Eigen::Index c) {
    return Matrix::NullaryExpr(r, c, [&] { return normal(engine); });
  };
  Program p;
  const Matrix root = any(size, size);
  p.h = root * root.transpose() + 0.01 * Matrix::Identity(size, size);
  p.g = 3 * any(size, 1);
  p.rows = any(rows, size);
  p.bounds = -slack * any(rows, 1).cwiseAbs();
  return p;
}

TEST(SmallProgram, EqualsTheEnumerationOfFaces) {
  std::mt19937 engine(1);
  for (int i = 0; i < 300; ++i) {
    const Program p = random_program(engine, 1 + i % 4, 1 + i % 7, 1);
    const Vector s = inverse::solve_small_program(p.h, p.g, p.rows, p.bounds);
    EXPECT_TRUE(p.allows(s)) << i;
    EXPECT_NEAR(p.value(s), by_enumeration(p), 1e-7) << i;
  }
}

TEST(SmallProgram, LeavesACornerWhereManyRowsMeet) {
  std::mt19937 engine(2);
  int moved = 0;
  for (int i = 0; i < 500; ++i) {
    Program p = random_program(engine, 2 + i % 3, 9, 0);
    p.rows.row(3) = p.rows.row(1);                  // twice the same
    p.rows.row(5) = p.rows.row(0) + p.rows.row(2);  // implied by others
    if (i % 2 == 0) p.rows.topRows(p.h.rows()) = -Matrix::Identity(p.h.rows(), p.h.rows());
    if (i % 3 == 0) p.rows = (p.rows.array() * 2).round() / 2;  // ties
    const Vector s = inverse::solve_small_program(p.h, p.g, p.rows, p.bounds);
    EXPECT_TRUE(p.allows(s)) << i;
    EXPECT_NEAR(p.value(s), by_enumeration(p), 1e-7) << i;
    if (s.norm() > 1e-6) ++moved;
  }
  EXPECT_GT(moved, 50);
}

TEST(SmallProgram, LeavesOutRowsOfZeros) {
  const Matrix one = Matrix::Identity(1, 1);
  EXPECT_NEAR(inverse::solve_small_program(one, -Vector::Ones(1), Matrix::Zero(1, 1), Vector::Zero(1))[0], 1, 1e-12);
}

TEST(SmallProgram, FreeMinimumAndNoRows) {
  const Matrix h = 4 * Matrix::Identity(2, 2);
  const Vector s = inverse::solve_small_program(h, Vector::Constant(2, -8), Matrix(0, 2), Vector(0));
  EXPECT_LT((s - Vector::Constant(2, 2)).norm(), 1e-12);
}

}  // namespace
}  // namespace softkin
