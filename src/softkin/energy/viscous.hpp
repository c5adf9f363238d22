#pragma once

#include <softkin/energy/elastic.hpp>

namespace softkin::energy {

/// Maxwell branches of the elements of a block over a time step: springs and dampers in series, beside the elastic law.
///
/// source  a branch stores G/2 (bar C : C_v^-1 - 3) and flows by dC_v/dt = (bar C - (bar C : C_v^-1) C_v / 3) / tau,
///         det C_v = 1; bar C = J^(-2/3) C, of a dielectric elastomer that of the elastic part. Reese, Govindjee 1998.
///         The implicit step is C_v = unimodular part of (k C_v0 + (1 - k) bar C): Shutov, Landgraf, Ihlemann 2013,
///         there with k = 1 / (1 + time / tau). Here k = exp(-time / tau), with which a strain that is held relaxes at
///         small strain as it does in continuous time, whatever the step.
///         With it the stress is the gradient of 3/2 G (det(k C_v0 + (1 - k) bar C)^(1/3) - k) / (1 - k), least over all
///         unimodular C_v: a step is an elastic problem.
struct ViscousBlock {
  int branches = 0;
  const Pack* modulus = nullptr;    // G of every branch [MPa]; 0 in lanes that have fewer
  const Pack* kept = nullptr;       // k of every branch [-]; 1: instant, 0: relaxed
  const double* strains = nullptr;  // C_v0 by quadrature point, branch, entry (xx, yy, zz, xy, yz, xz) and lane;
                                    // null: the unit matrix
};

/// Adds energy and gradient of the branches. Where J <= 0 they are finite and meaningless.
template <int K, int Q>
void add_viscous_force(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Shape<K>& current,
                       ElasticForce<K>& out);

/// Adds second derivatives. projected: a positive semidefinite matrix in their place, the stiffness at C_v that is held
/// without what the change of volume contributes.
template <int K, int Q>
void add_viscous_stiffness(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Shape<K>& current,
                           bool projected, ElasticStiffness<K>& out);

/// Adds the Cauchy stress of the branches at every quadrature point [MPa].
template <int K, int Q>
void add_viscous_stress(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Shape<K>& current,
                        Pack33 (&stress)[Q]);

/// What the branches remember after the step.
///
/// strains  C_v, in the order of ViscousBlock::strains
/// returns  the energy that the branches lose as they flow at the shape that the step ends with, >= 0 [mJ]
template <int K, int Q>
Pack flow(const ElasticBlock<K, Q>& block, const ViscousBlock& viscous, const Shape<K>& current, double* strains);

}  // namespace softkin::energy
