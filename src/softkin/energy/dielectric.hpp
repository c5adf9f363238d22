#pragma once

#include <softkin/energy/elastic.hpp>

namespace softkin::energy {

// DielectricPrisms, prisms between two electrodes: the potential is 0 on their first triangle and the voltage on the
// second, and between them what the interpolation of the nodes makes of it.
//
// Energy per rest volume: -eps/2 J |F^-T E_0|^2, with E_0 = voltage grad(zeta), zeta the fraction of the voltage at a
// point: the electric enthalpy of a linear dielectric at constant voltage, in the rest frame.
//
// source  Z. Suo, X. Zhao, W. Greene, JMPS 56, 2008, "A nonlinear field theory of deformable dielectrics", ideal
//         dielectric elastomers

/// Permittivity of a vacuum [MPa per (kV/mm)^2]: 8.8541878128e-12 F/m.
inline constexpr double vacuum_permittivity_MPa = 8.8541878128e-6;

/// Adds energy and gradient of the electric field. Where it is not 0 and J <= 0 the result is finite and meaningless,
/// and the lane is marked in `forbidden`.
///
/// prisms        slopes [1/mm] and volumes at rest; its law is not read
/// permittivity  of every lane, times the square of its fraction of the voltage [MPa per (kV/mm)^2]
/// voltage_kV    between the electrodes; the force is even in it
inline void add_dielectric_force(const DielectricPrisms& prisms, const Pack& permittivity, double voltage_kV,
                                 const Shape<6>& current, ElasticForce<6>& out) {
  SOFTKIN_RUN_KERNEL(add_dielectric_force(prisms, permittivity, voltage_kV, current, out));
}

/// Adds Maxwell's stress eps (e e^T - |e|^2 / 2 I), e the true field, at every quadrature point [MPa].
inline void add_maxwell_stress(const DielectricPrisms& prisms, const Pack& permittivity, double voltage_kV,
                               const Shape<6>& current, Pack33 (&stress)[6]) {
  SOFTKIN_RUN_KERNEL(add_maxwell_stress(prisms, permittivity, voltage_kV, current, stress));
}

/// Adds the second derivative of the energy: exact; it has hardly anything that is positive.
inline void add_dielectric_stiffness(const DielectricPrisms& prisms, const Pack& permittivity, double voltage_kV,
                                     const Shape<6>& current, ElasticStiffness<6>& out) {
  SOFTKIN_RUN_KERNEL(add_dielectric_stiffness(prisms, permittivity, voltage_kV, current, out));
}

}  // namespace softkin::energy
