#pragma once

#include <softkin/core/types.hpp>
#include <softkin/energy/kernels/magnet.hpp>

namespace softkin::energy {

/// Energy of magnets that turn with their elements and do not stretch, -(R m) . b(x) with the rotation R of F = R U,
/// and its gradient, in every lane. Where R is not unique (elements turned inside out, with two stretches of one size)
/// the gradient is large but finite.
///
/// current   positions [mm]
/// gradient  of the energy in the nodes' positions [N]
/// energy    [mJ]
/// source    energy: Mukherjee, Rambausek, Danas, J. Mech. Phys. Solids 151, 2021; derivatives: docs/magnetism.md
template <int K, int Q>
void magnet_force(const MagnetBlock<K, Q>& block, const FluxBlock<Q>& flux, const Shape<K>& current, Shape<K>& gradient,
                  Pack& energy) {
  SOFTKIN_RUN_KERNEL(magnet_force(block, flux, current, gradient, energy));
}

/// Second derivative of that energy. projected: made positive semidefinite at every quadrature point, and no smaller
/// than the exact one: by the nearest such matrix in how it turns and stretches, by a bound in how it moves through a
/// field that changes in space.
template <int K, int Q>
void magnet_stiffness(const MagnetBlock<K, Q>& block, const FluxBlock<Q>& flux, const Shape<K>& current, bool projected,
                      ElasticStiffness<K>& out) {
  SOFTKIN_RUN_KERNEL(magnet_stiffness(block, flux, current, projected, out));
}

}  // namespace softkin::energy
