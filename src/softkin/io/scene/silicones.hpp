#pragma once

#include <softkin/model/named_material.hpp>
#include <softkin/model/robot_spec.hpp>
#include <string>
#include <vector>

namespace softkin {

/// Constants of a silicone that were fitted to a measured curve: by softkin calibrate material, as of an incompressible
/// material. scripts/silicone_sets.py makes the table from the curves.
struct SiliconeSet {
  std::string material;        // "ecoflex-00-30"
  std::string name;            // "yeoh"
  Law law = Law::neo_hookean;  // neo_hookean, mooney_rivlin, yeoh or ogden
  std::vector<double>
      constants;            // neo-hookean: mu; mooney-rivlin: c10, c01; yeoh: c10, c20, c30; ogden: mu1, alpha1, ...
  double up_to_strain = 0;  // that was fitted
  double rms_percent = 0;   // of the largest stress that was fitted

  /// As scenes have it. poisson_ratio: close to 0.5
  [[nodiscard]] ElasticSpec elastic(double poisson_ratio) const;
};

/// All fitted sets, by material.
[[nodiscard]] const std::vector<SiliconeSet>& silicone_sets();

/// Where the curves come from.
[[nodiscard]] const char* silicone_curves_source();

/// A silicone that scenes can name: what its maker says of it, and the constants that follow; and those fitted to a
/// measured curve, where there is one.
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

  /// Neo-Hookean, by the data sheet. poisson_ratio: close to 0.5
  [[nodiscard]] ElasticSpec elastic(double poisson_ratio = usual_poisson_ratio) const;
  /// A set by its name; throws InvalidInput of the origin with those that there are.
  [[nodiscard]] ElasticSpec elastic(const std::string& set, double poisson_ratio, const Origin& origin) const;
  /// "datasheet", then those of silicone_sets().
  [[nodiscard]] std::vector<std::string> sets() const;
  /// For notes and reports, with the moduli of all sets.
  [[nodiscard]] NamedMaterial named(const std::string& set, double poisson_ratio) const;

  static constexpr double usual_poisson_ratio = 0.49;
  static constexpr const char* default_set = "datasheet";
};

/// All of them, in the order of the documents.
[[nodiscard]] const std::vector<Silicone>& silicones();

/// The one of that name; throws InvalidInput of the origin with the nearest name.
[[nodiscard]] const Silicone& silicone(const std::string& name, const Origin& origin);

}  // namespace softkin
