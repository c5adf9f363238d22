#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/contact_at_rest.hpp>
#include <softkin/statics/physical/contact_measure.hpp>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

namespace {

/// Share of a constraint's own compliance below which what it adds to others is rounding [-].
constexpr double dependent = 1e-9;

/// What is gone of a share that is safe: a shorter way is not quite the same.
constexpr double within = 0.95;

/// Moves shorter than this share of the robot's diagonal turn nothing that matters.
constexpr double least_turning = 1e-4;
/// What turns add to moves grows with their square; where something touches, no more than so many times that over the
/// diagonal is believed.
constexpr double most_turning = 30;

}  // namespace

Demand between(const Demand& from, const Demand& to, double share) {
  if (share == 1) return to;
  return {from.actuation + share * (to.actuation - from.actuation), from.share + share * (to.share - from.share),
          from.fading + share * (to.fading - from.fading)};
}

System::System(const Model& model)
    : model_(model),
      elastic_(model),
      measures_(model),
      surroundings_(model),
      supports_turn_(model),
      any_dead_load_(model.dead_load.rows() > 0 && !model.dead_load.isZero(0)) {
  elastic_.add_cliques(cliques_);
  measures_.add_cliques(cliques_);
  surroundings_.add_cliques(cliques_);
  if (model.magnetism) magnets_ = std::make_unique<const Magnets>(model, elastic_.element_slots());
  linear::BlockPattern pattern(static_cast<Index>(model.rest.rows()), cliques_);
  freedoms_ = std::make_unique<supports::Freedoms>(model, pattern);
  supports::ReducedMatrix reduced(*freedoms_, pattern);
  auto symbolic = std::make_shared<const linear::FrontTree>(linear::make_front_tree(reduced.columns()));
  linear::require_memory(*symbolic, sizeof(float));  // before what takes long
  layout_ = std::make_shared<const Layout>(Layout{
      std::move(pattern), std::move(reduced), std::move(symbolic), cliques_.slots.back(), {}, cliques_.slots.back()});
  check_contact_at_rest(model);
  if (model.contact.any())
    contacts_ = std::make_unique<Contacts>(model);
  else
    cliques_ = {};
  turning_ = std::make_unique<supports::GlobalStep>(model, elastic_.laplacian(), freedoms_->vertex_order());
}

System::Workspace::Workspace(const System& system)
    : elastic(system.elastic_.make_scratch()),
      contacts(system.contacts_ ? system.contacts_->make_scratch() : nullptr),
      layout(system.layout_),
      factorised_layout(layout),
      slots(9 * static_cast<std::size_t>(layout->slots)),
      slopes(system.model_.actuators.size()),
      factor(layout->symbolic),
      precision(contacts ? linear::MixedLdlt::Precision::good : linear::MixedLdlt::Precision::enough) {}

void System::Workspace::solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team) {
  const supports::ReducedMatrix& reduced = factorised_layout->reduced;
  if (reduced.in_order()) return factor.solve(right_sides, team);
  reduced.to_columns(right_sides, in_columns);
  factor.solve(in_columns, team);
  reduced.to_unknowns(in_columns, right_sides);
}

bool System::constrains(Index actuator) const {
  const Actuator& a = model_.actuators[actuator];
  return a.kind != ActuatorKind::dea && drives(a) && a.control == Control::ratio;
}

void System::evaluate(const Iterate& at, const Demand& demand, const std::vector<bool>& active, Workspace& work,
                      Balance& balance, Team& team) const {
  const Body::Result elastic = elastic_.force(demand, at.positions, work.elastic, work.gradient, team);
  balance.energy = elastic.energy;
  balance.inverted = elastic.inverted;
  balance.forbidden = elastic.forbidden;
  if (any_dead_load_) {
    balance.energy -= demand.share * model_.dead_load.cwiseProduct(at.positions - model_.rest).sum();
    work.gradient -= demand.share * model_.dead_load;
  }
  if (demand.fading != 0) {
    balance.energy -= demand.fading * work.unbalanced.cwiseProduct(at.positions - model_.rest).sum();
    work.gradient -= demand.fading * work.unbalanced;
  }
  balance.energy += surroundings_.add_gradient(demand.actuation, at.positions, work.gradient);
  if (magnets_) {
    const std::optional<double> magnetic = magnets_->add_gradient(demand, at.positions, work.gradient, team);
    balance.energy += magnetic.value_or(0);
    balance.forbidden = balance.forbidden || !magnetic;
    work.left_field = work.left_field || !magnetic;
  }
  if (contacts_ && !balance.forbidden) {
    contacts_->find(at.positions, *work.contacts, team);
    if (work.friction_follows) contacts_->friction().hold(work.contacts->terms, at.anchors, work.contacts->holds);
    balance.energy += contacts_->energy(at.positions, *work.contacts);
    balance.forbidden = !std::isfinite(balance.energy);
    if (!balance.forbidden) contacts_->add_gradient(at.positions, *work.contacts, work.gradient);
  }
  balance.constraint.setZero(actuators());
  balance.load_energy = 0;
  for (Index a = 0; a < actuators(); ++a) {
    if (!measures_.measures(a) || (!active[a] && at.multipliers[a] == 0)) continue;
    const double value = measures_.value(a, at.positions, &work.slopes[a]);
    if (active[a])
      balance.constraint[a] = value - target(a, demand);
    else
      balance.load_energy += sign(a) * at.multipliers[a] * value;
    work.gradient += sign(a) * at.multipliers[a] * work.slopes[a];
  }
  balance.force.resize(freedoms_->size());
  freedoms_->reduce(work.gradient, at.positions, balance.force);
}

void System::set_time(std::shared_ptr<const ViscousHistory> history, double elapsed_s, Workspace& work,
                      Team& team) const {
  if (!viscous()) return;
  if (history != work.elastic.history || elapsed_s != work.elastic.elapsed_s) work.tangents.at.resize(0, 3);
  elastic_.set_time(std::move(history), elapsed_s, work.elastic, team);
}

Demand System::unbalanced(const Iterate& at, const Demand& demand, Workspace& work, Team& team) const {
  Balance balance;
  hold_friction(at, work, team);
  evaluate(at, demand, std::vector<bool>(static_cast<std::size_t>(actuators()), false), work, balance, team);
  work.unbalanced = work.gradient;
  constexpr double balanced = 1e-6;  // of what elements pull with: Newton's method does not need a way for that
  const Imbalance left = imbalance(balance, work, team);
  return {demand.actuation, demand.share, left.residual > balanced * left.pull ? 1.0 : 0.0};
}

System::Imbalance System::imbalance(const Balance& balance, const Workspace& work, Team& team) const {
  constexpr double roundings = 16;  // of a vertex's elements
  return {freedoms_->largest(balance.force), elastic_.largest_pull(work.elastic, team),
          roundings * std::numeric_limits<double>::epsilon() * work.stiffest * model_.diagonal_mm};
}

/// The layout of the body with all that is near each other, where the one that there is does not hold what touches.
void System::hold_contacts(const Iterate& at, Workspace& work, Team& team) const {
  if (!contacts_ || Contacts::holds(work.layout->touching, *work.contacts)) return;
  contact::Candidates pairs;
  contacts_->find_pairs(at.positions, *work.contacts, team, pairs);
  linear::Cliques cliques = cliques_;
  contacts_->add_cliques(pairs, cliques);
  linear::BlockPattern pattern(static_cast<Index>(model_.rest.rows()), cliques);
  supports::ReducedMatrix reduced = supports::ReducedMatrix::wider(*freedoms_, pattern);
  auto symbolic = std::make_shared<const linear::FrontTree>(linear::make_front_tree(reduced.columns()));
  work.layout = std::make_shared<const Layout>(Layout{std::move(pattern), std::move(reduced), std::move(symbolic),
                                                      cliques.slots.back(), std::move(pairs), cliques_.slots.back()});
  work.slots.resize(9 * static_cast<std::size_t>(work.layout->slots));
}

void System::assemble(const Iterate& at, const Demand& demand, Stiffness kind, Workspace& work, Team& team) const {
  hold_contacts(at, work, team);
  elastic_.stiffness(demand, at.positions, kind == Stiffness::projected, work.elastic, work.slots, team);
  if (magnets_) magnets_->add_stiffness(demand, at.positions, kind == Stiffness::projected, work.slots, team);
  Eigen::VectorXd scale(actuators());
  for (Index a = 0; a < actuators(); ++a) scale[a] = sign(a) * at.multipliers[a];
  measures_.second_derivatives(at.positions, scale, work.slots, team);
  surroundings_.stiffness(demand.actuation, work.slots);
  if (contacts_)
    contacts_->stiffness(at.positions, kind == Stiffness::projected, *work.contacts, work.layout->touching,
                         work.slots.data() + 9 * work.layout->first_touching);
}

int System::factorise(const Iterate& at, const Demand& demand, const std::vector<bool>& active, Stiffness kind,
                      double shift, Workspace& work, Team& team, const Balance* balance) const {
  assemble(at, demand, kind, work, team);
  const Layout& layout = *work.layout;
  layout.reduced.reduce(layout.pattern, work.slots, work.gradient, at.positions, work.values, team);

  const linear::BlockColumns& columns = layout.reduced.columns();
  double trace = 0;
  work.stiffest = 0;
  const auto each_diagonal = [&](const auto& visit) {
    for (Index node = 0; node < columns.nodes(); ++node)
      for (Index i = 0; i < columns.width(node); ++i)
        visit(work.values[columns.offsets[columns.starts[node]] + i * (columns.width(node) + 1)]);
  };
  each_diagonal([&](double value) {
    trace += std::abs(value);
    work.stiffest = std::max(work.stiffest, std::abs(value));
  });
  const double mean = work.mean = trace / std::max<Index>(1, columns.size());
  if (shift > 0) each_diagonal([&](double& value) { value += shift * mean; });
  if (work.factorised_layout != work.layout) {
    work.factor.change(layout.symbolic);
    work.factorised_layout = work.layout;
  }
  using Precision = linear::MixedLdlt::Precision;
  const auto made = [&](Precision precision) {
    ask(at, active, work, balance);
    if (!layout.reduced.in_order()) layout.reduced.to_columns(work.solutions, work.in_columns);
    Eigen::MatrixXd& right_sides = layout.reduced.in_order() ? work.solutions : work.in_columns;
    LargeVector<double>* spare = contacts_ ? nullptr : &work.slots;  // nothing else is to be multiplied with them
    work.negative = work.factor.factorise(work.values, 1e-13 * mean, precision, right_sides, team, spare).negative;
    if (!layout.reduced.in_order()) layout.reduced.to_unknowns(work.in_columns, work.solutions);
    close(work);
  };
  made(work.precision);
  if (!work.factor.trusted() && (work.unstable == 0 || !loses_energy(work, team))) made(Precision::twice);
  work.exact = kind == Stiffness::exact && shift == 0;
  work.factorised = at.positions;
  return work.unstable;
}

/// Is there a change of shape that keeps the active measures and loses energy? Rayleigh's and Ritz's method on inverse
/// iterates of the last factorisation, however it is rounded: energies are those of the stiffness itself.
bool System::loses_energy(Workspace& work, Team& team) const {
  constexpr int iterates = 5;
  constexpr double rounding = 1e-12;  // over the mean diagonal
  Balance right;
  right.constraint.setZero(actuators());
  Eigen::VectorXd next = lopsided(freedoms_->size()), multipliers;
  Eigen::MatrixXd basis(next.size(), iterates);
  for (int i = 0; i < iterates; ++i) {
    right.force = -next;
    step(right, work, next, multipliers, team);
    for (int again = 0; again < 2; ++again) next -= basis.leftCols(i) * (basis.leftCols(i).transpose() * next);
    next.normalize();
    if (!next.allFinite()) return false;
    basis.col(i) = next;
  }
  Eigen::MatrixXd image = Eigen::MatrixXd::Zero(basis.rows(), iterates);
  linear::subtract_product(work.layout->reduced.columns(), work.values, basis, image, team);
  return symmetric_eigenvalues(-(basis.transpose() * image)).minCoeff() < -rounding * work.mean;
}

void System::couple(const Iterate& at, const std::vector<bool>& active, Workspace& work, Team& team) const {
  ask(at, active, work, nullptr);
  work.solve(work.solutions, team);
  close(work);
}

/// What a factorisation is to solve for: the active constraints' slopes, and the force of the balance.
void System::ask(const Iterate& at, const std::vector<bool>& active, Workspace& work, const Balance* balance) const {
  work.active.clear();
  for (Index a = 0; a < actuators(); ++a)
    if (active[a]) work.active.push_back(a);
  const Index count = static_cast<Index>(work.active.size());
  reduce_slopes(at, work, work.constraint_slopes);
  work.solutions.resize(freedoms_->size(), count + (balance ? 1 : 0));
  work.solutions.leftCols(count) = work.constraint_slopes;
  if (balance) work.solutions.col(count) = -balance->force;
}

void System::reduce_slopes(const Iterate& at, const Workspace& work, Eigen::MatrixXd& slopes) const {
  slopes.resize(freedoms_->size(), static_cast<Index>(work.active.size()));
  for (Index i = 0; i < static_cast<Index>(slopes.cols()); ++i) {
    freedoms_->reduce(work.slopes[work.active[i]], at.positions, slopes.col(i));
    slopes.col(i) *= sign(work.active[i]);
  }
}

/// What the constraints leave of the stiffness, from their responses.
void System::close(Workspace& work) const {
  const Index count = static_cast<Index>(work.active.size());
  work.unstable = work.negative;
  work.softest.resize(0);
  if (count == 0) return;
  work.responses = work.solutions.leftCols(count);
  Eigen::MatrixXd schur = work.constraint_slopes.transpose() * work.responses;
  work.scale.resize(count);
  for (Index i = 0; i < count; ++i) work.scale[i] = schur(i, i) != 0 ? 1 / std::sqrt(std::abs(schur(i, i))) : 1;
  schur = work.scale.asDiagonal() * (0.5 * (schur + schur.transpose()).eval()) * work.scale.asDiagonal();
  work.schur = MinimumNorm(schur, dependent);
  work.unstable -= static_cast<int>((symmetric_eigenvalues(schur).array() < -dependent).count());
}

void System::step(const Balance& balance, Workspace& work, Eigen::VectorXd& step, Eigen::VectorXd& change,
                  Team& team) const {
  step = -balance.force;
  if (!step.isZero(0)) work.solve(step, team);  // where constraints alone change there is nothing to solve for
  meet_constraints(balance, work, step, change);
}

void System::first_step(const Balance& balance, Workspace& work, Eigen::VectorXd& step, Eigen::VectorXd& change) const {
  step = work.solutions.col(static_cast<Index>(work.active.size()));
  meet_constraints(balance, work, step, change);
}

/// Change of the multipliers that closes the constraints, of which a step without them misses so much more.
Eigen::VectorXd System::closing(const Balance& balance, const Workspace& work, const Eigen::VectorXd& more) const {
  Eigen::VectorXd asked = more;
  for (Index i = 0; i < static_cast<Index>(asked.size()); ++i)
    asked[i] += sign(work.active[i]) * balance.constraint[work.active[i]];
  return work.scale.cwiseProduct(work.schur.solve(work.scale.cwiseProduct(asked)));
}

/// Adds to a step without constraints what closes them.
void System::meet_constraints(const Balance& balance, Workspace& work, Eigen::VectorXd& step,
                              Eigen::VectorXd& change) const {
  change.setZero(actuators());
  if (work.active.empty()) return;
  const Eigen::VectorXd multipliers = closing(balance, work, work.constraint_slopes.transpose() * step);
  step -= work.responses * multipliers;
  for (Index i = 0; i < static_cast<Index>(multipliers.size()); ++i) change[work.active[i]] = multipliers[i];
}

void System::correct_multipliers(const Balance& balance, const Workspace& work, Eigen::VectorXd& multipliers) const {
  if (work.active.empty()) return;
  const Eigen::VectorXd change = closing(balance, work, -(work.responses.transpose() * balance.force));
  for (Index i = 0; i < static_cast<Index>(change.size()); ++i) multipliers[work.active[i]] += change[i];
}

void System::upset(const Iterate& at, const Demand& from, const Demand& to, const std::vector<bool>& active,
                   Workspace& work, Balance& balance, Team& team) const {
  balance.constraint.setZero(actuators());
  Points moves = at.positions, force;
  hold(to, moves);
  moves -= at.positions;
  if (moves.isZero(0)) {
    force.setZero(moves.rows(), 3);
  } else {
    work.layout->pattern.gather(work.slots, work.blocks, team);
    work.layout->pattern.multiply(work.blocks, moves, force, team);
    for (Index a = 0; a < actuators(); ++a) {
      if (!active[a]) continue;
      (void)measures_.value(a, at.positions, &work.slopes[a]);
      balance.constraint[a] = work.slopes[a].cwiseProduct(moves).sum();
    }
  }
  bool layers = from.share != to.share && elastic_.prestretched();
  bool fields = magnets_ && magnets_->any_dipole() && from.share != to.share;
  for (Index a = 0; a < actuators(); ++a) {
    const double change = to.actuation[a] - from.actuation[a];
    if (change == 0) continue;
    if (active[a]) {
      balance.constraint[a] += target(a, from) - target(a, to);
    } else if (under_voltage(model_.actuators[a])) {
      Points per_square;
      elastic_.field_force(a, 1, at.positions, work.elastic, per_square, team);
      force += change * (to.actuation[a] + from.actuation[a]) * per_square;
    } else if (model_.actuators[a].kind == ActuatorKind::dea) {
      layers = true;
    } else if (model_.actuators[a].kind == ActuatorKind::magnetic) {
      fields = true;
    } else if (loads(a)) {
      Points slope;
      surroundings_.command_force(a, from.actuation, at.positions, slope);
      force += change * slope;
    } else if (!constrains(a) && measures_.measures(a)) {
      (void)measures_.value(a, at.positions, &work.slopes[a]);
      force += sign(a) * unit(a) * change * work.slopes[a];
    }
  }
  if (any_dead_load_) force -= (to.share - from.share) * model_.dead_load;
  if (to.fading != from.fading) force -= (to.fading - from.fading) * work.unbalanced;
  if (fields) magnets_->add_change(from, to, at.positions, force, team);
  if (layers) {  // the stretch of layers: central difference of the elastic force
    Demand low = from, high = from;
    constexpr double reach = 1e-4;
    for (Index a = 0; a < actuators(); ++a) {
      if (under_voltage(model_.actuators[a])) continue;  // the field was counted
      low.actuation[a] -= reach * (to.actuation[a] - from.actuation[a]);
      high.actuation[a] += reach * (to.actuation[a] - from.actuation[a]);
    }
    low.share -= reach * (to.share - from.share);
    high.share += reach * (to.share - from.share);
    Points below, above;
    elastic_.force(low, at.positions, work.elastic, below, team);
    elastic_.force(high, at.positions, work.elastic, above, team);
    force += (above - below) / (2 * reach);
  }
  balance.force.resize(freedoms_->size());
  freedoms_->reduce(force, at.positions, balance.force);
}

void System::measure(const Iterate& at, const Demand& demand, Workspace& work, ElementDeformation& out,
                     Team& team) const {
  Balance balance;
  hold_friction(at, work, team);
  evaluate(at, demand, std::vector<bool>(static_cast<std::size_t>(actuators()), false), work, balance, team);
  out.reactions = work.gradient;
  for (Index v = 0; v < out.reactions.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (model_.support_of[v][axis] < 0) out.reactions(v, axis) = 0;
  elastic_.stress(demand, at.positions, work.elastic, out.stress, team);
  if (magnets_) out.magnetic = magnets_->load(demand, at.positions, team);
  if (contacts_ && !balance.forbidden) {
    Points room;
    out.contacts =
        contact_forces(contacts_->surfaces(), contacts_->potential(), contacts_->points().of(at.positions, room),
                       work.contacts->terms, contacts_->friction(), work.contacts->holds, at.anchors);
  }
}

void System::advance(const Eigen::VectorXd& step, double scale, Workspace& work, Points& positions, Team& team,
                     const Demand* held) const {
  freedoms_->expand(scale * step, positions, work.moves);
  if (held && !contacts_) {  // where things touch the turns that it brings meet more of them
    Points there = positions;
    hold(*held, there);
    work.moves += there - positions;
  }
  const auto move = [&] {
    freedoms_->move(step, scale, positions);
    if (held) hold(*held, positions);
  };
  const double length = work.moves.cwiseAbs().maxCoeff();
  if (length < least_turning * model_.diagonal_mm) return move();
  elastic_.turning(positions, work.moves, work.elastic, work.lacking, team);
  move();
  const Points straight = contacts_ ? positions : Points();
  std::vector<supports::Pose> poses = turning_->poses(positions);
  turning_->step(work.lacking, positions, poses, team);
  // what holds a body by contact alone is not in the way of its turns
  if (contacts_ && largest_move(straight, positions) > most_turning * length * length / model_.diagonal_mm)
    positions = straight;
}

void System::hold(const Demand& demand, Points& positions) const {
  freedoms_->hold(demand.share, positions);
  supports_turn_.place(demand.actuation, demand.share, positions);
  surroundings_.place(demand.actuation, positions);
}

void System::hold_friction(const Iterate& at, Workspace& work, Team& team) const {
  if (!friction()) return;
  contacts_->find(at.positions, *work.contacts, team);
  contacts_->friction().hold(work.contacts->terms, at.anchors, work.contacts->holds);
}

double System::renew_friction(const Points& from, Iterate& at, Workspace& work, Team& team) const {
  if (!friction()) return 0;
  contacts_->find(at.positions, *work.contacts, team);
  contacts_->renew(from, at.positions, *work.contacts, at.anchors);
  const Friction::Holds before = work.contacts->holds;
  contacts_->friction().hold(work.contacts->terms, at.anchors, work.contacts->holds);
  return contacts_->disagreement(at.positions, before, work.contacts->holds);
}

double System::slipping_share(const Iterate& at, Workspace& work, Team& team) const {
  if (!friction()) return 0;
  hold_friction(at, work, team);
  return contacts_->friction().slipping_share(at.positions, work.contacts->holds);
}

void System::slide_friction(Iterate& at, Workspace& work, Team& team) const {
  if (!friction()) return;
  contacts_->find(at.positions, *work.contacts, team);
  contacts_->slide(at.positions, *work.contacts, at.anchors);
  contacts_->friction().hold(work.contacts->terms, at.anchors, work.contacts->holds);
}

double System::clear_share(const Points& from, const Way& way, double end, Workspace& work, Points& to,
                           Team& team) const {
  constexpr double gentle = 0.7, wild = 2.5;  // turns of a piece, and of what was stretched as well
  way(end, to);
  if (!contacts_) return end;
  const double turn = to.allFinite() ? contacts_->largest_turn(from, to) : 2 * wild;
  if (!(turn <= wild)) return 0.5 * end * wild / turn;
  const int pieces = std::max(1, static_cast<int>(std::ceil(turn / gentle)));
  Points last = from, next;
  for (int piece = 1; piece <= pieces; ++piece) {
    if (piece < pieces)
      way(end * piece / pieces, next);
    else
      next = to;
    const double share = contacts_->safe_share(last, next, *work.contacts, team);
    if (share < 1) return end * (piece - 1 + share) / pieces;
    last.swap(next);
  }
  return end;
}

bool System::advance_clear(const Eigen::VectorXd& step, double& scale, Workspace& work, Points& positions,
                           Team& team) const {
  constexpr double least = 1e-3;
  const Points from = positions;
  const Way way = [&](double share, Points& out) {
    out = from;
    advance(step, share * scale, work, out, team);
  };
  for (double end = 1; end >= least;) {
    const double share = clear_share(from, way, end, work, positions, team);
    if (share >= end) {
      scale *= end;
      return true;
    }
    end = within * share;
  }
  return false;
}

void System::set_firmness(const ContactFirmness& firmness, Workspace& work) const {
  if (contacts_) work.contacts->firmness = firmness;
}

void System::straighten_contact(const Iterate& at, double foresight, Workspace& work, Team& team) const {
  Contacts::Scratch& scratch = *work.contacts;
  contacts_->find(at.positions, scratch, team);
  contacts_->note_pushes(scratch);
  scratch.firmness = {1, 1, foresight};
  scratch.straight = true;
}

void System::follow_pushes(const Points& moves, double share, Workspace& work) const {
  contacts_->follow_pushes(moves, share, *work.contacts);
}

double System::missed_by_pushes(const Workspace& work) const {
  constexpr double faint = 0.01;  // over the largest
  double largest = 0, most = 0;
  for (const ContactPush& push : work.contacts->pushes) largest = std::max(largest, push.push);
  for (const ContactPush& push : work.contacts->pushes) {
    const ContactPotential::Term& term = work.contacts->terms[static_cast<std::size_t>(push.term)];
    const double by_gap = -energy::barrier(std::sqrt(term.separation.squared), contacts_->surfaces().reach_mm).slope;
    most = std::max(most, std::abs(by_gap - push.push) / (push.push + faint * largest));
  }
  return most;
}

void System::forget_pushes(Workspace& work) const {
  work.contacts->firmness = {};
  work.contacts->straight = false;
  work.contacts->pushes.clear();
}

System::Size System::size_of(const Eigen::VectorXd& unknowns, const Points& positions) const {
  Points moves;
  freedoms_->expand(unknowns, positions, moves);
  double largest = 0, sum = 0;
  for (Index v = 0; v < moves.rows(); ++v) {
    const double square = moves.row(v).squaredNorm();
    if (!(square <= largest)) largest = square;  // also where it is not a number
    sum += square;
  }
  return {std::sqrt(largest), std::sqrt(sum / static_cast<double>(moves.rows()))};
}

bool System::multiplies_unknowns(const Workspace& work) const {
  return !friction() && work.layout->reduced.in_order();
}

void System::gather(const Iterate& at, Workspace& work, Team& team) const {
  const Layout& layout = *work.layout;
  if (multiplies_unknowns(work))
    layout.reduced.reduce(layout.pattern, work.slots, work.gradient, at.positions, work.values, team);
  else
    layout.pattern.gather(work.slots, work.blocks, team);
}

void System::multiply(const Iterate& at, const Eigen::MatrixXd& vectors, Workspace& work, Eigen::MatrixXd& product,
                      Team& team) const {
  if (multiplies_unknowns(work)) {
    product.setZero();
    linear::subtract_product(work.layout->reduced.columns(), work.values, vectors, product, team);
    product = -product;
    return;
  }
  Points force;
  for (Index i = 0; i < vectors.cols(); ++i) {
    freedoms_->expand(vectors.col(i), at.positions, work.moves);
    work.layout->pattern.multiply(work.blocks, work.moves, force, team);
    if (friction()) contacts_->add_friction_response(at.positions, *work.contacts, work.moves, force);
    freedoms_->reduce(force, at.positions, product.col(i));
    freedoms_->add_turning(work.gradient, at.positions, vectors.col(i), product.col(i));
  }
}

void System::command_force(const Iterate& at, const Demand& demand, Index actuator, Workspace& work, Points& force,
                           Points& moves, Team& team) const {
  const Actuator& command = model_.actuators[actuator];
  surroundings_.motion(actuator, moves);
  supports_turn_.add_velocity(actuator, demand.actuation, demand.share, moves);
  if (!drives(command)) {
    surroundings_.command_force(actuator, demand.actuation, at.positions, force);
    if (command.kind != ActuatorKind::motion && command.kind != ActuatorKind::turn) return;
    assemble(at, demand, Stiffness::exact, work, team);
    work.layout->pattern.gather(work.slots, work.blocks, team);
    work.layout->pattern.multiply(work.blocks, moves, force, team);
    if (friction()) contacts_->add_friction_response(at.positions, *work.contacts, moves, force);
    return;
  }
  if (under_voltage(command)) {  // the force goes with the square of the voltage
    elastic_.field_force(actuator, 1, at.positions, work.elastic, force, team);
    force *= 2 * demand.actuation[actuator];
    return;
  }
  if (command.kind == ActuatorKind::magnetic)
    return magnets_->command_force(actuator, demand, at.positions, force, team);
  if (command.kind != ActuatorKind::dea) {
    (void)measures_.value(actuator, at.positions, &force);
    force *= sign(actuator) * unit(actuator);
    return;
  }
  // central difference of fourth order; the force is smooth in the ratio
  const double reach = 1e-3 * demand.actuation[actuator];
  const auto at_ratio = [&](double change) {
    Demand changed = demand;
    changed.actuation[actuator] += change;
    elastic_.force(changed, at.positions, work.elastic, work.moves, team);
    return work.moves;
  };
  force = (8 * (at_ratio(reach) - at_ratio(-reach)) - (at_ratio(2 * reach) - at_ratio(-2 * reach))) / (12 * reach);
}

}  // namespace softkin::physical
