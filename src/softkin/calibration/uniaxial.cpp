#include <cmath>
#include <softkin/calibration/uniaxial.hpp>
#include <softkin/core/error.hpp>

namespace softkin::calibration {

namespace {

/// Slope of the isochoric energy by s, where the stretches are s, s^-1/2, s^-1/2.
double isochoric_slope(const ElasticLaw& law, double s) {
  const double excess = s * s + 2 / s - 3;
  const double slope_1 = law.c10 + 2 * law.c20 * excess + 3 * law.c30 * excess * excess;
  return 2 * (s - 1 / (s * s)) * (slope_1 + law.c01 / s);
}

/// The bulk modulus times J - 1 balances the isochoric pull on the sides; both as functions of their stretch t.
double excess_pressure(const ElasticLaw& law, double stretch, double t) {
  const double s = std::pow(stretch / t, 2.0 / 3);
  const double j = stretch * t * t;
  return 3 * law.bulk * (j - 1) * j - isochoric_slope(law, s) * s;
}

double nearly_incompressible_stress(const ElasticLaw& law, double stretch) {
  double low = 1 / std::sqrt(stretch), high = low;  // no change of volume at low
  for (int grow = 0; excess_pressure(law, stretch, high) < 0; ++grow) {
    if (grow > 200) throw InvalidInput("under tension this law finds no stretch of its sides");
    high *= 1.05;
  }
  for (int halve = 0; halve < 100 && high - low > 1e-15; ++halve) {
    const double middle = 0.5 * (low + high);
    (excess_pressure(law, stretch, middle) < 0 ? low : high) = middle;
  }
  const double t = 0.5 * (low + high), s = std::pow(stretch / t, 2.0 / 3);
  // from the isochoric part: J - 1 of a nearly incompressible law has few digits
  return isochoric_slope(law, s) * s / stretch;
}

}  // namespace

double uniaxial_stress(const IncompressibleLaw& law, double strain) {
  const double s = 1 + strain, excess = s * s + 2 / s - 3;
  const double slope_1 = law.c10 + 2 * law.c20 * excess + 3 * law.c30 * excess * excess;
  return 2 * (s - 1 / (s * s)) * (slope_1 + law.c01 / s);
}

double uniaxial_stress(const ElasticLaw& law, double strain) {
  if (!(strain >= 0) || !std::isfinite(strain)) throw InvalidInput("a tensile strain must not be below 0");
  const double stretch = 1 + strain;
  if (law.law == Law::neo_hookean) {
    const double j = 1 + law.mu * (1 - 1 / stretch) / (law.lambda + law.mu);  // nothing pulls the sides
    return law.mu * (stretch - j / (stretch * stretch));
  }
  if (law.law != Law::mooney_rivlin && law.law != Law::yeoh)
    throw InvalidInput("tension is known of neo-hookean, mooney-rivlin and yeoh alone");
  return nearly_incompressible_stress(law, stretch);
}

}  // namespace softkin::calibration
