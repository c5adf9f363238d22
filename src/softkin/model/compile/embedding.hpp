#pragma once

#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// Finds the element with which a point moves. Prisms count as three tetrahedra each, split along the diagonals from
/// the smallest vertex index, so that neighbours agree.
class Embedder {
 public:
  /// vertices    #V by 3 [mm]; elements with positive volume
  /// edge_nodes  order 2: of every tetrahedron, and there are no prisms; order 1: empty
  Embedder(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms,
           const std::vector<EdgeNodes>& edge_nodes = {});

  [[nodiscard]] bool empty() const { return tetrahedra_.empty(); }

  /// The point as a weighted sum of vertices of the nearest tetrahedron: its barycentric coordinates, extrapolated
  /// where it lies outside; of equally near ones that which extrapolates least. Weights below 1e-12 are dropped.
  /// Order 2: the nearest by its corners, with the quadratic shape functions, which are continued linearly outside it.
  ///
  /// throws  InvalidInput where there is no element, the point is not finite, or the nearest element is so strongly
  ///         curved that no coordinates in it give the point
  [[nodiscard]] EmbeddedPoint embed(const Vec3& point) const;

  /// A piece of a straight line, between two fractions of its length.
  struct Piece {
    Index element = -1;
    double begin = 0, end = 0;
  };
  /// Returns the pieces of a straight line that move with one element each, in order: cut where the line leaves an
  /// element, by its corners; outside of all in pieces of an eighth of the nearest element's longest edge.
  [[nodiscard]] std::vector<Piece> pieces(const Vec3& from, const Vec3& to) const;
  /// As embed(), by the element of a piece.
  [[nodiscard]] EmbeddedPoint embed_in(Index element, const Vec3& point) const;

  /// The longest edge of the element of a piece, of its corners [mm].
  [[nodiscard]] double edge_of(Index element) const;
  /// The longest edge of the element that carries the point, of its corners [mm]. There must be an element.
  [[nodiscard]] double edge_near(const Vec3& point) const;

 private:
  struct Nearest {
    Index element = -1;
    double distance = 0;
    Barycentric coordinates;  // by the corners
  };
  [[nodiscard]] Nearest nearest(const Vec3& point) const;
  [[nodiscard]] Nearest seen_from(Index element, const Vec3& point) const;
  [[nodiscard]] EmbeddedPoint weighted(const Nearest& by, const Vec3& point) const;
  /// Of order 2: weights in an element whose corners give the point the coordinates; distance is updated.
  [[nodiscard]] TetrahedronWeights quadratic_weights(Index element, const Vec3& point, Barycentric coordinates,
                                                     double& distance) const;

  Points vertices_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<EdgeNodes> edge_nodes_;
  BoxTree tree_;
  double tolerance_ = 0;  // distances that differ by less are the same [mm]
};

/// The mean of a region as weights of its vertices: of its volume (dimension 3), its area (2), else of its vertices.
/// A triangle or a tetrahedron of order 1 acts at its centroid, one of order 2 by the integrals of its shape functions
/// (straight edges: a third at a triangle's edges and nothing at its corners, 1/5 and -1/20 in a tetrahedron); a quad
/// as the mean of its two triangulations.
///
/// throws  InvalidInput where the region has no volume, area or vertex to take the mean of, or a triangle that is not
///         a face of an element of order 2
[[nodiscard]] EmbeddedPoint mean_of(const Region& region, const Mesh& mesh, const EdgeTable& edges);
[[nodiscard]] inline EmbeddedPoint mean_of(const Region& region, const Mesh& mesh) {
  return mean_of(region, mesh, EdgeTable(mesh));
}

}  // namespace softkin
