#pragma once

#include <softkin/energy/pack.hpp>

namespace softkin::energy {

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

}  // namespace softkin::energy
