#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// Row i as a column.
[[nodiscard]] inline Vec3 vertex_at(const Points& points, Index i) {
  return points.row(i).transpose();
}

/// Ascending, each once.
template <class Value>
void sort_unique(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Corners; of positive volume where 0, 1, 2 turn counterclockwise seen from 3.
using Tetrahedron = std::array<Index, 4>;
using Prism = std::array<Index, 6>;  // bottom triangle 0 1 2, top 3 4 5, edges 0-3, 1-4, 2-5
/// Nodes on the edges 01, 12, 02, 03, 13, 23 of a quadratic tetrahedron.
using EdgeNodes = std::array<Index, 6>;
using Triangle = std::array<Index, 3>;
using Quad = std::array<Index, 4>;
/// An edge of tetrahedra or of sheets of order 2: its ends, ascending, and the node on it.
using EdgeWithNode = std::array<Index, 3>;

/// A named part of a mesh (a physical group): indices into the mesh's arrays, ascending, without repetition.
struct Region {
  std::string name;                       // unique in a mesh
  int dimension = 3;                      // 3: tetrahedra and prisms; 2: triangles and quads; 1 and 0: vertices
  std::vector<Index> tetrahedra, prisms;  // of dimension 3
  std::vector<Index> triangles, quads;    // of dimension 2
  std::vector<Index> vertices;            // of dimension 1 and 0
};

/// Corners of the edges, in the order of EdgeNodes.
inline constexpr int tetrahedron_edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
/// Corners of the edges: of both triangles, then between them.
inline constexpr int prism_edges[9][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};

/// A volume mesh as it stands in its file: lengths in the file's unit, elements in the file's orientation.
struct Mesh {
  Points vertices;                      // #V by 3
  std::vector<Tetrahedron> tetrahedra;  // corners
  std::vector<EdgeNodes> edge_nodes;    // of order 2: of every tetrahedron, and there are no prisms; of order 1: empty
  std::vector<Prism> prisms;            // corners
  std::vector<Triangle> triangles;      // surface cells that some region names; of order 2 their corners
  // of order 2: of edges of triangles that no tetrahedron has their ends, ascending, and the node on them
  std::vector<std::array<Index, 3>> sheet_edges;
  std::vector<Quad> quads;
  std::vector<Region> regions;
  std::vector<std::string> missing;  // files beside its own that name regions and are not there, a sentence each
  bool no_sidecars = false;          // none of them is there
};

/// A closed triangle surface (from STL), vertices welded.
struct TriangleSurface {
  Points vertices;                  // #vertices by 3, in the file's unit or [mm]
  std::vector<Triangle> triangles;  // normals outwards
};

/// The longest distance between two corners of an element [mm].
template <std::size_t N>
[[nodiscard]] double longest_edge(const Points& vertices, const std::array<Index, N>& element) {
  double longest2 = 0;
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < i; ++j)
      longest2 = std::max(longest2, (vertices.row(element[i]) - vertices.row(element[j])).squaredNorm());
  return std::sqrt(longest2);
}

/// Signed volume, positive where the vertex order is the standard one; of an element of order 2 that of its corners.
[[nodiscard]] double signed_volume(const Points& vertices, const Tetrahedron& element);
/// Signed volume of the prism with bilinear sides (exact integral of the linear prism's Jacobian).
[[nodiscard]] double signed_volume(const Points& vertices, const Prism& element);
/// Volume enclosed by a closed surface whose normals point outwards (divergence theorem).
[[nodiscard]] double enclosed_volume(const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace softkin
