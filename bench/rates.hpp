#pragma once

#include <softkin/core/team.hpp>

namespace softkin::bench {

/// What the machine can do, measured: the most of several runs.
struct Rates {
  double dgemm = 0;      // C = A B, 960 x 960 on every thread (Eigen) [flop/s]
  double front = 0;      // softkin's LDL^T of a dense front of 4000 [flop/s]
  double bandwidth = 0;  // a = b + s c over 3 arrays far larger than the caches [byte/s]
};

[[nodiscard]] Rates measure_rates(Team& team);

}  // namespace softkin::bench
