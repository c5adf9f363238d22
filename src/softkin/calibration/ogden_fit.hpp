#pragma once

#include <softkin/core/elastic_law.hpp>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::calibration {

/// Ogden's law of so many terms at most to a tensile test: least squares in the nominal stress of an incompressible
/// material, with mu_p alpha_p >= 0 of every term, so that the law is stable at every stretch. Terms whose strength is
/// 0 are left out.
///
/// strain, stress  [-], [MPa]
/// terms           1 to max_ogden_terms
/// source          the strengths are linear and follow from the exponents (variable projection, Golub and Pereyra
///                 1973); exponents from the best places of a grid, by a compass search from each
[[nodiscard]] std::vector<OgdenTerm> fit_ogden(const Eigen::VectorXd& strain, const Eigen::VectorXd& stress, int terms);

/// The limit of Gent's law, and its shear modulus [MPa], to a tensile test.
struct GentConstants {
  double shear_modulus = 0, jm = 0;
};
[[nodiscard]] GentConstants fit_gent(const Eigen::VectorXd& strain, const Eigen::VectorXd& stress);

}  // namespace softkin::calibration
