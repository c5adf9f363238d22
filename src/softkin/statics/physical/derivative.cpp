#include <algorithm>
#include <cmath>
#include <softkin/statics/chamber_caps.hpp>
#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/derivative.hpp>
#include <softkin/statics/physical/workspace_handle.hpp>
#include <utility>

namespace softkin::physical {

Derivative::Derivative(const System& system, Workspace& work, double accuracy, Team& team)
    : system_(system),
      work_(work),
      accuracy_(accuracy),
      tuning_(work.options.newton.derivative),
      team_(team),
      active_(system.actuators()) {}

/// Collects the constrained measures: of chambers, and of cables that are in tension or at their largest length.
void Derivative::hold(const Iterate& at, const LoadState& load_state) {
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!system_.measures().constrains(a)) continue;
    active_[a] = !system_.measures().only_pulls(a) || at.multipliers[a] > 0 ||
                 system_.measures().value(a, at.positions) >=
                     (1 - tuning_.slack_margin) * system_.measures().target(a, load_state.actuation, at.multipliers[a]);
    if (active_[a]) held_.push_back(a);
  }
  hold_friction(system_, at, work_, team_);
  system_.evaluate(at, load_state, active_, work_, balance_, team_);
}

void Derivative::make_room(Index columns) {
  right_.moves.setZero(system_.freedoms().size(), columns);
  right_.multipliers.setZero(held_.size(), columns);
  moves_.resize(columns);
}

/// Sets a right-hand side from the change of the forces and the moves of vertices that are no unknowns, which change
/// measures, too.
void Derivative::ask(const Iterate& at, Index column, const Points& force, Points moves) {
  system_.freedoms().reduce(-force, at.positions, right_.moves.col(column));
  if (moves.isZero(0)) return;
  for (Index i = 0; i < std::ssize(held_); ++i)
    right_.multipliers(i, column) -=
        system_.measures().sign(held_[i]) * work_.slopes[held_[i]].cwiseProduct(moves).sum();
  moves_[column] = std::move(moves);
}

/// Computes the derivative of the forces by a command that sets no measure, and that of the vertices that it moves
/// itself.
void Derivative::by_command(const Iterate& at, const LoadState& load_state, Index actuator, Points& force,
                            Points& moves) {
  system_.placement().velocity(actuator, load_state, moves);
  system_.command_force(at, load_state, actuator, work_, force, team_);
  if (!moves.isZero(0)) system_.add_pull(at, load_state, balance_, moves, work_, force, team_);
}

/// Sets the right-hand sides of the commands.
void Derivative::ask(const Iterate& at, const LoadState& load_state) {
  by_commands_ = true;
  make_room(system_.actuators());
  for (Index i = 0; i < std::ssize(held_); ++i)
    right_.multipliers(i, held_[i]) =
        system_.measures().sign(held_[i]) * system_.measures().target_by_command(held_[i], at.multipliers[held_[i]]);
  Points force, moves;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (system_.measures().constrains(a)) continue;
    by_command(at, load_state, a, force, moves);
    ask(at, a, force, moves);
  }
}

/// Solves for all right-hand sides. False where the factor is too far off, or its stiffness singular.
bool Derivative::solve(const Iterate& at, bool exact_factor) {
  Bordered equations(system_, work_, team_);
  equations.set(at, balance_);
  const bool symmetric = system_.symmetric();
  const int rounds = !symmetric ? tuning_.friction_rounds : exact_factor ? tuning_.exact_rounds : tuning_.nearby_rounds;
  // the guess is the last derivative, of a shape nearby; with an exact factor it would hide the rounding of that
  const Slopes& last = work_.tangents;
  const bool like_last = by_commands_ && !exact_factor && last.at.rows() == at.positions.rows() && last.held == held_;
  const Columns guess = like_last ? Columns{last.moves, last.multipliers} : Columns{};
  const linear::Remainder remainder =
      equations.solve(right_, tuning_.accuracy_fraction * accuracy_, rounds, found_, like_last ? &guess : nullptr);
  const bool rounded = exact_factor && symmetric && !(remainder.apart <= tuning_.max_rounding);
  return remainder.left <= tuning_.accuracy_fraction * accuracy_ && !rounded;
}

Points Derivative::positions(const Iterate& at, Index column) const {
  Points positions;
  system_.freedoms().expand(found_.moves.col(column), at.positions, positions);
  if (const Points& moves = moves_[column]; moves.rows() > 0) positions += moves;
  return positions;
}

/// Returns the multipliers of the constrained measures, in users' units.
Eigen::VectorXd Derivative::multipliers(Index column) const {
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(system_.actuators());
  for (Index i = 0; i < std::ssize(held_); ++i)
    multipliers[held_[i]] = found_.multipliers(i, column) / system_.measures().unit(held_[i]);
  return multipliers;
}

/// Returns the derivative of the supports' forces, which is that of the gradient at their vertices: by the number
/// itself, by the moves, and by the multipliers of the constrained measures; without the pressures on supports that
/// close chambers.
///
/// force  the derivative by the number itself
/// loads  derivatives of all tensions and pressures, in users' units
Points Derivative::reactions(const Iterate& at, const LoadState& load_state, Index column, Points force,
                             const Eigen::VectorXd& loads) {
  const Points moves = positions(at, column);
  system_.add_pull(at, load_state, balance_, moves, work_, force, team_);
  for (Index i = 0; i < std::ssize(held_); ++i)
    force += system_.measures().sign(held_[i]) * found_.multipliers(i, column) * system_.pull(held_[i], at);
  for (Index a = 0; a < system_.actuators(); ++a) {
    const Actuator& actuator = system_.model().actuators[a];
    add_cap_force(system_.model(), actuator, at.positions, system_.measures().unit(a) * loads[a], force);
    add_cap_force_change(system_.model(), actuator, at.positions, moves, at.multipliers[a], force);
  }
  for (Index v = 0; v < force.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (system_.model().held.support_of[v][axis] < 0) force(v, axis) = 0;
  return force;
}

/// Solves for all right-hand sides, with the factor at hand or a new one.
bool Derivative::find(const Iterate& at, const LoadState& load_state) {
  using Precision = linear::MixedLdlt::Precision;
  bool solved = false;
  if (work_.solved_shape.rows() > 0) {
    if (work_.saddle.active() != held_) system_.couple(at, active_, balance_, work_, team_);
    system_.assemble(at, load_state, balance_, System::Stiffness::exact, work_, team_);
    system_.gather(at, balance_, work_, team_);
    solved = solve(at, false);
  }
  const auto solve_anew = [&](Precision precision) {
    work_.solved_shape.resize(0, 3);
    const Temporarily scope(work_.saddle.precision(), precision);
    (void)system_.factorise(at, load_state, active_, balance_, {}, work_, team_);
    if (system_.contact()) system_.gather(at, balance_, work_, team_);  // else multiply() uses the factorised matrix
    return solve(at, work_.saddle.factor().in_double());
  };
  solved = solved || solve_anew(work_.saddle.precision()) ||
           (!work_.saddle.factor().in_double() && solve_anew(Precision::twice));
  if (solved && work_.solved_shape.rows() == 0) work_.solved_shape = at.positions;
  return solved;
}

Sensitivity Derivative::of(const Iterate& at, const LoadState& load_state) {
  hold(at, load_state);
  ask(at, load_state);
  const Index actuators = system_.actuators();
  if (!find(at, load_state)) return no_sensitivity(at.positions.rows(), actuators);
  Sensitivity result{{}, Eigen::MatrixXd(actuators, actuators), true};
  for (Index a = 0; a < actuators; ++a) {
    result.positions.push_back(positions(at, a));
    result.multipliers.col(a) = multipliers(a);
    if (system_.measures().given_load(a))
      result.multipliers(a, a) = system_.measures().rate(a, load_state.actuation[a]) / system_.measures().unit(a);
  }
  const bool moves = std::any_of(moves_.begin(), moves_.end(), [](const Points& move) { return move.rows() > 0; });
  if (!system_.contact() && !moves)
    work_.tangents = {at.positions, held_, std::move(found_.moves), std::move(found_.multipliers)};
  return result;
}

/// Sets the right-hand side of a change of the commands. Returns the change of the forces at fixed positions.
Points Derivative::ask_along(const Iterate& at, const LoadState& load_state, Index column, const Actuation& change) {
  for (Index i = 0; i < std::ssize(held_); ++i)
    right_.multipliers(i, column) = system_.measures().sign(held_[i]) * change[held_[i]] *
                                    system_.measures().target_by_command(held_[i], at.multipliers[held_[i]]);
  Points force, moves, pulled = Points::Zero(at.positions.rows(), 3);
  Points sum = pulled, motion = pulled;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (change[a] == 0 || system_.measures().constrains(a)) continue;
    if (system_.model().actuators[a].is<ForceCommand>()) {
      system_.surroundings().add_force(a, change[a], sum);  // there may be hundreds of these
      continue;
    }
    by_command(at, load_state, a, force, moves);
    sum += change[a] * force;
    if (!moves.isZero(0)) motion += change[a] * moves;
  }
  if (!motion.isZero(0)) system_.add_pull(at, load_state, balance_, motion, work_, pulled, team_);
  ask(at, column, sum, motion);
  return sum - pulled;
}

ParameterSensitivity Derivative::of(const Iterate& at, const LoadState& load_state,
                                    const std::vector<Actuation>& changes, bool reactions) {
  const Index count = changes.size();
  const Points nothing = Points::Zero(at.positions.rows(), 3);
  hold(at, load_state);
  make_room(count);
  std::vector<Points> forces;
  for (Index p = 0; p < count; ++p) {
    Points force = ask_along(at, load_state, p, changes[p]);
    if (reactions) forces.push_back(std::move(force));
  }
  ParameterSensitivity result{{}, Eigen::MatrixXd::Zero(system_.actuators(), count), false};
  result.regular = count == 0 || find(at, load_state);
  for (Index p = 0; p < count; ++p) {
    result.positions.push_back(result.regular ? positions(at, p) : nothing);
    if (!result.regular) {
      if (reactions) result.reactions.push_back(nothing);
      continue;
    }
    result.multipliers.col(p) = multipliers(p);
    for (Index a = 0; a < system_.actuators(); ++a)
      if (system_.measures().given_load(a))
        result.multipliers(a, p) +=
            changes[p][a] * system_.measures().rate(a, load_state.actuation[a]) / system_.measures().unit(a);
    if (reactions)
      result.reactions.push_back(this->reactions(at, load_state, p, std::move(forces[p]), result.multipliers.col(p)));
  }
  return result;
}

std::vector<Points> Derivative::under(const Iterate& at, const LoadState& load_state,
                                      const std::vector<Points>& forces) {
  hold(at, load_state);
  make_room(forces.size());
  for (std::size_t p = 0; p < forces.size(); ++p) ask(at, p, -forces[p], Points::Zero(at.positions.rows(), 3));
  std::vector<Points> found;
  if (forces.empty() || !find(at, load_state)) return found;
  for (std::size_t p = 0; p < forces.size(); ++p) found.push_back(positions(at, p));
  return found;
}

Perturbation::Perturbation(const Perturbed& perturbed, const System& like)
    : more(std::make_unique<const System>(perturbed.more, like)),
      less(std::make_unique<const System>(perturbed.less, like)),
      difference(perturbed.difference) {}

/// system: of the robot with a perturbed number
Derivative::Found Derivative::found_by(const System& system, const Iterate& at, const LoadState& load_state,
                                       const std::shared_ptr<const ViscousHistory>& history, double elapsed_s) const {
  Workspace work(system);
  Iterate own = at;  // factors and offsets of commands may be among the numbers
  for (Index a = 0; a < system.actuators(); ++a)
    if (system.measures().measures(a) && system.measures().given_load(a))
      own.multipliers[a] = system.measures().given(a, load_state.actuation[a]);
  system.set_time(history, elapsed_s, work, team_);
  own.eyelets = system.tendons().lengths(own.positions, balance_.slips);  // slipping tendons continue to slip
  hold_friction(system, own, work, team_);
  Balance balance;
  system.evaluate(own, load_state, active_, work, balance, team_);
  Found found{std::move(work.gradient), at.positions, std::move(balance.constraint), std::move(own.multipliers)};
  system.placement().hold(load_state, found.held);
  return found;
}

/// Sets the right-hand side of a perturbed number.
Derivative::Direct Derivative::ask_number(const Iterate& at, const LoadState& load_state, Index column,
                                          const Perturbation& number,
                                          const std::shared_ptr<const ViscousHistory>& history, double elapsed_s) {
  Found more = found_by(*number.more, at, load_state, history, elapsed_s);
  const Found less = found_by(*number.less, at, load_state, history, elapsed_s);
  const Direct direct{(more.gradient - less.gradient) / number.difference,
                      (more.multipliers - less.multipliers) / number.difference};
  Points moves = (more.held - less.held) / number.difference, force = direct.force;
  for (Index i = 0; i < std::ssize(held_); ++i)
    right_.multipliers(i, column) = -system_.measures().sign(held_[i]) *
                                    (more.constraint[held_[i]] - less.constraint[held_[i]]) / number.difference;
  if (!moves.isZero(0)) system_.add_pull(at, load_state, balance_, moves, work_, force, team_);
  ask(at, column, force, std::move(moves));
  return direct;
}

ParameterSensitivity Derivative::of(const Iterate& at, const LoadState& load_state,
                                    const std::vector<Perturbation>& perturbations,
                                    const std::shared_ptr<const ViscousHistory>& history, double elapsed_s,
                                    bool reactions) {
  const Index count = perturbations.size();
  hold(at, load_state);
  make_room(count);
  std::vector<Direct> direct;
  for (Index p = 0; p < count; ++p)
    direct.push_back(ask_number(at, load_state, p, perturbations[p], history, elapsed_s));
  ParameterSensitivity result{{}, Eigen::MatrixXd::Zero(system_.actuators(), count), false};
  result.regular = count == 0 || find(at, load_state);
  for (Index p = 0; p < count; ++p) {
    result.positions.push_back(result.regular ? positions(at, p) : Points(Points::Zero(at.positions.rows(), 3)));
    if (result.regular) result.multipliers.col(p) = multipliers(p);
    for (Index a = 0; result.regular && a < system_.actuators(); ++a)
      result.multipliers(a, p) += direct[p].loads[a] / system_.measures().unit(a);
  }
  for (Index p = 0; reactions && p < count; ++p)
    result.reactions.push_back(
        result.regular ? this->reactions(at, load_state, p, std::move(direct[p].force), result.multipliers.col(p))
                       : Points(Points::Zero(at.positions.rows(), 3)));
  return result;
}

/// The right-hand side of the adjoint: K Y + G M = by_places, G^T Y - C M = by_multipliers.
void Derivative::ask_adjoint(const Iterate& at, Index column, const ShapeGradient& reported) {
  if (reported.by_places.rows() > 0)
    system_.freedoms().reduce(reported.by_places, at.positions, right_.moves.col(column));
  if (reported.by_loads.size() == 0) return;
  for (Index i = 0; i < std::ssize(held_); ++i)
    right_.multipliers(i, column) = reported.by_loads[held_[i]] / system_.measures().unit(held_[i]);
}

/// With K X + G L = F and G^T X - C L = T of a number: by_places . X + by_multipliers . L = Y . F + M . T, plus the
/// direct change by the number.
Eigen::MatrixXd Derivative::of(const Iterate& at, const LoadState& load_state,
                               const std::vector<Perturbation>& perturbations,
                               const std::shared_ptr<const ViscousHistory>& history, double elapsed_s,
                               const std::vector<ShapeGradient>& reported) {
  const Index rows = reported.size(), count = perturbations.size();
  hold(at, load_state);
  make_room(rows);
  for (Index r = 0; r < rows; ++r) ask_adjoint(at, r, reported[r]);
  if (rows > 0 && !find(at, load_state)) return {};
  const Columns adjoint = std::move(found_);
  Eigen::MatrixXd result(rows, count);
  for (Index p = 0; p < count; ++p) {
    make_room(1);
    moves_[0].resize(0, 3);
    const Direct direct = ask_number(at, load_state, 0, perturbations[p], history, elapsed_s);
    for (Index r = 0; r < rows; ++r) {
      const ShapeGradient& each = reported[r];
      double sum =
          adjoint.moves.col(r).dot(right_.moves.col(0)) + adjoint.multipliers.col(r).dot(right_.multipliers.col(0));
      if (each.by_places.rows() > 0 && moves_[0].rows() > 0) sum += each.by_places.cwiseProduct(moves_[0]).sum();
      for (Index a = 0; a < std::ssize(each.by_loads); ++a)
        sum += each.by_loads[a] * direct.loads[a] / system_.measures().unit(a);
      result(r, p) = sum;
    }
  }
  return result;
}

Sensitivity Equilibria::sensitivity(const State& state, const Options& options, double accuracy, Team& team) const {
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, options.reuse_factor, options.tuning);
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  Sensitivity found =
      Derivative(system_, handle.work(), accuracy, team).of(system_.iterate(*at), {at->actuation, at->load_factor});
  for (Points& moves : found.positions) drop_vertices(moves);
  return found;
}

ParameterSensitivity Equilibria::sensitivity(const State& state, const std::vector<Actuation>& changes,
                                             const Options& options, double accuracy, bool reactions,
                                             Team& team) const {
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, options.reuse_factor, options.tuning);
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  ParameterSensitivity found = Derivative(system_, handle.work(), accuracy, team)
                                   .of(system_.iterate(*at), {at->actuation, at->load_factor}, changes, reactions);
  for (Points& moves : found.positions) drop_vertices(moves);
  for (Points& forces : found.reactions) drop_vertices(forces);
  return found;
}

std::vector<Points> Equilibria::moves_under(const State& state, const std::vector<Points>& forces,
                                            const Options& options, double accuracy, Team& team) const {
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, options.reuse_factor, options.tuning);
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  const Points none = Points::Zero(at->positions.rows() - state.positions.rows(), 3);  // of the pressures
  std::vector<Points> all;
  for (const Points& force : forces) (all.emplace_back(at->positions.rows(), 3)) << force, none;
  std::vector<Points> found = Derivative(system_, handle.work(), accuracy, team)
                                  .under(system_.iterate(*at), {at->actuation, at->load_factor}, all);
  for (Points& moves : found) drop_vertices(moves);
  return found;
}

ParameterSensitivity Equilibria::sensitivity(const State& state, const std::vector<Perturbation>& perturbations,
                                             const Options& options, double accuracy, bool reactions,
                                             Team& team) const {
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, options.reuse_factor, options.tuning);
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  ParameterSensitivity found = Derivative(system_, handle.work(), accuracy, team)
                                   .of(system_.iterate(*at), {at->actuation, at->load_factor}, perturbations,
                                       at->history, at->elapsed_s, reactions);
  for (Points& moves : found.positions) drop_vertices(moves);
  for (Points& forces : found.reactions) drop_vertices(forces);
  return found;
}

Eigen::MatrixXd Equilibria::gradients(const State& state, const std::vector<Perturbation>& perturbations,
                                      const std::vector<ShapeGradient>& reported, const Options& options,
                                      double accuracy, Team& team) const {
  const Inside at(*this, state, team);
  WorkspaceHandle handle(*this, at->positions, options.reuse_factor, options.tuning);
  system_.set_time(at->history, at->elapsed_s, handle.work(), team);
  const Points none = Points::Zero(at->positions.rows() - state.positions.rows(), 3);  // of the pressures
  std::vector<ShapeGradient> all = reported;
  for (ShapeGradient& each : all) {
    if (each.by_places.rows() == 0) continue;
    Points places(at->positions.rows(), 3);
    places << each.by_places, none;
    each.by_places = std::move(places);
  }
  return Derivative(system_, handle.work(), accuracy, team)
      .of(system_.iterate(*at), {at->actuation, at->load_factor}, perturbations, at->history, at->elapsed_s, all);
}

}  // namespace softkin::physical
