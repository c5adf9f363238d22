#pragma once

#include <softkin/model/mesh/mesh_check.hpp>

namespace softkin {

/// Fills in what check_mesh finds by how elements meet: duplicates, faces, edges, vertices and parts. check.degenerate
/// must be known. points are the mesh's vertices in any scale.
void check_topology(const Mesh& mesh, const Points& points, MeshCheck& check);

}  // namespace softkin
