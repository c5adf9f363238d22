#pragma once

#include <softkin/linear/kernels/front.hpp>

namespace softkin::linear {

/// Columns that are solved together: a front's part of L is read once for so many.
inline constexpr Index columns_together = 4;
/// Values after a column, and after L, that kernels may read; after a column they may write them, too.
inline constexpr Index solve_slack = 8;

/// One front's part of a solution, in place, L unit lower trapezoidal, in either precision; the sums are in double.
///
/// front    the rows after `size` of its columns, solve_slack at most, hold zeros
/// y        `columns` <= columns_together columns, `stride` >= size + solve_slack apart
/// forward  y_own := L_own^-1 y_own, y_below := y_below - L_below y_own
template <class Number>
void solve_forward(const FrontColumns<Number>& front, double* y, Index stride, Index columns) {
  SOFTKIN_RUN_KERNEL(solve_forward(front, y, stride, columns));
}
/// backward  y_own := L_own^-T (y_own - L_below^T y_below). y holds zeros in the slack of its columns.
template <class Number>
void solve_backward(const FrontColumns<Number>& front, double* y, Index stride, Index columns) {
  SOFTKIN_RUN_KERNEL(solve_backward(front, y, stride, columns));
}

}  // namespace softkin::linear
