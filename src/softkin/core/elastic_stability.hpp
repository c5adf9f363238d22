#pragma once

#include <optional>
#include <softkin/core/elastic_law.hpp>
#include <softkin/core/types.hpp>

namespace softkin {

/// d^2W / (d ln l_i d ln l_j) of a change of shape without a change of volume [MPa], l_i the principal stretches.
/// Laws of rubber: neo-hookean, mooney-rivlin, yeoh, gent, ogden; of others that of their shear modulus at small
/// strain.
[[nodiscard]] Mat3 logarithmic_stiffness(const ElasticLaw& law, const Vec3& stretches);

/// Modes in which a sheet of rubber is stretched: along one axis with free sides, along one axis with a fixed width,
/// and equally along two axes. The last one is also compression along one axis.
enum class StretchMode { uniaxial, planar, equibiaxial };
inline constexpr StretchMode stretch_modes[] = {StretchMode::uniaxial, StretchMode::planar, StretchMode::equibiaxial};

/// Principal stretches of a mode whose largest one is given; their product is 1.
[[nodiscard]] Vec3 stretches_of(StretchMode mode, double largest);

/// Where a law loses its stability.
struct StabilityLimit {
  StretchMode mode = StretchMode::uniaxial;
  double stretch = 1;  // the largest principal stretch
};

/// The smallest stretch of any mode up to a largest one at which the logarithmic stiffness, over changes of shape that
/// keep the volume, is no longer positive definite; none: the law is stable so far.
///
/// source  Drucker's and Hill's condition, d tau : d ln l > 0 for all d ln l, as Abaqus checks it
[[nodiscard]] std::optional<StabilityLimit> stability_limit(const ElasticLaw& law, double largest_stretch);

}  // namespace softkin
