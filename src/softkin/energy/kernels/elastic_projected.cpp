#include <softkin/energy/kernels/elastic_law_point.hpp>
#include <softkin/energy/kernels/elastic_polar.hpp>

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

template <Law law>
PrincipalTangent tangent_of(const LawBlock& constants, const Pack (&s)[3]) {
  if constexpr (law == Law::corotational)
    return corotational_tangent(constants, s);
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
struct ProjectedTangent {
  PrincipalTangent tangent;  // times the volume
  Pack33 frame;              // U
  Pack3 slope[K];            // V^T slope
};

template <Law law, int K>
void set(const LawBlock& constants, const Pack3 (&slope)[K], const Pack& volume, const Shape<K>& current,
         ProjectedTangent<K>& p) {
  const Polar turned = polar(deformation_gradient<K>(slope, current));
  const Principal stretch = principal(turned.stretch);
  p.frame = times(turned.rotation, stretch.axes);
  p.tangent = tangent_of<law>(constants, stretch.value);
  clamp(p.tangent);
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
void add(const ProjectedTangent<K>& p, int a, int b, Pack33& k) {
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

template <Law law, int K, int Q>
void stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out) {
  ProjectedTangent<K> points[Q];
  for (int q = 0; q < Q; ++q) set<law, K>(block.law, block.slope[q], block.volume[q], current, points[q]);
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
  dispatch(block.law.law, [&]<Law law>() { stiffness<law, K, Q>(block, current, out); });
}

template void projected_stiffness(const ElasticBlock<4, 1>&, const Shape<4>&, ElasticStiffness<4>&);
template void projected_stiffness(const ElasticBlock<10, 4>&, const Shape<10>&, ElasticStiffness<10>&);
template void projected_stiffness(const ElasticBlock<6, 6>&, const Shape<6>&, ElasticStiffness<6>&);

}  // namespace softkin::energy::SOFTKIN_TARGET
