#pragma once

#include <Eigen/Core>
#include <memory>
#include <softkin/core/types.hpp>

namespace softkin {

// Decompositions of dense matrices, each compiled once: Eigen's templates of them take the compiler longer than the
// files that need them.

/// A = U S V^T.
struct SingularValues {
  Eigen::VectorXd values;  // of S, descending
  Eigen::MatrixXd right;   // V, square
};
[[nodiscard]] SingularValues singular_values(const Eigen::MatrixXd& matrix);

/// Of a symmetric matrix, of which the lower half is read.
struct SymmetricEigen {
  Eigen::VectorXd values;   // ascending
  Eigen::MatrixXd vectors;  // orthonormal, as columns
};
[[nodiscard]] SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);
[[nodiscard]] Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);
[[nodiscard]] Vec3 principal_values(const Mat3& symmetric);

/// The proper rotation R that maximises tr(R^T A), of A = U S V^T.
struct NearestRotation {
  Mat3 rotation;
  Vec3 values;  // of S, descending
};
[[nodiscard]] NearestRotation nearest_rotation(const Mat3& map);

/// Returns a vector without any symmetry that a robot may have, the same each time.
[[nodiscard]] Eigen::VectorXd unsymmetric(Eigen::Index size);

/// Minimises |A x - b| by QR with pivoting of columns.
struct LeastSquares {
  Eigen::VectorXd solution;
  Eigen::Index rank = 0;
};
[[nodiscard]] LeastSquares least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

/// The same of several b, a column each, by QR without pivoting: of columns that are independent.
[[nodiscard]] Eigen::MatrixXd least_squares_of_full_rank(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// R of A = Q R: min(rows, columns) rows.
[[nodiscard]] Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& matrix);

/// The solution of a system whose symmetric matrix is not negative, by L D L^T.
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

/// By LU with full pivoting; not finite where there is none.
[[nodiscard]] Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix);

/// A = L L^T of a positive definite matrix.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const Eigen::MatrixXd& matrix);
  [[nodiscard]] bool positive() const { return positive_; }
  [[nodiscard]] const Eigen::MatrixXd& lower() const { return lower_; }  // zero above the diagonal
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  /// L^-1 of the columns.
  void solve_lower(Eigen::MatrixXd& columns) const;

 private:
  Eigen::MatrixXd lower_;
  bool positive_;
};

/// The smallest x that minimises |A x - b|, where columns may depend on each other.
class MinimumNorm {
 public:
  MinimumNorm() = default;
  /// threshold  pivots below that fraction of the largest count as zero; negative: by rounding
  explicit MinimumNorm(const Eigen::MatrixXd& matrix, double threshold = -1);
  [[nodiscard]] Eigen::Index rank() const;
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;

 private:
  std::shared_ptr<const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>> factor_;
};

}  // namespace softkin
