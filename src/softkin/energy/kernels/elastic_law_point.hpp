#pragma once

#include <softkin/energy/kernels/elastic.hpp>
#include <softkin/energy/kernels/wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

/// A deformation gradient and what the laws that are functions of the invariants need of it, in every lane.
struct Deformation {
  Pack33 gradient;               // F
  Pack33 cofactor;               // dJ/dF
  Pack33 left;                   // F F^T
  Pack33 right;                  // C = F^T F
  Pack first, second, jacobian;  // I1, I2, J
};

/// W(I1, I2, J) and its derivatives [MPa]; those that a law does not have are 0.
struct InvariantEnergy {
  Pack energy;
  Pack by_first, by_second{}, by_jacobian{};
  Pack by_first_first{}, by_first_jacobian{}, by_second_jacobian{}, by_jacobian_jacobian{};
};

/// Does W depend on I2, on J, on a product of J and another invariant, not only linearly on I1?
template <Law law>
inline constexpr bool uses_second = law_traits(law).uses_second;
template <Law law>
inline constexpr bool uses_jacobian = law_traits(law).uses_jacobian;
template <Law law>
inline constexpr bool couples_jacobian = law_traits(law).couples_jacobian;
template <Law law>
inline constexpr bool curved_in_first = law_traits(law).curved_in_first;
/// A condition that fails for every law, once it is looked at.
template <Law>
inline constexpr bool no_such_law = false;

inline Pack33 transposed(const Pack33& a) {
  return {{{a.row[0].x, a.row[1].x, a.row[2].x},
           {a.row[0].y, a.row[1].y, a.row[2].y},
           {a.row[0].z, a.row[1].z, a.row[2].z}}};
}

/// a b
inline Pack33 times(const Pack33& a, const Pack33& b) {
  Pack33 c;
  for (int i = 0; i < 3; ++i) c.row[i] = a.row[i].x * b.row[0] + a.row[i].y * b.row[1] + a.row[i].z * b.row[2];
  return c;
}

/// a += left right^T
inline void add_outer(Pack33& a, const Pack3& left, const Pack3& right) {
  a.row[0] = a.row[0] + left.x * right;
  a.row[1] = a.row[1] + left.y * right;
  a.row[2] = a.row[2] + left.z * right;
}

inline void add_to_diagonal(Pack33& a, const Pack& value) {
  a.row[0].x += value;
  a.row[1].y += value;
  a.row[2].z += value;
}

inline Pack trace(const Pack33& a) {
  return a.row[0].x + a.row[1].y + a.row[2].z;
}

/// sum_ij a_ij b_ij
inline Pack inner(const Pack33& a, const Pack33& b) {
  return dot(a.row[0], b.row[0]) + dot(a.row[1], b.row[1]) + dot(a.row[2], b.row[2]);
}

/// dJ/dF
inline Pack33 cofactor(const Pack33& f) {
  return {{cross(f.row[1], f.row[2]), cross(f.row[2], f.row[0]), cross(f.row[0], f.row[1])}};
}

/// F = sum_a x_a slope_a^T. The slopes' sum is zero, so the positions are taken from the first node's: elements far
/// from the origin lose no digits.
template <int K>
Pack33 deformation_gradient(const Pack3 (&slope)[K], const Shape<K>& current) {
  Pack33 f{};
  for (int a = 1; a < K; ++a) add_outer(f, current[a] - current[0], slope[a]);
  return f;
}

inline Deformation deformation(const Pack33& f) {
  Deformation d;
  d.gradient = f;
  d.cofactor = cofactor(f);
  d.left = times(f, transposed(f));
  d.right = transpose_times(f, f);
  d.first = trace(d.right);
  d.second = inner(d.cofactor, d.cofactor);
  d.jacobian = dot(f.row[0], d.cofactor.row[0]);
  return d;
}

/// J as the laws that forbid inversion see it: flat below a volume that nothing survives, so that all stays finite.
inline Pack positive_jacobian(const Pack& jacobian) {
  return max(jacobian, pack(1e-12));
}

inline InvariantEnergy st_venant_kirchhoff(const LawBlock& law, const Deformation& d) {
  Pack33 twice_strain = d.right;
  add_to_diagonal(twice_strain, pack(-1));
  const Pack spread = d.first - 3;
  InvariantEnergy w;
  w.energy = 0.25 * law.mu * inner(twice_strain, twice_strain) + 0.125 * law.lambda * spread * spread;
  w.by_first = 0.5 * law.mu * (d.first - 1) + 0.25 * law.lambda * spread;
  w.by_second = -0.5 * law.mu;
  w.by_first_first = 0.5 * law.mu + 0.25 * law.lambda;
  return w;
}

inline InvariantEnergy neo_hookean(const LawBlock& law, const Deformation& d) {
  const Pack swelling = d.jacobian - 1;
  const Pack stiffness = law.lambda + law.mu;
  InvariantEnergy w;
  w.energy = 0.5 * law.mu * (d.first - 3) - law.mu * swelling + 0.5 * stiffness * swelling * swelling;
  w.by_first = 0.5 * law.mu;
  w.by_jacobian = stiffness * swelling - law.mu;
  w.by_jacobian_jacobian = stiffness;
  return w;
}

inline InvariantEnergy mooney_rivlin(const LawBlock& law, const Deformation& d) {
  const Pack j = positive_jacobian(d.jacobian);
  const Pack per_j = 1 / j;
  const Pack root = inverse_cbrt(j);
  const Pack scale = root * root, square = scale * scale;
  const Pack first = law.c10 * scale * d.first, second = law.c01 * square * d.second;
  const Pack swelling = j - 1;
  InvariantEnergy w;
  w.energy = first - 3 * law.c10 + second - 3 * law.c01 + 0.5 * law.bulk * swelling * swelling;
  w.by_first = law.c10 * scale;
  w.by_second = law.c01 * square;
  w.by_jacobian = (-2.0 / 3) * per_j * (first + 2 * second) + law.bulk * swelling;
  w.by_first_jacobian = (-2.0 / 3) * per_j * w.by_first;
  w.by_second_jacobian = (-4.0 / 3) * per_j * w.by_second;
  w.by_jacobian_jacobian = (2.0 / 9) * per_j * per_j * (5 * first + 14 * second) + law.bulk;
  return w;
}

/// f(bar I1 - 3) and its first two derivatives [MPa].
struct BarredEnergy {
  Pack energy, slope, curvature;
};

/// W = f(bar I1 - 3) + bulk/2 (J - 1)^2, by the chain rule.
template <class Function>
InvariantEnergy barred_first(const LawBlock& law, const Deformation& d, const Function& f) {
  const Pack j = positive_jacobian(d.jacobian);
  const Pack per_j = 1 / j;
  const Pack root = inverse_cbrt(j);
  const Pack scale = root * root;
  const Pack barred = scale * d.first, swelling = j - 1;
  const BarredEnergy barred_energy = f(barred - 3);
  const Pack &slope = barred_energy.slope, &curvature = barred_energy.curvature;
  const Pack barred_by_j = (-2.0 / 3) * barred * per_j;
  InvariantEnergy w;
  w.energy = barred_energy.energy + 0.5 * law.bulk * swelling * swelling;
  w.by_first = slope * scale;
  w.by_jacobian = slope * barred_by_j + law.bulk * swelling;
  w.by_first_first = curvature * scale * scale;
  w.by_first_jacobian = scale * (curvature * barred_by_j - (2.0 / 3) * slope * per_j);
  w.by_jacobian_jacobian =
      curvature * barred_by_j * barred_by_j + (10.0 / 9) * slope * barred * per_j * per_j + law.bulk;
  return w;
}

inline InvariantEnergy yeoh(const LawBlock& law, const Deformation& d) {
  return barred_first(law, d, [&](const Pack& stretch) {
    return BarredEnergy{stretch * (law.c10 + stretch * (law.c20 + stretch * law.c30)),
                        law.c10 + stretch * (2 * law.c20 + 3 * stretch * law.c30), 2 * law.c20 + 6 * stretch * law.c30};
  });
}

/// Share of the limit that is left, as the law sees it: flat where hardly anything is, so that all stays finite.
inline Pack room_below_limit(const LawBlock& law, const Pack& stretch) {
  return max(1 - stretch / law.jm, pack(1e-9));
}

inline InvariantEnergy gent(const LawBlock& law, const Deformation& d) {
  return barred_first(law, d, [&](const Pack& stretch) {
    const Pack per_room = 1 / room_below_limit(law, stretch);
    const Pack slope = 0.5 * law.mu * per_room;
    return BarredEnergy{0.5 * law.mu * law.jm * log(per_room), slope, slope * per_room / law.jm};
  });
}

/// Lanes whose deformation the law has no energy for.
template <Law law>
PackMask has_no_energy(const LawBlock& constants, const Pack33& f, const Pack& jacobian) {
  if constexpr (!forbids_inversion(law)) return PackMask{};
  PackMask none = jacobian <= 0;
  if constexpr (law == Law::gent) {
    const Pack root = inverse_cbrt(positive_jacobian(jacobian));
    none |= root * root * inner(f, f) - 3 >= constants.jm;
  }
  return none;
}

/// W and its derivatives for a law that is a function of the invariants.
template <Law law>
InvariantEnergy invariant_energy(const LawBlock& constants, const Deformation& d) {
  static_assert(law_traits(law).form == LawForm::invariants);
  if constexpr (law == Law::st_venant_kirchhoff)
    return st_venant_kirchhoff(constants, d);
  else if constexpr (law == Law::neo_hookean)
    return neo_hookean(constants, d);
  else if constexpr (law == Law::mooney_rivlin)
    return mooney_rivlin(constants, d);
  else if constexpr (law == Law::yeoh)
    return yeoh(constants, d);
  else if constexpr (law == Law::gent)
    return gent(constants, d);
  else
    static_assert(no_such_law<law>, "a law of the invariants needs its energy here");
}

/// Calls work.template operator()<law>() for the law given: once per block, so that no inner loop asks.
template <class Work>
void dispatch(Law law, const Work& work) {
  switch (law) {
    case Law::st_venant_kirchhoff:
      return work.template operator()<Law::st_venant_kirchhoff>();
    case Law::corotational:
      return work.template operator()<Law::corotational>();
    case Law::neo_hookean:
      return work.template operator()<Law::neo_hookean>();
    case Law::mooney_rivlin:
      return work.template operator()<Law::mooney_rivlin>();
    case Law::yeoh:
      return work.template operator()<Law::yeoh>();
    case Law::gent:
      return work.template operator()<Law::gent>();
    case Law::ogden:
      return work.template operator()<Law::ogden>();
  }
  refuse_law(law);
}

}  // namespace softkin::energy::SOFTKIN_TARGET
