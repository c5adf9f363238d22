#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <softkin/core/dense.hpp>

namespace softkin {

SingularValues singular_values(const Eigen::MatrixXd& matrix) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

LeastSquares least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  return {qr.solve(right), qr.rank()};
}

Eigen::MatrixXd least_squares_of_full_rank(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(matrix).solve(right);
}

Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& matrix) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  return qr.matrixQR().topRows(std::min(matrix.rows(), matrix.cols())).triangularView<Eigen::Upper>();
}

MinimumNorm::MinimumNorm(const Eigen::MatrixXd& matrix, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  if (threshold >= 0) factor.setThreshold(threshold);
  factor.compute(matrix);
  factor_ = std::make_shared<const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>>(std::move(factor));
}

Eigen::Index MinimumNorm::rank() const {
  return factor_->rank();
}

Eigen::MatrixXd MinimumNorm::solve(const Eigen::MatrixXd& right) const {
  return factor_->solve(right);
}

}  // namespace softkin
