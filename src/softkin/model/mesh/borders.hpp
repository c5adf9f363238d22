#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Returns the border lines of a surface, by its edges of one triangle alone: closed ones begin and end with the same
/// vertex. Where several meet, each continues along any of them.
///
/// beside  of each triangle the vertices on its edges 01, 12, 20; -1: none
[[nodiscard]] std::vector<std::vector<Index>> borders_of(const std::vector<Triangle>& triangles,
                                                         const std::vector<std::array<Index, 3>>& beside);

}  // namespace softkin
