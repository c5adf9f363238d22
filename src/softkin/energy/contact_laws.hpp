#pragma once

namespace softkin::energy {

/// A function of one length with its derivatives by it.
struct LengthLaw {
  double value = 0, slope = 0, curvature = 0;
};

/// Barrier between surfaces, per area and per modulus: reach beta(gap / reach), beta(z) = -(z - 1)^2 ln z for z < 1,
/// else 0. Without bound where the gap closes, twice continuously differentiable where it ends.
///
/// gap      > 0 [mm]
/// reach    gap at which surfaces begin to feel each other, > 0 [mm]
/// returns  value [mm], slope [-], whose negative times the modulus is the pressure, curvature [1/mm]
/// source   Li et al. 2020, "Incremental potential contact", equation 6, by the gap itself and with the factor that
///          makes pressure independent of the mesh: Li et al. 2023, "Convergent incremental potential contact"
[[nodiscard]] LengthLaw barrier(double gap, double reach);

/// Dissipative potential of Coulomb's friction, per normal force and coefficient: 1 N mm per mm of slip, smooth in
/// slips below `creep`, by which a contact that sticks yields.
///
/// slip     >= 0 [mm]
/// creep    > 0 [mm]
/// returns  value [mm], slope, 0 to 1 [-], curvature [1/mm]
/// source   Li et al. 2020, equations 14 and 15
[[nodiscard]] LengthLaw friction(double slip, double creep);

}  // namespace softkin::energy
