#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// The approximate size of the factor of a robot's stiffness matrix.
struct MemoryNeed {
  double unknowns = 0;  // three of every vertex of an element
  double values = 0;    // entries of the factor and of the update matrices stored meanwhile
};

/// Estimates the factor by nested dissection: elements are halved at the median of their centroids along the longest
/// axis recursively, and the common vertices of two halves are eliminated after both. It takes about 1e-6 s for each
/// vertex of each element.
///
/// vertices    #V by 3, at rest [mm]
/// tetrahedra, edge_nodes, prisms  as of a Mesh
/// source      George, "Nested dissection of a regular finite element mesh", SIAM J. Numer. Anal. 10(2), 1973
[[nodiscard]] MemoryNeed memory_need(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra,
                                     const std::vector<EdgeNodes>& edge_nodes, const std::vector<Prism>& prisms);

}  // namespace softkin
