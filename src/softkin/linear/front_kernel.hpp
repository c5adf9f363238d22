#pragma once

#include <cstdint>
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

/// Values of its pivots' columns.
template <class Number>
[[nodiscard]] constexpr std::int64_t own_values(Index size, Index pivots) {
  return static_cast<std::int64_t>(front_stride<Number>(size)) * pivots;
}

/// Rows before each column that a front leaves: kernels write there what belongs above the diagonal.
template <class Number>
inline constexpr Index left_head = 64 / static_cast<Index>(sizeof(Number));

/// From one column of what a front leaves, `below` rows, to the next.
template <class Number>
[[nodiscard]] constexpr Index left_stride(Index below) {
  return front_stride<Number>(below + left_head<Number>);
}

/// Values after a front's last column that kernels may read.
inline constexpr Index front_slack = 16;

/// Where a front stands, column-major, lower triangles.
template <class Number>
struct FrontPlace {
  Number* own;   // columns of its pivots: `size` rows, front_stride(size) apart
  Number* left;  // what it leaves: size - pivots rows and columns, left_stride of those apart, after left_head values
  Index size, pivots;
};

/// Multiplications for which a loop is shared by a team.
inline constexpr double worth_sharing = 4e6;

/// First columns of a dense symmetric matrix eliminated: A = L D L^T without pivoting.
///
/// front     at least one pivot. Its own columns are those of the matrix, their rows beyond `size` zero. On return:
///           unit lower L in them, its diagonal undefined; and left is what the elimination adds to the other columns.
///           Upper triangles are scratch.
/// diagonal  D, `pivots` values
/// returns   how many of D are negative; a pivot smaller in magnitude than `least` counts as one, and becomes -least
/// team      for large fronts; the result does not depend on it
template <class Number>
Index factor_front(const FrontPlace<Number>& front, Number least, Number* diagonal, FrontWork<Number>& work,
                   Team& team);

extern template Index factor_front(const FrontPlace<double>&, double, double*, FrontWork<double>&, Team&);
extern template Index factor_front(const FrontPlace<float>&, float, float*, FrontWork<float>&, Team&);

}  // namespace softkin::linear
