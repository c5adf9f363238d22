#pragma once

#include <softkin/core/target.hpp>

namespace softkin::contact {

/// Where eight things or groups of them are, and how their points move: each in a box. Lanes without any overlap with
/// nothing: their boxes are inside out.
struct alignas(64) EightLanes {
  double low[3][8], high[3][8], min_move[3][8], max_move[3][8];
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
    /// Calls met(context, ...) for all pairs whose boxes may meet during the motion, by their relative moves, except
    /// for pairs with a common vertex; always in the same order. <0, 0>: vertices are not compared, nodes may be null.
    template <int of_asker, int of_other>
    void meet(const Askers& askers, const TreeLevels& tree, Met met, void* context);)

}  // namespace softkin::contact
