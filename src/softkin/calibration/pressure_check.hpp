#pragma once

#include <optional>
#include <softkin/core/progress.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/robot_spec.hpp>
#include <string>
#include <utility>
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

/// Returns the place of the tested chamber among the actuators. requested: its name; empty: the only one
/// throws  InvalidInput: no chamber, several, none of that name
[[nodiscard]] std::size_t tested_chamber(const RobotSpec& spec, const std::string& requested);

/// Pressures of a measured curve compared with those that a scene's physical formulation predicts.
struct PressureComparison {
  std::string actuator;
  std::vector<double> ratios;
  std::vector<std::optional<double>> predicted;           // per ratio [kPa]; none: no equilibrium
  std::vector<std::pair<Branch, ModulusCheck>> branches;  // those with two ratios or more that have a prediction

  [[nodiscard]] bool is_complete() const;
};

/// Inflates a chamber by volume, the others open, to even ratios of the curve.
///
/// spec     of the scene; solved in the physical formulation
/// chamber  its place among the actuators
/// throws   InvalidInput as compile() does, where the scene has no elastic constants; a loading branch without ratios
///         above 1
[[nodiscard]] PressureComparison compare_with_physics(RobotSpec spec, std::size_t chamber, const ActuatorCurve& curve,
                                                      int threads, const ProgressCallback& progress = {});

}  // namespace softkin::calibration
