#pragma once

#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// The regions of a description by name: the groups of its mesh, then its own, and "all" (every element; of a mesh
/// without volume every triangle).
///
/// Groups of dimension 3 and 2 hold the vertices of their cells, edge nodes too. A shape holds the vertices inside it
/// or on its boundary (within 1e-9 of the mesh's diagonal) and the elements whose centroids are; a list of vertices
/// those, the nodes of edges between them, and the elements all of whose corners are listed; a list of elements those
/// and their vertices.
/// Dimension: 3 where a shape or a list of elements holds an element, 0 for other shapes and lists of vertices.
class RegionTable {
 public:
  /// throws  InvalidInput on duplicate names, shapes without extent or that hold nothing, indices out of range
  explicit RegionTable(const RobotSpec& spec) : RegionTable(spec, spec.mesh) {}
  /// The description's regions on another mesh than its own, which must outlive the table.
  RegionTable(const RobotSpec& spec, const Mesh& mesh);

  /// throws  InvalidInput at origin, with the nearest name, where the name is unknown, stands for two groups or
  ///         for nothing
  [[nodiscard]] const Region& find(const std::string& name, const Origin& origin) const;

  /// A region by its name, or what a shape in its place selects.
  [[nodiscard]] Region resolve(const RegionRef& reference) const;

  /// The mesh's, then the scene's.
  [[nodiscard]] const std::vector<Region>& regions() const { return regions_; }
  [[nodiscard]] const EdgeTable& edges() const { return edges_; }

 private:
  [[nodiscard]] Region select(const Selector& selector, const std::string& name, const Origin& origin) const;

  const Mesh& mesh_;
  EdgeTable edges_;
  double tolerance_ = 0;
  std::vector<Region> regions_;
  Region all_;
  std::vector<Index> lost_;  // edge nodes of the description's mesh that this one does without
};

/// "region 'base'" or "the box", for messages.
[[nodiscard]] std::string label(const RegionRef& reference);

/// throws  InvalidInput at origin where a cell names a vertex that is not there, a coordinate is not finite, or a mesh
///         of order 2 has prisms or elements without edge nodes
void check_cells(const Mesh& mesh, const Origin& origin);

/// Whether some three of the vertices span a plane (height over the longest distance above 1e-6).
[[nodiscard]] bool span_plane(const Points& points, const std::vector<Index>& vertices);

}  // namespace softkin
