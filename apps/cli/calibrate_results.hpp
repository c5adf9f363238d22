#pragma once

#include <softkin/io/plot/svg_plot.hpp>

#include "calibrate_material.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

/// A ratio of R_omega that the user asked to look at.
struct TriedRatio {
  double ratio = 1;
  std::vector<calibration::SpecimenResponse> stretched, twisted;
};

/// What came out of specimens of two materials.
struct SpecimenResults {
  std::vector<StretchedSpecimen> specimens;
  std::vector<TwistedSpecimen> twists;
  calibration::RatioEstimate rod;  // Eq. (16)
  std::optional<calibration::Moduli> rod_moduli;
  std::optional<calibration::RatioFit> physical, target;
  std::vector<calibration::SpecimenResponse> physical_twists, target_twists;
  std::vector<TriedRatio> tried;

  /// Of the first simulation that is not converged; empty: all are.
  [[nodiscard]] std::string failure(const MaterialOptions& options) const;
};

/// Difference over what was measured [%].
[[nodiscard]] double off_percent(double found, double measured);

/// What the simulations took as given, with " (default)" where the user did not say it.
[[nodiscard]] std::vector<std::string> set_up_lines(const MaterialOptions& options);
[[nodiscard]] std::string specimens_text(const SpecimenResults& results, const MaterialOptions& options);
[[nodiscard]] Json specimens_json(const SpecimenResults& results, const MaterialOptions& options);
[[nodiscard]] Plot specimens_plot(const SpecimenResults& results, const MaterialOptions& options);
[[nodiscard]] std::string specimens_residuals(const SpecimenResults& results);

/// The materials of a scene, YAML.
[[nodiscard]] std::string specimens_fragment(const SpecimenResults& results, const MaterialOptions& options);

}  // namespace softkin::cli
