#include <cstring>
#include <softkin/energy/kernels/elastic_law_point.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

using softkin::energy::SOFTKIN_TARGET::inner;

/// A symmetric matrix in every lane: xx, yy, zz, xy, yz, xz.
struct Symmetric {
  Pack at[6];
};
constexpr int rows[6] = {0, 1, 2, 0, 1, 0}, columns[6] = {0, 1, 2, 1, 2, 2};
constexpr int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

Symmetric scaled(const Pack& scale, const Symmetric& a) {
  Symmetric result;
  for (int i = 0; i < 6; ++i) result.at[i] = scale * a.at[i];
  return result;
}

void add(Symmetric& to, const Pack& scale, const Symmetric& a) {
  for (int i = 0; i < 6; ++i) to.at[i] += scale * a.at[i];
}

/// a : b
Pack inner(const Symmetric& a, const Symmetric& b) {
  return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2] +
         2 * (a.at[3] * b.at[3] + a.at[4] * b.at[4] + a.at[5] * b.at[5]);
}

Symmetric cofactor(const Symmetric& a) {
  const Pack(&m)[6] = a.at;
  return {{m[1] * m[2] - m[4] * m[4], m[0] * m[2] - m[5] * m[5], m[0] * m[1] - m[3] * m[3], m[5] * m[4] - m[3] * m[2],
           m[3] * m[5] - m[0] * m[4], m[3] * m[4] - m[1] * m[5]}};
}

Pack determinant(const Symmetric& a, const Symmetric& cofactors) {
  return a.at[0] * cofactors.at[0] + a.at[3] * cofactors.at[3] + a.at[5] * cofactors.at[5];
}

/// The strain at a quadrature point.
struct Strain {
  Pack33 gradient;  // F
  Pack jacobian;    // J, positive
  Pack scale;       // J^(-2/3)
  Symmetric right;  // C
  Symmetric barred;
};

template <int K>
[[gnu::always_inline]] inline Strain strain_at(const Pack3 (&slope)[K], const Shape<K>& current) {
  Strain s;
  s.gradient = deformation_gradient<K>(slope, current);
  const Pack3* f = s.gradient.row;
  s.jacobian = positive_jacobian(dot(f[0], cross(f[1], f[2])));
  const Pack root = inverse_cbrt(s.jacobian);
  s.scale = root * root;
  const Pack33 c = transpose_times(s.gradient, s.gradient);
  s.right = {{c.row[0].x, c.row[1].y, c.row[2].z, c.row[0].y, c.row[1].z, c.row[0].z}};
  s.barred = scaled(s.scale, s.right);
  return s;
}

/// A branch at the end of the step.
struct Branch {
  Pack before_root;   // cube root of the determinant of what M has from the step's begin
  Symmetric flowed;   // M
  Symmetric inverse;  // A = C_v^-1 at the end
  Pack root;          // cube root of the determinant of M, and its inverse
  Pack inverse_root;
  Pack ended;
};

Symmetric unit() {
  const Pack zero{}, one = pack(1);
  return {{one, one, one, zero, zero, zero}};
}

/// branch  -1: the strain itself
Symmetric remembered(const ViscousBlock& viscous, int q, int branch) {
  if (!viscous.strains) return unit();
  Symmetric before;
  const std::ptrdiff_t each = viscous.branches + 1;
  std::memcpy(before.at, viscous.strains + 6 * lanes * (each * q + 1 + branch), sizeof(before.at));
  return before;
}

[[gnu::always_inline]] inline Branch branch_at(const ViscousBlock& viscous, int q, int branch, const Strain& s) {
  Branch b;
  const double* begun = viscous.begun + begun_entries * lanes * (viscous.branches * q + branch);
  std::memcpy(b.flowed.at, begun, sizeof(b.flowed.at));
  std::memcpy(&b.before_root, begun + 6 * lanes, sizeof(b.before_root));
  b.ended = viscous.fractions[branch].ended;
  add(b.flowed, b.ended, s.barred);
  const Symmetric cofactors = cofactor(b.flowed);
  const Pack size = determinant(b.flowed, cofactors);
  b.inverse_root = inverse_cbrt(size);
  const Pack square = b.inverse_root * b.inverse_root;
  b.root = size * square;
  b.inverse = scaled(square, cofactors);
  return b;
}

/// 3 (root - before_root) / ended - 3, without the cancellation of a short step: det M minus its value without
/// ended bar C, over ended, is cof M : bar C - ended M : cof bar C + ended^2.
Pack stored(const Branch& b, const Strain& s, const Symmetric& barred_cofactors) {
  const Pack square = b.root * b.root;
  const Pack above = square * inner(b.inverse, s.barred) - b.ended * (inner(b.flowed, barred_cofactors) - b.ended);
  return 3 * (above / (square + b.before_root * (b.root + b.before_root)) - 1);
}

/// C^-1, from the cofactors of bar C, whose determinant is 1.
Symmetric inverse_of_right(const Strain& s, const Symmetric& barred_cofactors) {
  return scaled(s.scale, barred_cofactors);
}

/// Second Piola-Kirchhoff stress of the branches, from the sum of their G A.
Symmetric stress_of(const Symmetric& inverses, const Strain& s, const Symmetric& inverse_right) {
  Symmetric stress = scaled(s.scale, inverses);
  add(stress, (-1.0 / 3) * inner(stress, s.right), inverse_right);
  return stress;
}

/// Sum of G A at a quadrature point.
Symmetric inverses_at(const ViscousBlock& viscous, int q, const Strain& s) {
  Symmetric inverses{};
  for (int i = 0; i < viscous.branches; ++i) add(inverses, viscous.modulus[i], branch_at(viscous, q, i, s).inverse);
  return inverses;
}

Pack33 full(const Symmetric& a) {
  return {{{a.at[0], a.at[3], a.at[5]}, {a.at[3], a.at[1], a.at[4]}, {a.at[5], a.at[4], a.at[2]}}};
}

/// Entries of a fourth-order tensor with both symmetries: a row for each pair (i, j), the upper triangle.
struct Moduli {
  Pack at[6][6];
};

const Pack& entry(const Moduli& c, int e, int f) {
  return e < f ? c.at[e][f] : c.at[f][e];
}

/// c += alpha a (x) a
void add_square(Moduli& c, const Pack& alpha, const Symmetric& a) {
  for (int e = 0; e < 6; ++e) {
    const Pack left = alpha * a.at[e];
    for (int f = e; f < 6; ++f) c.at[e][f] += left * a.at[f];
  }
}

/// c += a (x) b + b (x) a
void add_both(Moduli& c, const Symmetric& a, const Symmetric& b) {
  for (int e = 0; e < 6; ++e)
    for (int f = e; f < 6; ++f) c.at[e][f] += a.at[e] * b.at[f] + b.at[e] * a.at[f];
}

/// c_ijkl += alpha (a_ik a_jl + a_il a_jk) / 2
void add_crossed(Moduli& c, const Pack& alpha, const Symmetric& a) {
  const Symmetric half = scaled(0.5 * alpha, a);
  for (int e = 0; e < 6; ++e)
    for (int f = e; f < 6; ++f) {
      const int i = rows[e], j = columns[e], k = rows[f], l = columns[f];
      c.at[e][f] += half.at[place[i][k]] * a.at[place[j][l]] + half.at[place[i][l]] * a.at[place[j][k]];
    }
}

/// alpha (p_ijkl / 3 - (p_ikjl + p_iljk) / 2)
Moduli uncrossed(const Pack& alpha, const Moduli& p) {
  const Pack third = (1.0 / 3) * alpha, half = 0.5 * alpha;
  Moduli c;
  for (int e = 0; e < 6; ++e)
    for (int f = e; f < 6; ++f) {
      const int i = rows[e], j = columns[e], k = rows[f], l = columns[f];
      c.at[e][f] =
          third * p.at[e][f] - half * (entry(p, place[i][k], place[j][l]) + entry(p, place[i][l], place[j][k]));
    }
  return c;
}

/// c : a
Symmetric along(const Moduli& c, const Symmetric& a) {
  Symmetric result;
  for (int e = 0; e < 6; ++e)
    result.at[e] = entry(c, e, 0) * a.at[0] + entry(c, e, 1) * a.at[1] + entry(c, e, 2) * a.at[2] +
                   2 * (entry(c, e, 3) * a.at[3] + entry(c, e, 4) * a.at[4] + entry(c, e, 5) * a.at[5]);
  return result;
}

/// What a quadrature point adds to the stiffness, times its volume.
struct PointStiffness {
  Symmetric stress;  // S
  Moduli moduli;     // 2 dS/dC
  Pack33 gradient;
};

/// source  Holzapfel 2000, Nonlinear Solid Mechanics, Eqs. (6.167)-(6.169): moduli of what depends on bar C alone; of a
///         branch they are 2 G ended / root (A (x) A / 3 - A (.) A), and the sums over branches are taken first
template <int K>
void set_point(const Pack3 (&slope)[K], const Pack& volume, const ViscousBlock& viscous, int q, const Shape<K>& current,
               PointStiffness& out) {
  const Strain s = strain_at<K>(slope, current);
  const Symmetric inverse_right = inverse_of_right(s, cofactor(s.barred));
  Symmetric inverses{};
  Moduli squares{};
  for (int i = 0; i < viscous.branches; ++i) {
    const Branch b = branch_at(viscous, q, i, s);
    const Pack modulus = volume * viscous.modulus[i];
    add(inverses, modulus, b.inverse);
    add_square(squares, 2 * modulus * b.ended * b.inverse_root, b.inverse);
  }
  Moduli& c = out.moduli;
  c = uncrossed(s.scale * s.scale, squares);
  out.stress = stress_of(inverses, s, inverse_right);
  const Symmetric once = along(c, s.right);
  const Pack twice = inner(once, s.right), traces = s.scale * inner(inverses, s.right);
  Symmetric mixed = scaled(pack(-1.0 / 3), once);  // with C^-1
  add(mixed, pack(-2.0 / 3), out.stress);
  add(mixed, (1.0 / 18) * twice - (1.0 / 9) * traces, inverse_right);
  add_both(c, mixed, inverse_right);
  add_crossed(c, (2.0 / 3) * traces, inverse_right);
  out.gradient = s.gradient;
}

/// dP_iJ / dF_kL = F_iI c_IJKL F_kK + delta_ik S_JL, its upper triangle by (i, J) and (k, L).
struct Tangent {
  Pack at[9][9];

  explicit Tangent(const PointStiffness& p) {
    const Pack* f = &p.gradient.row[0].x;  // by rows
    Pack left[9][6];
    for (int r = 0; r < 9; ++r)
      for (int e = 0; e < 6; ++e)
        left[r][e] = f[r - r % 3] * entry(p.moduli, place[0][r % 3], e) +
                     f[r - r % 3 + 1] * entry(p.moduli, place[1][r % 3], e) +
                     f[r - r % 3 + 2] * entry(p.moduli, place[2][r % 3], e);
    for (int r = 0; r < 9; ++r)
      for (int c = r; c < 9; ++c) {
        const int k = c / 3, l = c % 3;
        at[r][c] =
            f[3 * k] * left[r][place[0][l]] + f[3 * k + 1] * left[r][place[1][l]] + f[3 * k + 2] * left[r][place[2][l]];
        if (r / 3 == k) at[r][c] += p.stress.at[place[r % 3][l]];
      }
  }

  [[nodiscard]] const Pack& operator()(int r, int c) const { return r < c ? at[r][c] : at[c][r]; }
};

template <int K>
void add_point(const PointStiffness& p, const Pack3 (&slope)[K], ElasticStiffness<K>& out) {
  static_assert(sizeof(Pack33) == 9 * sizeof(Pack));
  const Tangent tangent(p);
  for (int b = 0; b < K; ++b) {
    Pack3 pulled[9];  // by (i, J), along each axis of node b
    for (int r = 0; r < 9; ++r) {
      const auto along_axis = [&](int k) {
        return tangent(r, 3 * k) * slope[b].x + tangent(r, 3 * k + 1) * slope[b].y + tangent(r, 3 * k + 2) * slope[b].z;
      };
      pulled[r] = {along_axis(0), along_axis(1), along_axis(2)};
    }
    for (int a = b; a < K; ++a) {
      Pack33& block = out.block[a * (a + 1) / 2 + b];
      for (int i = 0; i < 3; ++i)
        block.row[i] = block.row[i] +
                       (slope[a].x * pulled[3 * i] + slope[a].y * pulled[3 * i + 1] + slope[a].z * pulled[3 * i + 2]);
    }
  }
}

template <int K>
void add_projected(const Pack3 (&slope)[K], const Pack& volume, const ViscousBlock& viscous, int q,
                   const Shape<K>& current, ElasticStiffness<K>& out) {
  const Strain s = strain_at<K>(slope, current);
  const Pack33 stress = full(scaled(volume * s.scale, inverses_at(viscous, q, s)));
  for (int b = 0; b < K; ++b) {
    const Pack3 pulled = stress * slope[b];
    for (int a = b; a < K; ++a) add_to_diagonal(out.block[a * (a + 1) / 2 + b], dot(slope[a], pulled));
  }
}

}  // namespace

template <int Q>
void begin_step(const energy::ViscousBlock& branches, double* begun) {
  const ViscousBlock& viscous = wide(branches);
  for (int q = 0; q < Q; ++q) {
    const Symmetric strain = remembered(viscous, q, -1);
    for (int i = 0; i < viscous.branches; ++i, begun += begun_entries * lanes) {
      Symmetric before = scaled(viscous.fractions[i].remembered, remembered(viscous, q, i));
      add(before, viscous.fractions[i].begun, strain);
      const Pack root = cbrt(determinant(before, cofactor(before)));
      std::memcpy(begun, before.at, sizeof(before.at));
      std::memcpy(begun + 6 * lanes, &root, sizeof(root));
    }
  }
}

template <int K, int Q>
void add_viscous_force(const energy::ElasticBlock<K, Q>& elements, const energy::ViscousBlock& branches,
                       const energy::Shape<K>& shape, energy::ElasticForce<K>& force) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const ViscousBlock& viscous = wide(branches);
  const Shape<K>& current = wide(shape);
  ElasticForce<K>& out = wide(force);
  for (int q = 0; q < Q; ++q) {
    const Strain s = strain_at<K>(block.slope[q], current);
    const Symmetric cofactors = cofactor(s.barred);
    Symmetric inverses{};
    Pack energy{};
    for (int i = 0; i < viscous.branches; ++i) {
      const Branch b = branch_at(viscous, q, i, s);
      energy += 0.5 * viscous.modulus[i] * stored(b, s, cofactors);
      add(inverses, viscous.modulus[i], b.inverse);
    }
    out.energy += block.volume[q] * energy;
    const Symmetric stress = stress_of(inverses, s, inverse_of_right(s, cofactors));
    const Pack33 first = times(s.gradient, full(scaled(block.volume[q], stress)));
    for (int a = 0; a < K; ++a) out.gradient[a] = out.gradient[a] + first * block.slope[q][a];
  }
}

template <int K, int Q>
void add_viscous_stiffness(const energy::ElasticBlock<K, Q>& elements, const energy::ViscousBlock& branches,
                           const energy::Shape<K>& shape, bool projected, energy::ElasticStiffness<K>& stiffness) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const ViscousBlock& viscous = wide(branches);
  const Shape<K>& current = wide(shape);
  ElasticStiffness<K>& out = wide(stiffness);
  for (int q = 0; q < Q; ++q) {
    if (projected) {
      add_projected<K>(block.slope[q], block.volume[q], viscous, q, current, out);
      continue;
    }
    PointStiffness point;
    set_point<K>(block.slope[q], block.volume[q], viscous, q, current, point);
    add_point<K>(point, block.slope[q], out);
  }
}

template <int K, int Q>
void add_viscous_stress(const energy::ElasticBlock<K, Q>& elements, const energy::ViscousBlock& branches,
                        const energy::Shape<K>& shape, energy::Pack33 (&out)[Q]) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const ViscousBlock& viscous = wide(branches);
  const Shape<K>& current = wide(shape);
  Pack33(&stress)[Q] = wide(out);
  for (int q = 0; q < Q; ++q) {
    const Strain s = strain_at<K>(block.slope[q], current);
    const Symmetric inverse_right = inverse_of_right(s, cofactor(s.barred));
    const Symmetric pulled_back = stress_of(inverses_at(viscous, q, s), s, inverse_right);
    const Pack33 cauchy = times(times(s.gradient, full(scaled(1 / s.jacobian, pulled_back))), transposed(s.gradient));
    for (int r = 0; r < 3; ++r) stress[q].row[r] = stress[q].row[r] + cauchy.row[r];
  }
}

namespace {

/// Deviator of bar C C_v^-1, a matrix without symmetry, and the trace of its square.
struct Overstress {
  Pack33 at;
  Pack size;
};

Overstress overstress(const Symmetric& barred, const Symmetric& inverse) {
  Overstress o;
  o.at = times(full(barred), full(inverse));
  add_to_diagonal(o.at, (-1.0 / 3) * trace(o.at));
  o.size = max(inner(o.at, transposed(o.at)), Pack{});
  return o;
}

/// Integral of |s|^2 over a step, over its relaxation time, for s = a + b exp(-time), from s at begin and end. rate:
/// the step over the relaxation time
Pack integral(const Overstress& begin, const Overstress& end, const Pack& rate, const BranchFractions& fractions) {
  // their angle, from the Frobenius norms, which are theirs where strains have the same axes
  const Pack sizes = inner(begin.at, begin.at) * inner(end.at, end.at);
  const Pack both =
      select(sizes > 0, inner(begin.at, end.at) * sqrt(begin.size * end.size / max(sizes, pack(1e-300))), Pack{});
  // |s|^2 = |a|^2 + 2 a b e^-t + |b|^2 e^-2t with a = (end - e^-x begin) / (1 - e^-x), b = (begin - end) / (1 - e^-x)
  const Pack& e = fractions.remembered;
  const Pack gone = select(rate < 0.5, rate * (fractions.remembered + fractions.begun), 1 - e);
  const Pack per = 1 / max(gone * gone, pack(1e-300));
  const Pack aa = per * (end.size - 2 * e * both + e * e * begin.size);
  const Pack bb = per * (begin.size - 2 * both + end.size);
  const Pack ab = per * ((1 + e) * both - end.size - e * begin.size);
  const Pack closed = aa * rate + 2 * ab * gone + 0.5 * bb * gone * (1 + e);
  // short steps cancel: there |s|^2 changes evenly
  const Pack even = rate * (begin.size + both + end.size) / 3;
  return max(select(rate < 1e-3, even, closed), Pack{});
}

}  // namespace

template <int K, int Q>
void flow(const energy::ElasticBlock<K, Q>& elements, const energy::ViscousBlock& branches, const energy::Pack* rates,
          const energy::Shape<K>& shape, double* strains, double* kept) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const ViscousBlock& viscous = wide(branches);
  const Pack* rate = wide(rates);
  const Shape<K>& current = wide(shape);
  Pack lost{};
  const auto keep = [&strains](const Symmetric& strain) {
    std::memcpy(strains, strain.at, sizeof(strain.at));
    strains += 6 * lanes;
  };
  for (int q = 0; q < Q; ++q) {
    const Strain s = strain_at<K>(block.slope[q], current);
    keep(s.barred);
    for (int i = 0; i < viscous.branches; ++i) {
      const Branch b = branch_at(viscous, q, i, s);
      keep(scaled(b.inverse_root, b.flowed));
      const Overstress begin = overstress(remembered(viscous, q, -1), cofactor(remembered(viscous, q, i)));
      lost += 0.5 * block.volume[q] * viscous.modulus[i] *
              integral(begin, overstress(s.barred, b.inverse), rate[i], viscous.fractions[i]);
    }
  }
  SOFTKIN_TARGET::keep(lost, kept);
}

template void begin_step<1>(const energy::ViscousBlock&, double*);
template void begin_step<4>(const energy::ViscousBlock&, double*);
template void begin_step<6>(const energy::ViscousBlock&, double*);
template void add_viscous_force(const energy::ElasticBlock<4, 1>&, const energy::ViscousBlock&, const energy::Shape<4>&,
                                energy::ElasticForce<4>&);
template void add_viscous_stiffness(const energy::ElasticBlock<4, 1>&, const energy::ViscousBlock&,
                                    const energy::Shape<4>&, bool, energy::ElasticStiffness<4>&);
template void add_viscous_stress(const energy::ElasticBlock<4, 1>&, const energy::ViscousBlock&,
                                 const energy::Shape<4>&, energy::Pack33 (&)[1]);
template void flow(const energy::ElasticBlock<4, 1>&, const energy::ViscousBlock&, const energy::Pack*,
                   const energy::Shape<4>&, double*, double* kept);
template void add_viscous_force(const energy::ElasticBlock<10, 4>&, const energy::ViscousBlock&,
                                const energy::Shape<10>&, energy::ElasticForce<10>&);
template void add_viscous_stiffness(const energy::ElasticBlock<10, 4>&, const energy::ViscousBlock&,
                                    const energy::Shape<10>&, bool, energy::ElasticStiffness<10>&);
template void add_viscous_stress(const energy::ElasticBlock<10, 4>&, const energy::ViscousBlock&,
                                 const energy::Shape<10>&, energy::Pack33 (&)[4]);
template void flow(const energy::ElasticBlock<10, 4>&, const energy::ViscousBlock&, const energy::Pack*,
                   const energy::Shape<10>&, double*, double* kept);
template void add_viscous_force(const energy::ElasticBlock<6, 6>&, const energy::ViscousBlock&, const energy::Shape<6>&,
                                energy::ElasticForce<6>&);
template void add_viscous_stiffness(const energy::ElasticBlock<6, 6>&, const energy::ViscousBlock&,
                                    const energy::Shape<6>&, bool, energy::ElasticStiffness<6>&);
template void add_viscous_stress(const energy::ElasticBlock<6, 6>&, const energy::ViscousBlock&,
                                 const energy::Shape<6>&, energy::Pack33 (&)[6]);
template void flow(const energy::ElasticBlock<6, 6>&, const energy::ViscousBlock&, const energy::Pack*,
                   const energy::Shape<6>&, double*, double* kept);

}  // namespace softkin::energy::SOFTKIN_TARGET
