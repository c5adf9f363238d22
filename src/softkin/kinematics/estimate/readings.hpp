#pragma once

#include <softkin/model/measured_poses.hpp>
#include <softkin/model/model.hpp>

namespace softkin::estimate {

/// Is it a function of the shape alone: a coordinate, a length, a volume, an angle?
[[nodiscard]] bool is_of_shape(const PoseColumn& column);

/// What a reading is at an equilibrium, in the unit of its kind.
///
/// state      with multipliers [N or kPa]
/// reactions  on the vertices, #V by 3 [N], as Statics::measured() has them; read where the reading is a support's
[[nodiscard]] double reading_at(const Model& model, const PoseColumn& column, const State& state,
                                const Points& reactions);

/// How an equilibrium changes with something.
struct ShapeChange {
  const Points& moves;                 // #V by 3 [mm per unit]
  const Eigen::VectorXd& multipliers;  // m [N or kPa per unit]
  const Points& reactions;             // #V by 3 [N per unit]
};

/// How a reading changes thereby; lengths of cables and volumes by central differences along the moves, exact to 1e-9.
[[nodiscard]] double reading_change(const Model& model, const PoseColumn& column, const State& state,
                                    const ShapeChange& change);

/// Its derivative by the vertices' places, #V by 3, of a marker's coordinate or of what a sensor measures.
[[nodiscard]] Points reading_gradient(const Model& model, const PoseColumn& column, const Points& positions);

}  // namespace softkin::estimate
