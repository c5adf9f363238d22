#pragma once

#include <softkin/core/team.hpp>
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

/// C = A B, 960 x 960 on every thread, by Eigen with the instructions that softkin runs with: the most of several runs
/// [flop/s].
template <class Number>
[[nodiscard]] double product_rate(Team& team);

/// What the machine can do, measured: the most of several runs.
struct Rates {
  double dgemm = 0;      // product_rate<double>() [flop/s]
  double front = 0;      // softkin's LDL^T of a dense front of 4000 [flop/s]
  double bandwidth = 0;  // a = b + s c over 3 arrays far larger than the caches [byte/s]
};

[[nodiscard]] Rates measure_rates(Team& team);

}  // namespace softkin::bench
