#pragma once

#include <softkin/calibration/uniaxial.hpp>
#include <softkin/model/measurements.hpp>
#include <softkin/model/robot_spec.hpp>

namespace softkin::calibration {

/// How well a curve follows the data.
struct FitQuality {
  double r_squared = 0;  // 1 - squares left over squares about the mean [-]
  double rms_mpa = 0;
  double largest_mpa = 0;
};

/// The linear range of a tensile test: the longest one from its first point on in which no stress is off the straight
/// line through the origin that fits them all by more than a share of that line's stress at the range's end.
struct LinearRange {
  double modulus_mpa = 0;  // slope of that line
  double end_strain = 0;   // [-]
  std::size_t points = 0;
  bool whole = false;     // does the range end only with the data
  double offset_mpa = 0;  // of the free straight line over the range: a test that was not zeroed has one
  FitQuality quality;     // over the range
};

/// tolerance  the share, > 0
/// throws     InvalidInput on fewer than five points, or where no range of five has a line with a slope > 0
[[nodiscard]] LinearRange linear_range(const TensileCurve& curve, double tolerance = 0.05);

/// An incompressible law fitted to a tensile test.
struct LawFit {
  IncompressibleLaw law;
  bool at_bound = false;  // without the bound E >= 1 % of the data's mean secant modulus the initial modulus is less
  std::optional<double> falls_at;  // strain from -0.5 to the data's end beyond which, seen from 0, the stress falls [-]
  FitQuality quality;
  std::size_t points = 0;
};

/// Least squares in the stress; linear in the constants.
///
/// law       neo_hookean, mooney_rivlin or yeoh
/// most      strain up to which points count [-]; 0: all
/// throws    InvalidInput on another law, fewer points with strain > 0 than constants, or a stress whose fit is not
///           finite
[[nodiscard]] LawFit fit_law(const TensileCurve& curve, Law law, double most = 0);

/// The constants for a scene. Its laws are compressible: scaled by 3 / (2 (1 + nu)), so that the modulus at small
/// strain is that of the fit. neo-hookean: E of the fit and nu.
[[nodiscard]] ElasticSpec scene_constants(const IncompressibleLaw& law, double poisson_ratio);

/// Of the law as the scene has it, over the points that were fitted.
[[nodiscard]] FitQuality scene_quality(const TensileCurve& curve, const ElasticSpec& spec, double most = 0);

}  // namespace softkin::calibration
