#pragma once

#include <cstddef>
#include <cstdint>
#include <softkin/core/target.hpp>

namespace softkin::linear {

/// Columns of a front that are eliminated together.
inline constexpr Index front_block = 64;

/// Values of work space for a block's pivots: L in groups of columns, then the pivots' inverses.
inline constexpr Index corner_values = front_block * (front_block + 1);

/// A block of columns of a front, and where its elimination stands.
template <class Number>
struct FrontBlock {
  Number *own, *left;                       // as factor_front takes them
  Index size, pivots, stride, left_stride;  // of the front
  Index begin, width;                       // of the block
  Number* corner;                           // corner_values
  Number *plain, *scaled;                   // of the rows below the block: L D, and L; front_panels(size) rows

  /// Of a column that is left, rows from left_head before it on.
  [[nodiscard]] Number* at(Index row, Index column) const {
    return column < pivots ? own + static_cast<std::ptrdiff_t>(column) * stride + row
                           : left + static_cast<std::ptrdiff_t>(column - pivots) * left_stride + (row - pivots);
  }
  [[nodiscard]] Index first() const { return begin + width; }  // row and column below the block
  [[nodiscard]] Index rest() const { return size - first(); }
};

/// Rows of work space for a front of `size` rows, on any target.
[[nodiscard]] constexpr Index front_panels(Index size) {
  return size + 64;
}

/// Rows that a front leaves, from `from` on, one after the other, to as many of a vector's rows of its parent from `to`
/// on: to those whose bits are set, the first always.
struct RowPack {
  Index from, to;
  std::uint32_t bits;
};

/// Columns of what a front leaves that are added to its parent's columns.
template <class Number>
struct FrontSum {
  const Number* from;  // what the child leaves: its column and row 0
  Number* to;          // the parent's column and row `first`
  Index from_stride, to_stride, first;
  const RowPack* last;  // beyond the child's last pack
};

/// A front's columns of L, column-major, unit lower trapezoidal: on and above the diagonal stands anything.
template <class Number>
struct FrontColumns {
  const Number* values;
  Index stride, size, pivots;
};

SOFTKIN_KERNELS(
    /// L and D of the pivot block; L in place and into the corner.
    /// returns  negative pivots, those below `least` in magnitude among them, which become -least
    template <class Number> Index factor_corner(const FrontBlock<Number>& block, Number least, Number* diagonal);

    /// Strips of rows below the block: what one thread takes at a time.
    template <class Number> Index strip_count(const FrontBlock<Number>& block);

    /// Strips [low, high) below the block: L D = A L_corner^-T into `plain`, L into `scaled` and in place.
    template <class Number> void solve_strips(const FrontBlock<Number>& block, Index low, Index high);

    /// Strips [low, high): the lower triangle of the columns beyond the block minus scaled plain^T. Of what stands
    /// there beyond the front's pivots the first block takes no notice: it is as if it were zero.
    template <class Number> void update_strips(const FrontBlock<Number>& block, Index low, Index high);

    /// Rows of a RowPack's vector.
    template <class Number> Index pack_rows();

    /// The columns of a pack's rows, their rows of this pack and of all after it. What is added above the diagonal is
    /// anything at all; rows of the parent between those of a pack, and up to pack_rows() - 1 below its last, are read
    /// and written, and stay as they are.
    template <class Number> void add_pack_columns(const FrontSum<Number>& sum, const RowPack* pack);

    /// One front's part of a solution (linear/front_solve.hpp).
    template <class Number>
    void solve_forward(const FrontColumns<Number>& front, double* y, Index stride, Index columns);
    template <class Number>
    void solve_backward(const FrontColumns<Number>& front, double* y, Index stride, Index columns);)

}  // namespace softkin::linear
