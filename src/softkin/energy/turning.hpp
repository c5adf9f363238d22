#pragma once

#include <softkin/energy/elastic.hpp>

namespace softkin::energy {

/// What a step lacks to turn an element instead of shearing it. A linear step of a body that bends far enlarges it as
/// it turns it; the deformation gradient F with rate F' is better led to exp([w]) (F + F' - [w] F), w being the rate at
/// which the rotation of F turns.
///
/// block    the element at rest
/// current  its nodes [mm], step: their moves [mm]
/// pull     sum over quadrature points of volume (exp([w]) (F + F' - [w] F) - F - F') slope_a [mm^2 mm]
/// source   the rotation-strain coordinates of Huang et al. 2011, used as a retraction: second order in the step
template <int K, int Q>
void turning_pull(const ElasticBlock<K, Q>& block, const Shape<K>& current, const Shape<K>& step, Shape<K>& pull);

}  // namespace softkin::energy
