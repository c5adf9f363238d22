#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <string>

namespace softkin::bench {

/// A factorisation of a symmetric positive definite matrix, timed.
struct FactorTimes {
  double analyse = 0, factor = 0, solve = 0;  // [s]: once; medians of several
  double nonzeros = 0;                        // of the factor
  double residual = 0;                        // |A x - b| / |b|
};

/// matrix: lower triangle. Each factorises `repeat` times and solves for one right-hand side of ones.
[[nodiscard]] FactorTimes time_eigen_simplicial(const Eigen::SparseMatrix<double>& matrix, int repeat);

/// CHOLMOD's supernodal LL^T in METIS's order; none where CHOLMOD was not found when this was built. Its threads are
/// those of its BLAS.
[[nodiscard]] std::optional<FactorTimes> time_cholmod_supernodal(const Eigen::SparseMatrix<double>& matrix, int repeat);

/// |A x - b| / |b| for the lower triangle of A.
[[nodiscard]] double relative_residual(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& x,
                                       const Eigen::VectorXd& b);

}  // namespace softkin::bench
