#pragma once

#include <filesystem>
#include <softkin/model/mesh/mesh.hpp>
#include <string>

namespace softkin {

/// Reads a mesh, its form chosen by the extension: .msh, .vtk, .vtu, .mesh, .node/.ele, .inp, .tet. Where regions of
/// several dimensions have the same name, the highest keeps it and the others become "NAME_2d", "_1d", "_0d".
/// throws  InvalidInput naming file and line (or byte)
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

/// What the files of this extension are called, "Gmsh" say; "" where softkin neither reads nor writes them.
[[nodiscard]] std::string mesh_form(const std::filesystem::path& path);

/// Writes .msh (Gmsh 4.1 binary, physical groups kept), .vtu (volume regions as cell data; a cell in several keeps the
/// first) or .stl (boundary, normals outwards whatever the elements' orientation; a face of order 2 as four facets).
/// throws  InvalidInput on another extension, on tetrahedra of two orders or of order 2 beside prisms, or where the
///         file cannot be written
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace softkin
