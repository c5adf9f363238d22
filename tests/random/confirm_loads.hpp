#pragma once

#include <limits>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>

#include "random/reference_elements.hpp"

namespace softkin::random_robots {

inline constexpr Real rounding_unit = std::numeric_limits<double>::epsilon();
/// Units in the last place that rounding may add up to.
inline constexpr Real sums = 16;

/// Forces at every vertex, summed over whatever acts there.
struct Forces {
  explicit Forces(Index vertices)
      : sum(RealPoints::Zero(vertices, 3)), size(vertices, 0), stiffness(vertices, 0), rounding(vertices, 0) {}

  RealPoints sum;                               // [N]; 0: balance
  std::vector<Real> size, stiffness, rounding;  // [N], [N/mm], [N]: see ElementPulls

  void add(Index v, const RealVec3& force, Real blur) {
    sum.row(v) += force.transpose();
    size[v] += force.norm();
    rounding[v] += blur + rounding_unit * force.norm();
  }
};

/// Loads that follow the surface: the turn of a place by the singular vectors of what deforms surface and normal.
void add_tractions(const Model& model, const State& state, Forces& forces);
/// A liquid around it: pressures by depth, on faces that are halved where its level cuts them.
void add_liquid(const Model& model, const State& state, Forces& forces);
/// Threads: tension times what each vertex of a place lengthens it by.
void add_fibres(const Model& model, const State& state, Forces& forces);
/// Sheets: stresses of their strain, where they wrinkle along the direction in which nothing shears; moments times the
/// differences of their angles.
void add_layers(const Model& model, const State& state, Forces& forces);

}  // namespace softkin::random_robots
