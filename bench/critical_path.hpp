#pragma once

#include <softkin/linear/front_tree.hpp>
#include <softkin/linear/kernels/front.hpp>
#include <vector>

namespace softkin::bench {

/// How far a factorisation can be shared, by counts of multiplications: no memory, no caches, no waking of threads.
struct CriticalPath {
  double total = 0, heaviest = 0, top = 0;  // multiplications: all, of the heaviest piece, above the pieces
  int pieces = 0;                           // of which each is one core's

  /// Work over the longest way through it on so many cores, which take what linear::SparseLdlt hands out.
  [[nodiscard]] double speedup(int cores) const;

  /// What one core does of a front of the top, and what all may share.
  struct Part {
    double alone = 0, shared = 0;
  };
  std::vector<double> piece_work;
  std::vector<Part> top_parts;
};

[[nodiscard]] CriticalPath critical_path(const linear::FrontTree& tree);

}  // namespace softkin::bench
