#pragma once

#include <softkin/contact/candidates.hpp>
#include <softkin/model/model.hpp>
#include <vector>

namespace softkin::physical {

/// The corners of the flat triangles of contact surfaces: the nodes, except that the point of a node on an edge of
/// order 2 lies beyond it by a third of the height of the edge's arc. A uniform pressure on the four flat triangles of
/// a face then gives the consistent loads of its six nodes, and the triangles bound the volume that the face does.
///
/// equation  of a node m between a and b: 4/3 x_m - (x_a + x_b) / 6. Of a pressure the triangles give 1/12 of the face
///           to each corner and 1/4 to each point between: 1/4 4/3 = 1/3 to a node m, 1/12 - 2 (1/4 1/6) = 0 to a
///           corner, as the integrals of the shape functions
class ContactPoints {
 public:
  /// model must outlive the object
  explicit ContactPoints(const Model& model);

  /// Are all points nodes: order 1?
  [[nodiscard]] bool are_nodes() const { return edges_.empty(); }

  /// Returns the points of positions or moves of the nodes: the argument itself, or `room`, into which they are
  /// written.
  [[nodiscard]] const Points& of(const Points& nodes, Points& room) const;

  /// Returns the points of a shape.
  [[nodiscard]] static Points in(const Model& model, const Points& nodes);

  /// Adds forces on points, which are left changed, to those on the nodes.
  void add_forces(Points& on_points, Points& on_nodes) const;

  /// The nodes that carry four points: point i is the sum of fractions(i, k) x_k.
  struct Carriers {
    static constexpr int most = 10;
    int count = 0;
    std::array<Index, most> nodes;
    Eigen::Matrix<double, 4, most> fractions = Eigen::Matrix<double, 4, most>::Zero();
  };
  [[nodiscard]] Carriers carriers(const contact::Nodes& points) const;

 private:
  const std::vector<EdgeWithNode>& edges_;
  std::vector<Index> edge_of_;  // of every row of the positions; -1: none
};

}  // namespace softkin::physical
