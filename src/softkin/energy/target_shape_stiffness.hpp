#pragma once

#include <softkin/energy/target_shape.hpp>

namespace softkin::energy {

/// Gradient of every lane's volume [mm^2].
inline void volume_slope(const Shape<4>& current, Shape<4>& out) {
  SOFTKIN_RUN_KERNEL(volume_slope_of_blocks(current, out));
}
inline void volume_slope(const Shape<6>& current, Shape<6>& out) {
  SOFTKIN_RUN_KERNEL(volume_slope_of_blocks(current, out));
}

/// The change of a body element's pull with its shape, -K d with K the derivative of minus the pull.
///
/// current   as pull_of_body returns it: centred [mm]
/// rotation  the one that pull_of_body found there
/// change    d, of the elements' vertices [mm]; need not be centred
/// equation  pull = w (a R T + b X) with the rest shape T and a, b of Eq. (5); R turns by
///           omega = (tr(S) I - S)^-1 sum_i q_i x d_i, q = R T, S = sum_i x_i q_i^T, as R^T H stays symmetric
template <int K>
void pull_change_of_body(const BodyBlock<K>& block, const Shape<K>& current, const PackRotation& rotation,
                         const Shape<K>& change, Shape<K>& out) {
  SOFTKIN_RUN_KERNEL(pull_change_of_body(block, current, rotation, change, out));
}

/// The same of an actuation element whose ratio changes by ratio_change.
template <int K>
void pull_change_of_actuation(const ActuationBlock<K>& block, const Pack& ratio, const Pack& ratio_change,
                              const Shape<K>& current, const PackRotation& rotation, const Shape<K>& change,
                              Shape<K>& out) {
  SOFTKIN_RUN_KERNEL(pull_change_of_actuation(block, ratio, ratio_change, current, rotation, change, out));
}

/// The pull by which elements, turned as their targets are, ask for a move: w (exp(omega) (X + d - omega x X) - X) with
/// the change d and omega of pull_change_of_body. To first order w d; a bend by a large angle stays one.
///
/// out  a target for the global step, not a derivative
template <int K>
void turned_move_of_body(const BodyBlock<K>& block, const Shape<K>& current, const PackRotation& rotation,
                         const Shape<K>& change, Shape<K>& out) {
  SOFTKIN_RUN_KERNEL(turned_move_of_body(block, current, rotation, change, out));
}
template <int K>
void turned_move_of_actuation(const ActuationBlock<K>& block, const Pack& ratio, const Shape<K>& current,
                              const PackRotation& rotation, const Shape<K>& change, Shape<K>& out) {
  SOFTKIN_RUN_KERNEL(turned_move_of_actuation(block, ratio, current, rotation, change, out));
}

/// How current_ratio changes with the shape, along `change`; neither need be centred.
template <int K>
[[nodiscard]] Pack ratio_change(const ActuationBlock<K>& block, const Shape<K>& current, const Shape<K>& change) {
  const auto run = [&](double* kept) { SOFTKIN_RUN_KERNEL(ratio_change(block, current, change, kept)); };
  Pack value;
  run(&value[0]);
  return value;
}

/// How the pull answers to the element's own ratio and that to the shape; current is centred.
template <int K>
void ratio_coupling(const ActuationBlock<K>& block, const Pack& ratio, const Shape<K>& current,
                    const PackRotation& rotation, RatioCoupling<K>& out) {
  SOFTKIN_RUN_KERNEL(ratio_coupling(block, ratio, current, rotation, out));
}

/// The stiffness of body elements: minus the derivative of the pull.
///
/// projected  false: exact for R_omega = 1, half the energy's Hessian. true: the nearest positive semidefinite matrix.
/// deviation  for R_omega < 1 the pull is no gradient and its derivative not symmetric: there the result is always a
///            positive semidefinite matrix near it, with the volume term grad V grad V^T of the same trace
/// equation   w (N (x) I - G^T (tr(S) I - S)^-1 G), G_i = [q_i]x. Only the three modes G^T u, turns of the target, can
///            be negative: where an eigenvalue of (tr(S) I - S) in the metric G G^T is below 1, it becomes 1
template <int K>
void stiffness_of_body(const BodyBlock<K>& block, const Shape<K>& current, const PackRotation& rotation, bool projected,
                       TargetStiffness<K>& out) {
  SOFTKIN_RUN_KERNEL(stiffness_of_body(block, current, rotation, projected, out));
}

/// The same of actuation elements at their ratios.
///
/// redistributed  does the element's ratio follow its shape (least-norm)? Then the result is positive semidefinite:
///                near the derivative with the sum of all ratios free, whose growth mode meets hardly any resistance
template <int K>
void stiffness_of_actuation(const ActuationBlock<K>& block, const Pack& ratio, bool redistributed,
                            const Shape<K>& current, const PackRotation& rotation, bool projected,
                            TargetStiffness<K>& out) {
  SOFTKIN_RUN_KERNEL(stiffness_of_actuation(block, ratio, redistributed, current, rotation, projected, out));
}

}  // namespace softkin::energy
