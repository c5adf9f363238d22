#pragma once

#include <softkin/core/elastic_law.hpp>

namespace softkin::calibration {

/// Constants of an incompressible law [MPa]: W = c10 (I1 - 3) + c01 (I2 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3.
/// neo-hookean: c10 alone; mooney-rivlin: c10, c01; yeoh: c10, c20, c30.
struct IncompressibleLaw {
  Law law = Law::neo_hookean;
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0;

  /// At rest [MPa]: 6 (c10 + c01).
  [[nodiscard]] double youngs_modulus() const { return 6 * (c10 + c01); }
};

/// Nominal stress [MPa] under tension along one axis, sides free; s = 1 + strain > 0.
///
/// source  P = 2 (s - s^-2) (W_1 + W_2 / s), W_1 = c10 + 2 c20 (I1 - 3) + 3 c30 (I1 - 3)^2, W_2 = c01,
///         I1 = s^2 + 2 / s
[[nodiscard]] double uniaxial_stress(const IncompressibleLaw& law, double strain);

/// The same of a law as scenes have it, which is compressible: the sides take the stretch at which nothing pulls them.
/// neo-hookean, mooney-rivlin and yeoh; strain >= 0.
///
/// throws  InvalidInput on another law, a strain below 0, or where no stretch of the sides is found
[[nodiscard]] double uniaxial_stress(const ElasticLaw& law, double strain);

}  // namespace softkin::calibration
