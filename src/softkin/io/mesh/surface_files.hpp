#pragma once

#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <string_view>

namespace softkin {

// Surfaces of one form each, from content that is in memory; file is for messages. Faces of more than three corners are
// cut into triangles, corners at one place are joined, faces whose corners stand at fewer than three places are left
// out. throws  InvalidInput naming file and line (or byte)

/// ASCII (one or several solids) or binary STL, as read_stl.
[[nodiscard]] TriangleSurface read_stl(const std::string& file, const std::string& content);

/// Wavefront OBJ: the vertices and faces of all objects and groups; normals, texture, lines and points are passed over.
/// Refused: free-form curves and surfaces.
[[nodiscard]] TriangleSurface read_obj(const std::string& file, std::string content);

/// PLY, ASCII or binary in either byte order: x, y and z of the element `vertex`, the list `vertex_indices` or
/// `vertex_index` of the element `face`; other elements and properties are passed over. Refused: triangle strips.
[[nodiscard]] TriangleSurface read_ply(const std::string& file, std::string_view content);

/// OFF of Geomview, ASCII, with colours, normals or texture (COFF, NOFF, STOFF and what is combined of them), which are
/// passed over. Refused: binary files, and coordinates of other numbers than three (4OFF, nOFF).
[[nodiscard]] TriangleSurface read_off(const std::string& file, std::string content);

/// Is the first word of a text that of an OFF file?
[[nodiscard]] bool is_off_keyword(std::string_view word);

}  // namespace softkin
