#pragma once

#include <string>
#include <vector>

namespace softkin::bench {

/// Seconds of a clock that only goes forward.
[[nodiscard]] double now();

/// throws  InvalidInput on an empty list
[[nodiscard]] double median(std::vector<double> values);

/// Exponent of the growth of times with sizes: slope of the logarithms by least squares; two values or more, all > 0.
[[nodiscard]] double growth(const std::vector<double>& sizes, const std::vector<double>& times);

/// Processor, cores, memory, compiler and flags, in a line or two.
[[nodiscard]] std::string machine_text();

}  // namespace softkin::bench
