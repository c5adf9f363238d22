#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <softkin/core/team.hpp>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::contact {

using Box = Eigen::AlignedBox3d;

/// Boxes of eight things or of eight groups of them; lanes without any overlap with nothing.
struct alignas(64) EightBoxes {
  double low[3][8], high[3][8];

  EightBoxes() {
    std::fill_n(&low[0][0], 24, std::numeric_limits<double>::infinity());
    std::fill_n(&high[0][0], 24, -std::numeric_limits<double>::infinity());
  }
  void set(int lane, const Box& box) {
    for (int k = 0; k < 3; ++k) low[k][lane] = box.min()[k], high[k][lane] = box.max()[k];
  }
  [[nodiscard]] Box at(int lane) const {
    return {Vec3(low[0][lane], low[1][lane], low[2][lane]), Vec3(high[0][lane], high[1][lane], high[2][lane])};
  }
  /// Bit l: lane l overlaps with the box.
  [[nodiscard]] unsigned overlaps(const Box& box) const;
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

  /// Gives item i the box box_of(i).
  template <class BoxOf>
  void refit(const BoxOf& box_of, Team& team);

  /// Calls visit(group) for every group from `first` on with a box that overlaps with the given one; always in the same
  /// order.
  template <class Visit>
  void visit(const Box& box, Index first, const Visit& visit) const;

 private:
  using Level = std::vector<EightBoxes>;
  static constexpr std::size_t depth = 80;  // of the stack: 7 a level and one more, 11 levels of an Index

  void sort(const Points& centres, Index begin, Index end);
  [[nodiscard]] static Box joint(const EightBoxes& boxes);
  void refit_upper(std::size_t level);

  std::vector<Index> items_;
  std::vector<Level> levels_;  // [0]: of the items; lane l of block b of a level: block 8 b + l of the level below
};

inline unsigned EightBoxes::overlaps(const Box& box) const {
  typedef double Eight __attribute__((vector_size(64)));
  typedef long long Mask __attribute__((vector_size(64)));
  const auto* lows = reinterpret_cast<const Eight*>(low);
  const auto* highs = reinterpret_cast<const Eight*>(high);
  const Vec3 &from = box.min(), &to = box.max();
  const Mask meets = (lows[0] <= to[0]) & (highs[0] >= from[0]) & (lows[1] <= to[1]) & (highs[1] >= from[1]) &
                     (lows[2] <= to[2]) & (highs[2] >= from[2]);
  unsigned bits = 0;
  for (unsigned l = 0; l < 8; ++l) bits |= static_cast<unsigned>(meets[l]) & (1u << l);
  return bits;
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
void WideTree::visit(const Box& box, Index first, const Visit& visit) const {
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
    unsigned bits = levels_[static_cast<std::size_t>(level)][static_cast<std::size_t>(block)].overlaps(box);
    for (; bits != 0; bits &= bits - 1) {
      const Index below = 8 * block + __builtin_ctz(bits);
      // the last of its groups
      const std::int64_t last = ((static_cast<std::int64_t>(below) + 1) << (3 * (level - 1))) - 1;
      if (last >= first) stack[waiting++] = {level - 1, below};
    }
  }
}

}  // namespace softkin::contact
