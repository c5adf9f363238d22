#pragma once

#include <softkin/statics/physical/corrector.hpp>

namespace softkin::physical {

/// Moves from an unstable equilibrium along its lowest mode to one of less energy, until it is stable or none is found.
/// Returns false if interrupted.
bool buckle(Corrector& corrector, const LoadState& load_state, Iterate& at);

}  // namespace softkin::physical
