#pragma once

namespace softkin {

/// Volumes of the closed air of a chamber on its syringe at the start, under atmospheric pressure.
struct SyringeSetup {
  double chamber_mm3 = 0;       // V_c^0, > 0
  double tube_mm3 = 0;          // V_t, >= 0
  double syringe_mm3 = 0;       // V_sy^0, > 0
  double atmosphere_kPa = 100;  // absolute, > 0; the paper's value for one atmosphere
};

/// alpha = V_c / V_c^0 of the chamber of a closed syringe [-].
///
/// absolute_kPa  > 0
/// syringe_mm3   pushed out of the syringe since the start
/// source        Fang et al. 2020, Eq. (19)
[[nodiscard]] double chamber_ratio(const SyringeSetup& setup, double absolute_kPa, double syringe_mm3);

/// Returns Delta V_sy [mm^3] that brings the chamber to a ratio under a pressure: the inverse of Eq. (18).
[[nodiscard]] double syringe_volume(const SyringeSetup& setup, double absolute_kPa, double ratio);

}  // namespace softkin
