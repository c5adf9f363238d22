#pragma once

#include <softkin/linear/front_tree.hpp>
#include <softkin/linear/kernels/front.hpp>
#include <vector>

namespace softkin::bench {

/// How far a factorisation can be shared, by counts of multiplications: no memory, no caches, no waking of threads.
struct CriticalPath {
  double total = 0, heaviest = 0, top = 0;  // multiplications: all, of the heaviest piece, above the pieces
  int pieces = 0;                           // of which each is one core's

  /// Returns the ratio of the total work to the work along the critical path on `cores` cores, with the scheduling of
  /// linear::SparseLdlt.
  [[nodiscard]] double speedup(int cores) const;

  /// Work on a front above the pieces: the part that a single core does, and the part that all cores can divide.
  struct Part {
    double alone = 0, shared = 0;
  };
  std::vector<double> piece_work;
  std::vector<Part> top_parts;
};

[[nodiscard]] CriticalPath critical_path(const linear::FrontTree& tree);

}  // namespace softkin::bench
