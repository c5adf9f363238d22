#pragma once

#include <filesystem>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Medit .mesh (INRIA, ASCII). References become regions "ref_N" (tetrahedra, prisms) and "surface_ref_N"
/// (triangles, quadrilaterals), so that a name stands for one region. TetrahedraP2 and TrianglesP2 are of order 2.
[[nodiscard]] Mesh read_medit(const std::filesystem::path& path);

/// TetGen .node + .ele (path names either; the other stands beside it) and, where present, .face. Numbering from 0 or
/// 1. The (last) element attribute becomes regions "attribute_N", face markers "marker_N". -o2 (10 nodes
/// an element) as TetGen 1.5 and 1.6 order them.
[[nodiscard]] Mesh read_tetgen(const std::filesystem::path& path);

/// Abaqus .inp: *NODE, *ELEMENT (C3D4, C3D6, C3D10), *NSET, *ELSET (also GENERATE, and sets of sets), *SURFACE of
/// element faces. Sets become regions by their names (spelled as at first mention). Flat files, or one part with one
/// instance that is not moved; other element types and *INCLUDE, *SYSTEM, *NGEN, ... are refused; materials, steps and
/// the like are passed over.
[[nodiscard]] Mesh read_abaqus(const std::filesystem::path& path);

/// The form that the paper's authors publish: "N vertices", "M tets", coordinates, "4 a b c d" from 0. Sidecars beside
/// it, where present: NAME_chamber.txt -> regions chamber1.., NAME_rigid_handle.txt -> handle, rigid.
[[nodiscard]] Mesh read_tet(const std::filesystem::path& path);

/// A sidecar's column as indices of the rows that hold 1. Rows "id:c1:c2:...:" (matched by position; ids are checked to
/// count up from 1 or 0) or one bare 0/1 each. column counts from 1.
struct Sidecar {
  Index rows = 0;
  std::vector<std::vector<Index>> columns;
  bool bare = false;  // one 0/1 a row, without ids
};
[[nodiscard]] Sidecar read_sidecar(const std::filesystem::path& path);

}  // namespace softkin
