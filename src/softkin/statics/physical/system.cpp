#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/statics/chamber_caps.hpp>
#include <softkin/statics/physical/contact_at_rest.hpp>
#include <softkin/statics/physical/system.hpp>
#include <stdexcept>

namespace softkin::physical {

LoadState between(const LoadState& from, const LoadState& to, double fraction) {
  if (fraction == 1) return to;
  return {from.actuation + fraction * (to.actuation - from.actuation),
          from.load_factor + fraction * (to.load_factor - from.load_factor),
          from.fading + fraction * (to.fading - from.fading)};
}

System::System(const Model& model) : System(model, nullptr) {}
System::System(const Model& model, const System& like) : System(model, &like) {}

System::System(const Model& model, const System* like)
    : System(model, pressures_of(model, like ? like->pressures() : nullptr), like) {}

System::System(const Model& given, std::unique_ptr<const Pressures> pressures, const System* like)
    : pressures_(std::move(pressures)),
      own_(pressures_ ? with_vertices(given, *pressures_) : nullptr),
      model_(own_ ? *own_ : given),
      body_(model_, pressures_.get()),
      dead_loads_(model_),
      fading_loads_(model_),
      surroundings_(model_),
      actuator_loads_(model_) {
  const Model& model = model_;
  body_.add_cliques(coupling_.cliques);
  actuator_loads_.add_cliques(coupling_.cliques);
  surroundings_.add_cliques(coupling_.cliques);
  const auto make = [&]<class Part>(std::unique_ptr<Part>& part) {
    part = std::make_unique<Part>(model);
    part->add_cliques(coupling_.cliques);
  };
  if (Tractions::act(model)) make(tractions_);
  if (Hydrostatics::acts(model)) make(hydrostatics_);
  if (!model.loads.moments.empty()) make(moments_);
  if (!model.reinforcement.fibres.empty()) make(fibres_);
  if (!model.reinforcement.layers.empty()) make(layers_);
  if (FibreFamilies::any(model)) {
    families_ = std::make_unique<const FibreFamilies>(model, body_.element_slots());
    body_.add_stress_of(*families_);
  }
  if (model.magnetism) magnets_ = std::make_unique<const Magnets>(model, body_.element_slots());
  if (like)
    reuse_layout(*like);
  else
    make_layout();
  if (model.contact.any())
    contacts_ = std::make_unique<Contacts>(model);
  else
    coupling_.cliques = {};
  placement_ = std::make_unique<const Placement>(model, body_, *freedoms_, like ? like->placement_.get() : nullptr);
  terms_ = {&body_, &dead_loads_, &fading_loads_, &surroundings_};
  for (const Term* term :
       std::initializer_list<const Term*>{tractions_.get(), hydrostatics_.get(), moments_.get(), fibres_.get(),
                                          layers_.get(), families_.get(), magnets_.get(), contacts_.get()})
    if (term != nullptr) terms_.push_back(term);
}

void System::make_layout() {
  linear::BlockPattern pattern(model_.rest.rows(), coupling_.cliques);
  freedoms_ = std::make_unique<const supports::Freedoms>(model_, pattern,
                                                         pressures_ ? pressures_->corners : std::vector<Index>());
  supports::ReducedMatrix reduced(*freedoms_, pattern);
  auto symbolic = std::make_shared<const linear::FrontTree>(linear::make_front_tree(reduced.columns()));
  linear::require_memory(*symbolic, sizeof(float));  // before the long computations
  coupling_.layout =
      std::make_shared<const Layout>(Layout{std::move(pattern), std::move(reduced), std::move(symbolic),
                                            coupling_.cliques.slots.back(), coupling_.cliques.fingerprint()});
  check_contact_at_rest(model_);
}

void System::reuse_layout(const System& like) {
  if (model_.held.fixed != like.model_.held.fixed || model_.rest != like.model_.rest)
    throw InvalidInput("a robot with another number has another mesh or is held otherwise");
  if (coupling_.cliques.fingerprint() !=
      like.coupling_.layout->fingerprint)  // for example if a cable's point lies in another element
    return make_layout();
  freedoms_ = std::make_unique<const supports::Freedoms>(*like.freedoms_, model_);
  coupling_.layout = like.coupling_.layout;
}

void System::evaluate(const Iterate& at, const LoadState& load_state, const std::vector<bool>& active, Workspace& work,
                      Balance& balance, Team& team) const {
  balance.evaluation = ++work.evaluated;
  work.gradient.setZero(at.positions.rows(), 3);
  Term::Sum sum{work.gradient};
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.evaluate(at, load_state, scratch, sum, team); });
  balance.energy = sum.energy;
  balance.inverted = sum.inverted;
  balance.forbidden = sum.forbidden;
  work.left_field = work.left_field || sum.left_field;
  actuator_loads_.evaluate(at, load_state, active, work.slopes, work.gradient, balance);
  balance.force.resize(freedoms_->size());
  freedoms_->reduce(work.gradient, at.positions, balance.force);
}

double System::pressure_work(const Points& positions, const Eigen::VectorXd& force) const {
  double sum = 0;
  if (!pressures_) return sum;
  Points missed;
  freedoms_->expand(force, positions, missed);
  for (Index p = 0; p < pressures_->count(); ++p)
    sum += positions(pressures_->first + p, 0) * missed(pressures_->first + p, 0);
  return sum;
}

void System::set_time(std::shared_ptr<const ViscousHistory> history, double elapsed_s, Workspace& work,
                      Team& team) const {
  if (!viscous()) return;
  if (history != work.elastic.history || elapsed_s != work.elastic.elapsed_s) work.tangents.at.resize(0, 3);
  body_.set_time(std::move(history), elapsed_s, work.elastic, team);
}

LoadState System::unbalanced(const Iterate& at, const LoadState& load_state, Workspace& work, Team& team) const {
  Balance balance;
  evaluate(at, load_state, std::vector<bool>(actuators(), false), work, balance, team);
  work.fading.force = work.gradient;
  constexpr double balanced = 1e-6;  // of the internal forces: Newton's method corrects smaller residuals directly
  const Imbalance left = imbalance(balance, work, team);
  return {load_state.actuation, load_state.load_factor, left.residual > balanced * left.pull ? 1.0 : 0.0};
}

void System::require_last(const Balance& balance, const Workspace& work) {
  if (balance.evaluation != work.evaluated) throw std::logic_error("the workspace has evaluated another shape since");
}

Imbalance System::imbalance(const Balance& balance, const Workspace& work, Team& team) const {
  require_last(balance, work);
  constexpr double roundings = 16;  // rounding errors of the forces at a vertex
  const double pull = body_.largest_pull(work.elastic, team);
  return {freedoms_->largest(balance.force), work.layers ? std::max(pull, work.layers->pulls.maxCoeff()) : pull,
          roundings * std::numeric_limits<double>::epsilon() * work.saddle.spectrum().stiffest * model_.diagonal_mm};
}

/// Makes another layout if the current one lacks slots for the vertices that are coupled now.
void System::give_slots(const Iterate& at, Workspace& work, Team& team) const {
  bool lacking = false;
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { lacking = lacking || term.lacks_slots(scratch); });
  if (!lacking) return;
  linear::Cliques cliques = coupling_.cliques;
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.add_cliques_of(at, scratch, cliques, team); });
  linear::BlockPattern pattern(model_.rest.rows(), cliques);
  supports::ReducedMatrix reduced = supports::ReducedMatrix::wider(*freedoms_, pattern);
  auto symbolic = std::make_shared<const linear::FrontTree>(linear::make_front_tree(reduced.columns()));
  work.stiffness.layout = std::make_shared<const Layout>(
      Layout{std::move(pattern), std::move(reduced), std::move(symbolic), cliques.slots.back()});
  work.stiffness.slots.resize(9 * static_cast<std::size_t>(work.stiffness.layout->slots));
}

void System::assemble(const Iterate& at, const LoadState& load_state, const Balance& balance, Stiffness kind,
                      Workspace& work, Team& team) const {
  require_last(balance, work);
  work.stiffness.assembled = kind == Stiffness::exact ? balance.evaluation : 0;
  give_slots(at, work, team);
  each_term(work, [&](const Term& term, Term::Scratch& scratch) {
    term.stiffness(at, load_state, kind == Stiffness::projected, scratch, work.stiffness.slots, team);
  });
  actuator_loads_.stiffness(at, work.stiffness.slots, team);
}

int System::factorise(const Iterate& at, const LoadState& load_state, const std::vector<bool>& active,
                      const Balance& balance, const Factoring& factoring, Workspace& work, Team& team) const {
  assemble(at, load_state, balance, factoring.kind, work, team);
  work.stiffness.layout->reduced.reduce(work.stiffness.layout->pattern, work.stiffness.slots, work.gradient,
                                        at.positions, work.stiffness.values, team);
  ask(at, active, balance, work);
  const bool spares = multiplies_unknowns(work) && !contacts_;  // the slots are not needed for other products
  LargeVector<double>* spare = spares ? &work.stiffness.slots : nullptr;
  if (spare) work.stiffness.assembled = 0;
  if (!spare && !contacts_) work.stiffness.layout->pattern.gather(work.stiffness.slots, work.stiffness.blocks, team);
  work.saddle.factorise({work.stiffness.layout, work.stiffness.values, factoring.shift, spare},
                        factoring.step ? &balance : nullptr, team);
  work.factored.exact = factoring.kind == Stiffness::exact && factoring.shift == 0;
  work.factored.by = balance.evaluation;
  work.factored.shape = at.positions;
  return work.saddle.spectrum().unstable;
}

void System::couple(const Iterate& at, const std::vector<bool>& active, const Balance& balance, Workspace& work,
                    Team& team) const {
  ask(at, active, balance, work);
  work.saddle.couple(team);
}

/// Passes the active measures and their gradients to the factorisation.
void System::ask(const Iterate& at, const std::vector<bool>& active, const Balance& balance, Workspace& work) const {
  work.saddle.activate(active);
  work.factored.softest.reset();
  reduce_slopes(at, balance, work, work.saddle.slopes(), work.saddle.pulls());
  work.saddle.compliance() = compliance(balance, work);
  if (!tendons().any()) return;
  work.saddle.tendons() = tendons().columns(at, *freedoms_);
  work.saddle.slips() = balance.slips;
}

void System::reduce_slopes(const Iterate& at, const Balance& balance, const Workspace& work, Eigen::MatrixXd& slopes,
                           Eigen::MatrixXd& pulls) const {
  require_last(balance, work);
  const std::vector<Index>& active = work.saddle.active();
  slopes.resize(freedoms_->size(), active.size());
  for (Index i = 0; i < slopes.cols(); ++i) {
    freedoms_->reduce(work.slopes[active[i]], at.positions, slopes.col(i));
    slopes.col(i) *= measures().sign(active[i]);
  }
  if (std::none_of(active.begin(), active.end(), [&](Index a) { return tendons().has_friction(a); }))
    return pulls.resize(0, 0);
  pulls = slopes;
  Points pull;
  for (Index i = 0; i < slopes.cols(); ++i) {
    if (!tendons().has_friction(active[i])) continue;
    actuator_loads_.pull(active[i], at, pull);
    freedoms_->reduce(pull, at.positions, pulls.col(i));
    pulls.col(i) *= measures().sign(active[i]);
  }
}

Eigen::VectorXd System::compliance(const Balance& balance, const Workspace& work) const {
  const std::vector<Index>& active = work.saddle.active();
  if (balance.compliance.size() == 0) return {};
  return Eigen::VectorXd::NullaryExpr(active.size(), [&](Eigen::Index i) { return balance.compliance[active[i]]; });
}

Points System::residual_change_by_supports(const Iterate& at, const LoadState& to, const std::vector<bool>& active,
                                           Workspace& work, Balance& balance, Team& team) const {
  balance.constraint.setZero(actuators());
  Points moves = at.positions, force;
  placement_->hold(to, moves);
  moves -= at.positions;
  if (moves.isZero(0)) {
    force.setZero(moves.rows(), 3);
  } else {
    work.stiffness.layout->pattern.gather(work.stiffness.slots, work.stiffness.blocks, team);
    work.stiffness.layout->pattern.multiply(work.stiffness.blocks, moves, force, team);
    actuator_loads_.add_moves(active, at.positions, moves, work.slopes, balance.constraint);
  }
  return force;
}

void System::residual_change(const Iterate& at, const LoadState& from, const LoadState& to,
                             const std::vector<bool>& active, Workspace& work, Balance& balance, Team& team) const {
  Points force = residual_change_by_supports(at, to, active, work, balance, team);
  actuator_loads_.add_change(at, from, to, active, work.slopes, balance.constraint, force);
  if (tendons().any()) {
    balance.slips = tendons().slips(at);
    balance.growth = Eigen::VectorXd::Ones(actuators());
    for (Index a = 0; a < actuators(); ++a)
      if (tendons().has_friction(a) && measures().given_load(a) && at.multipliers[a] != 0)
        balance.growth[a] = measures().given(a, to.actuation[a]) / at.multipliers[a];
  }
  each_term(work, [&](const Term& term, Term::Scratch& scratch) {
    term.add_change(from, to, at.positions, scratch, force, team);
  });
  balance.force.resize(freedoms_->size());
  freedoms_->reduce(force, at.positions, balance.force);
}

void System::measure(const Iterate& at, const LoadState& load_state, Workspace& work, ElementDeformation& out,
                     Team& team) const {
  Balance balance;
  evaluate(at, load_state, std::vector<bool>(actuators(), false), work, balance, team);
  out.reactions = work.gradient;
  for (Index a = 0; a < actuators(); ++a)
    add_cap_force(model_, model_.actuators[a], at.positions, at.multipliers[a], out.reactions);
  for (Index v = 0; v < out.reactions.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (model_.held.support_of[v][axis] < 0) out.reactions(v, axis) = 0;
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.describe(at, load_state, scratch, out, team); });
  for (Index a = 0; a < actuators(); ++a) {
    if (!tendons().has_friction(a)) continue;
    out.tendons.resize(actuators());
    out.tendons[a] = tendons().forces(a, at.multipliers[a], at);
  }
}

bool System::multiplies_unknowns(const Workspace& work) const {
  return reciprocal() && work.stiffness.layout->reduced.in_order();
}

void System::gather(const Iterate& at, const Balance& balance, Workspace& work, Team& team) const {
  require_last(balance, work);
  const Layout& layout = *work.stiffness.layout;
  if (multiplies_unknowns(work))
    layout.reduced.reduce(layout.pattern, work.stiffness.slots, work.gradient, at.positions, work.stiffness.values,
                          team);
  else
    layout.pattern.gather(work.stiffness.slots, work.stiffness.blocks, team);
}

void System::multiply(const Iterate& at, const Eigen::MatrixXd& vectors, Workspace& work, Eigen::MatrixXd& product,
                      Team& team) const {
  if (multiplies_unknowns(work)) {
    product.setZero();
    linear::subtract_product(work.stiffness.layout->reduced.columns(), work.stiffness.values, vectors, product, team);
    product = -product;
    return;
  }
  Points force;
  for (Index i = 0; i < vectors.cols(); ++i) {
    freedoms_->expand(vectors.col(i), at.positions, work.moves);
    work.stiffness.layout->pattern.multiply(work.stiffness.blocks, work.moves, force, team);
    each_term(work,
              [&](const Term& term, Term::Scratch& scratch) { term.add_response(at, work.moves, scratch, force); });
    actuator_loads_.add_response(at, work.moves, force);
    freedoms_->reduce(force, at.positions, product.col(i));
    freedoms_->add_turning(work.gradient, at.positions, vectors.col(i), product.col(i));
  }
}

void System::command_force(const Iterate& at, const LoadState& load_state, Index actuator, Workspace& work,
                           Points& force, Team& team) const {
  actuator_loads_.derivative(actuator, at, load_state.actuation[actuator], force);
  each_term(work, [&](const Term& term, Term::Scratch& scratch) {
    term.add_derivative(actuator, load_state, at.positions, scratch, force, team);
  });
}

void System::add_pull(const Iterate& at, const LoadState& load_state, const Balance& balance, const Points& moves,
                      Workspace& work, Points& force, Team& team) const {
  require_last(balance, work);
  if (work.stiffness.assembled != balance.evaluation) assemble(at, load_state, balance, Stiffness::exact, work, team);
  work.stiffness.layout->pattern.gather(work.stiffness.slots, work.stiffness.blocks, team);
  Points pulled;
  work.stiffness.layout->pattern.multiply(work.stiffness.blocks, moves, pulled, team);
  each_term(work, [&](const Term& term, Term::Scratch& scratch) { term.add_response(at, moves, scratch, pulled); });
  actuator_loads_.add_response(at, moves, pulled);
  force += pulled;
}

bool System::loads(Index actuator) const {
  return std::any_of(terms_.begin(), terms_.end(), [&](const Term* term) { return term->loads(actuator); });
}

bool System::symmetric() const {
  return std::all_of(terms_.begin(), terms_.end(), [](const Term* term) { return term->symmetric(); });
}

bool System::conservative() const {
  return !tendons().any() &&
         std::all_of(terms_.begin(), terms_.end(), [](const Term* term) { return term->conservative(); });
}

bool System::kinked() const {
  return contact() || std::any_of(terms_.begin(), terms_.end(), [](const Term* term) { return term->kinked(); });
}

bool System::any_dead_load() const {
  return std::any_of(terms_.begin(), terms_.end(), [](const Term* term) { return term->grows(); });
}

}  // namespace softkin::physical
