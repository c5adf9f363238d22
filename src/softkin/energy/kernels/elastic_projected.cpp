#include <softkin/energy/kernels/elastic_law_point.hpp>
#include <softkin/energy/kernels/elastic_polar.hpp>
#include <softkin/energy/kernels/elastic_stretches.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

/// d^2W/dF^2 in the frame of the principal stretches, F = U diag(s) V^T: `stretch` couples the diagonal entries of dF;
/// the entries (i, j) and (j, i), i, j other than k, have `same`[k] with themselves and `other`[k] with each other.
struct PrincipalTangent {
  Pack33 stretch;
  Pack same[3], other[3];
};

Pack33 diagonal(const Pack (&s)[3]) {
  const Pack zero{};
  return {{{s[0], zero, zero}, {zero, s[1], zero}, {zero, zero, s[2]}}};
}

template <Law law>
PrincipalTangent invariant_tangent(const LawBlock& constants, const Pack (&s)[3]) {
  const Deformation d = deformation(diagonal(s));
  const InvariantEnergy w = invariant_energy<law>(constants, d);
  const Pack3 squares{d.right.row[0].x, d.right.row[1].y, d.right.row[2].z};
  const Pack3 stretches{s[0], s[1], s[2]};
  const Pack3 by_jacobian{s[1] * s[2], s[2] * s[0], s[0] * s[1]};
  const Pack3 rest{d.first - squares.x, d.first - squares.y, d.first - squares.z};
  const Pack3 second{s[0] * rest.x, s[1] * rest.y, s[2] * rest.z};
  const Pack3 coupled = 2 * w.by_first_jacobian * stretches + 2 * w.by_second_jacobian * second;

  PrincipalTangent t{};
  add_outer(t.stretch, 4 * (w.by_first_first + w.by_second) * stretches, stretches);
  add_outer(t.stretch, w.by_jacobian_jacobian * by_jacobian + coupled, by_jacobian);
  add_outer(t.stretch, by_jacobian, coupled);
  const Pack3 direct = 2 * w.by_second * (rest - squares - squares);
  t.stretch.row[0] = t.stretch.row[0] + Pack3{direct.x, w.by_jacobian * s[2], w.by_jacobian * s[1]};
  t.stretch.row[1] = t.stretch.row[1] + Pack3{w.by_jacobian * s[2], direct.y, w.by_jacobian * s[0]};
  t.stretch.row[2] = t.stretch.row[2] + Pack3{w.by_jacobian * s[1], w.by_jacobian * s[0], direct.z};
  add_to_diagonal(t.stretch, 2 * w.by_first);
  for (int k = 0; k < 3; ++k) {
    const Pack &si = s[(k + 1) % 3], &sj = s[(k + 2) % 3];
    t.same[k] = 2 * w.by_first + 2 * w.by_second * s[k] * s[k];
    t.other[k] = -2 * w.by_second * si * sj - w.by_jacobian * s[k];
  }
  return t;
}

PrincipalTangent corotational_tangent(const LawBlock& constants, const Pack (&s)[3]) {
  constexpr double singular = 1e-9;  // two mirrored stretches of one size: the rotation is not unique
  PrincipalTangent t;
  for (Pack3& row : t.stretch.row) row = {constants.lambda, constants.lambda, constants.lambda};
  add_to_diagonal(t.stretch, 2 * constants.mu);
  const Pack of_turn = constants.lambda * (s[0] + s[1] + s[2] - 3) - 2 * constants.mu;
  for (int k = 0; k < 3; ++k) {
    t.other[k] = -of_turn / max(s[(k + 1) % 3] + s[(k + 2) % 3], pack(singular));
    t.same[k] = 2 * constants.mu - t.other[k];
  }
  return t;
}

/// The change of shape of one of Ogden's terms: with t_i = l_i dW/dl_i, d^2W/(dl_i dl_j) = (dt_i/d ln l_j - d_ij t_i) /
/// (l_i l_j); shears have the divided difference and the mean of dW/dl at two stretches.
void add_ogden_term(PrincipalTangent& t, const LawBlock& constants, int term, const Stretches& s) {
  const OgdenPowers p(constants, term, s);
  const Pack scaled = p.mu * p.alpha;
  const Pack by_stretch[3] = {1 / s.value[0], 1 / s.value[1], 1 / s.value[2]};
  const Pack3 each{p.power[0] * by_stretch[0], p.power[1] * by_stretch[1], p.power[2] * by_stretch[2]};
  const Pack3 inverse{by_stretch[0], by_stretch[1], by_stretch[2]};
  add_outer(t.stretch, (1.0 / 3) * scaled * p.mean * inverse, inverse);
  add_outer(t.stretch, (-1.0 / 3) * scaled * each, inverse);
  add_outer(t.stretch, (-1.0 / 3) * scaled * inverse, each);
  Pack direct[3], slope[3];
  for (int i = 0; i < 3; ++i) {
    const Pack pull = p.mu * (p.power[i] - p.mean);
    slope[i] = pull * by_stretch[i];
    direct[i] = (scaled * p.power[i] - pull) * by_stretch[i] * by_stretch[i];
  }
  t.stretch.row[0].x += direct[0];
  t.stretch.row[1].y += direct[1];
  t.stretch.row[2].z += direct[2];
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Pack difference = p.mu * (divided_difference(p, s, i, j) + p.mean * by_stretch[i] * by_stretch[j]);
    const Pack mean = (slope[i] + slope[j]) / (s.value[i] + s.value[j]);
    t.same[k] += 0.5 * (difference + mean);
    t.other[k] += 0.5 * (difference - mean);
  }
}

PrincipalTangent ogden_tangent(const LawBlock& constants, const Pack (&principal_stretches)[3]) {
  const Stretches s = stretches_of(principal_stretches);
  PrincipalTangent t{};
  for (int term = 0; term < max_ogden_terms; ++term)
    if (has_term(constants, term)) add_ogden_term(t, constants, term, s);
  const Pack(&l)[3] = s.value;
  const Pack pressure = constants.bulk * (l[0] * l[1] * l[2] - 1);
  const Pack3 by_jacobian{l[1] * l[2], l[2] * l[0], l[0] * l[1]};
  const Pack zero{};
  add_outer(t.stretch, constants.bulk * by_jacobian, by_jacobian);
  t.stretch.row[0] = t.stretch.row[0] + Pack3{zero, pressure * l[2], pressure * l[1]};
  t.stretch.row[1] = t.stretch.row[1] + Pack3{pressure * l[2], zero, pressure * l[0]};
  t.stretch.row[2] = t.stretch.row[2] + Pack3{pressure * l[1], pressure * l[0], zero};
  for (int k = 0; k < 3; ++k) t.other[k] -= pressure * l[k];
  return t;
}

template <Law law>
PrincipalTangent tangent_of(const LawBlock& constants, const Pack (&s)[3]) {
  constexpr LawForm form = law_traits(law).form;
  if constexpr (form == LawForm::rotation)
    return corotational_tangent(constants, s);
  else if constexpr (form == LawForm::stretches)
    return ogden_tangent(constants, s);
  else
    return invariant_tangent<law>(constants, s);
}

/// Negative eigenvalues to zero.
void clamp(PrincipalTangent& t) {
  const Pack zero{};
  for (int k = 0; k < 3; ++k) {
    const Pack symmetric = max(t.same[k] + t.other[k], zero), antisymmetric = max(t.same[k] - t.other[k], zero);
    t.same[k] = 0.5 * (symmetric + antisymmetric);
    t.other[k] = 0.5 * (symmetric - antisymmetric);
  }
  const Principal eigen = principal(t.stretch);
  const Pack33 modes = transposed(eigen.axes);
  t.stretch = Pack33{};
  for (int k = 0; k < 3; ++k) add_outer(t.stretch, max(eigen.value[k], zero) * modes.row[k], modes.row[k]);
}

template <int K>
struct TurnedTangent {
  PrincipalTangent tangent;  // times the volume
  Pack33 frame;              // U
  Pack3 slope[K];            // V^T slope
};

template <Law law, bool projected, int K>
void set(const LawBlock& constants, const Pack3 (&slope)[K], const Pack& volume, const Shape<K>& current,
         TurnedTangent<K>& p) {
  const Polar turned = polar(deformation_gradient<K>(slope, current));
  const Principal stretch = principal(turned.stretch);
  p.frame = times(turned.rotation, stretch.axes);
  p.tangent = tangent_of<law>(constants, stretch.value);
  if constexpr (projected) clamp(p.tangent);
  for (Pack3& row : p.tangent.stretch.row) row = volume * row;
  for (int k = 0; k < 3; ++k) {
    p.tangent.same[k] *= volume;
    p.tangent.other[k] *= volume;
  }
  const Pack33 to_principal = transposed(stretch.axes);
  for (int a = 0; a < K; ++a) p.slope[a] = to_principal * slope[a];
}

/// k += U M U^T, M_ij = sum_kl (d^2W/dF^2)_ik,jl slope_a,k slope_b,l
template <int K>
void add(const TurnedTangent<K>& p, int a, int b, Pack33& k) {
  const Pack3 &ga = p.slope[a], &gb = p.slope[b];
  const Pack33& s = p.tangent.stretch;
  const Pack(&same)[3] = p.tangent.same;
  const Pack(&other)[3] = p.tangent.other;
  const Pack xx = ga.x * gb.x, yy = ga.y * gb.y, zz = ga.z * gb.z;
  const Pack33 m{{{s.row[0].x * xx + same[2] * yy + same[1] * zz, s.row[0].y * ga.x * gb.y + other[2] * ga.y * gb.x,
                   s.row[0].z * ga.x * gb.z + other[1] * ga.z * gb.x},
                  {s.row[1].x * ga.y * gb.x + other[2] * ga.x * gb.y, s.row[1].y * yy + same[2] * xx + same[0] * zz,
                   s.row[1].z * ga.y * gb.z + other[0] * ga.z * gb.y},
                  {s.row[2].x * ga.z * gb.x + other[1] * ga.x * gb.z, s.row[2].y * ga.z * gb.y + other[0] * ga.y * gb.z,
                   s.row[2].z * zz + same[1] * xx + same[0] * yy}}};
  for (int i = 0; i < 3; ++i) {
    const Pack3& u = p.frame.row[i];
    const Pack3 row = u.x * m.row[0] + u.y * m.row[1] + u.z * m.row[2];
    k.row[i] = k.row[i] + p.frame * row;
  }
}

template <Law law, bool projected, int K, int Q>
void stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out) {
  TurnedTangent<K> points[Q];
  for (int q = 0; q < Q; ++q) set<law, projected, K>(block.law, block.slope[q], block.volume[q], current, points[q]);
  for (int a = 0, ab = 0; a < K; ++a)
    for (int b = 0; b <= a; ++b, ++ab) {
      Pack33 k{};
      for (int q = 0; q < Q; ++q) add(points[q], a, b, k);
      out.block[ab] = k;
    }
}

}  // namespace

template <int K, int Q>
void projected_stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out) {
  dispatch(block.law.law, [&]<Law law>() { stiffness<law, true, K, Q>(block, current, out); });
}

template <Law law, int K, int Q>
void stretch_stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out) {
  stiffness<law, false, K, Q>(block, current, out);
}

template void projected_stiffness(const ElasticBlock<4, 1>&, const Shape<4>&, ElasticStiffness<4>&);
template void projected_stiffness(const ElasticBlock<10, 4>&, const Shape<10>&, ElasticStiffness<10>&);
template void projected_stiffness(const ElasticBlock<6, 6>&, const Shape<6>&, ElasticStiffness<6>&);
template void stretch_stiffness<Law::ogden>(const ElasticBlock<4, 1>&, const Shape<4>&, ElasticStiffness<4>&);
template void stretch_stiffness<Law::ogden>(const ElasticBlock<10, 4>&, const Shape<10>&, ElasticStiffness<10>&);
template void stretch_stiffness<Law::ogden>(const ElasticBlock<6, 6>&, const Shape<6>&, ElasticStiffness<6>&);

}  // namespace softkin::energy::SOFTKIN_TARGET
