#pragma once

#include <softkin/core/target.hpp>

namespace softkin::contact {

/// Where eight things or groups of them are, and how their points move: each in a box. Lanes without any overlap with
/// nothing: their boxes are inside out.
struct alignas(64) EightLanes {
  double low[3][8], high[3][8], least_move[3][8], most_move[3][8];
};

/// The vertices that eight things have, by their place in them; -1: none.
struct alignas(32) EightNodes {
  Index node[3][8];

  EightNodes() {
    for (auto& each : node)
      for (Index& one : each) one = -1;
  }
};

/// Levels of a WideTree, that of its items first.
struct TreeLevels {
  const EightLanes* boxes[12];  // 11 levels of eight hold what an Index counts
  const EightNodes* nodes;      // of the items
  Index count;
};

/// Eight things that ask what they may meet.
struct Askers {
  EightLanes boxes;
  const EightNodes* nodes;
  int lanes;    // how many there are
  Index first;  // group of the tree: those before are not looked at
  Index own;    // group that they are themselves, of which each pair is looked at once; -1: none
};

/// Called for what lane `lane` of the askers may meet: bit l, lane l of `group`.
using Met = void (*)(void* context, Index group, int lane, unsigned bits);

SOFTKIN_KERNELS(
    /// Calls met(context, ...) for all that may be met on the way, as moves against each other tell, but for what has a
    /// vertex in common; always in the same order. <0, 0>: vertices are not looked at, nodes may be null.
    template <int of_asker, int of_other>
    void meet(const Askers& askers, const TreeLevels& tree, Met met, void* context);)

}  // namespace softkin::contact
