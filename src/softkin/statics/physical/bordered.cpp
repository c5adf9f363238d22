#include <cmath>
#include <softkin/statics/physical/bordered.hpp>

namespace softkin::physical {

void Bordered::set(const Iterate& at) {
  at_ = &at;
  system_.reduce_slopes(at, work_, slopes_);
}

/// Solves with the factor, in place.
void Bordered::precondition(Columns& columns) {
  if (!columns.moves.isZero(0)) work_.solve(columns.moves, team_);
  if (work_.active.empty()) return;
  const Eigen::MatrixXd asked =
      work_.scale.asDiagonal() * (work_.constraint_slopes.transpose() * columns.moves - columns.multipliers);
  columns.multipliers = work_.scale.asDiagonal() * work_.schur.solve(asked);
  columns.moves.noalias() -= work_.responses * columns.multipliers;
}

void Bordered::multiply(const Columns& columns, Columns& product) {
  product.moves.resizeLike(columns.moves);
  system_.multiply(*at_, columns.moves, work_, product.moves, team_);
  product.moves.noalias() += slopes_ * columns.multipliers;
  product.multipliers.noalias() = slopes_.transpose() * columns.moves;
}

linear::Remainder Bordered::solve(const Columns& right, double accuracy, int rounds, Columns& found) {
  constexpr linear::Remainder failed{1, 1};
  const Index size = static_cast<Index>(slopes_.rows()), count = static_cast<Index>(slopes_.cols());
  if (count > 0 && work_.schur.rank() < count) return failed;
  found = right;
  precondition(found);
  if (!found.moves.allFinite() || !found.multipliers.allFinite()) return failed;
  // moves and multipliers in one norm: that of the moves, and of those that would cost the multipliers' energy
  const double squares = found.moves.squaredNorm();
  const double energy = std::abs(found.moves.cwiseProduct(right.moves - slopes_ * found.multipliers).sum());
  const double stiffness = squares > 0 && energy > 0 ? energy / squares : 1;
  Eigen::VectorXd weights(count);
  for (Index i = 0; i < count; ++i) weights[i] = 1 / (work_.scale[i] * std::sqrt(stiffness));
  const auto split = [&](const Eigen::MatrixXd& joined) {
    return Columns{joined.topRows(size), weights.cwiseInverse().asDiagonal() * joined.bottomRows(count)};
  };
  const auto join = [&](const Columns& columns, Eigen::MatrixXd& joined) {
    joined.topRows(size) = columns.moves;
    joined.bottomRows(count) = weights.asDiagonal() * columns.multipliers;
  };
  const auto product = [&](const Eigen::MatrixXd& in, Eigen::MatrixXd& out) {
    Columns answer;
    multiply(split(in), answer);
    precondition(answer);
    join(answer, out);
  };
  Eigen::MatrixXd left(size + count, found.moves.cols()), x;
  join(found, left);
  const linear::Remainder remainder = linear::conjugate_residuals(product, accuracy, rounds, left, x);
  if (!x.allFinite()) return failed;
  found = split(x);
  return remainder;
}

}  // namespace softkin::physical
