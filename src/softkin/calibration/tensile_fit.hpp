#pragma once

#include <softkin/core/elastic_law.hpp>
#include <softkin/model/measurements.hpp>
#include <softkin/model/robot_spec.hpp>

namespace softkin::calibration {

/// Constants of an incompressible law [MPa]: W = c10 (I1 - 3) + c01 (I2 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3.
/// neo-hookean: c10 alone; mooney-rivlin: c10, c01; yeoh: c10, c20, c30; gent: c10 and jm, W = -c10 jm ln(1 - (I1 -
/// 3) / jm); ogden: its terms.
struct IncompressibleLaw {
  Law law = Law::neo_hookean;                 // which of the constants count
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0;  // [MPa]
  double jm = 0;                              // gent: I1 - 3 < jm [-]; 0: no limit
  OgdenTerm ogden[max_ogden_terms] = {};      // ogden

  /// At rest [MPa]: 6 (c10 + c01), or 3/2 the sum of mu_p alpha_p.
  [[nodiscard]] double youngs_modulus() const { return 6 * (c10 + c01) + 3 * shear_modulus(ogden); }
  /// Terms of Ogden's law that are there.
  [[nodiscard]] int terms() const;
};

/// The change of shape of such a law, as scenes have it; without a bulk modulus.
[[nodiscard]] ElasticLaw isochoric(const IncompressibleLaw& law);

/// Nominal stress [MPa] under tension along one axis, sides free; s = 1 + strain > 0.
///
/// source  P = 2 (s - s^-2) (W_1 + W_2 / s), W_1 = c10 + 2 c20 (I1 - 3) + 3 c30 (I1 - 3)^2, W_2 = c01,
///         I1 = s^2 + 2 / s; gent: W_1 = c10 jm / (jm - (I1 - 3)); ogden: P = sum mu_p (s^(alpha_p - 1) -
///         s^(-alpha_p / 2 - 1))
[[nodiscard]] double uniaxial_stress(const IncompressibleLaw& law, double strain);

/// The same of a law as scenes have it, which is compressible: the sides take the stretch at which nothing pulls them.
/// neo-hookean, mooney-rivlin, yeoh, gent and ogden; strain >= 0.
///
/// throws  InvalidInput on another law, a strain below 0, or where no stretch of the sides is found
[[nodiscard]] double uniaxial_stress(const ElasticLaw& law, double strain);

/// How well a curve follows the data.
struct FitQuality {
  double r_squared = 0;    // 1 - squares left over squares about the mean [-]
  double rms_mpa = 0;      // of what is left of stresses
  double largest_mpa = 0;  // the largest of that
};

/// The linear range of a tensile test: the longest one from its first point on in which no stress is off the straight
/// line through the origin that fits them all by more than a fraction of that line's stress at the range's end.
struct LinearRange {
  double modulus_mpa = 0;  // slope of that line
  double end_strain = 0;   // [-]
  std::size_t points = 0;  // in the range
  bool whole = false;      // does the range end only with the data
  double offset_mpa = 0;   // of the free straight line over the range: a test that was not zeroed has one
  FitQuality quality;      // over the range
};

/// tolerance  that fraction, > 0
/// throws     InvalidInput on fewer than five points, or where no range of five has a line with a slope > 0
[[nodiscard]] LinearRange linear_range(const TensileCurve& curve, double tolerance = 0.05);

/// An incompressible law fitted to a tensile test.
struct LawFit {
  IncompressibleLaw law;  // what was fitted
  bool at_bound = false;  // without the bound E >= 1 % of the data's mean secant modulus the initial modulus is less
  std::optional<double> free_rms_mpa;  // without the conditions of stability, where these change the fit
  std::optional<double> falls_at;  // strain from -0.5 to the data's end beyond which, seen from 0, the stress falls [-]
  FitQuality quality;              // over the points that were fitted
  std::size_t points = 0;          // that were fitted
};

/// Which law to fit.
struct LawChoice {
  Law law = Law::neo_hookean;  // its form
  int terms = 0;               // ogden: at most
  /// From rest to the largest stretch of the points that are fitted, in every mode of stability_limit.
  bool stable = true;

  /// "yeoh", "ogden-2"
  [[nodiscard]] std::string name() const;
};

/// All laws that are fitted, the simplest first: neo-hookean, mooney-rivlin, yeoh, gent, ogden-1 to ogden-3.
[[nodiscard]] const std::vector<LawChoice>& fitted_laws();

/// Least squares in the stress.
///
/// most      strain up to which points count [-]; 0: all
/// throws    InvalidInput on a law that is not fitted, fewer points with strain > 0 than constants, or a stress whose
///           fit is not finite
[[nodiscard]] LawFit fit_law(const TensileCurve& curve, const LawChoice& choice, double most = 0);
/// Does a curve have as many points up to a strain as this law has constants? most: 0: all points
[[nodiscard]] bool has_points_for(const TensileCurve& curve, const LawChoice& choice, double most = 0);
/// The same without the conditions of stability.
[[nodiscard]] inline LawFit fit_law(const TensileCurve& curve, Law law, double most = 0) {
  return fit_law(curve, LawChoice{law, law == Law::ogden ? max_ogden_terms : 0, false}, most);
}

/// The constants for a scene. Its laws are compressible: scaled by 3 / (2 (1 + nu)), so that the modulus at small
/// strain is that of the fit. neo-hookean: E of the fit and nu.
[[nodiscard]] ElasticSpec scene_constants(const IncompressibleLaw& law, double poisson_ratio);

/// Of the law as the scene has it, over the points that were fitted.
[[nodiscard]] FitQuality scene_quality(const TensileCurve& curve, const ElasticSpec& spec, double most = 0);

}  // namespace softkin::calibration
