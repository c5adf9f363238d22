#pragma once

#include <softkin/model/box_tree.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// Finds, for a point, the element that carries it along. Prisms count as three tetrahedra each, split along the
/// diagonals from the smallest vertex index, so that neighbours agree.
class Embedder {
 public:
  /// vertices  #V by 3 [mm]; elements with positive volume
  Embedder(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms);

  [[nodiscard]] bool empty() const { return tetrahedra_.empty(); }

  /// The point as a weighted sum of vertices of the nearest tetrahedron: its barycentric coordinates, extrapolated
  /// where it lies outside; of equally near ones that which extrapolates least. Weights below 1e-12 are dropped.
  ///
  /// throws  InvalidInput where there is no element, or the point is not finite
  [[nodiscard]] EmbeddedPoint embed(const Vec3& point) const;

 private:
  Points vertices_;
  std::vector<Tetrahedron> tetrahedra_;
  BoxTree tree_;
  double tolerance_ = 0;  // distances that differ by less are the same [mm]
};

}  // namespace softkin
