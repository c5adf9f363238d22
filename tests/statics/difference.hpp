#pragma once

#include <functional>
#include <softkin/core/types.hpp>

namespace softkin::testing {

/// Central differences of a value in the coordinates of points, #V by 3.
inline Points difference(const std::function<double(const Points&)>& value, const Points& at, double reach) {
  Points slope(at.rows(), 3), moved = at;
  for (Index v = 0; v < at.rows(); ++v)
    for (int c = 0; c < 3; ++c) {
      moved(v, c) = at(v, c) + reach;
      const double high = value(moved);
      moved(v, c) = at(v, c) - reach;
      slope(v, c) = (high - value(moved)) / (2 * reach);
      moved(v, c) = at(v, c);
    }
  return slope;
}

/// Central difference of a field along a direction.
inline Points change_along(const std::function<Points(const Points&)>& field, const Points& at, const Points& direction,
                           double reach) {
  return (field(at + reach * direction) - field(at - reach * direction)) / (2 * reach);
}

}  // namespace softkin::testing
