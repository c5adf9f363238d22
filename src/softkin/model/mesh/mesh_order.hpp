#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// The nodes of a mesh of order 2 by the ends of their edges; empty for one of order 1.
class EdgeTable {
 public:
  /// The mesh's indices must be in range.
  /// throws  InvalidInput where an edge has different nodes in two elements, or two edges have the same node
  explicit EdgeTable(const Mesh& mesh);

  [[nodiscard]] bool empty() const { return edges_.empty(); }
  /// The node between two corners, or -1 where no element has the edge.
  [[nodiscard]] Index find(Index a, Index b) const;
  /// The nodes on the edges 01, 12, 20 of a triangle; -1 as in find().
  [[nodiscard]] std::array<Index, 3> of(const Triangle& triangle) const;
  /// The nodes of the edges both of whose ends are among the vertices, which are in ascending order.
  [[nodiscard]] std::vector<Index> between(const std::vector<Index>& vertices) const;

 private:
  struct Edge {
    Index low, high, node;
  };
  std::vector<Edge> edges_;  // ascending
};

/// Reorders the edge nodes of an element as exchanging its corners 2 and 3 does.
void exchange_corners_2_and_3(EdgeNodes& edge_nodes);

/// The node on the edge between two corners of an element, which must be there.
[[nodiscard]] Index edge_node(const Tetrahedron& element, const EdgeNodes& edge_nodes, Index a, Index b);

/// A mesh of order 1 with a node in the middle of every edge of a tetrahedron, shared by its elements, after the
/// vertices that it had. Regions of dimension 1 and 0 get the nodes of the edges both of whose ends they hold.
/// The mesh's indices must be in range.
///
/// throws  InvalidInput where the mesh has prisms or is of order 2 already
[[nodiscard]] Mesh elevated(const Mesh& mesh);

/// A mesh of order 2 without its edge nodes: they stay as vertices of no element, in no region.
[[nodiscard]] Mesh lowered(Mesh mesh);

}  // namespace softkin
