#pragma once

#include <softkin/core/types.hpp>
#include <softkin/energy/kernels/rotation.hpp>

namespace softkin::energy {

[[nodiscard]] inline Pack33 to_matrix(const PackRotation& rotation) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(to_matrix_of_blocks(rotation, kept)); };
  Pack33 value;
  run(&value.row[0].x[0]);
  return value;
}

/// Best proper rotation (det +1) between two shapes, in every lane, that of Eq. (2): maximises tr(R^T H), H = sum_i
/// current_i target_i^T. Right for inverted, flat and mirrored shapes too; where it is not unique, one of the best.
///
/// correlation  H [any unit]
/// rotation     in: where to start (a unit quaternion); out: the best one, to rounding
/// source       Newton on SO(3) from the last iteration's rotation. A rotation is the best one exactly if R^T H is
///              symmetric and tr(R^T H) I - R^T H positive semidefinite; lanes where Newton does not arrive at this
///              take the largest eigenvector of Davenport's 4 x 4 matrix. Fang et al. 2020 use an SVD.
inline void best_rotation(const Pack33& correlation, PackRotation& rotation) {
  SOFTKIN_RUN_KERNEL(best_rotation_of_blocks(correlation, rotation));
}

/// The same for one matrix, by Davenport's eigenproblem.
[[nodiscard]] Mat3 best_rotation(const Mat3& correlation);

}  // namespace softkin::energy
