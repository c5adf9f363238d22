#pragma once

#include <softkin/energy/kernels/wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

/// F = R S with a proper rotation R (the best one, so det S < 0 where det F < 0) and a symmetric S.
struct Polar {
  Pack33 rotation, stretch;
};
[[nodiscard]] Polar polar(const Pack33& gradient);

/// (tr(S) I - S)^-1, which gives the turn of R: R^T dR = [w]_x, (tr(S) I - S) w = axial(R^T dF - dF^T R). It is
/// positive semidefinite; where it is singular (two mirrored stretches of the same size: R is not unique) the result
/// is large but finite.
[[nodiscard]] Pack33 polar_turn_compliance(const Pack33& stretch);

/// Eigenvalues and eigenvectors (the columns of `axes`, right-handed or not) of a symmetric matrix, in every lane:
/// matrix = axes diag(value) axes^T.
///
/// source  cyclic Jacobi rotations, to rounding
struct Principal {
  Pack value[3];
  Pack33 axes;
};
[[nodiscard]] Principal principal(const Pack33& symmetric);

/// elastic_stiffness with d^2W/dF^2 replaced by the nearest positive semidefinite matrix, in every lane.
///
/// source  in the frame of the principal stretches the 9 x 9 matrix of an isotropic law is a 3 x 3 block (stretches)
///         and three 2 x 2 blocks (symmetric and antisymmetric shears); Smith, De Goes, Kim 2019, "Analytic
///         eigensystems for isotropic distortion energies", Section 4
template <int K, int Q>
void projected_stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out);

/// elastic_stiffness of a law of the principal stretches, exact: the same blocks as they are.
template <Law law, int K, int Q>
void stretch_stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out);

}  // namespace softkin::energy::SOFTKIN_TARGET
