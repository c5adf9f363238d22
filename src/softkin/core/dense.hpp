#pragma once

#include <Eigen/Core>

namespace softkin {

// Decompositions of dense matrices of any size, each compiled once: Eigen's templates of them take the compiler longer
// than the files that need them.

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

/// A vector that no symmetry of a robot shares, the same each time.
[[nodiscard]] Eigen::VectorXd lopsided(Eigen::Index size);

/// Minimises |A x - b| by QR with pivoting of columns.
struct LeastSquares {
  Eigen::VectorXd solution;
  Eigen::Index rank = 0;
};
[[nodiscard]] LeastSquares least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

}  // namespace softkin
