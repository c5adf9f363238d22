#pragma once

#include <functional>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Halves edges that are longer than limit(their middle) [mm] until none is, and with them the longest edges of their
/// triangles, which keeps triangles from becoming thin. New vertices are common to neighbours: a closed surface stays
/// closed, and its geometry is unchanged.
///
/// throws  InvalidInput where it would need more than `most` triangles
[[nodiscard]] TriangleSurface refined(TriangleSurface surface, const std::function<double(const Vec3&)>& limit,
                                      std::size_t most);

}  // namespace softkin
