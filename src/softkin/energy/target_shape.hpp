#pragma once

#include <softkin/energy/rotation.hpp>

namespace softkin::energy {

/// Body elements of K vertices (4: tetrahedra, 6: prisms), one per lane.
template <int K>
struct BodyBlock {
  Shape<K> rest;     // centred [mm]
  Pack volume;       // at rest [mm^3]
  Pack weight;       // w_i Vol_i [mm^3]; 0 in lanes without an element
  Pack shape_ratio;  // R_omega [-]
  bool blended;      // is any shape ratio below 1
};

/// Actuation elements of K vertices (3: cable triangle, 4: pneumatic tetrahedron, 6: DEA prism), one per lane. The
/// target shape at ratio a is constant + f(a) grown + g(a) thinned; f, g: a, - (cable); cbrt(a), - (pneumatic);
/// sqrt(a), 1 / a (DEA).
template <int K>
struct ActuationBlock {
  Shape<K> constant, grown, thinned;  // centred [mm]
  Pack measure;                       // length [mm], volume [mm^3] or mean area of top and bottom [mm^2] at rest
  Pack weight;                        // w_i Vol_i [mm^3]; 0 in lanes without an element
};

/// What an element pulls with: weight (V^t - N V^d), and its energy weight ||N V^d - V^t||^2 [mm^5], Eq. (1).
template <int K>
struct ElementPull {
  Shape<K> pull;
  Pack energy;
};

/// Signed volume of every lane [mm^3]; current need not be centred. Prisms: bilinear sides, exact.
[[nodiscard]] Pack volume(const Shape<4>& current);
[[nodiscard]] Pack volume(const Shape<6>& current);

/// What an actuation element has now of what its actuator controls: length, volume, mean area over the rest's [-].
template <int K>
[[nodiscard]] Pack current_ratio(const ActuationBlock<K>& block, const Shape<K>& current);

/// Local step of a body element.
///
/// current   the elements' vertices [mm]; centred on return
/// rotation  in: where the search begins; out: R_i
/// source    Fang et al. 2020, Eqs. (2)-(5), (9); r is the cube root of the volume ratio (the print lacks the root)
/// deviation the volume-preserving target of an element below an eighth of its volume turns linearly into the rigid
///           one, which an inverted element takes whole: Eq. (4) would enlarge inverted elements
template <int K>
void pull_of_body(const BodyBlock<K>& block, Shape<K>& current, PackRotation& rotation, ElementPull<K>& out);

/// Local step of an actuation element at the local ratios given.
///
/// ratio   s_i, alpha_i or lambda_i [-], > 0
/// source  Fang et al. 2020, Eq. (2), Section II-D and Fig. 4
template <int K>
void pull_of_actuation(const ActuationBlock<K>& block, const Pack& ratio, Shape<K>& current, PackRotation& rotation,
                       ElementPull<K>& out);

/// Target shapes of Fig. 4 for one element at rest, split as ActuationBlock has it: rows are points.
template <int K>
struct TargetSplit {
  Eigen::Matrix<double, K, 3> constant, grown, thinned;
};
/// (cable end, cable end, apex), Eq. (6): the edge on x shrinks, the apex on y stays.
[[nodiscard]] TargetSplit<3> split_cable(const Eigen::Matrix<double, 3, 3>& rest);
/// The whole element grows about its centroid, Eq. (8).
[[nodiscard]] TargetSplit<4> split_pneumatic(const Eigen::Matrix<double, 4, 3>& rest);
/// Eq. (7): both triangles grow in their planes about their centres; the distance of the centres thins along the mean
/// normal.
[[nodiscard]] TargetSplit<6> split_dea(const Eigen::Matrix<double, 6, 3>& rest);

}  // namespace softkin::energy
