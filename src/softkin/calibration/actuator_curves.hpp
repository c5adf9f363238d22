#pragma once

#include <cstddef>
#include <optional>
#include <softkin/model/actuator_curve.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// A measured point of an actuator's curve.
struct CurveSample {
  double input = 0;  // gauge pressure [kPa] or voltage [kV]
  double ratio = 1;  // volume or area over that without input [-]
  Branch branch = Branch::loading;
  std::size_t repeat = 0;  // samples of one sweep have one number
};

/// How well a branch describes its samples.
struct BranchQuality {
  std::size_t samples = 0, repeats = 0;
  double rms = 0;                    // of the samples' ratios around the curve [-]
  double largest = 0;                // distance of a sample's ratio from the curve [-]
  std::optional<double> mean_error;  // standard error of the mean of the repeats, largest along the curve [-]
  std::size_t pooled = 0;            // points that were merged because the ratio fell with the input
};

struct CurveFit {
  CurveBranch loading;
  std::optional<CurveBranch> unloading;
  BranchQuality loading_quality, unloading_quality;
};

/// Monotone curves through the samples of each branch.
///
/// Up to 15 different inputs in a branch are its points as they are (equal ones averaged). Of more, the points are at
/// most 15 local quadratic fits at even distances. Where they do not ascend, neighbours are pooled (isotonic
/// regression). A loading branch that begins within a twentieth of its range from input 0 begins at (0, 1), by the
/// definition of the ratio; an unloading branch that ends within a fiftieth of its range from 0 is continued to 0.
/// Spread: standard deviation, at each point, of the fits of single repeats, where at least two reach it.
///
/// throws  InvalidInput: no loading samples, a branch with fewer than two different inputs or whose ratio does not
///         rise with its input
[[nodiscard]] CurveFit fit_curve(const std::vector<CurveSample>& samples);

enum class DielectricLaw { neo_hookean, gent };

/// A dielectric elastomer that stretches alike in both directions of its plane, between compliant electrodes, under
/// constant forces that stretch it by `prestretch` without voltage. Incompressible.
struct Dielectric {
  DielectricLaw law = DielectricLaw::neo_hookean;
  double shear_modulus_MPa = 0;      // mu at small strain, > 0
  double relative_permittivity = 0;  // > 0
  double thickness_mm = 0;           // before any stretch, > 0
  double prestretch = 1;             // length over that without forces [-], >= 1
  double stretch_limit = 0;          // gent: J_lim > 2 p^2 + p^-4 - 3, p the prestretch
};

/// Permittivity of vacuum [F/m].
inline constexpr double vacuum_permittivity = 8.8541878128e-12;

/// Voltage that holds a stretch [kV].
///
/// stretch  length over that without forces [-], >= prestretch
/// source   sigma + eps E^2 = lambda dW/dlambda, the equation of state of equal-biaxial stretch: mu (l^2 - l^-4)
///          (neo-hookean), times J_lim / (J_lim - 2 l^2 - l^-4 + 3) (Gent), with sigma = s l of the constant forces
///          and E = l^2 U / H: Z. Suo, "Theory of dielectric elastomers", Acta Mechanica Solida Sinica 23(6), 2010
[[nodiscard]] double voltage_of(const Dielectric& elastomer, double stretch);

/// Where the voltage that holds a stretch has its first maximum: beyond it the elastomer thins without end, or snaps to
/// a much larger stretch.
struct PullIn {
  double stretch = 1;  // length over that without forces [-]
  double voltage_kV = 0;
  double field_kV_mm = 0;  // true
};

/// None where the voltage rises up to the stretch that a Gent chain allows.
[[nodiscard]] std::optional<PullIn> pull_in(const Dielectric& elastomer);

/// Points of the stable branch from no voltage on.
struct DielectricCurve {
  std::vector<double> voltages;     // ascending from 0 [kV]
  std::vector<double> area_ratios;  // over the area without voltage [-]
  std::optional<PullIn> pull_in;    // none: the voltage rises all the way
  bool broken_down = false;         // the curve ends where the field reaches the breakdown field
  double end_field_kV_mm = 0;       // true, at the end of the curve
};

/// points           >= 3, even in the stretch's distance from the end, denser towards it
/// breakdown_kV_mm  true field that the elastomer bears; 0: not known
/// throws           InvalidInput on values out of range
[[nodiscard]] DielectricCurve dielectric_curve(const Dielectric& elastomer, int points, double breakdown_kV_mm = 0);

}  // namespace softkin::calibration
