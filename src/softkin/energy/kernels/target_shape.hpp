#pragma once

#include <softkin/core/target.hpp>
#include <softkin/energy/pack.hpp>

namespace softkin::energy {

/// Body elements of K vertices (4: tetrahedra, 6: prisms), one per lane.
template <class Pack, int K>
struct BodyBlockOf {
  Pack3Of<Pack> rest[K];  // centred [mm]
  Pack volume;            // at rest [mm^3]
  Pack weight;            // w_i Vol_i [mm^3]; 0 in lanes without an element
  Pack shape_ratio;       // R_omega [-]
  bool blended;           // is any shape ratio below 1
};

/// Actuation elements of K vertices (3: cable triangle, 4: pneumatic tetrahedron, 6: DEA prism), one per lane. The
/// target shape at ratio a is constant + f(a) grown + g(a) thinned; f, g: a, - (cable); cbrt(a), - (pneumatic);
/// sqrt(a), 1 / a (DEA).
template <class Pack, int K>
struct ActuationBlockOf {
  Pack3Of<Pack> constant[K], grown[K], thinned[K];  // centred [mm]
  Pack measure;  // length [mm], volume [mm^3] or mean area of top and bottom [mm^2] at rest
  Pack weight;   // w_i Vol_i [mm^3]; 0 in lanes without an element
};

/// What an element pulls with: weight (V^t - N V^d), and its energy weight ||N V^d - V^t||^2 [mm^5], Eq. (1).
template <class Pack, int K>
struct ElementPullOf {
  Pack3Of<Pack> pull[K];
  Pack energy;
};

/// Blocks (a, b), b <= a, of a symmetric matrix of K x K blocks of 3 x 3, at a (a + 1) / 2 + b [mm^3].
template <class Pack, int K>
struct TargetStiffnessOf {
  Pack33Of<Pack> block[K * (K + 1) / 2];
};

/// How an element's ratio answers to its shape, and its pull to the ratio: b and grad a of
/// d pull = w b (grad a . d current).
template <class Pack, int K>
struct RatioCouplingOf {
  Pack3Of<Pack> pull_slope[K];   // d pull / d ratio [mm^4]
  Pack3Of<Pack> ratio_slope[K];  // d current_ratio / d current [1/mm]
};

template <int K>
using BodyBlock = BodyBlockOf<Pack, K>;
template <int K>
using ActuationBlock = ActuationBlockOf<Pack, K>;
template <int K>
using ElementPull = ElementPullOf<Pack, K>;
template <int K>
using TargetStiffness = TargetStiffnessOf<Pack, K>;
template <int K>
using RatioCoupling = RatioCouplingOf<Pack, K>;

// energy/target_shape.hpp and target_shape_stiffness.hpp say what they do.
SOFTKIN_KERNELS(
    template <int K>
    void current_ratio(const energy::ActuationBlock<K>& block, const energy::Shape<K>& current, double* kept);
    template <int K> void pull_of_body(const energy::BodyBlock<K>& block, energy::Shape<K>& current,
                                       energy::PackRotation& rotation, energy::ElementPull<K>& out);
    template <int K>
    void pull_of_actuation(const energy::ActuationBlock<K>& block, const energy::Pack& ratio, energy::Shape<K>& current,
                           energy::PackRotation& rotation, energy::ElementPull<K>& out);
    template <int K> void pull_change_of_body(const energy::BodyBlock<K>& block, const energy::Shape<K>& current,
                                              const energy::PackRotation& rotation, const energy::Shape<K>& change,
                                              energy::Shape<K>& out);
    template <int K> void pull_change_of_actuation(const energy::ActuationBlock<K>& block, const energy::Pack& ratio,
                                                   const energy::Pack& ratio_change, const energy::Shape<K>& current,
                                                   const energy::PackRotation& rotation, const energy::Shape<K>& change,
                                                   energy::Shape<K>& out);
    template <int K> void turned_move_of_body(const energy::BodyBlock<K>& block, const energy::Shape<K>& current,
                                              const energy::PackRotation& rotation, const energy::Shape<K>& change,
                                              energy::Shape<K>& out);
    template <int K>
    void turned_move_of_actuation(const energy::ActuationBlock<K>& block, const energy::Pack& ratio,
                                  const energy::Shape<K>& current, const energy::PackRotation& rotation,
                                  const energy::Shape<K>& change, energy::Shape<K>& out);
    template <int K> void ratio_change(const energy::ActuationBlock<K>& block, const energy::Shape<K>& current,
                                       const energy::Shape<K>& change, double* kept);
    template <int K> void ratio_coupling(const energy::ActuationBlock<K>& block, const energy::Pack& ratio,
                                         const energy::Shape<K>& current, const energy::PackRotation& rotation,
                                         energy::RatioCoupling<K>& out);
    template <int K>
    void stiffness_of_body(const energy::BodyBlock<K>& block, const energy::Shape<K>& current,
                           const energy::PackRotation& rotation, bool projected, energy::TargetStiffness<K>& out);
    template <int K>
    void stiffness_of_actuation(const energy::ActuationBlock<K>& block, const energy::Pack& ratio, bool redistributed,
                                const energy::Shape<K>& current, const energy::PackRotation& rotation, bool projected,
                                energy::TargetStiffness<K>& out);
    void volume_of_blocks(const energy::Shape<4>& current, double* kept);
    void volume_of_blocks(const energy::Shape<6>& current, double* kept);
    void volume_slope_of_blocks(const energy::Shape<4>& current, energy::Shape<4>& out);
    void volume_slope_of_blocks(const energy::Shape<6>& current, energy::Shape<6>& out);)

}  // namespace softkin::energy
