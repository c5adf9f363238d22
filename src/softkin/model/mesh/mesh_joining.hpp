#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// A region of a mesh as it is after append(before, mesh).
[[nodiscard]] Region renumbered(Region region, const Mesh& before);

/// Appends a mesh of the same order. Its regions join those of the same name and dimension.
void append(Mesh& all, const Mesh& part);

}  // namespace softkin
