#pragma once

#include <optional>
#include <softkin/core/progress.hpp>
#include <softkin/model/model.hpp>
#include <vector>

namespace softkin::calibration {

/// Gauge pressures that the physical formulation predicts for volume ratios of one chamber, the others at rest.
///
/// model    physical, the chamber's control a ratio
/// ratios   within the actuator's range; solved one from the last, in the order given
/// threads  of each solve; 0: as many as it is worth
/// returns  as many [kPa]; none where no equilibrium was found
/// throws   InvalidInput: another formulation or control, a ratio outside the range
[[nodiscard]] std::vector<std::optional<double>> predicted_pressures(const Model& model, Index actuator,
                                                                     const std::vector<double>& ratios, int threads = 0,
                                                                     const ProgressCallback& progress = {});

/// What measured pressures say of the moduli behind predicted ones.
struct ModulusCheck {
  double factor = 1;         // least squares: measured = factor * predicted; all moduli times it
  double misfit_before = 0;  // rms of measured - predicted over the rms of the measured [-]
  double misfit_after = 0;   // the same with the factor
};

/// At a given shape pressures are proportional to all moduli together, where no weight and no other load acts.
///
/// measured, predicted  as many, of the same ratios [kPa]
/// throws               InvalidInput where nothing is predicted to resist
[[nodiscard]] ModulusCheck check_modulus(const std::vector<double>& measured, const std::vector<double>& predicted);

}  // namespace softkin::calibration
