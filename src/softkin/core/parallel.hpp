#pragma once

#include <omp.h>

#include <softkin/core/types.hpp>

namespace softkin {

/// Calls body(begin, end) on `threads` contiguous pieces of [0, count); threads = 0: as many as the machine has.
/// body must not throw. The pieces depend on `threads`, so body's result must not.
template <class Body>
void parallel_pieces(Index count, int threads, const Body& body) {
  const int team = threads > 0 ? threads : omp_get_num_procs();
  if (team == 1 || count < 2) {
    body(Index{0}, count);
    return;
  }
#pragma omp parallel num_threads(team)
  {
    const std::int64_t part = omp_get_thread_num(), parts = omp_get_num_threads();
    body(static_cast<Index>(count * part / parts), static_cast<Index>(count * (part + 1) / parts));
  }
}

}  // namespace softkin
