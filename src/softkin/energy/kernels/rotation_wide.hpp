#pragma once

#include <softkin/energy/kernels/wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

// As in energy/rotation.hpp.
[[nodiscard]] Pack33 to_matrix(const PackRotation& rotation);
void best_rotation(const Pack33& correlation, PackRotation& rotation);

}  // namespace softkin::energy::SOFTKIN_TARGET
