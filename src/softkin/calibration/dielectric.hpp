#pragma once

#include <optional>
#include <vector>

namespace softkin::calibration {

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

/// True electric field at a stretch and its voltage [kV/mm].
[[nodiscard]] double field_of(const Dielectric& elastomer, double stretch, double voltage_kV);

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
