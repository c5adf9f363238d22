#include <Eigen/LU>
#include <softkin/statics/complementarity.hpp>
#include <vector>

namespace softkin {

Eigen::VectorXd complementary(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& offset) {
  constexpr int most_pivots = 1000;
  constexpr double rounding = 1e-12;
  const Eigen::Index count = offset.size();
  const double none = -rounding * (count > 0 ? offset.cwiseAbs().maxCoeff() : 0);
  std::vector<bool> positive(static_cast<std::size_t>(count), false);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(count);
  for (int pivot = 0; pivot < most_pivots; ++pivot) {
    std::vector<Eigen::Index> basis;
    for (Eigen::Index i = 0; i < count; ++i)
      if (positive[i]) basis.push_back(i);
    x.setZero();
    if (!basis.empty()) {
      const Eigen::MatrixXd inner = matrix(basis, basis);
      const Eigen::VectorXd right = -offset(basis);
      const Eigen::VectorXd part = inner.partialPivLu().solve(right);
      for (std::size_t k = 0; k < basis.size(); ++k) x[basis[k]] = part[static_cast<Eigen::Index>(k)];
    }
    const Eigen::VectorXd rest = matrix * x + offset;
    Eigen::Index wrong = 0;
    while (wrong < count && (positive[wrong] ? x[wrong] >= 0 : rest[wrong] >= none)) ++wrong;
    if (wrong == count) return x;
    positive[wrong] = !positive[wrong];
  }
  return Eigen::VectorXd::Zero(count);
}

}  // namespace softkin
