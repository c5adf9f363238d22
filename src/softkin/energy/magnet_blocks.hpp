#pragma once

#include <softkin/energy/elastic_blocks.hpp>

namespace softkin::energy {

/// Elements of K nodes and Q quadrature points, one per lane, whose magnets turn with them.
template <class Pack, int K, int Q>
struct MagnetBlockOf {
  Pack3Of<Pack> slope[Q][K];  // gradients of the shape functions in the rest shape [1/mm]
  Pack3Of<Pack> moment[Q];    // at rest, volume / mu_0 b_r [N mm / mT]; 0 in lanes without an element
  double shape[Q][K];         // the functions at the points [-]
};

/// Flux density at a point of every lane.
template <class Pack>
struct FluxPointOf {
  Pack3Of<Pack> value;       // [mT]
  Pack33Of<Pack> slope;      // by place, a row for each component [mT/mm]
  Pack33Of<Pack> second[3];  // of each component [mT/mm^2]
};

/// Flux density at the quadrature points of a block.
template <class Pack, int Q>
struct FluxBlockOf {
  bool in_space = false;  // are the derivatives there, else zero
  FluxPointOf<Pack> point[Q];
};

template <int K, int Q>
using MagnetBlock = MagnetBlockOf<Pack, K, Q>;
using FluxPoint = FluxPointOf<Pack>;
template <int Q>
using FluxBlock = FluxBlockOf<Pack, Q>;

}  // namespace softkin::energy
