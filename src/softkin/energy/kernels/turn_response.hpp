#pragma once

#include <softkin/core/target.hpp>
#include <softkin/energy/pack.hpp>

namespace softkin::energy {

// energy/turn_response.hpp documents them.
SOFTKIN_KERNELS(void turn_response_of_blocks(const energy::Pack33& stiffness, double* kept);
                void turn_response_of_blocks(const energy::Pack33& stiffness, const energy::Pack33& metric,
                                             const energy::Pack& least, double* kept);)

}  // namespace softkin::energy
