#pragma once

#include <cmath>

namespace softkin::random_robots {

using Real = long double;

/// A number and its derivative in one direction.
struct Dual {
  Real value = 0, slope = 0;

  Dual() = default;
  Dual(Real v, Real s = 0) : value(v), slope(s) {}

  friend Dual operator+(Dual a, Dual b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Dual operator-(Dual a, Dual b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Dual operator-(Dual a) { return {-a.value, -a.slope}; }
  friend Dual operator*(Dual a, Dual b) { return {a.value * b.value, a.slope * b.value + a.value * b.slope}; }
  friend Dual operator/(Dual a, Dual b) {
    const Real ratio = a.value / b.value;
    return {ratio, (a.slope - ratio * b.slope) / b.value};
  }
  Dual& operator+=(Dual b) { return *this = *this + b; }
};

inline Dual power(Dual a, Real exponent) {
  const Real value = std::pow(a.value, exponent);
  return {value, exponent * value / a.value * a.slope};
}
inline Real power(Real a, Real exponent) {
  return std::pow(a, exponent);
}

inline Dual exponential(Dual a) {
  const Real value = std::exp(a.value);
  return {value, value * a.slope};
}

inline Dual logarithm(Dual a) {
  return {std::log(a.value), a.slope / a.value};
}

}  // namespace softkin::random_robots
