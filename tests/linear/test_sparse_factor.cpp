#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/linear/ordering.hpp>
#include <softkin/linear/sparse_factor.hpp>

namespace softkin::linear {

namespace {

/// Laplacian of a nx x ny x nz grid with random weights, plus a little of the identity; several components when split.
Eigen::SparseMatrix<double> grid_matrix(int nx, int ny, int nz, unsigned seed, bool split = false) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> weight(0.1, 2);
  const Index n = nx * ny * nz;
  std::vector<Eigen::Triplet<double>> entries;
  const auto at = [&](int i, int j, int k) { return i + nx * (j + ny * k); };
  const auto couple = [&](Index a, Index b) {
    const double w = weight(engine);
    entries.emplace_back(std::max(a, b), std::min(a, b), -w);
    entries.emplace_back(a, a, w);
    entries.emplace_back(b, b, w);
  };
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (i + 1 < nx && !(split && i == nx / 2)) couple(at(i, j, k), at(i + 1, j, k));
        if (j + 1 < ny) couple(at(i, j, k), at(i, j + 1, k));
        if (k + 1 < nz) couple(at(i, j, k), at(i, j, k + 1));
      }
  for (Index v = 0; v < n; ++v) entries.emplace_back(v, v, 0.01);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Points random_points(Index n) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  return Points::NullaryExpr(n, 3, [&] { return normal(engine); });
}

}  // namespace

TEST(SparseFactor, SolvesAsADenseFactorDoes) {
  for (const auto& matrix : {grid_matrix(12, 4, 5, 1), grid_matrix(9, 5, 3, 2, true), grid_matrix(1, 1, 1, 3),
                             grid_matrix(2, 1, 1, 4), grid_matrix(40, 1, 1, 5)}) {
    const Points right = random_points(matrix.rows());
    const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd expected = dense.ldlt().solve(right);
    Points solution = right;
    Team alone(1);
    SparseFactor(matrix).solve(solution, alone);
    EXPECT_NEAR((solution - expected).norm(), 0, 1e-11 * expected.norm());
  }
}

TEST(SparseFactor, ResultDoesNotDependOnThreads) {
  const auto matrix = grid_matrix(30, 6, 6, 7);
  const SparseFactor factor(matrix);
  Points one = random_points(matrix.rows()), two = one, three = one;
  Team alone(1), pair(2), trio(3);
  factor.solve(one, alone);
  factor.solve(two, pair);
  factor.solve(three, trio);
  EXPECT_EQ(one, two);
  EXPECT_EQ(one, three);
}

TEST(SparseFactor, RefusesAnIndefiniteMatrix) {
  Eigen::SparseMatrix<double> matrix = grid_matrix(4, 3, 3, 1);
  matrix.coeffRef(5, 5) = -1;
  EXPECT_THROW(SparseFactor{matrix}, InvalidInput);
}

TEST(Ordering, IsAPermutationWhosePiecesAreIndependent) {
  const auto matrix = grid_matrix(20, 5, 5, 1);
  const Ordering ordering = nested_dissection(matrix);
  const Index n = matrix.rows();
  std::vector<int> seen(n, 0);
  std::vector<Index> piece(n, -1);
  for (Index k = 0; k < n; ++k) {
    ++seen[ordering.order[k]];
    for (std::size_t p = 0; p + 1 < ordering.pieces.size(); ++p)
      if (k >= ordering.pieces[p] && k < ordering.pieces[p + 1]) piece[ordering.order[k]] = p;
  }
  for (const int count : seen) EXPECT_EQ(count, 1);
  EXPECT_GE(ordering.pieces.size(), 3u);
  for (Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it)
      EXPECT_TRUE(piece[it.row()] < 0 || piece[j] < 0 || piece[it.row()] == piece[j]);
}

}  // namespace softkin::linear
