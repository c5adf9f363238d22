#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <softkin/core/team.hpp>
#include <softkin/core/types.hpp>
#include <vector>
#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace softkin::contact {

using Box = Eigen::AlignedBox3d;

/// Where a thing is, and how its points move: each in a box.
struct MovingBox {
  Box at, move;

  void extend(const MovingBox& other) {
    at.extend(other.at);
    move.extend(other.move);
  }
};

/// Eight things or groups of them; lanes without any overlap with nothing.
struct alignas(64) EightBoxes {
  double low[3][8], high[3][8], least_move[3][8], most_move[3][8];

  EightBoxes() {
    for (double* all : {&low[0][0], &least_move[0][0]}) std::fill_n(all, 24, std::numeric_limits<double>::infinity());
    for (double* all : {&high[0][0], &most_move[0][0]}) std::fill_n(all, 24, -std::numeric_limits<double>::infinity());
  }
  void set(int lane, const MovingBox& box) {
    for (int k = 0; k < 3; ++k) {
      low[k][lane] = box.at.min()[k], high[k][lane] = box.at.max()[k];
      least_move[k][lane] = box.move.min()[k], most_move[k][lane] = box.move.max()[k];
    }
  }
  [[nodiscard]] MovingBox at(int lane) const {
    const auto place = [lane](const double(&values)[3][8]) {
      return Vec3(values[0][lane], values[1][lane], values[2][lane]);
    };
    return {{place(low), place(high)}, {place(least_move), place(most_move)}};
  }
  /// Bit l: something of lane l may meet something of the box on the way, as moves against each other tell.
  [[nodiscard]] unsigned may_meet(const MovingBox& box) const;
};

/// A tree of axis-aligned boxes with eight branches at every node. Its order is chosen once; boxes come and go.
class WideTree {
 public:
  /// centres  of the items at rest; those that are near each other come to stand together
  explicit WideTree(const Points& centres);

  [[nodiscard]] Index size() const { return static_cast<Index>(items_.size()); }
  /// Groups of eight items that stand together.
  [[nodiscard]] Index groups() const { return static_cast<Index>(levels_[0].size()); }
  /// Item in a lane of a group; only lanes of items.
  [[nodiscard]] Index item(Index group, int lane) const { return items_[static_cast<std::size_t>(8 * group + lane)]; }
  [[nodiscard]] const EightBoxes& boxes(Index group) const { return levels_[0][static_cast<std::size_t>(group)]; }
  /// Around them all.
  [[nodiscard]] static MovingBox joint(const EightBoxes& boxes);
  [[nodiscard]] MovingBox box(Index group) const {
    if (levels_.size() == 1) return joint(boxes(group));
    return levels_[1][static_cast<std::size_t>(group) / 8].at(group % 8);
  }

  /// Gives item i the box box_of(i).
  template <class BoxOf>
  void refit(const BoxOf& box_of, Team& team);

  /// Calls visit(group) for every group from `first` on of which one may meet the given box; always in the same order.
  template <class Visit>
  void visit(const MovingBox& box, Index first, const Visit& visit) const;

 private:
  using Level = std::vector<EightBoxes>;
  static constexpr std::size_t depth = 80;  // of the stack: 7 a level and one more, 11 levels of an Index

  void sort(const Points& centres, Index begin, Index end);
  void refit_upper(std::size_t level);

  std::vector<Index> items_;
  std::vector<Level> levels_;  // [0]: of the items; lane l of block b of a level: block 8 b + l of the level below
};

/// The vertices that eight things have, by their place in them; -1: none.
struct alignas(32) EightNodes {
  Index node[3][8];

  EightNodes() { std::fill_n(&node[0][0], 24, Index{-1}); }
};

typedef double Eight __attribute__((vector_size(64)));
typedef long long Mask __attribute__((vector_size(64)));
typedef int EightIndices __attribute__((vector_size(32)));

/// Bit l: lane l is all ones, else it is 0. may_meet is little more than this, and no compiler finds the instruction.
template <class Lanes>
unsigned bits_of(Lanes lanes) {
#ifdef __AVX512DQ__
  if constexpr (sizeof(Lanes) == 64) return _mm512_movepi64_mask(reinterpret_cast<__m512i>(lanes));
#endif
#ifdef __AVX2__
  if constexpr (sizeof(Lanes) == 32) return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(lanes)));
#endif
  unsigned bits = 0;
  for (unsigned l = 0; l < 8; ++l) bits |= static_cast<unsigned>(lanes[l]) & (1u << l);
  return bits;
}

/// Bit l: what is in lane l has a vertex of what is in a lane of others, of which each has so many.
template <int of_eight, int of_other>
unsigned that_share(const EightNodes& eight, const EightNodes& others, int lane) {
  EightIndices same{};
  for (int i = 0; i < of_eight; ++i)
    for (int j = 0; j < of_other; ++j)
      same |= reinterpret_cast<const EightIndices&>(eight.node[i]) == others.node[j][lane];
  return bits_of(same);
}

inline unsigned EightBoxes::may_meet(const MovingBox& box) const {
  const auto at = [](const double(&values)[3][8], int k) { return reinterpret_cast<const Eight*>(values)[k]; };
  Mask meets = ~Mask{};
  for (int k = 0; k < 3; ++k) {
    // moves of the box against the lanes, and where it is on the way, seen from them
    const Eight back = box.move.min()[k] - at(most_move, k), forth = box.move.max()[k] - at(least_move, k);
    const Eight from = box.at.min()[k] + (back < 0 ? back : Eight{}),
                to = box.at.max()[k] + (forth > 0 ? forth : Eight{});
    meets &= (at(low, k) <= to) & (at(high, k) >= from);
  }
  return bits_of(meets);
}

template <class BoxOf>
void WideTree::refit(const BoxOf& box_of, Team& team) {
  team.pieces(groups(), [&](Index begin, Index end) {
    for (Index group = begin; group < end; ++group) {
      EightBoxes& boxes = levels_[0][static_cast<std::size_t>(group)];
      const int lanes = static_cast<int>(std::min<Index>(8, size() - 8 * group));
      for (int lane = 0; lane < lanes; ++lane) boxes.set(lane, box_of(item(group, lane)));
      if (levels_.size() > 1) levels_[1][static_cast<std::size_t>(group / 8)].set(group % 8, joint(boxes));
    }
  });
  for (std::size_t level = 2; level < levels_.size(); ++level) refit_upper(level);
}

template <class Visit>
void WideTree::visit(const MovingBox& box, Index first, const Visit& visit) const {
  struct Place {
    std::int32_t level;
    Index block;
  };
  if (size() == 0) return;
  std::array<Place, depth> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {static_cast<std::int32_t>(levels_.size()) - 1, 0};
  while (waiting > 0) {
    const auto [level, block] = stack[--waiting];
    if (level == 0) {
      visit(block);
      continue;
    }
    unsigned bits = levels_[static_cast<std::size_t>(level)][static_cast<std::size_t>(block)].may_meet(box);
    for (; bits != 0; bits &= bits - 1) {
      const Index below = 8 * block + __builtin_ctz(bits);
      // the last of its groups
      const std::int64_t last = ((static_cast<std::int64_t>(below) + 1) << (3 * (level - 1))) - 1;
      if (last >= first) stack[waiting++] = {level - 1, below};
    }
  }
}

}  // namespace softkin::contact
