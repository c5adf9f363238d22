#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/derivative.hpp>
#include <softkin/statics/physical/lease.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// Rounds with a factor from nearby that cost about as much as a new factor, and with that.
constexpr int inexact_rounds = 8, exact_rounds = 3;
/// With friction, of which no factor holds all.
constexpr int friction_rounds = 40;
/// Of the accuracy, in what the factor makes of what is left: it may make a third too little of it.
constexpr double asked = 0.3;
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
    if (!system_.measures().constrains(a)) continue;
    active_[a] =
        !system_.measures().only_pulls(a) || at.multipliers[a] > 0 ||
        system_.measures().value(a, at.positions) >= (1 - verge) * system_.measures().target(a, demand.actuation);
    if (active_[a]) held_.push_back(a);
  }
  hold_friction(system_, at, work_, team_);
  system_.evaluate(at, demand, active_, work_, balance_, team_);
}

/// The right-hand sides.
void Derivative::ask(const Iterate& at, const Demand& demand) {
  right_.moves.setZero(system_.freedoms().size(), system_.actuators());
  right_.multipliers.setZero(static_cast<Index>(held_.size()), system_.actuators());
  for (Index i = 0; i < static_cast<Index>(held_.size()); ++i)
    right_.multipliers(i, held_[i]) = system_.measures().sign(held_[i]) * system_.measures().rest(held_[i]);
  Points force;
  moves_.resize(static_cast<std::size_t>(system_.actuators()));
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (system_.measures().constrains(a)) continue;
    Points& moves = moves_[static_cast<std::size_t>(a)];
    system_.command_force(at, demand, balance_, a, work_, force, moves, team_);
    if (moves.isZero(0)) moves.resize(0, 3);
    system_.freedoms().reduce(-force, at.positions, right_.moves.col(a));
    if (moves.rows() == 0) continue;
    for (Index i = 0; i < static_cast<Index>(held_.size()); ++i)  // what is held and moves takes measures along
      right_.multipliers(i, a) = -system_.measures().sign(held_[i]) * work_.slopes[held_[i]].cwiseProduct(moves).sum();
  }
}

/// False where the factor is too far off, or its stiffness singular.
bool Derivative::solve(const Iterate& at, bool exact_factor) {
  Bordered equations(system_, work_, team_);
  equations.set(at, balance_);
  const bool symmetric = system_.symmetric();
  const int rounds = !symmetric ? friction_rounds : exact_factor ? exact_rounds : inexact_rounds;
  // those of the last derivative, of a shape nearby; what they leave would not tell of the factor's own rounding
  const System::Slopes& last = work_.tangents;
  const bool like_last = !exact_factor && last.at.rows() == at.positions.rows() && last.held == held_;
  const Columns guess = like_last ? Columns{last.moves, last.multipliers} : Columns{};
  const linear::Remainder remainder =
      equations.solve(right_, asked * accuracy_, rounds, found_, like_last ? &guess : nullptr);
  const bool rounded = exact_factor && symmetric && !(remainder.apart <= singular);
  return remainder.left <= asked * accuracy_ && !rounded;
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
    for (Index i = 0; i < static_cast<Index>(held_.size()); ++i)
      result.multipliers(held_[i], a) = found_.multipliers(i, a) / system_.measures().unit(held_[i]);
    if (system_.measures().given_load(a)) result.multipliers(a, a) = 1;
  }
  return result;
}

Sensitivity Derivative::of(const Iterate& at, const Demand& demand) {
  hold(at, demand);
  ask(at, demand);
  using Precision = linear::MixedLdlt::Precision;
  bool solved = false;
  if (work_.home.rows() > 0) {
    if (work_.active != held_) system_.couple(at, active_, balance_, work_, team_);
    system_.assemble(at, demand, balance_, System::Stiffness::exact, work_, team_);
    system_.gather(at, balance_, work_, team_);
    solved = solve(at, false);
  }
  const auto solve_anew = [&](Precision precision) {
    work_.home.resize(0, 3);
    const InPrecision scope(work_, precision);
    (void)system_.factorise(at, demand, active_, balance_, {}, work_, team_);
    if (system_.contact())
      system_.gather(at, balance_, work_, team_);  // else what was factorised is what is multiplied with
    return solve(at, work_.factor.in_double());
  };
  solved = solved || solve_anew(work_.precision) || (!work_.factor.in_double() && solve_anew(Precision::twice));
  if (!solved) return no_sensitivity(static_cast<Index>(at.positions.rows()), system_.actuators());
  if (work_.home.rows() == 0) work_.home = at.positions;
  const Sensitivity sensitivity = result(at);
  const bool moves = std::any_of(moves_.begin(), moves_.end(), [](const Points& move) { return move.rows() > 0; });
  if (!system_.contact() && !moves)
    work_.tangents = {at.positions, held_, std::move(found_.moves), std::move(found_.multipliers)};
  return sensitivity;
}

Sensitivity Equilibria::sensitivity(const State& at, bool reuse_factor, double accuracy, Team& team) const {
  Lease lease(*this, at.positions, reuse_factor);
  system_.set_time(at.history, at.elapsed_s, lease.work(), team);
  return Derivative(system_, lease.work(), accuracy, team).of(system_.iterate(at), {at.actuation, at.share});
}

}  // namespace softkin::physical
