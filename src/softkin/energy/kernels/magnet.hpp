#pragma once

#include <softkin/core/target.hpp>
#include <softkin/energy/magnet_blocks.hpp>

namespace softkin::energy {

// energy/magnet.hpp documents them.
SOFTKIN_KERNELS(template <int K, int Q>
                void magnet_force(const energy::MagnetBlock<K, Q>& block, const energy::FluxBlock<Q>& flux,
                                  const energy::Shape<K>& current, energy::Shape<K>& gradient, energy::Pack& energy);
                template <int K, int Q>
                void magnet_stiffness(const energy::MagnetBlock<K, Q>& block, const energy::FluxBlock<Q>& flux,
                                      const energy::Shape<K>& current, bool projected,
                                      energy::ElasticStiffness<K>& out);)

}  // namespace softkin::energy
