#include <cmath>
#include <softkin/energy/kernels/elastic_law_point.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

/// Barycentric coordinate of a corner at a quadrature point of energy::elastic_rest.
template <int Q>
double corner_fraction(int q, int corner) {
  if constexpr (Q == 1) return 0.25;
  return q == corner ? (5 + 3 * std::sqrt(5.0)) / 20 : (5 - std::sqrt(5.0)) / 20;
}

template <int Q>
Pack pressure_at(const CornerPressure& pressure, int q) {
  Pack sum{};
  for (int i = 0; i < 4; ++i) sum += corner_fraction<Q>(q, i) * pressure.at[i];
  return sum;
}

/// What the product of two pressures over the element has beyond that of their means, over its volume.
double beyond_means(int i, int j) {
  return (i == j ? 0.1 : 0.05) - 0.0625;
}

/// One point sees the mean of a pressure alone.
Pack of_unseen(const CornerPressure& pressure) {
  return pressure.softness + pressure.smoothing;
}

/// What the part of the pressures that one quadrature point does not see adds.
void add_unseen(const Pack& volume, const CornerPressure& pressure, Pack& energy, PressureMiss& missed) {
  const Pack weight = volume * of_unseen(pressure);
  for (int i = 0; i < 4; ++i) {
    Pack left{};
    for (int j = 0; j < 4; ++j) left += beyond_means(i, j) * pressure.at[j];
    left = weight * left;
    missed.at[i] -= left;
    energy += 0.5 * pressure.at[i] * left;
  }
}

void add_cross_matrix(Pack33& k, const Pack3& w) {
  k.row[0].y -= w.z, k.row[0].z += w.y;
  k.row[1].x += w.z, k.row[1].z -= w.x;
  k.row[2].x -= w.y, k.row[2].y += w.x;
}

}  // namespace

template <int K, int Q>
void add_pressure_force(const energy::ElasticBlock<K, Q>& elements, const energy::CornerPressure& corners,
                        const energy::Shape<K>& shape, energy::ElasticForce<K>& force, energy::PressureMiss& left) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const CornerPressure& pressure = wide(corners);
  const Shape<K>& current = wide(shape);
  ElasticForce<K>& out = wide(force);
  PressureMiss& missed = wide(left);
  for (Pack& at : missed.at) at = Pack{};
  for (int q = 0; q < Q; ++q) {
    const Pack& volume = block.volume[q];
    const Pack33 f = deformation_gradient<K>(block.slope[q], current);
    const Pack33 turned = cofactor(f);
    const Pack p = pressure_at<Q>(pressure, q), eased = pressure.softness * p;
    out.energy += 0.5 * volume * eased * p;
    const Pack weight = volume * p;
    for (int a = 0; a < K; ++a) out.gradient[a] = out.gradient[a] + weight * (turned * block.slope[q][a]);
    const Pack swelling = volume * (dot(f.row[0], turned.row[0]) - 1 - eased);
    for (int i = 0; i < 4; ++i) missed.at[i] += corner_fraction<Q>(q, i) * swelling;
  }
  if constexpr (Q == 1) add_unseen(block.volume[0], pressure, out.energy, missed);
}

template <int K, int Q>
void add_pressure_stress(const energy::CornerPressure& corners, energy::Pack33 (&out)[Q]) {
  Pack33(&stress)[Q] = wide(out);
  for (int q = 0; q < Q; ++q) add_to_diagonal(stress[q], pressure_at<Q>(wide(corners), q));
}

template <int K, int Q>
void add_pressure_stiffness(const energy::ElasticBlock<K, Q>& elements, const energy::CornerPressure& corners,
                            const energy::Shape<K>& shape, bool projected, energy::ElasticStiffness<K>& stiffness,
                            energy::PressureCoupling<K>& coupling) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const CornerPressure& pressure = wide(corners);
  const Shape<K>& current = wide(shape);
  ElasticStiffness<K>& out = wide(stiffness);
  PressureCouplingOf<Pack, K>& coupled = wide(coupling);
  for (auto& of_pressure : coupled.node)
    for (Pack3& node : of_pressure) node = Pack3{};
  for (Pack& own : coupled.own) own = Pack{};
  for (int q = 0; q < Q; ++q) {
    const Pack& volume = block.volume[q];
    const Pack3(&slope)[K] = block.slope[q];
    const Pack33 f = deformation_gradient<K>(slope, current);
    const Pack33 turned = cofactor(f);
    for (int a = 0; a < K; ++a) {
      const Pack3 swelling = volume * (turned * slope[a]);
      for (int i = 0; i < 4; ++i) coupled.node[i][a] = coupled.node[i][a] + pack(corner_fraction<Q>(q, i)) * swelling;
    }
    for (int i = 0, ij = 0; i < 4; ++i)
      for (int j = 0; j <= i; ++j, ++ij)
        coupled.own[ij] -= corner_fraction<Q>(q, i) * corner_fraction<Q>(q, j) * volume * pressure.softness;
    if (projected) continue;
    const Pack weight = volume * pressure_at<Q>(pressure, q);
    for (int a = 0, ab = 0; a < K; ++a, ++ab)  // but the diagonal, where it is 0
      for (int b = 0; b < a; ++b, ++ab) add_cross_matrix(out.block[ab], weight * (f * cross(slope[b], slope[a])));
  }
  if constexpr (Q == 1)
    for (int i = 0, ij = 0; i < 4; ++i)
      for (int j = 0; j <= i; ++j, ++ij) coupled.own[ij] -= beyond_means(i, j) * block.volume[0] * of_unseen(pressure);
}

#define SOFTKIN_PRESSURE_OF(K, Q)                                                                             \
  template void add_pressure_force(const energy::ElasticBlock<K, Q>&, const energy::CornerPressure&,          \
                                   const energy::Shape<K>&, energy::ElasticForce<K>&, energy::PressureMiss&); \
  template void add_pressure_stress<K, Q>(const energy::CornerPressure&, energy::Pack33(&)[Q]);               \
  template void add_pressure_stiffness(const energy::ElasticBlock<K, Q>&, const energy::CornerPressure&,      \
                                       const energy::Shape<K>&, bool, energy::ElasticStiffness<K>&,           \
                                       energy::PressureCoupling<K>&);
SOFTKIN_PRESSURE_OF(4, 1)
SOFTKIN_PRESSURE_OF(10, 4)

}  // namespace softkin::energy::SOFTKIN_TARGET
