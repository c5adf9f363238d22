#pragma once

#include <functional>
#include <softkin/calibration/elasticity_ratio.hpp>
#include <softkin/calibration/specimen_test.hpp>

namespace softkin::calibration {

/// What a specimen says about a ratio, by simulations of its test.
struct SpecimenFit {
  Status status = Status::not_converged;  // limit: no ratio from 1e-4 to 1e4 moves its interface so far
  std::string remark;                     // why, where status is not converged
  double own_log_ratio = 0;               // at which the simulated interface moves as the measured one did
  double sensitivity_mm = 0;              // by how much its move falls where the logarithm grows by 1
  int simulations = 0;
  SpecimenResponse response;  // at the ratio of all specimens
};

/// Young's moduli from the forces of the testing machine, least squares over the specimens that have one.
struct Moduli {
  double a_mpa = 0, b_mpa = 0;
  double spread = 0;  // relative standard deviation of one specimen [-]; of a single one 0
  std::size_t specimens = 0;
};

/// A ratio from several specimens: E_A / E_B (physical) or R_omega A / R_omega B (target-shape).
struct RatioFit {
  Formulation formulation = Formulation::physical;
  Status status = Status::not_converged;  // converged where every specimen is
  RatioEstimate estimate;                 // of the specimens that are converged; 0 of them: meaningless
  std::vector<SpecimenFit> specimens;     // in the order given
  std::optional<Moduli> moduli;           // physical, where a force is given
};

using ShareDone = std::function<void(double share)>;

/// The ratio at which simulated tensile tests move the interface as the measured ones did: for every specimen by
/// bisection, shortened by the secant, from the closed form on; then all together.
///
/// source  Fang et al. 2020, Section IV-B, Fig. 7(c)
/// throws  InvalidInput on no specimen, one that is none, or one that cannot be meshed
[[nodiscard]] RatioFit fit_ratio(const std::vector<StretchedSpecimen>& specimens, const SpecimenOptions& options,
                                 Formulation formulation, const ShareDone& progress = {});

/// Moduli of a rod: force over area over the strain of each part. Nothing where no specimen has a force.
///
/// area_mm2  of the cross-section of specimens that do not state theirs
[[nodiscard]] std::optional<Moduli> rod_moduli(const std::vector<StretchedSpecimen>& specimens, double area_mm2);

/// What the tests do at a given ratio, found or not: stretched (Fig. 7c) or twisted (Fig. 7d).
/// log_ratio: as of SpecimenTest::at.
[[nodiscard]] std::vector<SpecimenResponse> predict(const std::vector<StretchedSpecimen>& specimens,
                                                    const SpecimenOptions& options, Formulation formulation,
                                                    double log_ratio, const ShareDone& progress = {});
[[nodiscard]] std::vector<SpecimenResponse> predict(const std::vector<TwistedSpecimen>& specimens,
                                                    const SpecimenOptions& options, Formulation formulation,
                                                    double log_ratio, const ShareDone& progress = {});

}  // namespace softkin::calibration
