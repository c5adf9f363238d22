#pragma once

#include <softkin/core/types.hpp>
#include <softkin/energy/pack.hpp>

namespace softkin::energy {

/// Unit quaternions, one per lane; w is the real part.
struct PackRotation {
  Pack w = pack(1), x = pack(0), y = pack(0), z = pack(0);
};

[[nodiscard]] Pack33 to_matrix(const PackRotation& rotation);

/// Best proper rotation (det +1) between two shapes, in every lane, that of Eq. (2): maximises tr(R^T H), H = sum_i
/// current_i target_i^T. Right for inverted, flat and mirrored shapes too; where it is not unique, one of the best.
///
/// correlation  H [any unit]
/// rotation     in: where to start (a unit quaternion); out: the best one, to rounding
/// source       Newton on SO(3) from the last iteration's rotation. A rotation is the best one exactly if R^T H is
///              symmetric and tr(R^T H) I - R^T H positive semidefinite; lanes where Newton does not arrive at this
///              take the largest eigenvector of Davenport's 4 x 4 matrix. Fang et al. 2020 use an SVD.
void best_rotation(const Pack33& correlation, PackRotation& rotation);

/// The same for one matrix, by Davenport's eigenproblem.
[[nodiscard]] Mat3 best_rotation(const Mat3& correlation);

}  // namespace softkin::energy
