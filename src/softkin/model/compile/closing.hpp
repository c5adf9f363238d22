#pragma once

#include <array>
#include <optional>
#include <softkin/model/drives.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <vector>

namespace softkin {

/// An edge of the rim of an open surface, as the surface passes it.
struct RimEdge {
  Index from = -1, to = -1;
  Index node = -1;  // on it; -1: straight
};

/// A polygon in one plane that closes an opening.
struct ClosingPolygon {
  std::vector<Index> vertices;  // in the order in which the surface passes its rim; from #V on: ClosedRim::corners
  std::vector<Index> nodes;     // on the edge from each vertex to the next one; -1: straight
};

/// The polygons that close the openings of a surface.
struct ClosedRim {
  std::vector<ClosingPolygon> polygons;
  std::vector<Vec3> corners;           // where three planes meet inside the surface [mm]; no vertices of the mesh
  std::optional<std::size_t> stray{};  // the rim's first edge that no plane closes; then there is nothing else
};

/// Closes the openings of a surface by planes that its rim cannot leave: a plane normal to x, y or z along which all
/// vertices of the rim in it are held, and any plane the vertices of which are held along x, y and z. A rim may run
/// from one plane normal to an axis into another, as those of a quarter and of an eighth of a body do: then the planes
/// close it as far as they intersect.
///
/// rim        as the surface passes it, whose triangles agree
/// held       by vertex and axis
/// tolerance  distance from a plane below which a vertex lies in it [mm]
[[nodiscard]] ClosedRim close_rim(const Points& vertices, const std::vector<RimEdge>& rim,
                                  const std::vector<std::array<bool, 3>>& held, double tolerance);

/// Returns a polygon as faces whose normals point out of the enclosed space. quadratic: as of order 2. Their area, as a
/// vector, is exact also where the polygon is not convex: faces may overlap and have opposite normals.
[[nodiscard]] std::vector<CavityFace> faces_of(const ClosingPolygon& polygon, bool quadratic);

}  // namespace softkin
