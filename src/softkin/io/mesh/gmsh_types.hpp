#pragma once

#include <cstdint>
#include <limits>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <string_view>
#include <utility>

namespace softkin::gmsh {

/// Element types of the MSH format that softkin knows.
enum class CellType : int {
  line = 1,
  triangle = 2,
  quad = 3,
  tetrahedron = 4,
  prism = 6,
  quadratic_line = 8,
  quadratic_triangle = 9,
  quadratic_tetrahedron = 11,
  point = 15
};

inline constexpr std::size_t kMostNodes = 10;  // of a CellType

struct CellShape {
  int dimension;
  int nodes;
};

[[nodiscard]] CellShape shape_of(CellType type);

/// The edge nodes of a tetrahedron from Gmsh's order (edges 01, 12, 02, 03, 23, 13) into softkin's, and back.
[[nodiscard]] constexpr EdgeNodes reordered(EdgeNodes nodes) {
  std::swap(nodes[4], nodes[5]);
  return nodes;
}

/// Why an element type cannot be read, or "" where it is a CellType.
[[nodiscard]] std::string refusal_of_type(std::int64_t type);

/// Does a name hold what cannot stand between double quotes on one line?
[[nodiscard]] bool is_unquotable(std::string_view name);

inline constexpr std::int64_t kMaxIndex = std::numeric_limits<Index>::max();
inline constexpr std::int64_t kMaxInt = std::numeric_limits<std::int32_t>::max();
inline constexpr std::int64_t kMaxSize = std::numeric_limits<std::int64_t>::max();

}  // namespace softkin::gmsh
