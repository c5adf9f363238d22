#pragma once

#include <softkin/energy/elastic.hpp>

namespace softkin::energy {

/// elastic_stiffness with d^2W/dF^2 replaced by the nearest positive semidefinite matrix, in every lane.
///
/// source  in the frame of the principal stretches the 9 x 9 matrix of an isotropic law is a 3 x 3 block (stretches)
///         and three 2 x 2 blocks (symmetric and antisymmetric shears); Smith, De Goes, Kim 2019, "Analytic
///         eigensystems for isotropic distortion energies", Section 4
template <int K, int Q>
void projected_stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out);

}  // namespace softkin::energy
