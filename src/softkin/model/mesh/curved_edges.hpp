#pragma once

#include <cstddef>
#include <softkin/model/mesh/curve_spec.hpp>

namespace softkin {

/// The result of curve_edges().
struct CurvedEdges {
  std::size_t edges = 0;              // of the surfaces that may curve
  std::size_t moved = 0, inside = 0;  // nodes: on these edges, and on others, which made room
  std::size_t held_back = 0;          // of those moved, not as far as intended
  double min_fraction = 1;            // smallest fraction of the intended displacement among these
  double farthest_mm = 0;             // that a node was moved
  std::vector<std::size_t> taken;     // number of edges moved onto each given surface
  std::size_t undetermined = 0;       // edges whose curvature on the smooth surface differs much at its two ends
  Vec3 undetermined_at{0, 0, 0};      // the middle of one of them [mm]
};

/// Returns a label for each tetrahedron, equal for tetrahedra in the same regions.
///
/// regions  of a mesh; those of dimension 3 count
[[nodiscard]] std::vector<Index> labels_of(const Mesh& mesh, const std::vector<Region>& regions);

/// Moves the nodes on the edges of a mesh's surface from the middle of the straight edge onto a given surface or onto a
/// smooth one through the vertices (smooth_surface.hpp). Creases stay. No element is folded: its Jacobian stays
/// everywhere above a tenth of that with straight edges, by its Bezier coefficients; where it would not, nodes inside
/// are moved too or, if that does not help, displacements are reduced.
///
/// mesh    of order 2; its edge nodes are placed anew
/// labels  of its tetrahedra: where they differ is a surface too
CurvedEdges curve_edges(Mesh& mesh, const std::vector<Index>& labels, const CurveSpec& spec);

/// The displacements of edge nodes onto a smooth surface, without the limit against folding: a row for each vertex
/// [mm], 0 for all but these nodes; by SmoothSurface::Bulge.
struct SmoothBulges {
  Points likely, most;
  bool hollow_crease = false;  // has the surface one
};

/// mesh  of order 2
[[nodiscard]] SmoothBulges smooth_bulges(const Mesh& mesh, const std::vector<Index>& labels, double crease_degrees);

/// The largest distance of an edge's node from the middle of its ends, over the edge's length.
[[nodiscard]] double largest_bulge(const Mesh& mesh);

}  // namespace softkin
