#pragma once

#include <softkin/core/large_vector.hpp>
#include <softkin/core/team.hpp>
#include <softkin/core/types.hpp>

namespace softkin::linear {

/// Work space of factor_front, kept from front to front.
template <class Number>
struct FrontWork {
  LargeVector<Number> scaled, plain, corner;  // as FrontBlock has them (linear/kernels/front.hpp)
};

/// Rows that a front's columns need for `size` rows: kernels write past the end.
template <class Number>
[[nodiscard]] constexpr Index front_stride(Index size) {
  return (size + 64 / static_cast<Index>(sizeof(Number)) + 6) / 8 * 8;
}

/// Values after a front's last column that kernels may read.
inline constexpr Index front_slack = 16;

/// Multiplications for which a loop is shared by a team.
inline constexpr double worth_sharing = 4e6;

/// First columns of a dense symmetric matrix eliminated: A = L D L^T without pivoting.
///
/// pivots    at least 1
/// front     size columns of front_stride(size) rows, column-major, lower triangle: the first `pivots` columns of the
///           matrix, their rows beyond `size` finite numbers. On return: unit lower L in those, its diagonal undefined,
///           and in the lower triangle of the others what the elimination adds to them. The upper triangle is scratch.
/// diagonal  D, `pivots` values
/// returns   how many of D are negative; a pivot smaller in magnitude than `least` counts as one, and becomes -least
/// team      for large fronts; the result does not depend on it
template <class Number>
Index factor_front(Number* front, Index size, Index pivots, Number least, Number* diagonal, FrontWork<Number>& work,
                   Team& team);

extern template Index factor_front(double*, Index, Index, double, double*, FrontWork<double>&, Team&);
extern template Index factor_front(float*, Index, Index, float, float*, FrontWork<float>&, Team&);

}  // namespace softkin::linear
