#pragma once

#include <softkin/statics/physical/settling.hpp>

namespace softkin::physical {

/// From an unstable equilibrium along its lowest mode to one of less energy, until it is stable or none is found.
/// False: interrupted.
bool buckle(Settler& settler, const Demand& demand, Iterate& at);

}  // namespace softkin::physical
