#pragma once

#include <filesystem>
#include <softkin/model/mesh.hpp>

namespace softkin {

/// Gmsh .msh 2.2 and 4.1, ASCII and binary; physical groups become regions by name (unnamed: "physical_DIM_TAG").
[[nodiscard]] Mesh read_gmsh(const std::filesystem::path& path);

/// Gmsh 4.1, regions as physical groups.
void write_gmsh(const std::filesystem::path& path, const Mesh& mesh, bool binary = true);

}  // namespace softkin
