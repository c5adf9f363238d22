#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/calibration/relaxation_problem.hpp>
#include <softkin/core/dense.hpp>

namespace softkin::calibration {

namespace {

using Eigen::VectorXd;

VectorXd within_bounds(const RelaxationProblem& problem, VectorXd unknowns) {
  for (Eigen::Index u = 0; u < unknowns.size(); ++u) {
    const auto [low, high] = problem.bounds(u);
    unknowns[u] = std::clamp(unknowns[u], low, high);
  }
  return unknowns;
}

/// The linear problem at a point: J^T J and J^T r over the unknowns that move, columns of J scaled to length 1.
struct NormalEquations {
  NormalEquations(const RelaxationProblem& problem, const VectorXd& unknowns, const VectorXd& residuals)
      : size(unknowns.size()) {
    const Eigen::MatrixXd slopes = problem.slopes(unknowns);
    const VectorXd full = slopes.transpose() * residuals;
    for (Eigen::Index u = 0; u < size; ++u) {
      const auto [low, high] = problem.bounds(u);
      const bool held = (unknowns[u] <= low && full[u] > 0) || (unknowns[u] >= high && full[u] < 0);
      if (!held && slopes.col(u).squaredNorm() > 0) moving.push_back(u);
    }
    const Eigen::Index count = moving.size();
    Eigen::MatrixXd some(slopes.rows(), count);
    scale.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      scale[i] = 1 / slopes.col(moving[i]).norm();
      some.col(i) = scale[i] * slopes.col(moving[i]);
    }
    matrix = some.transpose() * some;
    right = some.transpose() * residuals;
  }

  [[nodiscard]] VectorXd step(double damping) const {
    Eigen::MatrixXd damped = matrix;
    damped.diagonal().array() += damping;
    return spread(-scale.cwiseProduct(solve_symmetric(damped, right)), 0);
  }
  /// Of every unknown by what these are of those that move; rest: the others.
  [[nodiscard]] VectorXd spread(const VectorXd& some, double rest) const {
    VectorXd all = VectorXd::Constant(size, rest);
    for (std::size_t i = 0; i < moving.size(); ++i) all[moving[i]] = some[i];
    return all;
  }
  /// Unknowns in a combination that the rows do not determine have no deviation.
  [[nodiscard]] VectorXd deviations() const {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), singular = 1e-13, part = 1e-3;
    if (moving.empty()) return VectorXd::Constant(size, nan);
    const SymmetricEigen eigen = symmetric_eigen(matrix);
    VectorXd variances = VectorXd::Zero(right.size());
    for (Eigen::Index k = 0; k < eigen.values.size(); ++k) {
      const Eigen::ArrayXd fractions = eigen.vectors.col(k).array().square();
      const bool reported = eigen.values[k] > singular * eigen.values.maxCoeff();
      if (reported) variances.array() += fractions / eigen.values[k];
      for (Eigen::Index i = 0; i < fractions.size() && !reported; ++i)
        if (fractions[i] > part * part) variances[i] = nan;
    }
    return spread(scale.cwiseProduct(variances.cwiseSqrt()), nan);
  }

  Eigen::Index size = 0;
  std::vector<Eigen::Index> moving;
  Eigen::MatrixXd matrix;
  VectorXd right, scale;
};

}  // namespace

std::optional<Minimum> minimise(const RelaxationProblem& problem, const VectorXd& start, double enough) {
  constexpr int max_steps = 60;
  constexpr double min_damping = 1e-12, max_damping = 1e8;
  VectorXd unknowns = within_bounds(problem, start);
  std::optional<VectorXd> residuals = problem.residuals(unknowns);
  if (!residuals) return std::nullopt;
  double damping = 1e-3;
  for (int i = 0; i < max_steps; ++i) {
    const NormalEquations equations(problem, unknowns, *residuals);
    double gained = 0;
    for (; gained <= 0 && damping <= max_damping; damping *= 8) {
      const VectorXd tried = within_bounds(problem, unknowns + equations.step(damping));
      std::optional<VectorXd> left = problem.residuals(tried);
      if (!left || !(left->squaredNorm() < residuals->squaredNorm())) continue;
      gained = 1 - left->squaredNorm() / residuals->squaredNorm();
      unknowns = tried;
      residuals = std::move(left);
      damping = std::max(damping / 64, min_damping);  // the loop multiplies it once more
    }
    if (gained < enough) break;
  }
  return Minimum{unknowns, residuals->squaredNorm(), NormalEquations(problem, unknowns, *residuals).deviations()};
}

}  // namespace softkin::calibration
