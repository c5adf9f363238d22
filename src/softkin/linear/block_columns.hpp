#pragma once

#include <cstdint>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::linear {

/// Pattern of a symmetric matrix of dense blocks, lower triangle by block columns: the unknowns of a node (a vertex: up
/// to 3, a rigid region: up to 6) stand together, nodes in elimination order. A block's values are column-major.
struct BlockColumns {
  std::vector<Index> unknowns{0};        // first of each node, then their number
  std::vector<Index> starts{0};          // first entry of each column
  std::vector<Index> rows;               // nodes, ascending; a column's first is its diagonal
  std::vector<std::int64_t> offsets{0};  // of each entry's values, then their number; a diagonal block is square
  std::vector<Index> pieces{0};          // nodes that begin whole, independent subtrees; the last: their ancestors

  [[nodiscard]] Index nodes() const { return static_cast<Index>(unknowns.size()) - 1; }
  [[nodiscard]] Index size() const { return unknowns.back(); }
  [[nodiscard]] Index width(Index node) const { return unknowns[node + 1] - unknowns[node]; }
};

}  // namespace softkin::linear
