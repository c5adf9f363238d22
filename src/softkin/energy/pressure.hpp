#pragma once

#include <softkin/energy/elastic.hpp>

namespace softkin::energy {

// Elements that keep their volume by a pressure of their own: beside the energy of the law
//
//   sum over quadrature points of volume (p (J - 1) - softness p^2 / 2), p = sum_i L_i p_i,
//
// made stationary in the pressures at the corners, where it is (J - 1)^2 / (2 softness) of a J that is averaged over
// the elements around. p is a stress: tension is positive. softness 0: the volume does not change.
//
// source  Taylor, Hood 1973: p linear and continuous on quadratic tetrahedra is stable. On linear ones it is not by
//         itself; `smoothing` takes the part of p off that no linear element can answer, 1/2 smoothing
//         (p - mean of p)^2: Dohrmann, Bochev 2004, "A stabilized finite element method for the Stokes problem based on
//         polynomial pressure projections"

/// Adds energy, as W + softness p^2 / 2, which it is where the pressures are stationary, and its gradient in the nodes
/// with p held.
///
/// block     slopes [1/mm], volumes [mm^3]; its law is not read
/// pressure  [MPa], [1/MPa]
/// missed    the gradient in the pressures [mm^3]
template <int K, int Q>
void add_pressure_force(const ElasticBlock<K, Q>& block, const CornerPressure& pressure, const Shape<K>& current,
                        ElasticForce<K>& out, PressureMiss& missed) {
  SOFTKIN_RUN_KERNEL(add_pressure_force(block, pressure, current, out, missed));
}

/// Adds p to the Cauchy stress at every quadrature point [MPa].
template <int K, int Q>
void add_pressure_stress(const ElasticBlock<K, Q>&, const CornerPressure& pressure, Pack33 (&stress)[Q]) {
  SOFTKIN_RUN_KERNEL(add_pressure_stress<K, Q>(pressure, stress));
}

/// Adds the second derivative in the nodes, and gives those in nodes and pressures [mm^2] and in pressures [mm^3/MPa].
/// projected: nothing is added in the nodes, where it has hardly anything that is positive
template <int K, int Q>
void add_pressure_stiffness(const ElasticBlock<K, Q>& block, const CornerPressure& pressure, const Shape<K>& current,
                            bool projected, ElasticStiffness<K>& out, PressureCoupling<K>& coupling) {
  SOFTKIN_RUN_KERNEL(add_pressure_stiffness(block, pressure, current, projected, out, coupling));
}

}  // namespace softkin::energy
