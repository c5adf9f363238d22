#pragma once

#include <filesystem>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin {

/// Reads a mesh, its form chosen by the extension: .msh, .vtk, .vtu, .mesh, .node/.ele, .inp, .tet. Where regions of
/// several dimensions have the same name, the highest keeps it and the others become "NAME_2d", "_1d", "_0d".
/// throws  InvalidInput naming file and line (or byte)
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

/// What the files of this extension are called, "Gmsh" say; "" where softkin neither reads nor writes them.
[[nodiscard]] std::string mesh_form(const std::filesystem::path& path);

/// Writes .msh (Gmsh 4.1 binary, physical groups kept), .vtu (volume regions as cell data; a cell in several keeps the
/// first) or .stl (boundary, normals outwards whatever the elements' orientation; a face of order 2 as four facets).
/// throws  InvalidInput on another extension, on tetrahedra of two orders or of order 2 with prisms, or where the
///         file cannot be written
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

/// Names of the units of length that files may be in: mm, cm, m, um, in.
[[nodiscard]] const std::vector<std::string>& length_units();

/// Millimetres in one unit. Throws std::out_of_range where the name is none of length_units().
[[nodiscard]] double mm_per(const std::string& unit);

// One form each; throws as read_mesh and write_mesh. VTK: vtk.hpp

/// Gmsh .msh 2.2 or 4.1, ASCII or binary in either byte order.
///
/// Physical groups become regions: first those of $PhysicalNames in its order, also where they are empty, then the
/// unnamed ones as "physical_DIM_TAG". Where groups of several dimensions have the same name, the highest dimension
/// keeps it and the others become "NAME_DIMd" ("base_2d"). A group of lines becomes its vertices; of triangles of order
/// 2 the corners are kept.
/// Vertices and elements keep the order of the file. Elements with the same vertices (MSH 2.2 repeats an element for
/// every group it is in) are stored once, in the orientation of the first. Triangles and quads in no group are dropped.
/// Refused are elements other than points, lines, triangles and tetrahedra of order 1 or 2, quads and prisms of order
/// 1, tetrahedra of two orders, or of order 2 with prisms, partitioned 4.1 meshes, and files without volume elements
/// or triangles. Where there is no volume element all triangles are kept.
[[nodiscard]] Mesh read_gmsh(const std::filesystem::path& path);
/// The same of a file that is in memory; file is for messages.
[[nodiscard]] Mesh read_gmsh(const std::string& file, std::string_view content);

/// Writes Gmsh 4.1; regions become physical groups, so that read_gmsh returns the same mesh, coordinates exactly.
///
/// A region of dimension 1 is written as the points that it holds and comes back with dimension 0; triangles and quads
/// in no region are written, but read_gmsh drops them. Beside regions, cells in none are of physical group 0, Gmsh's
/// number for none. Of order 2 triangles have their edge nodes too, where each of them is a side of tetrahedra.
/// throws  InvalidInput for a mesh that read_gmsh would refuse (no element, NaN, indices out of range) and for
///         region names that are empty, repeated, longer than 127 bytes, or hold '"' or control characters
void write_gmsh(const std::filesystem::path& path, const Mesh& mesh, bool binary = true);

/// Medit .mesh (INRIA, ASCII). References become regions "ref_N" (tetrahedra, prisms) and "surface_ref_N"
/// (triangles, quadrilaterals), so that a name stands for one region. TetrahedraP2 and TrianglesP2 are of order 2. End
/// may be missing.
[[nodiscard]] Mesh read_medit(const std::filesystem::path& path);

/// TetGen .node + .ele (path names either; the other is next to it) and, where present, .face. Numbering from 0 or
/// 1. The (last) element attribute becomes regions "attribute_N", face markers "marker_N". -o2 (10 nodes
/// an element) as TetGen 1.5 and 1.6 order them.
[[nodiscard]] Mesh read_tetgen(const std::filesystem::path& path);

/// Abaqus .inp: *NODE, *ELEMENT (C3D4, C3D6, C3D10), *NSET, *ELSET (also GENERATE, and sets of sets), *SURFACE of
/// element faces. Sets become regions by their names (spelled as at first mention). Flat files, or one part with one
/// instance that is not moved; *INCLUDE of files in the deck's folder; other element types and *SYSTEM, *NGEN, ... are
/// refused; materials, steps and the like are passed over. Shells alone are a mesh of triangles.
[[nodiscard]] Mesh read_abaqus(const std::filesystem::path& path);

/// The form that the paper's authors publish: "N vertices", "M tets", coordinates, "4 a b c d" from 0. Sidecars beside
/// it, where present: NAME_chamber.txt -> regions chamber1.., NAME_rigid_handle.txt -> handle, rigid. Beside
/// ROBOT_body.tet they may be called ROBOT_chamber.txt and ROBOT_rigid_handle.txt, as theirs are.
[[nodiscard]] Mesh read_tet(const std::filesystem::path& path);

/// A sidecar's column as indices of the rows that hold 1. Rows "id:c1:c2:...:" (matched by position; ids are checked to
/// count up from 1 or 0) or one bare 0/1 each. column counts from 1.
struct Sidecar {
  Index rows = 0;                           // how many
  std::vector<std::vector<Index>> columns;  // of each the rows that hold 1, from 0
  bool bare = false;                        // one 0/1 a row, without ids
};
[[nodiscard]] Sidecar read_sidecar(const std::filesystem::path& path);  // throws as read_mesh

/// A surface of triangles from a file of STL, OBJ, PLY or OFF (surface_files.hpp). The format is detected from the
/// content or, where that does not suffice, from the extension. Lengths as they are in the file.
///
/// throws  InvalidInput naming file and line (or byte); of a file of another form what it is
[[nodiscard]] TriangleSurface read_surface(const std::filesystem::path& path);

/// ASCII (one or several solids) or binary STL; vertices with equal coordinates are welded. Also refused: no facets, a
/// facet without area, a number that is not finite (normals included), a file that continues after the last facet.
[[nodiscard]] TriangleSurface read_stl(const std::filesystem::path& path);

/// Binary STL, in single precision.
///
/// throws  InvalidInput naming the facet or vertex: no facets, a vertex that does not exist or is not finite, a facet
///         without area in single precision
void write_stl(const std::filesystem::path& path, const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace softkin
