#pragma once

#include <softkin/core/types.hpp>
#include <softkin/energy/kernels/elastic.hpp>

namespace softkin::energy {

/// Energy and its gradient, in every lane. Where a law has no energy, as J <= 0 and it forbids inversion or bar I1
/// is at its limit or beyond, the result is finite and meaningless, and the lane is marked in `forbidden`.
///
/// block    law [MPa], slopes [1/mm], volumes [mm^3]
/// current  positions [mm]
/// throws   InvalidInput on a law that does not exist
template <int K, int Q>
void elastic_force(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticForce<K>& out) {
  SOFTKIN_RUN_KERNEL(elastic_force(block, current, out));
}

/// Cauchy stress, force per deformed area, at every quadrature point and in every lane [MPa]; meaningless as the energy
/// is where a law forbids inversion.
///
/// source   sigma = P F^T / J, P = dW/dF; of a dielectric elastomer F and J are those of the elastic part
/// throws   InvalidInput on a law that does not exist
template <int K, int Q>
void elastic_stress(const ElasticBlock<K, Q>& block, const Shape<K>& current, Pack33 (&stress)[Q]) {
  SOFTKIN_RUN_KERNEL(elastic_stress(block, current, stress));
}

/// Second derivative of the energy. projected: with d^2W/dF^2 of every quadrature point replaced by the nearest
/// positive semidefinite matrix. Finite everywhere; where the corotational law's rotation is not unique (mirrored
/// elements with two stretches of one size) the exact one is large and meaningless, the projected one is usable.
///
/// source  projection: Smith, De Goes, Kim 2019, "Analytic eigensystems for isotropic distortion energies", Section 4
/// throws  InvalidInput on a law that does not exist
template <int K, int Q>
void elastic_stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, bool projected,
                       ElasticStiffness<K>& out) {
  SOFTKIN_RUN_KERNEL(elastic_stiffness(block, current, projected, out));
}

/// Shape functions' gradients and volumes of one element at rest.
///
/// throws  InvalidInput, with the first node's position, where the volume at a quadrature point is not above 0
template <int K, int Q>
struct ElasticRest {
  Eigen::Matrix<double, K, 3> slope[Q];  // [1/mm]
  double volume[Q];                      // [mm^3], sum: the element's volume
};
[[nodiscard]] ElasticRest<4, 1> elastic_rest(const Eigen::Matrix<double, 4, 3>& rest);
/// Nodes: corners, then the edges 01, 12, 02, 03, 13, 23; four-point rule (C3D10). Curved edges: the rule is not exact
/// for constant stress, the patch test is missed by the square of their curvature.
[[nodiscard]] ElasticRest<10, 4> elastic_rest(const Eigen::Matrix<double, 10, 3>& rest);
/// Three points in the triangle by two across (6 points).
[[nodiscard]] ElasticRest<6, 6> elastic_rest(const Eigen::Matrix<double, 6, 3>& rest);

/// Columns: two unit vectors in the mean plane of a prism's triangles and their common normal, from bottom to top;
/// right-handed.
///
/// throws  InvalidInput where the triangles span no area
[[nodiscard]] Mat3 layer_frame(const Eigen::Matrix<double, 6, 3>& rest);

/// What a step lacks to turn an element instead of shearing it. A linear step of a body that bends far enlarges it as
/// it turns it; the deformation gradient F with rate F' is better led to exp([w]) (F + F' - [w] F), w being the rate at
/// which the rotation of F turns.
///
/// block    the element at rest
/// current  its nodes [mm], step: their moves [mm]
/// pull     sum over quadrature points of volume (exp([w]) (F + F' - [w] F) - F - F') slope_a [mm^2 mm]
/// source   the rotation-strain coordinates of Huang et al. 2011, used as a retraction: second order in the step
template <int K, int Q>
void turning_pull(const ElasticBlock<K, Q>& block, const Shape<K>& current, const Shape<K>& step, Shape<K>& pull) {
  SOFTKIN_RUN_KERNEL(turning_pull(block, current, step, pull));
}

}  // namespace softkin::energy
