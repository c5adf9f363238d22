#pragma once

#include <cstddef>
#include <vector>

namespace softkin {

/// A strictly ascending function through given points: a cubic between neighbours, continuously differentiable, without
/// overshoot; and its inverse.
///
/// source  Fritsch and Carlson, SIAM J. Numer. Anal. 17(2), 1980; slopes at the points are those of Fritsch and
///         Butland, SIAM J. Sci. Stat. Comput. 5(2), 1984, at the ends three-point differences limited to stay
///         monotone (PCHIP)
class MonotoneCurve {
 public:
  /// throws  InvalidInput: fewer than two points, not as many x as y, numbers that are not finite or do not ascend
  MonotoneCurve(std::vector<double> x, std::vector<double> y);

  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const std::vector<double>& y() const { return y_; }

  /// throws  InvalidInput outside x().front() to x().back()
  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double slope(double x) const;
  /// The x whose value is y, to rounding.
  ///
  /// throws  InvalidInput outside y().front() to y().back()
  [[nodiscard]] double inverse(double y) const;

 private:
  /// Value of the cubic of interval i at the fraction t of it.
  [[nodiscard]] double cubic(std::size_t i, double t) const;

  std::vector<double> x_, y_, slopes_;
};

}  // namespace softkin
