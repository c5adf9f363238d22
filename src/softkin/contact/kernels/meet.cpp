#include <softkin/contact/kernels/meet.hpp>
#include <softkin/core/lanes.hpp>

namespace softkin::contact::SOFTKIN_TARGET {

namespace {

using namespace softkin::SOFTKIN_TARGET;

/// Bit l: lane l of a comparison holds. Broad phases are little more than this, and no compiler finds the instruction.
template <class Lanes>
[[gnu::always_inline]] inline unsigned bits_of(const Lanes& lanes) {
#if defined(__AVX512DQ__)
  if constexpr (sizeof(Lanes) == 64) return _mm512_movepi64_mask((__m512i)lanes);
#endif
#if defined(__AVX2__)
  if constexpr (sizeof(Lanes) == 32 && sizeof(lanes[0]) == 8)
    return static_cast<unsigned>(_mm256_movemask_pd((__m256d)lanes));
  if constexpr (sizeof(Lanes) == 32 && sizeof(lanes[0]) == 4)
    return static_cast<unsigned>(_mm256_movemask_ps((__m256)lanes));
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(Lanes) == 16 && sizeof(lanes[0]) == 8)
    return static_cast<unsigned>(_mm_movemask_pd((__m128d)lanes));
  if constexpr (sizeof(Lanes) == 16 && sizeof(lanes[0]) == 4)
    return static_cast<unsigned>(_mm_movemask_ps((__m128)lanes));
#endif
  unsigned bits = 0;
  for (unsigned l = 0; l < sizeof(Lanes) / sizeof(lanes[0]); ++l) bits |= static_cast<unsigned>(lanes[l]) & (1u << l);
  return bits;
}

/// As EightLanes, of one.
struct One {
  double low[3], high[3], min_move[3], max_move[3];
};

One lane_of(const EightLanes& boxes, int lane) {
  One one;
  for (int k = 0; k < 3; ++k) {
    one.low[k] = boxes.low[k][lane], one.high[k] = boxes.high[k][lane];
    one.min_move[k] = boxes.min_move[k][lane], one.max_move[k] = boxes.max_move[k][lane];
  }
  return one;
}

/// Around them all.
One joint(const EightLanes& boxes) {
  One one = lane_of(boxes, 0);
  const auto lower = [](double& least, double value) { least = value < least ? value : least; };
  const auto raise = [](double& most, double value) { most = value > most ? value : most; };
  for (int lane = 1; lane < 8; ++lane)
    for (int k = 0; k < 3; ++k) {
      lower(one.low[k], boxes.low[k][lane]), raise(one.high[k], boxes.high[k][lane]);
      lower(one.min_move[k], boxes.min_move[k][lane]), raise(one.max_move[k], boxes.max_move[k][lane]);
    }
  return one;
}

/// Bit l: something of lane l may meet something of the box during the motion.
unsigned may_meet(const EightLanes& boxes, const One& box) {
  constexpr int each = lanes_of<double>;
  unsigned bits = 0;
  for (int first = 0; first < 8; first += each) {
    decltype(Vector<double>{} < Vector<double>{}) meets;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](const double(&values)[3][8]) { return load(&values[k][first]); };
      // moves of the box relative to the lanes, and the range of its relative positions during the motion
      const Vector<double> none{}, back = box.min_move[k] - at(boxes.max_move),
                                   forth = box.max_move[k] - at(boxes.min_move);
      const Vector<double> from = box.low[k] + (back < 0 ? back : none), to = box.high[k] + (forth > 0 ? forth : none);
      const auto here = (at(boxes.low) <= to) & (at(boxes.high) >= from);
      meets = k == 0 ? here : meets & here;
    }
    bits |= bits_of(meets) << first;
  }
  return bits;
}

/// Bit l: what is in lane l has a vertex of what is in a lane of others, of which each has so many.
template <int of_eight, int of_other>
unsigned that_fraction(const EightNodes& eight, const EightNodes& others, int lane) {
  constexpr int bytes = vector_bytes < 32 ? vector_bytes : 32, each = bytes / static_cast<int>(sizeof(Index));
  typedef Index Some __attribute__((vector_size(bytes)));
  unsigned bits = 0;
  for (int first = 0; first < 8; first += each) {
    Some same{};
    for (int i = 0; i < of_eight; ++i) {
      Some nodes;
      std::memcpy(&nodes, &eight.node[i][first], sizeof nodes);
      for (int j = 0; j < of_other; ++j) same |= nodes == others.node[j][lane];
    }
    bits |= bits_of(same) << first;
  }
  return bits;
}

/// What lanes of the askers may meet in one group.
template <int of_asker, int of_other>
void meet_group(const Askers& askers, const One (&each)[8], const TreeLevels& tree, Index group, Met met,
                void* context) {
  const EightLanes& boxes = tree.boxes[0][group];
  const One around = tree.count == 1 ? joint(boxes) : lane_of(tree.boxes[1][group / 8], group % 8);
  for (unsigned some = may_meet(askers.boxes, around); some != 0; some &= some - 1) {
    const int lane = __builtin_ctz(some);
    unsigned bits = may_meet(boxes, each[lane]);
    if constexpr (of_asker > 0) bits &= ~that_fraction<of_other, of_asker>(tree.nodes[group], *askers.nodes, lane);
    if (group == askers.own) bits &= ~0u << (lane + 1);
    if (bits != 0) met(context, group, lane, bits);
  }
}

}  // namespace

template <int of_asker, int of_other>
void meet(const Askers& askers, const TreeLevels& tree, Met met, void* context) {
  constexpr int depth = 80;  // of the stack: 7 a level and one more, 11 levels of an Index
  struct Place {
    Index level, block;
  };
  Place stack[depth];
  int waiting = 0;
  const One around = joint(askers.boxes);
  One each[8];
  for (int lane = 0; lane < askers.lanes; ++lane) each[lane] = lane_of(askers.boxes, lane);
  stack[waiting++] = {tree.count - 1, 0};
  while (waiting > 0) {
    const Place at = stack[--waiting];
    if (at.level == 0) {
      meet_group<of_asker, of_other>(askers, each, tree, at.block, met, context);
      continue;
    }
    for (unsigned bits = may_meet(tree.boxes[at.level][at.block], around); bits != 0; bits &= bits - 1) {
      const Index below = 8 * at.block + __builtin_ctz(bits);
      // the last of its groups
      const std::int64_t last = ((static_cast<std::int64_t>(below) + 1) << (3 * (at.level - 1))) - 1;
      if (last >= askers.first) stack[waiting++] = {at.level - 1, below};
    }
  }
}

template void meet<0, 0>(const Askers&, const TreeLevels&, Met, void*);
template void meet<1, 3>(const Askers&, const TreeLevels&, Met, void*);
template void meet<2, 2>(const Askers&, const TreeLevels&, Met, void*);

}  // namespace softkin::contact::SOFTKIN_TARGET
