#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::linear {

/// An elimination order with independent parts: columns pieces[i] to pieces[i + 1] form whole subtrees of the
/// elimination tree, the columns from pieces.back() on are their common ancestors.
struct Ordering {
  std::vector<Index> order;   // order[k]: the row that is eliminated k-th
  std::vector<Index> pieces;  // ascending, from 0
};

/// Nested dissection (METIS), postordered, cut into about equally heavy pieces.
///
/// matrix  structurally symmetric; the lower triangle is read
[[nodiscard]] Ordering nested_dissection(const Eigen::SparseMatrix<double>& matrix);

/// The same of a mesh of quadratic elements: dissected at their corners or all rows alike, whichever leaves less to do.
///
/// ends  per row, what it stands in the middle of: the rows of an edge's ends, -1 for one that is no row; both -1: a
///       corner. Rows in the middle of edges are coupled only where ends of theirs are the same or coupled
[[nodiscard]] Ordering nested_dissection(const Eigen::SparseMatrix<double>& matrix,
                                         const std::vector<std::array<Index, 2>>& ends);

/// The same from an order that is known already, of this or a larger matrix of the same mesh.
///
/// order  every row once
[[nodiscard]] Ordering postordered(const Eigen::SparseMatrix<double>& matrix, const std::vector<Index>& order);

}  // namespace softkin::linear
