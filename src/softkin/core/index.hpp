#pragma once

#include <cstdint>

namespace softkin {

using Index = std::int32_t;  // of vertices, elements, actuators and what else is counted; -1 often stands for none

}  // namespace softkin
