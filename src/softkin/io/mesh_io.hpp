#pragma once

#include <filesystem>
#include <softkin/model/mesh.hpp>

namespace softkin {

/// Reads a mesh, its form chosen by the extension: .msh, .vtk, .vtu, .mesh, .node/.ele, .inp, .tet.
/// throws  InvalidInput naming file and line (or byte)
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

/// Writes .msh (Gmsh 4.1 binary, physical groups kept), .vtu (regions as cell data) or .stl (boundary).
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace softkin
