#pragma once

#include <softkin/core/large_vector.hpp>
#include <softkin/core/team.hpp>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::linear {

/// Work space of factor_front, kept from front to front.
struct FrontWork {
  LargeVector<double> scaled, plain;  // rows below the pivot block: L, and L D, eight rows to a panel
  std::vector<double> corner;         // L of the pivot block, by rows
};

/// Rows that a front's columns need for `size` rows: kernels write past the end.
[[nodiscard]] constexpr Index front_stride(Index size) {
  return (size + 14) / 8 * 8;
}

/// Values after a front's last column that kernels may read.
inline constexpr Index front_slack = 8;

/// First columns of a dense symmetric matrix eliminated: A = L D L^T without pivoting.
///
/// front     size columns of front_stride(size) rows, column-major, lower triangle; the rows beyond `size` hold finite
///           numbers. On return: unit lower L in the first `pivots` columns (its diagonal undefined), the Schur
///           complement in the lower triangle of the others. The upper triangle is scratch.
/// diagonal  D, `pivots` values
/// returns   how many of D are negative; a pivot smaller in magnitude than `least` counts as one, and becomes -least
/// team      for large fronts; the result does not depend on it
Index factor_front(double* front, Index size, Index pivots, double least, double* diagonal, FrontWork& work,
                   Team& team);

}  // namespace softkin::linear
