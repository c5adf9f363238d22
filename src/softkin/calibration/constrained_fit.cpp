#include <limits>
#include <softkin/calibration/constrained_fit.hpp>
#include <softkin/core/dense.hpp>
#include <vector>

namespace softkin::calibration {

namespace {

/// The least squares over some of the columns; 0 elsewhere.
Eigen::VectorXd fit_of_columns(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right,
                               const std::vector<Eigen::Index>& columns) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(matrix.cols());
  if (columns.empty()) return x;
  const Eigen::VectorXd part = least_squares(matrix(Eigen::all, columns), right).solution;
  for (std::size_t i = 0; i < columns.size(); ++i) x[columns[i]] = part[static_cast<Eigen::Index>(i)];
  return x;
}

}  // namespace

Eigen::VectorXd non_negative_fit(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  const Eigen::Index size = matrix.cols();
  const double tolerance = 1e-13 * matrix.norm() * right.norm();
  std::vector<Eigen::Index> passive;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
  for (Eigen::Index round = 0; round < 3 * size + 10; ++round) {
    Eigen::VectorXd gain = matrix.transpose() * (right - matrix * x);
    for (const Eigen::Index c : passive) gain[c] = -1;
    Eigen::Index entering = 0;
    if (!(gain.maxCoeff(&entering) > tolerance)) break;
    passive.push_back(entering);
    for (;;) {
      const Eigen::VectorXd next = fit_of_columns(matrix, right, passive);
      double step = 1;
      for (const Eigen::Index c : passive)
        if (next[c] <= 0) step = std::min(step, x[c] / (x[c] - next[c]));
      if (step >= 1) {
        x = next;
        break;
      }
      x += step * (next - x);
      std::vector<Eigen::Index> kept;
      for (const Eigen::Index c : passive) {
        if (next[c] > 0 || x[c] > 1e-14 * x.lpNorm<Eigen::Infinity>()) {
          kept.push_back(c);
        } else {
          x[c] = 0;
        }
      }
      if (kept.size() == passive.size()) return x;  // rounding alone
      passive = std::move(kept);
      if (passive.empty()) break;
    }
  }
  return x;
}

Eigen::VectorXd constrained_fit(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right,
                                const Eigen::MatrixXd& conditions, const Eigen::VectorXd& bounds) {
  // with z = R x - Q^T b, |A x - b| is |z| and a constant
  const Eigen::MatrixXd back = inverse_of(triangle_of(matrix));
  const Eigen::VectorXd free = least_squares(matrix, right).solution;
  Eigen::MatrixXd turned = conditions * back;
  Eigen::VectorXd distances = bounds - conditions * free;
  const Eigen::VectorXd scale = turned.rowwise().norm().cwiseMax(1e-300).cwiseInverse();
  turned = scale.asDiagonal() * turned;
  distances = scale.cwiseProduct(distances);
  const double size = std::max(distances.lpNorm<Eigen::Infinity>(), 1e-300);
  const Eigen::Index n = matrix.cols();
  Eigen::MatrixXd dual(n + 1, conditions.rows());
  dual.topRows(n) = turned.transpose();
  dual.row(n) = distances.transpose() / size;
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n + 1, n);
  const Eigen::VectorXd residual = dual * non_negative_fit(dual, unit) - unit;
  if (!(std::abs(residual[n]) > 1e-10)) return Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  return free + back * (-size / residual[n]) * residual.head(n);
}

}  // namespace softkin::calibration
