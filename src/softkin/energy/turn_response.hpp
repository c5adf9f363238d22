#pragma once

#include <softkin/energy/kernels/turn_response.hpp>

namespace softkin::energy {

/// Inverse of a symmetric positive semidefinite 3 x 3 matrix in every lane; zero in lanes where it is singular: there
/// the best rotation is not unique, and none of its derivatives is more right than none.
[[nodiscard]] inline Pack33 turn_response(const Pack33& stiffness) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(turn_response_of_blocks(stiffness, kept)); };
  Pack33 value;
  run(&value.row[0].x[0]);
  return value;
}

/// Inverse of a symmetric 3 x 3 matrix after raising its eigenvalues in a metric to at least `least` > 0.
///
/// metric   symmetric positive definite; where it is singular it counts as slightly larger
/// returns  L^-T Q max(Lambda, least)^-1 Q^T L^-1 with metric = L L^T, L^-1 stiffness L^-T = Q Lambda Q^T; zero in
///          lanes whose metric is zero
[[nodiscard]] inline Pack33 turn_response(const Pack33& stiffness, const Pack33& metric, const Pack& least) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(turn_response_of_blocks(stiffness, metric, least, kept)); };
  Pack33 value;
  run(&value.row[0].x[0]);
  return value;
}

}  // namespace softkin::energy
