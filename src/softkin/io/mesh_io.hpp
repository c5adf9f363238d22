#pragma once

#include <filesystem>
#include <softkin/model/mesh.hpp>

namespace softkin {

/// Reads a mesh, its form chosen by the extension: .msh, .vtk, .vtu, .mesh, .node/.ele, .inp, .tet.
/// throws  InvalidInput naming file and line (or byte)
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

/// Writes .msh (Gmsh 4.1 binary, physical groups kept), .vtu (volume regions as cell data; a cell in several keeps the
/// first) or .stl (boundary, normals outwards whatever the elements' orientation).
/// throws  InvalidInput on another extension, or where the file cannot be written
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace softkin
