#pragma once

#include <memory>
#include <softkin/model/model.hpp>

namespace softkin {

class BoxTree;  // model/mesh/box_tree.hpp

/// How far a shape passes through itself.
struct SelfOverlap {
  std::size_t points = 0;     // of its surface that lie inside it; 0: none
  double deepest_mm = 0;      // distance of the deepest one to where it would be outside [mm]
  Vec3 where = Vec3::Zero();  // of the deepest one [mm]
};

/// Detects shapes of a robot that pass through themselves.
///
/// body        every element but the air in chambers; prisms as three tetrahedra, tetrahedra of order 2 as eight with
///             straight edges
/// points      every vertex of the body's boundary, walls of chambers included, of order 2 the nodes on edges too: what
///             crosses between them without covering one is not seen
/// inside      in an element that has not the point as its vertex, deeper than 1e-5 of the robot's diagonal;
///             around inverted elements, which lie in their neighbours, nothing counts
/// depth       distance to the nearest boundary that is reached from there through elements no farther away, so that it
///             is that of the part which the point has entered, not that of its own wall
class OverlapSearch {
 public:
  /// Of shapes of this model, which need not outlive the object.
  explicit OverlapSearch(const Model& model);

  /// positions  #V by 3 [mm]; where one is not finite nothing is found
  [[nodiscard]] SelfOverlap in(const Points& positions) const;

 private:
  class Shape;

  std::vector<Tetrahedron> cells_;
  std::vector<Index> surface_;           // vertices of the boundary
  std::shared_ptr<const BoxTree> tree_;  // of the cells at rest
  double min_mm_ = 0;                    // less deep counts as touching
};

}  // namespace softkin
