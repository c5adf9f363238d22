#pragma once

#include <softkin/energy/elastic.hpp>

namespace softkin::energy {

// ViscousBlock: Maxwell branches of the elements of a block over a time step: springs and dampers in series, parallel
// to the elastic law.
//
// source  a branch stores G/2 (bar C : C_v^-1 - 3) and flows by dC_v/dt = (bar C - (bar C : C_v^-1) C_v / 3) / tau,
//         det C_v = 1; bar C = J^(-2/3) C, of a dielectric elastomer that of the elastic part. Reese, Govindjee 1998.
//         The step is C_v = the unimodular part of M, the mean of C_v and bar C at its begin and bar C at its end by
//         the fractions of ViscousBlock. With 1 / (1 + x), 0, x / (1 + x) in their place it is implicit Euler's, whose
//         closed form is due to Shutov, Landgraf, Ihlemann 2013; these are exact at small strain where the strain
//         changes evenly, and at large strain of first order with a far smaller error.
//         The stress that follows is the gradient of 3/2 G det(M)^(1/3) / ended, which is the least, over unimodular
//         C_v, of G/2 M : C_v^-1 / ended: a step is an elastic problem.

/// What is the same for every shape that a step may end with.
///
/// viscous  but for its begun
template <int Q>
void begin_step(const ViscousBlock& viscous, double* begun) {
  SOFTKIN_RUN_KERNEL(begin_step<Q>(viscous, begun));
}

/// Adds energy and gradient of the branches. Where J <= 0 they are finite and meaningless.
template <int K, int Q>
void add_viscous_force(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Shape<K>& current,
                       ElasticForce<K>& out) {
  SOFTKIN_RUN_KERNEL(add_viscous_force(block, viscous, current, out));
}

/// Adds second derivatives. projected: a positive semidefinite matrix in their place, the stiffness at C_v that is held
/// without what the change of volume contributes.
template <int K, int Q>
void add_viscous_stiffness(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Shape<K>& current,
                           bool projected, ElasticStiffness<K>& out) {
  SOFTKIN_RUN_KERNEL(add_viscous_stiffness(block, viscous, current, projected, out));
}

/// Adds the Cauchy stress of the branches at every quadrature point [MPa].
template <int K, int Q>
void add_viscous_stress(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Shape<K>& current,
                        Pack33 (&stress)[Q]) {
  SOFTKIN_RUN_KERNEL(add_viscous_stress(block, viscous, current, stress));
}

/// What the branches remember after the step.
///
/// rate     step over relaxation time of every branch, finite
/// strains  in the order of ViscousBlock::strains
/// returns  the energy that the branches dissipate in the step, >= 0 [mJ]: the integral of G / (2 tau) tr(dev(bar C
///          C_v^-1)^2), that stress changing from the step's begin to its end as where the strain changes evenly
template <int K, int Q>
Pack flow(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Pack* rate, const Shape<K>& current,
          double* strains) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(flow(block, viscous, rate, current, strains, kept)); };
  Pack value;
  run(&value[0]);
  return value;
}

}  // namespace softkin::energy
