#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <softkin/core/dense.hpp>

namespace softkin {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Vec3 principal_values(const Mat3& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

NearestRotation nearest_rotation(const Mat3& map) {
  const Eigen::JacobiSVD<Mat3> parts(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = parts.matrixU().determinant() * parts.matrixV().determinant() < 0 ? -1 : 1;
  return {parts.matrixU() * Vec3(1, 1, sign).asDiagonal() * parts.matrixV().transpose(), parts.singularValues()};
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  return matrix.ldlt().solve(right);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix) {
  return Eigen::FullPivLU<Eigen::MatrixXd>(matrix).inverse();
}

CholeskyFactor::CholeskyFactor(const Eigen::MatrixXd& matrix) : lower_(matrix) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(lower_);
  positive_ = factor.info() == Eigen::Success;
  lower_.triangularView<Eigen::StrictlyUpper>().setZero();
}

Eigen::MatrixXd CholeskyFactor::solve(const Eigen::MatrixXd& right) const {
  Eigen::MatrixXd x = right;
  solve_lower(x);
  lower_.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  return x;
}

Eigen::VectorXd CholeskyFactor::solve(const Eigen::VectorXd& right) const {
  Eigen::VectorXd x = right;
  lower_.triangularView<Eigen::Lower>().solveInPlace(x);
  lower_.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  return x;
}

void CholeskyFactor::solve_lower(Eigen::MatrixXd& columns) const {
  lower_.triangularView<Eigen::Lower>().solveInPlace(columns);
}

Eigen::VectorXd unsymmetric(Eigen::Index size) {
  Eigen::VectorXd vector(size);
  for (Eigen::Index i = 0; i < size; ++i) vector[i] = std::sin(1.0 + 1.618 * static_cast<double>(i));
  return vector;
}

}  // namespace softkin
