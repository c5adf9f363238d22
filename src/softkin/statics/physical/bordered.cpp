#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/statics/physical/bordered.hpp>

namespace softkin::physical {

void Bordered::set(const Iterate& at, const Balance& balance) {
  at_ = &at;
  system_.reduce_slopes(at, balance, work_, slopes_, pulls_);
  compliance_ = system_.compliance(balance, work_);
}

void Bordered::set_factorised(const Iterate& at) {
  at_ = &at;
  slopes_ = saddle_.slopes();
  pulls_ = saddle_.pulls();
  compliance_ = saddle_.compliance();
}

/// Solves with the factor, in place.
void Bordered::precondition(Columns& columns) {
  if (!columns.moves.isZero(0)) saddle_.solve(columns.moves, team_);
  if (saddle_.active().empty()) return;
  const Eigen::MatrixXd requested =
      saddle_.scale().asDiagonal() * (saddle_.slopes().transpose() * columns.moves - columns.multipliers);
  columns.multipliers = saddle_.scale().asDiagonal() * saddle_.schur().solve(requested);
  columns.moves.noalias() -= saddle_.responses() * columns.multipliers;
}

void Bordered::multiply(const Columns& columns, Columns& product) {
  product.moves.resizeLike(columns.moves);
  system_.multiply(*at_, columns.moves, work_, product.moves, team_);
  product.moves.noalias() += pulls() * columns.multipliers;
  product.multipliers.noalias() = slopes_.transpose() * columns.moves;
  if (compliance_.size() > 0) product.multipliers -= compliance_.asDiagonal() * columns.multipliers;
}

/// Solves many columns in blocks: columns profit from each other's directions, but each is made orthogonal to all.
linear::Remainder Bordered::solve(const Columns& right, double accuracy, int rounds, Columns& found,
                                  const Columns* guess) {
  constexpr Index most = 16;
  const Index all = right.moves.cols();
  if (all <= most) return solve_block(right, accuracy, rounds, found, guess);
  const auto block = [](const Columns& of, Index first, Index count) {
    return Columns{of.moves.middleCols(first, count), of.multipliers.middleCols(first, count)};
  };
  found = {Eigen::MatrixXd(right.moves.rows(), all), Eigen::MatrixXd(right.multipliers.rows(), all)};
  linear::Remainder worst;
  for (Index first = 0; first < all; first += most) {
    const Index count = std::min(most, all - first);
    Columns part;
    const Columns begun = guess != nullptr ? block(*guess, first, count) : Columns{};
    const linear::Remainder remainder =
        solve_block(block(right, first, count), accuracy, rounds, part, guess != nullptr ? &begun : nullptr);
    if (part.moves.cols() != count) return remainder;
    found.moves.middleCols(first, count) = part.moves;
    found.multipliers.middleCols(first, count) = part.multipliers;
    linear::Remainder::raise(worst.left, remainder.left);
    linear::Remainder::raise(worst.apart, remainder.apart);
  }
  return worst;
}

/// Returns the weights of multipliers in a common norm with moves: a multiplier counts as moves of the same energy.
Eigen::VectorXd Bordered::weights_of(const Columns& about, const Columns& right) const {
  const double squares = about.moves.squaredNorm();
  const double energy = std::abs(about.moves.cwiseProduct(right.moves - pulls() * about.multipliers).sum());
  const double stiffness = squares > 0 && energy > 0 ? energy / squares : 1;
  Eigen::VectorXd weights(slopes_.cols());
  for (Index i = 0; i < std::ssize(weights); ++i) weights[i] = 1 / (saddle_.scale()[i] * std::sqrt(stiffness));
  return weights;
}

linear::Remainder Bordered::solve_block(const Columns& right, double accuracy, int rounds, Columns& found,
                                        const Columns* guess) {
  constexpr linear::Remainder failed{1, 1};
  const Index size = slopes_.rows(), count = slopes_.cols();
  if (count > 0 && saddle_.schur().rank() < count) return failed;
  Columns begin = right;
  if (guess != nullptr) {
    multiply(*guess, begin);
    begin.moves = right.moves - begin.moves;
    begin.multipliers = right.multipliers - begin.multipliers;
  }
  precondition(begin);
  if (!begin.moves.allFinite() || !begin.multipliers.allFinite()) return failed;
  const Eigen::VectorXd weights = weights_of(guess != nullptr ? *guess : begin, right);
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
  Eigen::MatrixXd left(size + count, begin.moves.cols()), x;
  join(begin, left);
  double known = 1;  // the least ratio of a column to what the guess leaves of it
  if (guess != nullptr) {
    Eigen::MatrixXd all(left.rows(), left.cols());
    join(*guess, all);
    known = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < left.cols(); ++i)
      if (!left.col(i).isZero(0)) known = std::min(known, all.col(i).norm() / left.col(i).norm());
    if (!(known > 1)) return solve_block(right, accuracy, rounds, found, nullptr);
  }
  linear::Remainder remainder = linear::conjugate_residuals(product, accuracy * known, rounds, left, x);
  remainder.left /= known;
  if (!x.allFinite()) return failed;
  found = split(x);
  if (guess != nullptr) {
    found.moves += guess->moves;
    found.multipliers += guess->multipliers;
  }
  return remainder;
}

linear::Remainder Bordered::step(const Balance& balance, double accuracy, int rounds, Eigen::VectorXd& step,
                                 Eigen::VectorXd& change) {
  const Index count = saddle_.active().size();
  Columns right{-balance.force, Eigen::MatrixXd(count, 1)}, found;
  for (Index i = 0; i < count; ++i)
    right.multipliers(i, 0) = -system_.measures().sign(saddle_.active()[i]) * balance.constraint[saddle_.active()[i]];
  const linear::Remainder remainder = solve(right, accuracy, rounds, found);
  if (!(remainder.left < 1)) return remainder;
  step = found.moves.col(0);
  change.setZero(system_.actuators());
  for (Index i = 0; i < count; ++i) change[saddle_.active()[i]] = found.multipliers(i, 0);
  return remainder;
}

}  // namespace softkin::physical
