#include <cmath>
#include <softkin/linear/krylov.hpp>
#include <softkin/statics/physical/derivative.hpp>
#include <softkin/statics/physical/lease.hpp>

namespace softkin::physical {

namespace {

/// Rounds with a factor from nearby that cost about as much as a new factor, and with that.
constexpr int most_rounds = 8, exact_rounds = 3;
/// With friction, of which no factor holds all.
constexpr int friction_rounds = 40;
/// What rounding may add to a solution with the factor of the stiffness itself: more, and that is singular.
constexpr double singular = 1e-6;
/// A cable without tension that is as long as it may be but for this share is held.
constexpr double verge = 1e-9;

}  // namespace

Derivative::Derivative(const System& system, System::Workspace& work, double accuracy, Team& team)
    : system_(system),
      work_(work),
      accuracy_(accuracy),
      team_(team),
      active_(static_cast<std::size_t>(system.actuators())) {}

/// Measures that are held: of chambers, and of cables that pull or are as long as they may be.
void Derivative::hold(const Iterate& at, const Demand& demand) {
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!system_.constrains(a)) continue;
    active_[a] = !system_.only_pulls(a) || at.multipliers[a] > 0 ||
                 system_.measures().value(a, at.positions) >= (1 - verge) * system_.target(a, demand);
    if (active_[a]) held_.push_back(a);
  }
  System::Balance balance;
  system_.hold_friction(at, work_, team_);
  system_.evaluate(at, demand, active_, work_, balance, team_);
  slopes_.resize(system_.freedoms().size(), static_cast<Index>(held_.size()));
  for (Index i = 0; i < slopes_.cols(); ++i) {
    system_.freedoms().reduce(work_.slopes[held_[i]], at.positions, slopes_.col(i));
    slopes_.col(i) *= system_.sign(held_[i]);
  }
}

/// The right-hand sides.
void Derivative::ask(const Iterate& at, const Demand& demand) {
  right_.moves.setZero(system_.freedoms().size(), system_.actuators());
  right_.multipliers.setZero(slopes_.cols(), system_.actuators());
  for (Index i = 0; i < slopes_.cols(); ++i)
    right_.multipliers(i, held_[i]) = system_.sign(held_[i]) * system_.measures().rest(held_[i]);
  Points force;
  moves_.resize(static_cast<std::size_t>(system_.actuators()));
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (system_.constrains(a)) continue;
    system_.command_force(at, demand, a, work_, force, moves_[static_cast<std::size_t>(a)], team_);
    system_.freedoms().reduce(-force, at.positions, right_.moves.col(a));
  }
}

/// Solves with the factor, in place.
void Derivative::precondition(Columns& columns) {
  if (!columns.moves.isZero(0)) work_.solve(columns.moves, team_);
  if (held_.empty()) return;
  const Eigen::MatrixXd asked =
      work_.scale.asDiagonal() * (work_.constraint_slopes.transpose() * columns.moves - columns.multipliers);
  columns.multipliers = work_.scale.asDiagonal() * work_.schur.solve(asked);
  columns.moves.noalias() -= work_.responses * columns.multipliers;
}

void Derivative::multiply(const Iterate& at, const Columns& columns, Columns& product) {
  product.moves.resizeLike(columns.moves);
  system_.multiply(at, columns.moves, work_, product.moves, team_);
  product.moves.noalias() += slopes_ * columns.multipliers;
  product.multipliers.noalias() = slopes_.transpose() * columns.moves;
}

/// False where the factor is too far off, or its stiffness singular.
bool Derivative::solve(const Iterate& at, bool exact_factor) {
  const Index size = static_cast<Index>(slopes_.rows()), count = static_cast<Index>(slopes_.cols());
  if (count > 0 && work_.schur.rank() < count) return false;
  found_ = right_;
  precondition(found_);
  if (!found_.moves.allFinite() || !found_.multipliers.allFinite()) return false;
  // moves and multipliers in one norm: that of the moves, and of those that would cost the multipliers' energy
  const double squares = found_.moves.squaredNorm();
  const double energy = std::abs(found_.moves.cwiseProduct(right_.moves - slopes_ * found_.multipliers).sum());
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
    multiply(at, split(in), answer);
    precondition(answer);
    join(answer, out);
  };
  Eigen::MatrixXd left(size + count, found_.moves.cols()), x;
  join(found_, left);
  const bool symmetric = !system_.friction();
  const int rounds = !symmetric ? friction_rounds : exact_factor ? exact_rounds : most_rounds;
  const linear::Remainder remainder = linear::conjugate_residuals(product, accuracy_, rounds, left, x);
  const bool rounded = exact_factor && symmetric && !(remainder.apart <= singular);
  if (!(remainder.left <= accuracy_) || rounded || !x.allFinite()) return false;
  found_ = split(x);
  return true;
}

Sensitivity Derivative::result(const Iterate& at) const {
  const Index actuators = system_.actuators();
  Sensitivity result;
  result.regular = true;
  result.positions.resize(static_cast<std::size_t>(actuators));
  result.multipliers.setZero(actuators, actuators);
  for (Index a = 0; a < actuators; ++a) {
    system_.freedoms().expand(found_.moves.col(a), at.positions, result.positions[a]);
    if (const Points& moves = moves_[static_cast<std::size_t>(a)]; moves.rows() > 0) result.positions[a] += moves;
    for (Index i = 0; i < slopes_.cols(); ++i)
      result.multipliers(held_[i], a) = found_.multipliers(i, a) / system_.unit(held_[i]);
    if (!system_.constrains(a) && system_.measures().measures(a)) result.multipliers(a, a) = 1;
  }
  return result;
}

Sensitivity Derivative::of(const Iterate& at, const Demand& demand) {
  hold(at, demand);
  ask(at, demand);
  bool solved = false;
  if (work_.home.rows() > 0) {
    if (work_.active != held_) system_.couple(at, active_, work_, team_);
    system_.assemble(at, demand, System::Stiffness::exact, work_, team_);
    system_.gather(work_, team_);
    solved = solve(at, false);
  }
  if (!solved) {
    work_.home.resize(0, 3);
    (void)system_.factorise(at, demand, active_, System::Stiffness::exact, 0, work_, team_);
    system_.gather(work_, team_);
    solved = solve(at, true);
  }
  if (!solved) return no_sensitivity(static_cast<Index>(at.positions.rows()), system_.actuators());
  if (work_.home.rows() == 0) work_.home = at.positions;
  return result(at);
}

Sensitivity Equilibria::sensitivity(const State& at, bool reuse_factor, double accuracy, Team& team) const {
  Lease lease(*this, at.positions, reuse_factor);
  return Derivative(system_, lease.work(), accuracy, team).of(system_.iterate(at), {at.actuation, at.share});
}

}  // namespace softkin::physical
