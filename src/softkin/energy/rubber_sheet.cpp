#include <Eigen/Dense>
#include <cmath>
#include <softkin/energy/sheet.hpp>

namespace softkin::energy {

namespace {

/// A function of the strain with its derivatives.
struct Invariant {
  double value = 0;
  Vec3 slope = Vec3::Zero();
  Mat3 curvature = Mat3::Zero();
};

/// By the chain rule.
SheetResponse response_of(const SheetRubber& rubber, const Invariant& first, const Invariant& second) {
  const double over = first.value - 3;
  const double by_first = rubber.c10 + over * (2 * rubber.c20 + 3 * over * rubber.c30);
  const double bend = 2 * rubber.c20 + 6 * over * rubber.c30;
  SheetResponse out;
  out.energy = over * (rubber.c10 + over * (rubber.c20 + over * rubber.c30)) + rubber.c01 * (second.value - 3);
  out.stress = by_first * first.slope + rubber.c01 * second.slope;
  out.tangent =
      by_first * first.curvature + bend * first.slope * first.slope.transpose() + rubber.c01 * second.curvature;
  return out;
}

/// Trace and determinant of C = 1 + 2 E.
struct Stretches {
  Vec3 c;  // C11, C22, C12
  Invariant trace, area;

  explicit Stretches(const Vec3& strain) : c(2 * strain[0] + 1, 2 * strain[1] + 1, strain[2]) {
    trace = {c[0] + c[1], Vec3(2, 2, 0), Mat3::Zero()};
    area = {c[0] * c[1] - c[2] * c[2], Vec3(2 * c[1], 2 * c[0], -2 * c[2]), Mat3::Zero()};
    area.curvature(0, 1) = area.curvature(1, 0) = 4;
    area.curvature(2, 2) = -2;
  }
};

Mat3 product(const Vec3& a, const Vec3& b) {
  return a * b.transpose() + b * a.transpose();
}

/// The largest principal stretch, squared.
Invariant largest_square(const Stretches& s) {
  const double middle = s.trace.value / 2;
  const double apart = std::hypot((s.c[0] - s.c[1]) / 2, s.c[2]);
  const double angle = 0.5 * std::atan2(2 * s.c[2], s.c[0] - s.c[1]);
  const double x = std::cos(angle), y = std::sin(angle);
  const Vec3 mixed(-2 * x * y, 2 * x * y, x * x - y * y);
  return {middle + apart, Vec3(2 * x * x, 2 * y * y, 2 * x * y), mixed * mixed.transpose() / apart};
}

}  // namespace

/// I1 = tr C + 1 / det C, I2 = det C + tr C / det C
SheetResponse taut_rubber(const SheetRubber& rubber, const Vec3& strain) {
  const Stretches s(strain);
  const double t = s.trace.value, d = s.area.value;
  const Mat3 square = s.area.slope * s.area.slope.transpose();
  const Invariant first{t + 1 / d, s.trace.slope - s.area.slope / (d * d),
                        2 / (d * d * d) * square - s.area.curvature / (d * d)};
  const Invariant second{d + t / d, s.area.slope + s.trace.slope / d - t / (d * d) * s.area.slope,
                         (1 - t / (d * d)) * s.area.curvature - product(s.trace.slope, s.area.slope) / (d * d) +
                             2 * t / (d * d * d) * square};
  return response_of(rubber, first, second);
}

/// I1 = l^2 + 2 / l, I2 = 2 l + 1 / l^2, as functions of the square.
SheetResponse wrinkled_rubber(const SheetRubber& rubber, const Vec3& strain) {
  const Invariant square = largest_square(Stretches(strain));
  const double q = square.value, l = std::sqrt(q);
  const auto of = [&](double value, double slope, double bend) {
    return Invariant{value, slope * square.slope,
                     slope * square.curvature + bend * square.slope * square.slope.transpose()};
  };
  SheetResponse out = response_of(rubber, of(q + 2 / l, 1 - 1 / (l * q), 1.5 / (l * q * q)),
                                  of(2 * l + 1 / q, 1 / l - 1 / (q * q), 2 / (q * q * q) - 0.5 / (l * q)));
  out.state = SheetState::wrinkled;
  return out;
}

}  // namespace softkin::energy
