#pragma once

#include <softkin/energy/kernels/wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

// As in energy/turn_response.hpp.
[[nodiscard]] Pack33 turn_response(const Pack33& stiffness);
[[nodiscard]] Pack33 turn_response(const Pack33& stiffness, const Pack33& metric, const Pack& least);

}  // namespace softkin::energy::SOFTKIN_TARGET
