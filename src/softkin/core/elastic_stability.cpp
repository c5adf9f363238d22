#include <cmath>
#include <softkin/core/elastic_stability.hpp>

namespace softkin {

namespace {

/// Derivatives of W in bar I1 and bar I2.
struct InvariantSlopes {
  double by_first = 0, by_first_first = 0, by_second = 0;
};

InvariantSlopes slopes_of(const ElasticLaw& law, double excess) {
  switch (law.law) {
    case Law::mooney_rivlin:
      return {law.c10, 0, law.c01};
    case Law::yeoh:
      return {law.c10 + 2 * law.c20 * excess + 3 * law.c30 * excess * excess, 2 * law.c20 + 6 * law.c30 * excess, 0};
    case Law::gent: {
      const double left = 1 - excess / law.jm;
      return {law.mu / (2 * left), law.mu / (2 * law.jm * left * left), 0};
    }
    case Law::st_venant_kirchhoff:
    case Law::corotational:
    case Law::neo_hookean:
    case Law::ogden:
      break;
  }
  return {shear_modulus(law) / 2, 0, 0};
}

Mat3 ogden_stiffness(const ElasticLaw& law, const Vec3& stretches) {
  Mat3 stiffness = Mat3::Zero();
  for (const OgdenTerm& term : law.ogden)
    for (int i = 0; i < 3; ++i) stiffness(i, i) += term.mu * term.alpha * std::pow(stretches[i], term.alpha);
  return stiffness;
}

/// Smallest eigenvalue over changes of shape that keep the volume, and the largest one, for its scale.
struct PlaneEigenvalues {
  double least = 0, largest = 0;
};

PlaneEigenvalues in_plane(const Mat3& stiffness) {
  const Vec3 a = Vec3(1, -1, 0) / std::sqrt(2.0), b = Vec3(1, 1, -2) / std::sqrt(6.0);
  const double aa = a.dot(stiffness * a), bb = b.dot(stiffness * b), ab = a.dot(stiffness * b);
  const double mean = (aa + bb) / 2, apart = std::hypot((aa - bb) / 2, ab);
  return {mean - apart, mean + apart};
}

}  // namespace

Mat3 logarithmic_stiffness(const ElasticLaw& law, const Vec3& stretches) {
  if (law.law == Law::ogden) return ogden_stiffness(law, stretches);
  const Vec3 squares = stretches.cwiseAbs2(), inverse = squares.cwiseInverse();
  const InvariantSlopes w = slopes_of(law, squares.sum() - 3);
  Mat3 stiffness = 4 * w.by_first_first * squares * squares.transpose();
  stiffness.diagonal() += 4 * w.by_first * squares + 4 * w.by_second * inverse;
  return stiffness;
}

Vec3 stretches_of(StretchMode mode, double l) {
  switch (mode) {
    case StretchMode::planar:
      return {l, 1, 1 / l};
    case StretchMode::equibiaxial:
      return {l, l, 1 / (l * l)};
    case StretchMode::uniaxial:
      break;
  }
  return {l, 1 / std::sqrt(l), 1 / std::sqrt(l)};
}

std::optional<StabilityLimit> stability_limit(const ElasticLaw& law, double largest_stretch) {
  constexpr int steps = 200;
  constexpr double rounding = 1e-12;
  std::optional<StabilityLimit> nearest;
  for (const StretchMode mode : stretch_modes)
    for (int i = 0; i <= steps; ++i) {
      const double l = std::exp(std::log(largest_stretch) * i / steps);
      if (nearest && l >= nearest->stretch) break;
      const Vec3 stretches = stretches_of(mode, l);
      if (law.law == Law::gent && stretches.squaredNorm() - 3 >= law.jm) break;  // it has no energy there
      const PlaneEigenvalues eigen = in_plane(logarithmic_stiffness(law, stretches));
      if (!(eigen.least < -rounding * std::abs(eigen.largest))) continue;
      nearest = {mode, l};
      break;
    }
  return nearest;
}

}  // namespace softkin
