#include <softkin/calibration/nonnegative.hpp>
#include <softkin/core/dense.hpp>
#include <vector>

namespace softkin::calibration {

namespace {

/// Columns scaled to length 1, and no more rows than columns, which makes the iterations cheap.
struct Compressed {
  Compressed(const Eigen::MatrixXd& full, const Eigen::VectorXd& b) : scale(full.cols()) {
    matrix = full;
    for (Eigen::Index c = 0; c < full.cols(); ++c) {
      const double norm = full.col(c).norm();
      scale[c] = norm > 0 ? 1 / norm : 0;
      matrix.col(c) *= scale[c];
    }
    right = b;
    if (full.rows() <= full.cols()) return;
    Eigen::MatrixXd both(full.rows(), full.cols() + 1);
    both << matrix, b;
    const Eigen::MatrixXd triangle = triangle_of(both);
    matrix = triangle.topLeftCorner(full.cols(), full.cols());
    right = triangle.topRightCorner(full.cols(), 1);
  }

  Eigen::MatrixXd matrix;
  Eigen::VectorXd right, scale;
};

using Passive = std::vector<Eigen::Index>;

/// Least squares over these columns alone; the others 0.
Eigen::VectorXd solve_over(const Compressed& problem, const Passive& passive) {
  Eigen::MatrixXd columns(problem.matrix.rows(), passive.size());
  for (std::size_t i = 0; i < passive.size(); ++i) columns.col(i) = problem.matrix.col(passive[i]);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.matrix.cols());
  if (passive.empty()) return x;
  const Eigen::VectorXd some = least_squares(columns, problem.right).solution;
  for (std::size_t i = 0; i < passive.size(); ++i) x[passive[i]] = some[i];
  return x;
}

}  // namespace

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right,
                                          Eigen::Index free) {
  const Compressed problem(matrix, right);
  const Eigen::Index size = matrix.cols();
  const double enough = 1e-12 * problem.right.norm();
  Passive passive;
  for (Eigen::Index c = 0; c < free; ++c) passive.push_back(c);
  Eigen::VectorXd x = solve_over(problem, passive);
  for (Eigen::Index round = 0; round < 3 * size; ++round) {
    const Eigen::VectorXd gain = problem.matrix.transpose() * (problem.right - problem.matrix * x);
    Eigen::Index best = -1;
    for (Eigen::Index c = free; c < size; ++c)
      if (x[c] == 0 && gain[c] > enough && (best < 0 || gain[c] > gain[best])) best = c;
    if (best < 0) break;
    passive.push_back(best);
    Eigen::VectorXd next = solve_over(problem, passive);
    if (!(next[best] > 0)) break;  // rounding: nothing is gained any more
    for (;;) {
      double fraction = 1;
      Eigen::Index leaves = -1;  // the first that would fall below 0
      for (const Eigen::Index c : passive) {
        if (c < free || next[c] > 0) continue;
        const double own = x[c] > 0 ? x[c] / (x[c] - next[c]) : 0;
        if (leaves < 0 || own < fraction) leaves = c, fraction = own;
      }
      x += fraction * (next - x);
      if (leaves < 0) break;
      x[leaves] = 0;
      std::erase(passive, leaves);
      next = solve_over(problem, passive);
    }
  }
  return problem.scale.cwiseProduct(x);
}

}  // namespace softkin::calibration
