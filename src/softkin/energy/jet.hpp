#pragma once

#include <cmath>
#include <softkin/core/types.hpp>

namespace softkin::energy {

/// A number with its derivatives in N variables, of order 1 or 2: forward differentiation of small functions, exact to
/// rounding.
template <int N, int Order>
struct Jet {
  static_assert(Order == 1 || Order == 2);
  using Gradient = Eigen::Matrix<double, N, 1>;
  using Hessian = Eigen::Matrix<double, N, N>;
  struct None {};

  double value = 0;
  Gradient gradient = Gradient::Zero();
  std::conditional_t<Order == 2, Hessian, None> hessian{};

  Jet() { clear(); }
  Jet(double constant) : value(constant) { clear(); }  // NOLINT: constants stand beside variables
  static Jet variable(double at, int number) {
    Jet x(at);
    x.gradient[number] = 1;
    return x;
  }
  /// f(x) of a function with these derivatives there.
  [[nodiscard]] Jet of(double f, double first, double second) const {
    Jet out(f);
    out.gradient = first * gradient;
    if constexpr (Order == 2) out.hessian = first * hessian + second * gradient * gradient.transpose();
    return out;
  }

 private:
  void clear() {
    if constexpr (Order == 2) hessian.setZero();
  }
};

template <int N, int Order>
Jet<N, Order> operator+(const Jet<N, Order>& a, const Jet<N, Order>& b) {
  Jet<N, Order> out(a.value + b.value);
  out.gradient = a.gradient + b.gradient;
  if constexpr (Order == 2) out.hessian = a.hessian + b.hessian;
  return out;
}
template <int N, int Order>
Jet<N, Order> operator-(const Jet<N, Order>& a, const Jet<N, Order>& b) {
  Jet<N, Order> out(a.value - b.value);
  out.gradient = a.gradient - b.gradient;
  if constexpr (Order == 2) out.hessian = a.hessian - b.hessian;
  return out;
}
template <int N, int Order>
Jet<N, Order> operator*(const Jet<N, Order>& a, const Jet<N, Order>& b) {
  Jet<N, Order> out(a.value * b.value);
  out.gradient = a.value * b.gradient + b.value * a.gradient;
  if constexpr (Order == 2) {
    out.hessian = a.value * b.hessian + b.value * a.hessian;
    out.hessian += a.gradient * b.gradient.transpose() + b.gradient * a.gradient.transpose();
  }
  return out;
}
template <int N, int Order>
Jet<N, Order> operator*(double a, const Jet<N, Order>& b) {
  return b.of(a * b.value, a, 0);
}
template <int N, int Order>
Jet<N, Order> operator-(const Jet<N, Order>& a, double b) {
  return a.of(a.value - b, 1, 0);
}

/// 1 / sqrt(x), x > 0
inline double inverse_root(double x) {
  return 1 / std::sqrt(x);
}
template <int N, int Order>
Jet<N, Order> inverse_root(const Jet<N, Order>& x) {
  const double f = 1 / std::sqrt(x.value);
  return x.of(f, -f / (2 * x.value), 3 * f / (4 * x.value * x.value));
}

/// The angle of (x, y), in (-pi, pi].
inline double angle_of(double y, double x) {
  return std::atan2(y, x);
}
template <int N, int Order>
Jet<N, Order> angle_of(const Jet<N, Order>& y, const Jet<N, Order>& x) {
  const double square = x.value * x.value + y.value * y.value;
  const double by_y = x.value / square, by_x = -y.value / square;
  Jet<N, Order> out(std::atan2(y.value, x.value));
  out.gradient = by_y * y.gradient + by_x * x.gradient;
  if constexpr (Order == 2) {
    const double yy = 2 * by_y * by_x, xy = by_x * by_x - by_y * by_y;
    out.hessian = by_y * y.hessian + by_x * x.hessian;
    out.hessian += yy * (y.gradient * y.gradient.transpose() - x.gradient * x.gradient.transpose());
    out.hessian += xy * (x.gradient * y.gradient.transpose() + y.gradient * x.gradient.transpose());
  }
  return out;
}

template <class Number>
using Vector3Of = std::array<Number, 3>;

template <class Number>
Number dot(const Vector3Of<Number>& a, const Vector3Of<Number>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class Number>
Vector3Of<Number> cross(const Vector3Of<Number>& a, const Vector3Of<Number>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class Number>
Vector3Of<Number> scaled(const Number& factor, const Vector3Of<Number>& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
template <class Number>
Vector3Of<Number> normalized(const Vector3Of<Number>& a) {
  return scaled(inverse_root(dot(a, a)), a);
}

}  // namespace softkin::energy
