#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/linear/mixed_ldlt.hpp>
#include <utility>

namespace softkin::linear {

namespace {

/// Largest fraction of x . M x that rounding may change, and slowest contraction.
constexpr double max_rounded = 0.15, slowest = 0.3;
/// In single precision, pivots are replaced below this multiple of `least`.
constexpr double single_least = 1e6;
constexpr int max_patience = 64;

}  // namespace

void MixedLdlt::change(std::shared_ptr<const FrontTree> tree) {
  tree_ = std::move(tree);
  if (single_) single_->change(tree_);
  if (twice_) twice_->change(tree_);
}

void MixedLdlt::forget() {
  wait_ = 0;
  patience_ = 1;
}

void MixedLdlt::distrust() {
  wait_ = patience_;
  patience_ = std::min(2 * patience_, max_patience);
}

/// Solves with the factor in single precision; found_ becomes the solutions, with one more. False where they are not to
/// be trusted.
bool MixedLdlt::solve_trusted(const LargeVector<double>& values, bool by_energy, const Eigen::MatrixXd& right_sides,
                              Team& team) {
  const Index count = right_sides.cols();
  if (unsymmetric_.size() != right_sides.rows()) unsymmetric_ = unsymmetric(right_sides.rows());
  found_.resize(right_sides.rows(), count + 1);
  found_.leftCols(count) = right_sides;
  found_.col(count) = unsymmetric_;
  single_->solve(found_, team);
  left_ = unsymmetric_;
  subtract_product(tree_->pattern, values, found_.col(count), left_, team);
  rounded_ = std::abs(found_.col(count).dot(left_.col(0)) / found_.col(count).dot(unsymmetric_));
  if (by_energy) return rounded_ <= max_rounded;
  single_->solve(left_, team);
  return left_.norm() <= slowest * found_.col(count).norm();
}

Pivots MixedLdlt::factorise(const LargeVector<double>& values, double least, Precision precision,
                            Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team, LargeVector<double>* spare) {
  const bool waits = precision != Precision::twice && wait_ > 0;
  if (waits) --wait_;
  if (precision != Precision::twice && !waits) {
    in_double_ = false;
    if (!single_) single_.emplace(tree_);
    const Pivots pivots = single_->factorise(values, single_least * least, team, spare);
    const bool by_energy = pivots.negative == 0 && precision != Precision::good;
    trusted_ = pivots.replaced == 0 && solve_trusted(values, by_energy, right_sides, team);
    const bool guess = precision == Precision::sign && pivots.replaced == 0 && pivots.negative > 0;
    if (trusted_) patience_ = 1;
    if (trusted_ || guess) {
      right_sides = found_.leftCols(right_sides.cols());
      return pivots;
    }
    distrust();
  }
  if (!twice_) {
    require_memory(*tree_, sizeof(double));
    twice_.emplace(tree_);
  }
  in_double_ = trusted_ = true;
  const Pivots pivots = twice_->factorise(values, least, team, spare);
  twice_->solve(right_sides, team);
  return pivots;
}

void MixedLdlt::solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team) {
  if (in_double_)
    twice_->solve(right_sides, team);
  else
    single_->solve(right_sides, team);
}

double MixedLdlt::bytes() const {
  return (single_ ? single_->bytes() : 0) + (twice_ ? twice_->bytes() : 0);
}

}  // namespace softkin::linear
