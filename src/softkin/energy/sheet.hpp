#pragma once

#include <softkin/core/sheet_law.hpp>

namespace softkin::energy {

enum class SheetState { taut, wrinkled, slack };

/// The response of a sheet to a strain (E11, E22, 2 E12).
struct SheetResponse {
  double energy = 0;            // per volume [MPa]
  Vec3 stress = Vec3::Zero();   // S11, S22, S12 [MPa]
  Mat3 tangent = Mat3::Zero();  // dS/dE [MPa]; positive semidefinite but of rubber
  SheetState state = SheetState::taut;
};

/// Returns the response of a sheet. Without compressive stiffness, a fraction of 1e-6 of the unrelaxed response
/// remains, so that slack regions keep a shape.
///
/// source  relaxed energy by its dual, the maximum of S . E - S . M S / 2 over the stresses S >= 0, M the compliance:
///         wrinkled, S = s t t^T, it is the maximum over directions t of (t . E t)^2 / (2 t t : M t t)
///         of rubber: the energy of uniaxial tension along the largest stretch, Pipkin 1986, "The relaxed energy
///         density for isotropic elastic membranes"
/// returns  values that are not finite for rubber whose area is 0
[[nodiscard]] SheetResponse sheet_response(const SheetLaw& law, const Vec3& strain);

/// Returns a smooth response of a sheet without compressive stiffness: the maximum of S . E - S . M S / 2 +
/// barrier log det S, whose stresses are tensile in every direction, if only slightly. For paths that begin far from
/// their end.
///
/// Rubber is treated by its stiffness at rest: strains are small where paths begin.
///
/// barrier  over the stiffness along the first direction, above 0 [-]: strains of its root are smoothed
/// source   interior point methods: Nocedal, Wright 2006, section 19.1
[[nodiscard]] SheetResponse smooth_sheet_response(const SheetLaw& law, const Vec3& strain, double barrier);

/// What rubber stores in plane stress, taut or pressed; and under a pull along its largest stretch, above 1, in the
/// wrinkles that this leaves.
[[nodiscard]] SheetResponse taut_rubber(const SheetRubber& rubber, const Vec3& strain);
[[nodiscard]] SheetResponse wrinkled_rubber(const SheetRubber& rubber, const Vec3& strain);

}  // namespace softkin::energy
