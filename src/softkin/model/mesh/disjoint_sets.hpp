#pragma once

#include <numeric>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin {

/// Numbers from 0 that are joined to sets.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), Index{0}); }

  /// The number that stands for the set of i.
  Index find(Index i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  void join(Index a, Index b) { parent(find(a)) = find(b); }

 private:
  Index& parent(Index i) { return parents_[i]; }
  std::vector<Index> parents_;
};

}  // namespace softkin
