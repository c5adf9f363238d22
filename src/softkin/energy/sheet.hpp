#pragma once

#include <softkin/core/sheet_law.hpp>

namespace softkin::energy {

enum class SheetState { taut, wrinkled, slack };

/// What a sheet answers with to a strain (E11, E22, 2 E12).
struct SheetResponse {
  double energy = 0;            // per volume [MPa]
  Vec3 stress = Vec3::Zero();   // S11, S22, S12 [MPa]
  Mat3 tangent = Mat3::Zero();  // dS/dE [MPa]; positive semidefinite but of rubber
  SheetState state = SheetState::taut;
};

/// Of a sheet that takes tension only a share of 1e-6 is of one that is pressed, too: what is slack keeps a shape.
///
/// source  relaxed energy by its dual, the most of S . E - S . M S / 2 over the stresses S >= 0, M the compliance:
///         wrinkled, S = s t t^T, it is the most over directions t of (t . E t)^2 / (2 t t : M t t)
///         of rubber: what a pull along the largest stretch stores, Pipkin 1986, "The relaxed energy density for
///         isotropic elastic membranes"
/// returns  of rubber that has no area left what is not finite
[[nodiscard]] SheetResponse sheet_response(const SheetLaw& law, const Vec3& strain);

/// The same of one that takes tension only, without kinks: the most of S . E - S . M S / 2 + barrier log det S, whose
/// stresses pull in every direction, if by nearly nothing. For ways that begin far from where they end.
///
/// Of rubber by its stiffness at rest: strains where ways begin are small.
///
/// barrier  over the stiffness along the first direction, above 0 [-]: strains of its root are smoothed
/// source   interior point methods: Nocedal, Wright 2006, section 19.1
[[nodiscard]] SheetResponse smooth_sheet_response(const SheetLaw& law, const Vec3& strain, double barrier);

/// What rubber stores in plane stress, taut or pressed; and under a pull along its largest stretch, above 1, in the
/// wrinkles that this leaves.
[[nodiscard]] SheetResponse taut_rubber(const SheetRubber& rubber, const Vec3& strain);
[[nodiscard]] SheetResponse wrinkled_rubber(const SheetRubber& rubber, const Vec3& strain);

}  // namespace softkin::energy
