#pragma once

#include <softkin/energy/kernels/target_shape.hpp>
#include <softkin/energy/rotation.hpp>

namespace softkin::energy {

/// Signed volume of every lane [mm^3]; current need not be centred. Prisms: bilinear sides, exact.
[[nodiscard]] inline Pack volume(const Shape<4>& current) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(volume_of_blocks(current, kept)); };
  Pack value;
  run(&value[0]);
  return value;
}
[[nodiscard]] inline Pack volume(const Shape<6>& current) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(volume_of_blocks(current, kept)); };
  Pack value;
  run(&value[0]);
  return value;
}

/// What an actuation element has now of what its actuator controls: length, volume, mean area over the rest's [-].
template <int K>
[[nodiscard]] Pack current_ratio(const ActuationBlock<K>& block, const Shape<K>& current) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(current_ratio(block, current, kept)); };
  Pack value;
  run(&value[0]);
  return value;
}

/// Local step of a body element.
///
/// current   the elements' vertices [mm]; centred on return
/// rotation  in: where the search begins; out: R_i
/// source    Fang et al. 2020, Eqs. (2)-(5), (9); r is the cube root of the volume ratio (the print lacks the root)
/// deviation the volume-preserving target of an element below an eighth of its volume turns linearly into the rigid
///           one, which an inverted element takes whole: Eq. (4) would enlarge inverted elements
template <int K>
void pull_of_body(const BodyBlock<K>& block, Shape<K>& current, PackRotation& rotation, ElementPull<K>& out) {
  SOFTKIN_RUN_KERNEL(pull_of_body(block, current, rotation, out));
}

/// Local step of an actuation element at the local ratios given.
///
/// ratio   s_i, alpha_i or lambda_i [-], > 0
/// source  Fang et al. 2020, Eq. (2), Section II-D and Fig. 4
template <int K>
void pull_of_actuation(const ActuationBlock<K>& block, const Pack& ratio, Shape<K>& current, PackRotation& rotation,
                       ElementPull<K>& out) {
  SOFTKIN_RUN_KERNEL(pull_of_actuation(block, ratio, current, rotation, out));
}

/// Target shapes of Fig. 4 for one element at rest, split as ActuationBlock has it: rows are points.
template <int K>
struct TargetSplit {
  Eigen::Matrix<double, K, 3> constant, grown, thinned;
};
/// (cable end, cable end, apex), Eq. (6): the edge on x shrinks, the apex on y stays.
[[nodiscard]] TargetSplit<3> split_cable(const Eigen::Matrix<double, 3, 3>& rest);
/// The whole element grows about its centroid, Eq. (8).
[[nodiscard]] TargetSplit<4> split_pneumatic(const Eigen::Matrix<double, 4, 3>& rest);
/// Eq. (7): both triangles grow in their planes about their centres; the distance of the centres thins along the mean
/// normal.
[[nodiscard]] TargetSplit<6> split_dea(const Eigen::Matrix<double, 6, 3>& rest);

}  // namespace softkin::energy
