#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <softkin/contact/kernels/meet.hpp>
#include <softkin/core/team.hpp>
#include <softkin/core/types.hpp>
#include <vector>

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
struct EightBoxes : EightLanes {
  EightBoxes() {
    for (double* all : {&low[0][0], &min_move[0][0]}) std::fill_n(all, 24, std::numeric_limits<double>::infinity());
    for (double* all : {&high[0][0], &max_move[0][0]}) std::fill_n(all, 24, -std::numeric_limits<double>::infinity());
  }
  void set(int lane, const MovingBox& box) {
    for (int k = 0; k < 3; ++k) {
      low[k][lane] = box.at.min()[k], high[k][lane] = box.at.max()[k];
      min_move[k][lane] = box.move.min()[k], max_move[k][lane] = box.move.max()[k];
    }
  }
  [[nodiscard]] MovingBox at(int lane) const {
    const auto place = [lane](const double(&values)[3][8]) {
      return Vec3(values[0][lane], values[1][lane], values[2][lane]);
    };
    return {{place(low), place(high)}, {place(min_move), place(max_move)}};
  }
};

/// met(group, lane, bits) as the kernel says.
template <int of_asker, int of_other, class Callback>
void run_meet(const Askers& askers, const TreeLevels& tree, const Callback& met) {
  const Met call = [](void* context, Index group, int lane, unsigned bits) {
    (*static_cast<const Callback*>(context))(group, lane, bits);
  };
  void* context = const_cast<Callback*>(&met);
  SOFTKIN_RUN_KERNEL(meet<of_asker, of_other>(askers, tree, call, context));
}

/// A tree of axis-aligned boxes with eight branches at every node. Its order is chosen once; boxes come and go.
class WideTree {
 public:
  /// centres  of the items at rest; those that are near each other come to stand together
  explicit WideTree(const Points& centres);

  [[nodiscard]] Index size() const { return items_.size(); }
  /// Groups of eight items that stand together.
  [[nodiscard]] Index groups() const { return levels_[0].size(); }
  /// Item in a lane of a group; only lanes of items.
  [[nodiscard]] Index item(Index group, int lane) const { return items_[8 * group + lane]; }
  [[nodiscard]] const EightBoxes& boxes(Index group) const { return levels_[0][group]; }
  /// Around them all.
  [[nodiscard]] static MovingBox joint(const EightBoxes& boxes);
  [[nodiscard]] MovingBox box(Index group) const {
    if (levels_.size() == 1) return joint(boxes(group));
    return levels_[1][static_cast<std::size_t>(group) / 8].at(group % 8);
  }

  /// Gives item i the box box_of(i).
  template <class BoxOf>
  void refit(const BoxOf& box_of, Team& team);

  /// Levels as kernels take them, as long as the tree stands.
  [[nodiscard]] TreeLevels levels(const EightNodes* nodes) const;

  /// visit(item) for every item that may meet the box.
  template <class Visit>
  void each_met(const MovingBox& box, const Visit& visit) const {
    if (size() == 0) return;
    EightBoxes boxes;
    boxes.set(0, box);
    run_meet<0, 0>({boxes, nullptr, 1, 0, -1}, levels(nullptr), [&](Index group, int, unsigned bits) {
      for (; bits != 0; bits &= bits - 1) visit(item(group, __builtin_ctz(bits)));
    });
  }

 private:
  using Level = std::vector<EightBoxes>;

  void sort(const Points& centres, Index begin, Index end);
  void refit_upper(std::size_t level);

  std::vector<Index> items_;
  std::vector<Level> levels_;  // [0]: of the items; lane l of block b of a level: block 8 b + l of the level below
};

template <class BoxOf>
void WideTree::refit(const BoxOf& box_of, Team& team) {
  team.pieces(groups(), [&](Index begin, Index end) {
    for (Index group = begin; group < end; ++group) {
      EightBoxes& boxes = levels_[0][group];
      const int lanes = static_cast<int>(std::min<Index>(8, size() - 8 * group));
      for (int lane = 0; lane < lanes; ++lane) boxes.set(lane, box_of(item(group, lane)));
      if (levels_.size() > 1) levels_[1][group / 8].set(group % 8, joint(boxes));
    }
  });
  for (std::size_t level = 2; level < levels_.size(); ++level) refit_upper(level);
}

}  // namespace softkin::contact
