#pragma once

#include <cstdint>

namespace softkin {

using Index = std::int32_t;

}  // namespace softkin
