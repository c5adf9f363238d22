#include <algorithm>
#include <numeric>
#include <softkin/contact/wide_tree.hpp>

namespace softkin::contact {

WideTree::WideTree(const Points& centres) : items_(centres.rows()) {
  std::iota(items_.begin(), items_.end(), 0);
  sort(centres, 0, size());
  std::size_t blocks = items_.size();
  do {
    blocks = (blocks + 7) / 8;
    levels_.emplace_back(blocks);
  } while (blocks > 1);
}

/// Halves along the longest side until eight are left, so that every cut falls between two blocks of a level.
void WideTree::sort(const Points& centres, Index begin, Index end) {
  const Index count = end - begin;
  if (count <= 8) return;
  Index unit = 8;
  while (unit < (count + 7) / 8) unit *= 8;
  const Index middle = begin + ((count + unit - 1) / unit + 1) / 2 * unit;
  Box box;
  for (Index i = begin; i < end; ++i) box.extend(Vec3(centres.row(items_[i]).transpose()));
  Eigen::Index axis;
  box.sizes().maxCoeff(&axis);
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end, [&](Index a, Index b) {
    const double x = centres(a, axis), y = centres(b, axis);
    return x != y ? x < y : a < b;
  });
  sort(centres, begin, middle);
  sort(centres, middle, end);
}

TreeLevels WideTree::levels(const EightNodes* nodes) const {
  TreeLevels levels{{}, nodes, static_cast<Index>(levels_.size())};
  for (std::size_t i = 0; i < levels_.size(); ++i) levels.boxes[i] = levels_[i].data();
  return levels;
}

MovingBox WideTree::joint(const EightBoxes& boxes) {
  const auto least = [](const double(&values)[8]) { return *std::min_element(values, values + 8); };
  const auto most = [](const double(&values)[8]) { return *std::max_element(values, values + 8); };
  MovingBox box;
  for (int k = 0; k < 3; ++k) {
    box.at.min()[k] = least(boxes.low[k]), box.at.max()[k] = most(boxes.high[k]);
    box.move.min()[k] = least(boxes.min_move[k]), box.move.max()[k] = most(boxes.max_move[k]);
  }
  return box;
}

void WideTree::refit_upper(std::size_t level) {
  const Level& below = levels_[level - 1];
  for (std::size_t i = 0; i < below.size(); ++i) levels_[level][i / 8].set(static_cast<int>(i % 8), joint(below[i]));
}

}  // namespace softkin::contact
