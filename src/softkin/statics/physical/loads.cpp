#include <softkin/statics/physical/loads.hpp>

namespace softkin::physical {

namespace {

void add_dead_load(const Points& load, double fraction, const Points& rest, const Points& positions, Term::Sum& sum) {
  sum.energy -= fraction * load.cwiseProduct(positions - rest).sum();
  sum.gradient -= fraction * load;
}

}  // namespace

DeadLoads::DeadLoads(const Model& model)
    : model_(model), any_(model.loads.dead.rows() > 0 && !model.loads.dead.isZero(0)) {}

void DeadLoads::evaluate(const Iterate& at, const LoadState& load_state, Scratch& /*scratch*/, Sum& sum,
                         Team& /*team*/) const {
  if (any_) add_dead_load(model_.loads.dead, load_state.load_factor, model_.rest, at.positions, sum);
}

void DeadLoads::add_change(const LoadState& from, const LoadState& to, const Points& /*positions*/,
                           Scratch& /*scratch*/, Points& force, Team& /*team*/) const {
  if (any_) force -= (to.load_factor - from.load_factor) * model_.loads.dead;
}

void FadingLoads::evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                           Team& /*team*/) const {
  if (load_state.fading == 0) return;
  add_dead_load(static_cast<const Scratch&>(scratch).force, load_state.fading, model_.rest, at.positions, sum);
}

void FadingLoads::add_change(const LoadState& from, const LoadState& to, const Points& /*positions*/,
                             Term::Scratch& scratch, Points& force, Team& /*team*/) const {
  if (to.fading != from.fading) force -= (to.fading - from.fading) * static_cast<const Scratch&>(scratch).force;
}

}  // namespace softkin::physical
