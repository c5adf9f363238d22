#pragma once

#include <array>
#include <softkin/energy/elastic.hpp>

namespace softkin::physical {

/// Positions of the nodes of a block.
template <int K>
void load(const Points& positions, const std::array<std::array<Index, energy::lanes>, K>& nodes,
          energy::Shape<K>& shape) {
  for (int i = 0; i < K; ++i)
    for (int l = 0; l < energy::lanes; ++l) {
      const double* p = positions.data() + 3 * static_cast<std::ptrdiff_t>(nodes[i][l]);
      shape[i].x[l] = p[0];
      shape[i].y[l] = p[1];
      shape[i].z[l] = p[2];
    }
}

}  // namespace softkin::physical
