#pragma once

#include <cstddef>
#include <softkin/model/mesh/curve_spec.hpp>

namespace softkin {

/// What curve_edges() did.
struct CurvedEdges {
  std::size_t edges = 0;              // of the surfaces that may curve
  std::size_t moved = 0, inside = 0;  // nodes: on these edges, and on others, which made room
  std::size_t held_back = 0;          // of those moved, not as far as they should
  double least_share = 1;             // of its way that the one held back most went
  double farthest_mm = 0;             // that a node was moved
  std::vector<std::size_t> taken;     // edges that each given surface took
  std::size_t undetermined = 0;       // edges whose curvature on the smooth surface differs much at its two ends
  Vec3 undetermined_at{0, 0, 0};      // the middle of one of them [mm]
};

/// Where the tetrahedra's regions differ: a number for each tetrahedron, the same where it is in the same regions.
///
/// regions  of a mesh; those of dimension 3 count
[[nodiscard]] std::vector<Index> labels_of(const Mesh& mesh, const std::vector<Region>& regions);

/// Moves the nodes on the edges of a mesh's surface from the middle of the straight edge onto a given surface or onto a
/// smooth one through the vertices (smooth_surface.hpp). Creases stay. No element is folded: its Jacobian stays
/// everywhere above a tenth of that with straight edges, by its Bezier coefficients; where it would not, nodes inside
/// are moved along or, if that does not help, nodes are held back.
///
/// mesh    of order 2; its edge nodes are placed anew
/// labels  of its tetrahedra: where they differ is a surface too
CurvedEdges curve_edges(Mesh& mesh, const std::vector<Index>& labels, const CurveSpec& spec);

/// How far the nodes of the edges would be moved onto a smooth surface if nothing folded: vertices' rows [mm], 0 for
/// all but these nodes; by SmoothSurface::Bulge.
struct SmoothBulges {
  Points likely, most;
  bool hollow_crease = false;  // has the surface one
};

/// mesh  of order 2
[[nodiscard]] SmoothBulges smooth_bulges(const Mesh& mesh, const std::vector<Index>& labels, double crease_degrees);

/// The largest distance of an edge's node from the middle of its ends, over the edge's length.
[[nodiscard]] double largest_bulge(const Mesh& mesh);

}  // namespace softkin
