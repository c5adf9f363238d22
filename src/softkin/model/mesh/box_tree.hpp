#pragma once

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <softkin/core/types.hpp>
#include <utility>
#include <vector>

namespace softkin {

using Bounds = Eigen::AlignedBox3d;

/// A balanced tree of axis-aligned boxes: answers in logarithmic time which items may be near a point or on a ray.
class BoxTree {
 public:
  /// bounds  one box per item; the tree is empty where there is none
  explicit BoxTree(const std::vector<Bounds>& bounds);

  /// Calls visit(item), near boxes first, until no box is left whose squared distance from the point is at most the
  /// last value that visit returned (the squared distance within which the caller still searches).
  template <class Visit>
  void visit_near(const Vec3& point, const Visit& visit) const;

  /// The same items with other boxes; the fewer of them have changed places among each other, the faster it stays.
  void refit(const std::vector<Bounds>& bounds);

  /// Calls visit(item) for every item whose box holds the point, until visit returns false.
  template <class Visit>
  void visit_at(const Vec3& point, const Visit& visit) const;

  /// Calls visit(item) for every item whose box the ray origin + t direction, t >= 0, meets, until visit returns false.
  template <class Visit>
  void visit_ray(const Vec3& origin, const Vec3& direction, const Visit& visit) const;

  [[nodiscard]] bool contains(const Vec3& point) const { return !nodes_.empty() && nodes_[0].bounds.contains(point); }

 private:
  struct Node {
    Bounds bounds;
    Index begin = 0, end = 0;  // items_[begin, end)
    Index right = 0;           // second child, the first one follows its parent; 0: a leaf
  };
  static constexpr Index leaf_size = 4;
  static constexpr std::size_t depth = 80;  // of the stacks: halving an Index range of items takes 31 levels

  template <class Where, class Visit>
  void visit_where(const Where& where, const Visit& visit) const;
  void build(const std::vector<Bounds>& bounds, Index begin, Index end);
  static bool meets(const Bounds& bounds, const Vec3& origin, const Vec3& direction);

  std::vector<Index> items_;
  std::vector<Node> nodes_;
};

template <class Visit>
void BoxTree::visit_near(const Vec3& point, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<std::pair<double, Index>, depth> stack;
  std::size_t size = 0;
  double limit = std::numeric_limits<double>::infinity();
  stack[size++] = {nodes_[0].bounds.squaredExteriorDistance(point), 0};
  while (size > 0) {
    const auto [distance, at] = stack[--size];
    if (distance > limit) continue;
    const Node& node = nodes_[at];
    if (node.right == 0) {
      for (Index i = node.begin; i < node.end; ++i) limit = visit(items_[i]);
      continue;
    }
    std::pair<double, Index> near{nodes_[at + 1].bounds.squaredExteriorDistance(point), at + 1};
    std::pair<double, Index> far{nodes_[node.right].bounds.squaredExteriorDistance(point), node.right};
    if (far.first < near.first) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
}

template <class Visit>
void BoxTree::visit_at(const Vec3& point, const Visit& visit) const {
  visit_where([&](const Bounds& bounds) { return bounds.contains(point); }, visit);
}

template <class Visit>
void BoxTree::visit_ray(const Vec3& origin, const Vec3& direction, const Visit& visit) const {
  visit_where([&](const Bounds& bounds) { return meets(bounds, origin, direction); }, visit);
}

template <class Where, class Visit>
void BoxTree::visit_where(const Where& where, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<Index, depth> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Index at = stack[--size];
    const Node& node = nodes_[at];
    if (!where(node.bounds)) continue;
    if (node.right != 0) {
      stack[size++] = node.right;
      stack[size++] = at + 1;
      continue;
    }
    for (Index i = node.begin; i < node.end; ++i)
      if (!visit(items_[i])) return;
  }
}

}  // namespace softkin
