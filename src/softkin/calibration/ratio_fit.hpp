#pragma once

#include <functional>
#include <softkin/calibration/test_log.hpp>
#include <softkin/model/measurements.hpp>
#include <vector>

namespace softkin::calibration {

/// E_A / E_B of a stretched rod, A at the fixed end: strain of B over strain of A [-].
///
/// source  Fang et al. 2020, Eq. (16), right-hand side; its left-hand side, eps_A / eps_B, is a misprint
/// throws  InvalidInput on lengths that are not 0 < L_1 < L, 0 < Delta L_1 < Delta L
[[nodiscard]] double elasticity_ratio(const StretchedSpecimen& specimen);

/// Returns Delta L_1 / Delta L of a rod with this E_A / E_B; equally the fraction of a twist by which its interface
/// turns, where both materials have the same Poisson's ratio.
[[nodiscard]] double rod_fraction(double ratio, double length_mm, double interface_mm);

/// By how much Delta L_1 falls where the logarithm of E_A / E_B grows by 1, of a rod at the measured point [mm]: with
/// the same error of every Delta L_1 the specimens' logarithms weigh as its square.
[[nodiscard]] double rod_sensitivity_mm(const StretchedSpecimen& specimen);

/// A ratio from several specimens.
struct RatioEstimate {
  double ratio = 1;                // [-]
  double spread = 0;               // relative standard deviation of one specimen [-]; of a single one 0
  double least = 1, greatest = 1;  // of single specimens
  std::size_t specimens = 0;       // that it is of
};

/// The mean of the logarithms, weighted by the squares of the sensitivities: to first order the least squares in
/// Delta L_1.
///
/// throws  InvalidInput on no specimen, sizes that differ, or numbers that are not finite
[[nodiscard]] RatioEstimate combined_ratio(const std::vector<double>& log_ratios,
                                           const std::vector<double>& sensitivities);

/// That of rods by Eq. (16).
[[nodiscard]] RatioEstimate rod_ratio(const std::vector<StretchedSpecimen>& specimens);

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

/// Young's moduli from the forces of the testing machine, least squares over the specimens that have one.
struct Moduli {
  double a_mpa = 0, b_mpa = 0;  // of A and B, Young's [MPa]
  double spread = 0;            // relative standard deviation of one specimen [-]; of a single one 0
  std::size_t specimens = 0;    // that have a force
};

/// A ratio from several specimens: E_A / E_B (physical) or R_omega A / R_omega B (target-shape).
struct RatioFit {
  Formulation formulation = Formulation::physical;  // of the simulated tests; determines the kind of ratio
  Status status = Status::not_converged;            // converged where every specimen is
  RatioEstimate estimate;                           // of the specimens that are converged; 0 of them: meaningless
  std::vector<SpecimenFit> specimens;               // in the order given
  std::optional<Moduli> moduli;                     // physical, where a force is given
};

/// Callback with the completed fraction of the simulations, 0 to 1.
using FractionDone = std::function<void(double fraction)>;

/// The ratio at which simulated tensile tests move the interface as the measured ones did: for every specimen by
/// bisection, shortened by the secant, from the closed form on; then all together.
///
/// returns status interrupted, and what was done, where options.go_on has ended it
/// source  Fang et al. 2020, Section IV-B, Fig. 7(c)
/// throws  InvalidInput on no specimen, one that is none, or one that cannot be meshed
[[nodiscard]] RatioFit fit_ratio(const std::vector<StretchedSpecimen>& specimens, const SpecimenOptions& options,
                                 Formulation formulation, const FractionDone& progress = {});

/// Moduli of a rod: force over area over the strain of each part. Nothing where no specimen has a force.
///
/// area_mm2  of the cross-section of specimens that do not state theirs
[[nodiscard]] std::optional<Moduli> rod_moduli(const std::vector<StretchedSpecimen>& specimens, double area_mm2);

/// What the tests do at a given ratio, found or not: stretched (Fig. 7c) or twisted (Fig. 7d). An interrupted one is
/// the last.
///
/// log_ratio  as of SpecimenTest::at
[[nodiscard]] std::vector<SpecimenResponse> predict(const std::vector<StretchedSpecimen>& specimens,
                                                    const SpecimenOptions& options, Formulation formulation,
                                                    double log_ratio, const FractionDone& progress = {});
[[nodiscard]] std::vector<SpecimenResponse> predict(const std::vector<TwistedSpecimen>& specimens,
                                                    const SpecimenOptions& options, Formulation formulation,
                                                    double log_ratio, const FractionDone& progress = {});

}  // namespace softkin::calibration
