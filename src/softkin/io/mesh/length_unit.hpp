#pragma once

#include <string>
#include <vector>

namespace softkin {

/// Names of the units of length that files may be in: mm, cm, m, um, in.
[[nodiscard]] const std::vector<std::string>& length_units();

/// Millimetres in one unit. Throws std::out_of_range where the name is none of length_units().
[[nodiscard]] double mm_per(const std::string& unit);

}  // namespace softkin
