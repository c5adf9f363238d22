#pragma once

#include <optional>
#include <vector>

namespace softkin::calibration {

enum class DielectricLaw { neo_hookean, gent };

/// What is done to the edges of the layer while the voltage rises: T. Lu et al., "Dielectric elastomer actuators under
/// equal-biaxial forces, uniaxial forces, and uniaxial constraint of stiff fibers", Soft Matter 8, 2012, the law that
/// the paper takes for its crawler.
enum class DielectricLoading {
  equal_biaxial,  // constant forces, alike in both directions of its plane
  uniaxial,       // a constant force along one direction, none across
  constrained     // a constant force along one direction, and a stretch across that stiff fibres keep
};

/// A dielectric elastomer between compliant electrodes, under constant forces that stretch it by `prestretch` without
/// voltage. Incompressible.
struct Dielectric {
  DielectricLaw law = DielectricLaw::neo_hookean;
  double shear_modulus_MPa = 0;      // mu at small strain, > 0
  double relative_permittivity = 0;  // > 0
  double thickness_mm = 0;           // before any stretch, > 0
  double prestretch = 1;             // length along the force over that without forces [-], >= 1
  double stretch_limit = 0;          // gent: J_lim > l1^2 + l2^2 + l3^2 - 3 of the prestretches
  DielectricLoading loading = DielectricLoading::equal_biaxial;
  double prestretch_across = 1;  // constrained: what the fibres keep [-], >= 1
};

/// Permittivity of vacuum [F/m].
inline constexpr double vacuum_permittivity = 8.8541878128e-12;

/// Lengths in the plane, along the force (or alike in both) and across, over those without forces [-].
struct PlaneStretch {
  double along = 1, across = 1;

  [[nodiscard]] double area() const { return along * across; }
};

/// Of the stretch in the direction that is free to grow with the voltage: either of an equal-biaxial layer, across the
/// force of a uniaxial one (a Gent chain that is spread across may even pull it shorter along), along the force where
/// fibres keep the other.
[[nodiscard]] PlaneStretch plane_stretch(const Dielectric& elastomer, double stretch);

/// Voltage that holds a stretch [kV].
///
/// stretch  that of plane_stretch [-], not below that without voltage
/// source   dW/dl1 = s1 + eps (U/H)^2 l1 l2^2, dW/dl2 = s2 + eps (U/H)^2 l1^2 l2, the equations of state of an ideal
///          dielectric elastomer under nominal stresses s1 and s2 (Z. Suo, "Theory of dielectric elastomers", Acta
///          Mechanica Solida Sinica 23(6), 2010), W = mu/2 I (neo-hookean) or -mu/2 J_lim log(1 - I/J_lim) (Gent),
///          I = l1^2 + l2^2 + (l1 l2)^-2 - 3; s2 is s1 and l2 is l1, or s2 is 0, or l2 is kept (Lu et al. 2012)
[[nodiscard]] double voltage_of(const Dielectric& elastomer, double stretch);

/// Where the voltage that holds a stretch has its first maximum: beyond it the elastomer thins without end, or snaps to
/// a much larger stretch.
struct PullIn {
  double stretch = 1;     // that of plane_stretch [-]
  double area_ratio = 1;  // over the area without voltage [-]
  double voltage_kV = 0;
  double field_kV_mm = 0;  // true
};

/// None where the voltage rises up to the stretch that a Gent chain allows, or as far as it is looked for.
[[nodiscard]] std::optional<PullIn> pull_in(const Dielectric& elastomer);

/// Points of the stable branch from no voltage on.
struct DielectricCurve {
  std::vector<double> voltages;     // ascending from 0 [kV]
  std::vector<double> area_ratios;  // over the area without voltage [-]
  std::optional<PullIn> pull_in;    // none: the voltage rises to the end of the curve
  bool broken_down = false;         // the curve ends where the field reaches the breakdown field
  double end_field_kV_mm = 0;       // true, at the end of the curve
};

/// A neo-hookean elastomer that fibres constrain has no pull-in and no limit of its chains: its curve ends at this
/// stretch along the force, over the prestretch.
inline constexpr double constrained_end = 5;

/// points           >= 3, even in the stretch's distance from the end, denser towards it
/// breakdown_kV_mm  true field that the elastomer withstands; 0: unknown
/// throws           InvalidInput on values out of range
[[nodiscard]] DielectricCurve dielectric_curve(const Dielectric& elastomer, int points, double breakdown_kV_mm = 0);

}  // namespace softkin::calibration
