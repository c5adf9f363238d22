#include <softkin/energy/kernels/elastic_law_point.hpp>
#include <softkin/energy/kernels/elastic_polar.hpp>
#include <softkin/energy/kernels/elastic_stretches.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

/// W and P = dW/dF [MPa], J
struct Stress {
  Pack energy;
  Pack33 first;
  Pack jacobian;
};

/// P = 2 W_1 F + 2 W_2 (I1 F - F C) + W_J dJ/dF
template <Law law>
Stress invariant_stress(const LawBlock& constants, const Pack33& f) {
  const Deformation d = deformation(f);
  const InvariantEnergy w = invariant_energy<law>(constants, d);
  Stress stress{w.energy, {}, d.jacobian};
  Pack of_gradient = 2 * w.by_first;
  if constexpr (uses_second<law>) of_gradient += 2 * w.by_second * d.first;
  for (int i = 0; i < 3; ++i) {
    Pack3& row = stress.first.row[i];
    row = of_gradient * f.row[i];
    if constexpr (uses_second<law>) row = row - 2 * w.by_second * (d.right * f.row[i]);
    if constexpr (uses_jacobian<law>) row = row + w.by_jacobian * d.cofactor.row[i];
  }
  return stress;
}

/// P = 2 mu (F - R) + lambda tr(S - I) R
Stress corotational_stress(const LawBlock& constants, const Pack33& f) {
  const Polar p = polar(f);
  Pack33 strain = p.stretch;
  add_to_diagonal(strain, pack(-1));
  const Pack swelling = trace(strain);
  Stress stress;
  stress.energy = constants.mu * inner(strain, strain) + 0.5 * constants.lambda * swelling * swelling;
  const Pack twice_mu = 2 * constants.mu, of_rotation = constants.lambda * swelling;
  for (int i = 0; i < 3; ++i)
    stress.first.row[i] = twice_mu * (f.row[i] - p.rotation.row[i]) + of_rotation * p.rotation.row[i];
  stress.jacobian = dot(f.row[0], cross(f.row[1], f.row[2]));
  return stress;
}

/// P = F sum_i (l_i dW/dl_i / l_i^2) v_i v_i^T + bulk (J - 1) dJ/dF, v_i the eigenvectors of C = F^T F
Stress ogden_stress(const LawBlock& constants, const Pack33& f) {
  const Principal right = principal(transpose_times(f, f));
  const Pack zero{};
  const Stretches s =
      stretches_of({sqrt(max(right.value[0], zero)), sqrt(max(right.value[1], zero)), sqrt(max(right.value[2], zero))});
  const OgdenEnergy w = ogden_energy(constants, s);
  const Pack33 modes = transposed(right.axes);
  Pack33 second{};
  for (int i = 0; i < 3; ++i) add_outer(second, w.pull[i] / (s.value[i] * s.value[i]) * modes.row[i], modes.row[i]);
  const Pack33 by_gradient = cofactor(f);
  Stress stress{{}, times(f, second), dot(f.row[0], by_gradient.row[0])};
  const Pack swelling = positive_jacobian(stress.jacobian) - 1;
  const Pack pressure = constants.bulk * swelling;
  stress.energy = w.energy + 0.5 * pressure * swelling;
  for (int i = 0; i < 3; ++i) stress.first.row[i] = stress.first.row[i] + pressure * by_gradient.row[i];
  return stress;
}

template <Law law>
Stress stress_of(const LawBlock& constants, const Pack33& f) {
  constexpr LawForm form = law_traits(law).form;
  if constexpr (form == LawForm::rotation)
    return corotational_stress(constants, f);
  else if constexpr (form == LawForm::stretches)
    return ogden_stress(constants, f);
  else
    return invariant_stress<law>(constants, f);
}

template <Law law, int K, int Q>
void force(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticForce<K>& out) {
  Pack energy{};
  PackMask inverted{}, forbidden{};
  Shape<K> gradient{};
  for (int q = 0; q < Q; ++q) {
    const Pack& volume = block.volume[q];
    const Pack33 f = deformation_gradient<K>(block.slope[q], current);
    Stress stress = stress_of<law>(block.law, f);
    energy += volume * stress.energy;
    inverted |= (stress.jacobian <= 0) & (volume > 0);
    forbidden |= has_no_energy<law>(block.law, f, stress.jacobian) & (volume > 0);
    for (Pack3& row : stress.first.row) row = volume * row;
    for (int a = 0; a < K; ++a) gradient[a] = gradient[a] + stress.first * block.slope[q][a];
  }
  for (int a = 0; a < K; ++a) out.gradient[a] = gradient[a];
  out.energy = energy;
  out.inverted = inverted;
  out.forbidden = forbidden;
}

}  // namespace

template <int K, int Q>
void elastic_force(const energy::ElasticBlock<K, Q>& block, const energy::Shape<K>& current,
                   energy::ElasticForce<K>& out) {
  dispatch(block.law.law, [&]<Law law>() { force<law, K, Q>(wide(block), wide(current), wide(out)); });
}

template <int K, int Q>
void elastic_stress(const energy::ElasticBlock<K, Q>& elements, const energy::Shape<K>& shape,
                    energy::Pack33 (&out)[Q]) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const Shape<K>& current = wide(shape);
  Pack33(&stress)[Q] = wide(out);
  dispatch(block.law.law, [&]<Law law>() {
    for (int q = 0; q < Q; ++q) {
      const Pack33 f = deformation_gradient<K>(block.slope[q], current);
      const Stress point = stress_of<law>(block.law, f);
      stress[q] = times(point.first, transposed(f));
      for (Pack3& row : stress[q].row) row = (1 / point.jacobian) * row;
    }
  });
}

template void elastic_stress(const energy::ElasticBlock<4, 1>&, const energy::Shape<4>&, energy::Pack33 (&)[1]);
template void elastic_stress(const energy::ElasticBlock<10, 4>&, const energy::Shape<10>&, energy::Pack33 (&)[4]);
template void elastic_stress(const energy::ElasticBlock<6, 6>&, const energy::Shape<6>&, energy::Pack33 (&)[6]);
template void elastic_force(const energy::ElasticBlock<4, 1>&, const energy::Shape<4>&, energy::ElasticForce<4>&);
template void elastic_force(const energy::ElasticBlock<10, 4>&, const energy::Shape<10>&, energy::ElasticForce<10>&);
template void elastic_force(const energy::ElasticBlock<6, 6>&, const energy::Shape<6>&, energy::ElasticForce<6>&);

}  // namespace softkin::energy::SOFTKIN_TARGET
