#pragma once

#include <softkin/model/robot_spec.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A silicone that scenes can name: what its maker says of it, and the constants that follow.
///
/// Where the maker gives the nominal stress at twice the length, sigma_100, the shear modulus is that of an
/// incompressible neo-Hookean solid with this stress, sigma = mu (l - 1 / l^2), so mu = sigma_100 / 1.75.
struct Silicone {
  std::string name;              // "ecoflex-00-30"
  std::string hardness;          // Shore, "00-30"
  double stress_100_psi = 0;     // at twice the length; 0: not given
  double shear_modulus_MPa = 0;  // mu at small strain
  double density = 0;            // [kg/m^3]
  std::string source;

  /// Neo-Hookean. poisson_ratio: close to 0.5
  [[nodiscard]] ElasticSpec elastic(double poisson_ratio = usual_poisson_ratio) const;

  static constexpr double usual_poisson_ratio = 0.49;
};

/// All of them, in the order of the documents.
[[nodiscard]] const std::vector<Silicone>& silicones();

/// The one of that name; throws InvalidInput of the origin with the nearest name.
[[nodiscard]] const Silicone& silicone(const std::string& name, const Origin& origin);

}  // namespace softkin
