#pragma once

#include <array>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::contact {

using Corners = std::array<Index, 3>;  // of a triangle: vertices, counterclockwise seen from outside
using Ends = std::array<Index, 2>;     // of an edge: vertices, the lower one first
using SixNodes = std::array<Index, 6>;

/// A list for each of several things: items[begin[i], begin[i + 1]) belong to i.
struct Lists {
  std::vector<Index> begin, items;
};

/// What may touch: triangles with their edges and vertices, of one body or of several. Open borders and edges of more
/// than two triangles are allowed.
struct Surface {
  std::vector<Corners> triangles;
  std::vector<Ends> edges;      // each once, ascending
  std::vector<Index> vertices;  // those of triangles, ascending
  // Edge k of a triangle lies between its corners k and k + 1.
  std::vector<std::array<Index, 3>> triangle_edges;
  Lists edge_triangles, vertex_triangles;  // ascending; by place in `edges` and in `vertices`
  // At rest [mm^2]: a triangle gives a third of its area to each of its vertices and to each of its edges.
  std::vector<double> triangle_area, edge_area, vertex_area;
};

/// triangles  vertices of each, rows of rest; three different ones
/// rest       positions [mm]
/// throws     InvalidInput on a triangle that names a vertex twice or one that there is none of
[[nodiscard]] Surface make_surface(std::vector<Corners> triangles, const Points& rest);

/// Four triangles of the same orientation for each face with nodes at its edges: corners a, b, c, then the nodes of ab,
/// bc and ca.
[[nodiscard]] std::vector<Corners> split_faces(const std::vector<SixNodes>& faces);

}  // namespace softkin::contact
