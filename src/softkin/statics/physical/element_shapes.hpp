#pragma once

#include <array>
#include <cmath>

namespace softkin::physical {

/// Shape functions of elements of K nodes at the Q quadrature points of energy::elastic_rest.
template <int K, int Q>
using ElementShapes = std::array<std::array<double, K>, Q>;

inline void set_shapes(ElementShapes<4, 1>& shapes) {
  shapes = {{{0.25, 0.25, 0.25, 0.25}}};
}

inline void set_shapes(ElementShapes<10, 4>& shapes) {
  constexpr std::array<std::array<int, 2>, 6> edges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  for (int q = 0; q < 4; ++q) {
    std::array<double, 4> l{far, far, far, far};
    l[q] = near;
    for (int i = 0; i < 4; ++i) shapes[q][i] = l[i] * (2 * l[i] - 1);
    for (int e = 0; e < 6; ++e) shapes[q][4 + e] = 4 * l[edges[e][0]] * l[edges[e][1]];
  }
}

inline void set_shapes(ElementShapes<6, 6>& shapes) {
  constexpr std::array<std::array<double, 2>, 3> in_plane{{{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}}};
  for (int q = 0; q < 6; ++q) {
    const auto& [x, y] = in_plane[q % 3];
    const double z = (q < 3 ? -1 : 1) / std::sqrt(3.0);
    const std::array<double, 3> l{1 - x - y, x, y};
    for (int i = 0; i < 6; ++i) shapes[q][i] = l[i % 3] * (i < 3 ? 1 - z : 1 + z) / 2;
  }
}

}  // namespace softkin::physical
