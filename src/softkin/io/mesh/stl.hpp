#pragma once

#include <filesystem>
#include <softkin/model/mesh/mesh.hpp>
#include <vector>

namespace softkin {

/// ASCII (one or several solids) or binary STL; vertices with equal coordinates are welded.
///
/// throws  InvalidInput naming file and line (byte in binary files): no facets, a facet without area, a number that is
///         not finite (normals included), a file that ends early or goes on after the last facet
[[nodiscard]] TriangleSurface read_stl(const std::filesystem::path& path);

/// Binary STL, in single precision.
///
/// throws  InvalidInput naming the facet or vertex: no facets, a vertex that does not exist or is not finite, a facet
///         without area in single precision
void write_stl(const std::filesystem::path& path, const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace softkin
