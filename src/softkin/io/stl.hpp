#pragma once

#include <filesystem>
#include <softkin/model/mesh.hpp>

namespace softkin {

/// ASCII or binary STL; vertices with equal coordinates are welded. Facets without area are refused.
[[nodiscard]] TriangleSurface read_stl(const std::filesystem::path& path);

/// Binary STL.
void write_stl(const std::filesystem::path& path, const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace softkin
