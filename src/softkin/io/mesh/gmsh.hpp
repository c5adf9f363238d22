#pragma once

#include <filesystem>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Reads Gmsh .msh 2.2 or 4.1, ASCII or binary in either byte order.
///
/// Physical groups become regions: first those of $PhysicalNames in its order, also where they are empty, then the
/// unnamed ones as "physical_DIM_TAG". Where groups of several dimensions share a name, the highest dimension keeps it
/// and the others become "NAME_DIMd" ("base_2d"). A group of lines becomes its vertices; of triangles of
/// order 2 the corners are kept.
/// Vertices and elements keep the order of the file. Elements with the same vertices (MSH 2.2 repeats an element for
/// every group it is in) are stored once, in the orientation of the first. Triangles and quads in no group are dropped.
/// throws  InvalidInput naming file and line (binary: byte); also for elements other than points, lines, triangles
///         and tetrahedra of order 1 or 2, quads and prisms of order 1, for tetrahedra of two orders, or of order 2
///         beside prisms, for partitioned 4.1 meshes, and without any volume element
[[nodiscard]] Mesh read_gmsh(const std::filesystem::path& path);

/// Writes Gmsh 4.1; regions become physical groups, so that read_gmsh returns the same mesh, coordinates exactly.
///
/// A region of dimension 1 is written as the points that it holds and comes back with dimension 0; triangles and quads
/// in no region are written, but read_gmsh drops them. Beside regions, cells in none are of physical group 0, Gmsh's
/// number for none. Of order 2 triangles have their edge nodes too, where each of them is a side of tetrahedra.
/// throws  InvalidInput for a mesh that read_gmsh would refuse (no volume element, NaN, indices out of range) and for
///         region names that are empty, repeated, longer than 127 bytes, or hold '"' or control characters
void write_gmsh(const std::filesystem::path& path, const Mesh& mesh, bool binary = true);

}  // namespace softkin
