#include <algorithm>
#include <numeric>
#include <softkin/model/mesh/box_tree.hpp>

namespace softkin {

BoxTree::BoxTree(const std::vector<Bounds>& bounds) : items_(bounds.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  if (!items_.empty()) build(bounds, 0, items_.size());
}

void BoxTree::build(const std::vector<Bounds>& bounds, Index begin, Index end) {
  Node node;
  node.begin = begin;
  node.end = end;
  Bounds centers;
  for (Index i = begin; i < end; ++i) {
    node.bounds.extend(bounds[items_[i]]);
    centers.extend(bounds[items_[i]].center());
  }
  const std::size_t at = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= leaf_size) return;

  Index axis = 0;
  centers.sizes().maxCoeff(&axis);
  const Index middle = begin + (end - begin) / 2;
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end, [&](Index a, Index b) {
    const double ca = bounds[a].center()[axis], cb = bounds[b].center()[axis];
    return ca != cb ? ca < cb : a < b;
  });
  build(bounds, begin, middle);
  nodes_[at].right = nodes_.size();
  build(bounds, middle, end);
}

void BoxTree::refit(const std::vector<Bounds>& bounds) {
  for (std::size_t at = nodes_.size(); at-- > 0;) {  // children stand behind their parents
    Node& node = nodes_[at];
    node.bounds.setEmpty();
    if (node.right != 0) {
      node.bounds = nodes_[at + 1].bounds.merged(nodes_[node.right].bounds);
    } else {
      for (Index i = node.begin; i < node.end; ++i) node.bounds.extend(bounds[items_[i]]);
    }
  }
}

bool BoxTree::meets(const Bounds& bounds, const Vec3& origin, const Vec3& direction) {
  double first = 0, last = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = bounds.min()[axis] - origin[axis], high = bounds.max()[axis] - origin[axis];
    if (direction[axis] == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double a = low / direction[axis], b = high / direction[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

}  // namespace softkin
