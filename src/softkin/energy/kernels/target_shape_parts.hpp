#pragma once

#include <softkin/energy/kernels/rotation_wide.hpp>
#include <softkin/energy/kernels/target_shape.hpp>

/// Formulas for the internal forces of the target-shape formulation and for their derivatives.
namespace softkin::energy::SOFTKIN_TARGET {

template <int K>
using BodyBlock = BodyBlockOf<Pack, K>;
template <int K>
using ActuationBlock = ActuationBlockOf<Pack, K>;
template <int K>
using ElementPull = ElementPullOf<Pack, K>;
template <int K>
using TargetStiffness = TargetStiffnessOf<Pack, K>;
template <int K>
using RatioCoupling = RatioCouplingOf<Pack, K>;

inline Pack six_volumes(const Pack3& a, const Pack3& b, const Pack3& c) {
  return dot(a, cross(b, c));
}

inline Pack volume(const Shape<4>& p) {
  return six_volumes(p[1] - p[0], p[2] - p[0], p[3] - p[0]) / 6;
}

inline Pack volume(const Shape<6>& v) {
  Shape<6> p;
  for (int i = 0; i < 6; ++i) p[i] = v[i] - v[0];
  Pack six = six_volumes(p[0], p[2], p[1]) + six_volumes(p[3], p[4], p[5]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    six += 0.5 * (six_volumes(p[i], p[j], p[j + 3]) + six_volumes(p[i], p[j + 3], p[i + 3]) +
                  six_volumes(p[i], p[j], p[i + 3]) + six_volumes(p[j], p[j + 3], p[i + 3]));
  }
  return six / 6;
}

/// H of best_rotation
template <int K>
inline Pack33 correlation(const Shape<K>& current, const Shape<K>& target) {
  Pack33 h{};
  for (int i = 0; i < K; ++i) {
    h.row[0] = h.row[0] + current[i].x * target[i];
    h.row[1] = h.row[1] + current[i].y * target[i];
    h.row[2] = h.row[2] + current[i].z * target[i];
  }
  return h;
}

/// f and g of ActuationBlock
inline void growth(const ActuationBlock<3>&, const Pack& ratio, Pack& grown, Pack& thinned) {
  grown = ratio;
  thinned = pack(0);
}
inline void growth(const ActuationBlock<4>&, const Pack& ratio, Pack& grown, Pack& thinned) {
  grown = cbrt(ratio);
  thinned = pack(0);
}
inline void growth(const ActuationBlock<6>&, const Pack& ratio, Pack& grown, Pack& thinned) {
  grown = sqrt(ratio);
  thinned = 1 / ratio;
}

/// The derivatives of f and g.
inline void growth_slope(const ActuationBlock<3>&, const Pack&, Pack& grown, Pack& thinned) {
  grown = pack(1);
  thinned = pack(0);
}
inline void growth_slope(const ActuationBlock<4>&, const Pack& ratio, Pack& grown, Pack& thinned) {
  grown = cbrt(ratio) / (3 * ratio);
  thinned = pack(0);
}
inline void growth_slope(const ActuationBlock<6>&, const Pack& ratio, Pack& grown, Pack& thinned) {
  grown = 0.5 / sqrt(ratio);
  thinned = -1 / (ratio * ratio);
}

/// Below this fraction of its volume an element's soft target turns into the rigid one; below the minimum its scale
/// does not grow any further.
inline constexpr double whole_from = 1.0 / 8, min_scaled = 1e-6;

/// How much of the soft target is Eq. (4), times its scale r; the rest of it is the rigid target.
inline void soft_target(const Pack& volume_ratio, Pack& scaled, Pack& rigid) {
  const Pack fraction = max(pack(0), min(pack(1), (1 / whole_from) * volume_ratio));
  scaled = fraction / cbrt(max(volume_ratio, pack(min_scaled)));
  rigid = 1 - fraction;
}

/// The derivatives of soft_target by the volume ratio.
inline void soft_target_slope(const Pack& volume_ratio, Pack& scaled, Pack& rigid) {
  const Pack bounded = max(volume_ratio, pack(min_scaled));
  const Pack root = cbrt(bounded), zero = pack(0);
  const PackMask whole = volume_ratio >= whole_from, inverted = volume_ratio <= 0;
  const Pack turning = select(volume_ratio < min_scaled, pack(1), pack(2.0 / 3)) / (whole_from * root);
  scaled = select(whole, -1 / (3 * root * bounded), select(inverted, zero, turning));
  rigid = select(whole | inverted, zero, pack(-1 / whole_from));
}

}  // namespace softkin::energy::SOFTKIN_TARGET
