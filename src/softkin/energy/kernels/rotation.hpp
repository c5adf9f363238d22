#pragma once

#include <softkin/core/target.hpp>
#include <softkin/energy/pack.hpp>

namespace softkin::energy {

// energy/rotation.hpp documents them.
SOFTKIN_KERNELS(void to_matrix_of_blocks(const energy::PackRotation& rotation, double* kept);
                void best_rotation_of_blocks(const energy::Pack33& correlation, energy::PackRotation& rotation);)

/// Davenport's eigenproblem: the largest eigenvector of his 4 x 4 matrix, (w, x, y, z), of a correlation by rows.
void davenport(const double (&correlation)[9], double (&quaternion)[4]);

}  // namespace softkin::energy
