#pragma once

#include <softkin/model/measurements.hpp>
#include <vector>

namespace softkin::calibration {

/// E_A / E_B of a stretched rod, A at the fixed end: strain of B over strain of A [-].
///
/// source  Fang et al. 2020, Eq. (16), right-hand side; its left-hand side, eps_A / eps_B, is a misprint
/// throws  InvalidInput on lengths that are not 0 < L_1 < L, 0 < Delta L_1 < Delta L
[[nodiscard]] double elasticity_ratio(const StretchedSpecimen& specimen);

/// Delta L_1 / Delta L of a rod with this E_A / E_B; equally the share of a twist that its interface turns, where both
/// materials have the same Poisson's ratio.
[[nodiscard]] double rod_share(double ratio, double length_mm, double interface_mm);

/// By how much Delta L_1 falls where the logarithm of E_A / E_B grows by 1, of a rod at the measured point [mm]: with
/// the same error of every Delta L_1 the specimens' logarithms weigh as its square.
[[nodiscard]] double rod_sensitivity_mm(const StretchedSpecimen& specimen);

/// A ratio from several specimens.
struct RatioEstimate {
  double ratio = 1;   // [-]
  double spread = 0;  // relative standard deviation of one specimen [-]; of a single one 0
  double least = 1, greatest = 1;
  std::size_t specimens = 0;
};

/// The mean of the logarithms, weighted by the squares of the sensitivities: to first order the least squares in
/// Delta L_1.
///
/// throws  InvalidInput on no specimen, sizes that differ, or numbers that are not finite
[[nodiscard]] RatioEstimate combined_ratio(const std::vector<double>& log_ratios,
                                           const std::vector<double>& sensitivities);

/// A small-strain material of the target-shape formulation, up to a common factor of its moduli.
///
/// equation  E proportional to 6 R / (2 + R), nu = (1 - R) / (2 + R)
/// source    docs/paper.md, "What this formulation is and is not"
[[nodiscard]] double stiffness_of_shape_ratio(double shape_ratio);
[[nodiscard]] double poisson_ratio_of_shape_ratio(double shape_ratio);
/// The R_omega with that Poisson's ratio: (1 - 2 nu) / (1 + nu).
[[nodiscard]] double shape_ratio_of_poisson_ratio(double poisson_ratio);

/// ln(R_omega A / R_omega B) of that closed form for an E_A / E_B; the stiffer one has the R_omega given.
[[nodiscard]] double closed_form_log_ratio(double elasticity_ratio, double stiffer);

}  // namespace softkin::calibration
