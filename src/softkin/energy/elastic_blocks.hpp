#pragma once

#include <softkin/core/elastic_law.hpp>
#include <softkin/energy/pack.hpp>

namespace softkin::energy {

/// Constants of a law, one set per lane [MPa]; meaning as in ElasticLaw.
template <class Pack>
struct LawBlockOf {
  Law law = Law::neo_hookean;
  Pack mu{}, lambda{}, c10{}, c01{}, c20{}, c30{}, bulk{}, jm{};
};

/// The strengths and exponents of Ogden's terms. They use the places of constants that this law does not have, so that
/// blocks of the other laws do not grow.
template <class Pack>
struct OgdenPlaces {
  static constexpr Pack LawBlockOf<Pack>::*mu[max_ogden_terms] = {&LawBlockOf<Pack>::mu, &LawBlockOf<Pack>::c10,
                                                                  &LawBlockOf<Pack>::c20};
  static constexpr Pack LawBlockOf<Pack>::*alpha[max_ogden_terms] = {&LawBlockOf<Pack>::lambda, &LawBlockOf<Pack>::c01,
                                                                     &LawBlockOf<Pack>::c30};
};

/// The constants of a law into a lane.
template <class Pack>
void set_law(LawBlockOf<Pack>& block, int lane, const ElasticLaw& law) {
  block.law = law.law;
  block.mu[lane] = law.mu;
  block.lambda[lane] = law.lambda;
  block.c10[lane] = law.c10;
  block.c01[lane] = law.c01;
  block.c20[lane] = law.c20;
  block.c30[lane] = law.c30;
  block.bulk[lane] = law.bulk;
  block.jm[lane] = law.jm;
  if (law.law != Law::ogden) return;
  for (int p = 0; p < max_ogden_terms; ++p) {
    (block.*OgdenPlaces<Pack>::mu[p])[lane] = law.ogden[p].mu;
    (block.*OgdenPlaces<Pack>::alpha[p])[lane] = law.ogden[p].alpha;
  }
}

/// Elements of K nodes and Q quadrature points (4, 1: linear tetrahedra; 10, 4: quadratic ones; 6, 6: prisms), one per
/// lane, all of one law. F = sum_a x_a slope_a^T. A dielectric elastomer's active stretch, F = F_e F_a, is in the
/// slopes: slope_a = F_a^-T (slope of the passive element).
template <class Pack, int K, int Q>
struct ElasticBlockOf {
  LawBlockOf<Pack> law;
  Pack3Of<Pack> slope[Q][K];  // gradients of the shape functions in the rest shape [1/mm]
  Pack volume[Q];             // rest volume that the point stands for [mm^3]; 0 in lanes without an element
};

template <class Pack, int K>
struct ElasticForceOf {
  Pack3Of<Pack> gradient[K];      // of the energy in the nodes' positions [N]
  Pack energy;                    // [mJ]
  typename Pack::Mask inverted;   // lanes with J <= 0 at a quadrature point that has volume
  typename Pack::Mask forbidden;  // lanes with a deformation that has no energy, at a quadrature point that has volume
};

/// Blocks (a, b), b <= a, of a symmetric matrix of K x K blocks of 3 x 3, at a (a + 1) / 2 + b [N/mm].
template <class Pack, int K>
struct ElasticStiffnessOf {
  Pack33Of<Pack> block[K * (K + 1) / 2];
};

/// What a branch is at the end of a time step is made of, x being the step over its relaxation time.
template <class Pack>
struct BranchFractionsOf {
  Pack remembered;  // exp(-x): of C_v at its begin
  Pack begun;       // (1 - exp(-x)) / x - exp(-x): of the strain there
  Pack ended;       // the rest: of the strain at its end
};

/// Maxwell branches of the elements of a block over a time step: springs and dampers in series, beside the elastic law
/// (energy/viscous.hpp).
template <class Pack>
struct ViscousBlockOf {
  int branches = 0;
  const Pack* modulus = nullptr;                       // G of every branch [MPa]; 0 in lanes that have fewer
  const BranchFractionsOf<Pack>* fractions = nullptr;  // of every branch
  const double* strains = nullptr;  // at the begin, by quadrature point: bar C, then C_v of every branch;
                                    // by entry (xx, yy, zz, xy, yz, xz) and lane; null: unit matrices
  const double* begun = nullptr;    // begin_step() of these
};

/// Pressures at the corners of tetrahedra that keep their volume (energy/pressure.hpp).
template <class Pack>
struct CornerPressureOf {
  Pack at[4]{};      // [MPa]; tension is positive
  Pack softness{};   // 1 / bulk modulus [1/MPa]
  Pack smoothing{};  // linear tetrahedra [1/MPa]
};
template <class Pack>
struct PressureMissOf {
  Pack at[4];
};
template <class Pack, int K>
struct PressureCouplingOf {
  Pack3Of<Pack> node[4][K];  // by pressure and node
  Pack own[10];              // (i, j), j <= i, at i (i + 1) / 2 + j
};

/// Numbers of ViscousBlock::begun at each quadrature point for each branch, in every lane: what M has from the step's
/// begin, and the cube root of its determinant.
inline constexpr int begun_entries = 7;

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
/// Prisms between two electrodes (energy/dielectric.hpp).
using DielectricPrisms = ElasticBlock<6, 6>;

}  // namespace softkin::energy
