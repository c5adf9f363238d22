#include <algorithm>
#include <cmath>
#include <softkin/calibration/elasticity_ratio.hpp>
#include <softkin/core/error.hpp>

namespace softkin::calibration {

double elasticity_ratio(const StretchedSpecimen& s) {
  const bool inside = s.interface_mm > 0 && s.interface_mm < s.length_mm && std::isfinite(s.length_mm);
  const bool moved = s.interface_moved_mm > 0 && s.interface_moved_mm < s.stretch_mm && std::isfinite(s.stretch_mm);
  if (!inside || !moved) throw InvalidInput("a specimen needs 0 < L1 < L and 0 < dL1 < dL");
  return s.interface_mm * (s.stretch_mm - s.interface_moved_mm) /
         ((s.length_mm - s.interface_mm) * s.interface_moved_mm);
}

double rod_share(double ratio, double length_mm, double interface_mm) {
  return interface_mm / (interface_mm + ratio * (length_mm - interface_mm));
}

double rod_sensitivity_mm(const StretchedSpecimen& s) {
  return s.interface_moved_mm * (s.stretch_mm - s.interface_moved_mm) / s.stretch_mm;
}

RatioEstimate combined_ratio(const std::vector<double>& log_ratios, const std::vector<double>& sensitivities) {
  if (log_ratios.empty() || log_ratios.size() != sensitivities.size())
    throw InvalidInput("a ratio needs at least one specimen");
  double weights = 0, mean = 0;
  for (std::size_t i = 0; i < log_ratios.size(); ++i) {
    const double weight = sensitivities[i] * sensitivities[i];
    weights += weight;
    mean += weight * log_ratios[i];
  }
  mean /= weights;
  if (!std::isfinite(mean)) throw InvalidInput("a specimen's ratio is not finite");
  double squares = 0;
  for (std::size_t i = 0; i < log_ratios.size(); ++i)
    squares += sensitivities[i] * sensitivities[i] * (log_ratios[i] - mean) * (log_ratios[i] - mean);
  const auto count = static_cast<double>(log_ratios.size());
  const auto [least, greatest] = std::minmax_element(log_ratios.begin(), log_ratios.end());
  RatioEstimate estimate;
  estimate.ratio = std::exp(mean);
  if (log_ratios.size() > 1) estimate.spread = std::sqrt(squares / weights * count / (count - 1));
  estimate.least = std::exp(*least);
  estimate.greatest = std::exp(*greatest);
  estimate.specimens = log_ratios.size();
  return estimate;
}

double stiffness_of_shape_ratio(double shape_ratio) {
  return 6 * shape_ratio / (2 + shape_ratio);
}

double poisson_ratio_of_shape_ratio(double shape_ratio) {
  return (1 - shape_ratio) / (2 + shape_ratio);
}

double shape_ratio_of_poisson_ratio(double poisson_ratio) {
  return (1 - 2 * poisson_ratio) / (1 + poisson_ratio);
}

double closed_form_log_ratio(double elasticity_ratio, double stiffer) {
  const double softer_stiffness = stiffness_of_shape_ratio(stiffer) * std::exp(-std::abs(std::log(elasticity_ratio)));
  const double softer = 2 * softer_stiffness / (6 - softer_stiffness);
  const double log_ratio = std::log(stiffer / softer);
  return elasticity_ratio >= 1 ? log_ratio : -log_ratio;
}

}  // namespace softkin::calibration
