#pragma once

#include <array>
#include <softkin/model/mesh/mesh.hpp>
#include <vector>

namespace softkin::cli {

/// What mesh check finds about the edges of tetrahedra of order 2: vertices, an edge's ends first, then its node.
struct EdgeCheck {
  std::vector<std::array<Index, 3>> far;     // nodes further than a quarter of the edge's length from its middle
  std::vector<std::array<Index, 3>> uneven;  // the others that are further than a thousandth of it
  std::vector<std::array<Index, 4>> split;   // edges on which tetrahedra have different nodes; two of these
  std::vector<Index> shared;                 // nodes of several edges
};

[[nodiscard]] EdgeCheck check_edges(const Mesh& mesh);

}  // namespace softkin::cli
