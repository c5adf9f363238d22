#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/contact_at_rest.hpp>
#include <softkin/statics/physical/system.hpp>
#include <stdexcept>

namespace softkin::physical {

namespace {

/// Share of a constraint's own compliance below which what it adds to others is rounding [-].
constexpr double dependent = 1e-9;

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
      body_(model),
      dead_loads_(model),
      fading_loads_(model),
      surroundings_(model),
      measures_(model),
      supports_turn_(model) {
  body_.add_cliques(cliques_);
  measures_.add_cliques(cliques_);
  surroundings_.add_cliques(cliques_);
  if (model.magnetism) magnets_ = std::make_unique<const Magnets>(model, body_.element_slots());
  linear::BlockPattern pattern(static_cast<Index>(model.rest.rows()), cliques_);
  freedoms_ = std::make_unique<supports::Freedoms>(model, pattern);
  supports::ReducedMatrix reduced(*freedoms_, pattern);
  auto symbolic = std::make_shared<const linear::FrontTree>(linear::make_front_tree(reduced.columns()));
  linear::require_memory(*symbolic, sizeof(float));  // before what takes long
  layout_ = std::make_shared<const Layout>(
      Layout{std::move(pattern), std::move(reduced), std::move(symbolic), cliques_.slots.back()});
  check_contact_at_rest(model);
  if (model.contact.any())
    contacts_ = std::make_unique<Contacts>(model);
  else
    cliques_ = {};
  turning_ = std::make_unique<supports::GlobalStep>(model, body_.laplacian(), freedoms_->vertex_order());
  terms_ = {&body_, &dead_loads_, &fading_loads_, &surroundings_};
  if (magnets_) terms_.push_back(magnets_.get());
  if (contacts_) terms_.push_back(contacts_.get());
}

namespace {

std::vector<std::unique_ptr<Term::Scratch>> scratches(const std::vector<const Term*>& terms) {
  std::vector<std::unique_ptr<Term::Scratch>> all;
  for (const Term* term : terms) all.push_back(term->new_scratch());
  return all;
}

}  // namespace

System::Workspace::Workspace(const System& system)
    : terms(scratches(system.terms_)),
      elastic(static_cast<Body::Scratch&>(*terms[0])),
      fading(static_cast<FadingLoads::Scratch&>(*terms[2])),
      contacts(system.contacts_ ? &static_cast<Contacts::Scratch&>(*terms.back()) : nullptr),
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

void System::evaluate(const Iterate& at, const Demand& demand, const std::vector<bool>& active, Workspace& work,
                      Balance& balance, Team& team) const {
  balance.evaluation = ++work.evaluated;
  work.gradient.setZero(at.positions.rows(), 3);
  Term::Sum sum{work.gradient};
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.evaluate(at, demand, scratch, sum, team); });
  balance.energy = sum.energy;
  balance.inverted = sum.inverted;
  balance.forbidden = sum.forbidden;
  work.left_field = work.left_field || sum.left_field;
  balance.constraint.setZero(actuators());
  balance.load_energy = 0;
  for (Index a = 0; a < actuators(); ++a) {
    if (!measures_.measures(a) || (!active[a] && at.multipliers[a] == 0)) continue;
    const double value = measures_.value(a, at.positions, &work.slopes[a]);
    if (active[a])
      balance.constraint[a] = value - measures_.target(a, demand.actuation);
    else
      balance.load_energy += measures_.sign(a) * at.multipliers[a] * value;
    work.gradient += measures_.sign(a) * at.multipliers[a] * work.slopes[a];
  }
  balance.force.resize(freedoms_->size());
  freedoms_->reduce(work.gradient, at.positions, balance.force);
}

void System::set_time(std::shared_ptr<const ViscousHistory> history, double elapsed_s, Workspace& work,
                      Team& team) const {
  if (!viscous()) return;
  if (history != work.elastic.history || elapsed_s != work.elastic.elapsed_s) work.tangents.at.resize(0, 3);
  body_.set_time(std::move(history), elapsed_s, work.elastic, team);
}

Demand System::unbalanced(const Iterate& at, const Demand& demand, Workspace& work, Team& team) const {
  Balance balance;
  evaluate(at, demand, std::vector<bool>(static_cast<std::size_t>(actuators()), false), work, balance, team);
  work.fading.force = work.gradient;
  constexpr double balanced = 1e-6;  // of what elements pull with: Newton's method does not need a way for that
  const Imbalance left = imbalance(balance, work, team);
  return {demand.actuation, demand.share, left.residual > balanced * left.pull ? 1.0 : 0.0};
}

void System::require_last(const Balance& balance, const Workspace& work) {
  if (balance.evaluation != work.evaluated) throw std::logic_error("the workspace has evaluated another shape since");
}

System::Imbalance System::imbalance(const Balance& balance, const Workspace& work, Team& team) const {
  require_last(balance, work);
  constexpr double roundings = 16;  // of a vertex's elements
  return {freedoms_->largest(balance.force), body_.largest_pull(work.elastic, team),
          roundings * std::numeric_limits<double>::epsilon() * work.stiffest * model_.diagonal_mm};
}

/// Another layout where the one that there is does not hold what couples now.
void System::give_slots(const Iterate& at, Workspace& work, Team& team) const {
  bool lacking = false;
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { lacking = lacking || term.lacks_slots(scratch); });
  if (!lacking) return;
  linear::Cliques cliques = cliques_;
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.add_cliques_of(at, scratch, cliques, team); });
  linear::BlockPattern pattern(static_cast<Index>(model_.rest.rows()), cliques);
  supports::ReducedMatrix reduced = supports::ReducedMatrix::wider(*freedoms_, pattern);
  auto symbolic = std::make_shared<const linear::FrontTree>(linear::make_front_tree(reduced.columns()));
  work.layout = std::make_shared<const Layout>(
      Layout{std::move(pattern), std::move(reduced), std::move(symbolic), cliques.slots.back()});
  work.slots.resize(9 * static_cast<std::size_t>(work.layout->slots));
}

void System::assemble(const Iterate& at, const Demand& demand, const Balance& balance, Stiffness kind, Workspace& work,
                      Team& team) const {
  require_last(balance, work);
  work.assembled = kind == Stiffness::exact ? balance.evaluation : 0;
  give_slots(at, work, team);
  each_term(work, [&](const Term& term, Term::Scratch& scratch) {
    term.stiffness(at, demand, kind == Stiffness::projected, scratch, work.slots, team);
  });
  Eigen::VectorXd scale(actuators());
  for (Index a = 0; a < actuators(); ++a) scale[a] = measures_.sign(a) * at.multipliers[a];
  measures_.second_derivatives(at.positions, scale, work.slots, team);
}

int System::factorise(const Iterate& at, const Demand& demand, const std::vector<bool>& active, const Balance& balance,
                      const Factoring& factoring, Workspace& work, Team& team) const {
  assemble(at, demand, balance, factoring.kind, work, team);
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
  if (factoring.shift > 0) each_diagonal([&](double& value) { value += factoring.shift * mean; });
  if (work.factorised_layout != work.layout) {
    work.factor.change(layout.symbolic);
    work.factorised_layout = work.layout;
  }
  using Precision = linear::MixedLdlt::Precision;
  const auto made = [&](Precision precision) {
    ask(at, active, balance, factoring.step, work);
    if (!layout.reduced.in_order()) layout.reduced.to_columns(work.solutions, work.in_columns);
    Eigen::MatrixXd& right_sides = layout.reduced.in_order() ? work.solutions : work.in_columns;
    LargeVector<double>* spare = contacts_ ? nullptr : &work.slots;  // nothing else is to be multiplied with them
    if (spare) work.assembled = 0;
    work.negative = work.factor.factorise(work.values, 1e-13 * mean, precision, right_sides, team, spare).negative;
    if (!layout.reduced.in_order()) layout.reduced.to_unknowns(work.in_columns, work.solutions);
    close(work);
  };
  made(work.precision);
  if (!work.factor.trusted() && (work.unstable == 0 || !loses_energy(work, team))) made(Precision::twice);
  work.exact = factoring.kind == Stiffness::exact && factoring.shift == 0;
  work.factorised_by = balance.evaluation;
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

void System::couple(const Iterate& at, const std::vector<bool>& active, const Balance& balance, Workspace& work,
                    Team& team) const {
  ask(at, active, balance, false, work);
  work.solve(work.solutions, team);
  close(work);
}

/// What a factorisation is to solve for: the active constraints' slopes, and for a step the force of the balance.
void System::ask(const Iterate& at, const std::vector<bool>& active, const Balance& balance, bool step,
                 Workspace& work) const {
  work.active.clear();
  for (Index a = 0; a < actuators(); ++a)
    if (active[a]) work.active.push_back(a);
  const Index count = static_cast<Index>(work.active.size());
  reduce_slopes(at, balance, work, work.constraint_slopes);
  work.solutions.resize(freedoms_->size(), count + (step ? 1 : 0));
  work.solutions.leftCols(count) = work.constraint_slopes;
  if (step) work.solutions.col(count) = -balance.force;
}

void System::reduce_slopes(const Iterate& at, const Balance& balance, const Workspace& work,
                           Eigen::MatrixXd& slopes) const {
  require_last(balance, work);
  slopes.resize(freedoms_->size(), static_cast<Index>(work.active.size()));
  for (Index i = 0; i < static_cast<Index>(slopes.cols()); ++i) {
    freedoms_->reduce(work.slopes[work.active[i]], at.positions, slopes.col(i));
    slopes.col(i) *= measures_.sign(work.active[i]);
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
    asked[i] += measures_.sign(work.active[i]) * balance.constraint[work.active[i]];
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

bool System::moves_supports(const Demand& from, const Demand& to) const {
  if (from.share != to.share) return true;
  for (Index a = 0; a < actuators(); ++a) {
    const ActuatorKind kind = model_.actuators[a].kind;
    if ((kind == ActuatorKind::motion || kind == ActuatorKind::turn) && from.actuation[a] != to.actuation[a])
      return true;
  }
  return false;
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
  for (Index a = 0; a < actuators(); ++a) {
    const double change = to.actuation[a] - from.actuation[a];
    if (change == 0 || !measures_.measures(a)) continue;
    if (active[a]) {
      balance.constraint[a] += measures_.target(a, from.actuation) - measures_.target(a, to.actuation);
    } else if (!measures_.constrains(a)) {
      (void)measures_.value(a, at.positions, &work.slopes[a]);
      force += measures_.sign(a) * measures_.unit(a) * change * work.slopes[a];
    }
  }
  each_term(work, [&](const Term& term, Term::Scratch& scratch) {
    term.add_change(from, to, at.positions, scratch, force, team);
  });
  balance.force.resize(freedoms_->size());
  freedoms_->reduce(force, at.positions, balance.force);
}

void System::measure(const Iterate& at, const Demand& demand, Workspace& work, ElementDeformation& out,
                     Team& team) const {
  Balance balance;
  evaluate(at, demand, std::vector<bool>(static_cast<std::size_t>(actuators()), false), work, balance, team);
  out.reactions = work.gradient;
  for (Index v = 0; v < out.reactions.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (model_.support_of[v][axis] < 0) out.reactions(v, axis) = 0;
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.tell(at, demand, scratch, out, team); });
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
  body_.turning(positions, work.moves, work.elastic, work.lacking, team);
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
  return symmetric() && work.layout->reduced.in_order();
}

void System::gather(const Iterate& at, const Balance& balance, Workspace& work, Team& team) const {
  require_last(balance, work);
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
    each_term(work,
              [&](const Term& term, Term::Scratch& scratch) { term.add_response(at, work.moves, scratch, force); });
    freedoms_->reduce(force, at.positions, product.col(i));
    freedoms_->add_turning(work.gradient, at.positions, vectors.col(i), product.col(i));
  }
}

void System::command_force(const Iterate& at, const Demand& demand, const Balance& balance, Index actuator,
                           Workspace& work, Points& force, Points& moves, Team& team) const {
  surroundings_.motion(actuator, moves);
  supports_turn_.add_velocity(actuator, demand.actuation, demand.share, moves);
  force.setZero(at.positions.rows(), 3);
  if (measures_.measures(actuator)) {
    (void)measures_.value(actuator, at.positions, &force);
    force *= measures_.sign(actuator) * measures_.unit(actuator);
  }
  each_term(work, [&](const Term& term, Term::Scratch& scratch) {
    term.add_derivative(actuator, demand, at.positions, scratch, force, team);
  });
  if (moves.isZero(0)) return;
  assemble(at, demand, balance, Stiffness::exact, work, team);
  work.layout->pattern.gather(work.slots, work.blocks, team);
  Points pulled;
  work.layout->pattern.multiply(work.blocks, moves, pulled, team);
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.add_response(at, moves, scratch, pulled); });
  force += pulled;
}

bool System::loads(Index actuator) const {
  return std::any_of(terms_.begin(), terms_.end(), [&](const Term* term) { return term->loads(actuator); });
}

bool System::symmetric() const {
  return std::all_of(terms_.begin(), terms_.end(), [](const Term* term) { return term->symmetric(); });
}

bool System::any_dead_load() const {
  return std::any_of(terms_.begin(), terms_.end(), [](const Term* term) { return term->grows(); });
}

}  // namespace softkin::physical
