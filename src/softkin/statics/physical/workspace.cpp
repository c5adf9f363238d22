#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

namespace {

std::vector<std::unique_ptr<Term::Scratch>> scratches(const std::vector<const Term*>& terms) {
  std::vector<std::unique_ptr<Term::Scratch>> all;
  for (const Term* term : terms) all.push_back(term->new_scratch());
  return all;
}

Layers::Scratch* scratch_of_layers(const System& system, const std::vector<std::unique_ptr<Term::Scratch>>& all) {
  for (std::size_t t = 0; t < all.size(); ++t)
    if (system.terms()[t] == system.layers()) return &static_cast<Layers::Scratch&>(*all[t]);
  return nullptr;
}

/// Single precision is tried where the stiffness is positive, which it is not with pressures.
Saddle::Precision usual_precision(const System& system) {
  if (system.pressures()) return Saddle::Precision::twice;
  return system.contacts() ? Saddle::Precision::good : Saddle::Precision::enough;
}

}  // namespace

Workspace::Workspace(const System& system)
    : terms(scratches(system.terms())),
      elastic(static_cast<Body::Scratch&>(*terms[0])),
      fading(static_cast<FadingLoads::Scratch&>(*terms[2])),
      contacts(system.contacts() ? &static_cast<Contacts::Scratch&>(*terms.back()) : nullptr),
      layers(scratch_of_layers(system, terms)),
      stiffness{.layout = system.layout(),
                .slots = LargeVector<double>(9 * static_cast<std::size_t>(system.layout()->slots))},
      slopes(system.model().actuators.size()),
      saddle(system.measures(), stiffness.layout, usual_precision(system)) {}

}  // namespace softkin::physical
