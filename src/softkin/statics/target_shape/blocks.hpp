#pragma once

#include <softkin/statics/target_shape/element_sets.hpp>

/// What the loops over a model's element blocks share.
namespace softkin::target_shape {

/// Local ratios stay above this, where a target shape would vanish or turn over [-].
inline constexpr double least_ratio = 0.01;

/// A block's nodes, lane by lane.
template <int K, class Nodes>
inline void load(const Points& positions, const Nodes& nodes, energy::Shape<K>& shape) {
  for (int i = 0; i < K; ++i)
    for (int l = 0; l < energy::lanes; ++l) {
      const double* p = positions.data() + 3 * static_cast<std::size_t>(nodes[i][l]);
      shape[i].x[l] = p[0];
      shape[i].y[l] = p[1];
      shape[i].z[l] = p[2];
    }
}

/// Puts a block's values into the slots from `first` on.
template <int K>
inline void store(const energy::Shape<K>& values, Index first, Index count, double* pulls) {
  for (Index l = 0; l < count; ++l)
    for (int i = 0; i < K; ++i) {
      double* p = pulls + 3 * static_cast<std::size_t>(first + K * l + i);
      p[0] = values[i].x[l];
      p[1] = values[i].y[l];
      p[2] = values[i].z[l];
    }
}

}  // namespace softkin::target_shape
