#pragma once

#include <cstdint>
#include <softkin/core/target.hpp>

namespace softkin::linear {

/// Columns [begin, begin + width) of L: below the diagonal, row by row, then its rows further down, `width` values
/// each.
struct SupernodeColumns {
  Index begin, width;
  Index row_count, inner_rows;     // rows further down, and how many of them come before the top
  Index top;                       // first row of the top
  const Index* rows;               // those further down
  const double *triangle, *below;  // values
  const double* inverse_diagonal;  // of its columns
};

SOFTKIN_KERNELS(
    /// A supernode's part of a solution, four numbers a row: three coordinates and a spare.
    /// above  what rows from the top on lose
    void forward_supernode(const SupernodeColumns& node, double* rows, double* above);
    void backward_supernode(const SupernodeColumns& node, double* rows);)

}  // namespace softkin::linear
