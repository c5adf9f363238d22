#pragma once

#include <softkin/core/lanes.hpp>
#include <softkin/energy/elastic_blocks.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

using Pack = PackOf<SOFTKIN_VECTOR_BYTES>;
using PackMask = Pack::Mask;
using Pack3 = Pack3Of<Pack>;
using Pack33 = Pack33Of<Pack>;
using PackRotation = PackRotationOf<Pack>;
using softkin::SOFTKIN_TARGET::load;
using softkin::SOFTKIN_TARGET::store;
template <int K>
using Shape = Pack3[K];
using LawBlock = LawBlockOf<Pack>;
template <int K, int Q>
using ElasticBlock = ElasticBlockOf<Pack, K, Q>;
template <int K>
using ElasticForce = ElasticForceOf<Pack, K>;
template <int K>
using ElasticStiffness = ElasticStiffnessOf<Pack, K>;
using BranchFractions = BranchFractionsOf<Pack>;
using ViscousBlock = ViscousBlockOf<Pack>;
using CornerPressure = CornerPressureOf<Pack>;
using PressureMiss = PressureMissOf<Pack>;
template <int K>
using PressureCoupling = PressureCouplingOf<Pack, K>;
using DielectricPrisms = ElasticBlock<6, 6>;

SOFTKIN_INLINE Pack pack(double value) {
  return pack_of<Pack>(value);
}

/// What is kept in packs, seen as packs of this target, whose layout is the same.
template <template <class, int...> class Block, int... Sizes>
SOFTKIN_INLINE const Block<Pack, Sizes...>& wide(const Block<energy::Pack, Sizes...>& block) {
  return reinterpret_cast<const Block<Pack, Sizes...>&>(block);
}
template <template <class, int...> class Block, int... Sizes>
SOFTKIN_INLINE Block<Pack, Sizes...>& wide(Block<energy::Pack, Sizes...>& block) {
  return reinterpret_cast<Block<Pack, Sizes...>&>(block);
}
/// Copies of what may be a temporary, which gcc 12 aligns as any number where a function has returned it.
SOFTKIN_INLINE Pack wide(const energy::Pack& pack) {
  Pack copy;
  for (int p = 0; p < Pack::parts; ++p) copy.part[p] = load(reinterpret_cast<const double*>(&pack) + Pack::each * p);
  return copy;
}
SOFTKIN_INLINE Pack3 wide(const energy::Pack3& point) {
  return {wide(point.x), wide(point.y), wide(point.z)};
}
SOFTKIN_INLINE Pack33 wide(const energy::Pack33& matrix) {
  return {{wide(matrix.row[0]), wide(matrix.row[1]), wide(matrix.row[2])}};
}
SOFTKIN_INLINE const Pack* wide(const energy::Pack* packs) {
  return reinterpret_cast<const Pack*>(packs);
}
template <int K>
SOFTKIN_INLINE const Shape<K>& wide(const energy::Pack3 (&shape)[K]) {
  return reinterpret_cast<const Shape<K>&>(shape);
}
template <int K>
SOFTKIN_INLINE Shape<K>& wide(energy::Pack3 (&shape)[K]) {
  return reinterpret_cast<Shape<K>&>(shape);
}
template <int Q>
SOFTKIN_INLINE Pack33 (&wide(energy::Pack33 (&matrices)[Q]))[Q] {
  return reinterpret_cast<Pack33(&)[Q]>(matrices);
}

/// What a kernel gives back as a value, to wherever that is.
SOFTKIN_INLINE void keep(const Pack& pack, double* kept) {
  for (int p = 0; p < Pack::parts; ++p) store(kept + Pack::each * p, pack.part[p]);
}
SOFTKIN_INLINE void keep(const Pack33& matrix, double* kept) {
  for (int r = 0; r < 3; ++r) {
    keep(matrix.row[r].x, kept + (3 * r) * lanes);
    keep(matrix.row[r].y, kept + (3 * r + 1) * lanes);
    keep(matrix.row[r].z, kept + (3 * r + 2) * lanes);
  }
}

}  // namespace softkin::energy::SOFTKIN_TARGET
