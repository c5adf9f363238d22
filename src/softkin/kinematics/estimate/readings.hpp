#pragma once

#include <softkin/model/measured_poses.hpp>
#include <softkin/model/model.hpp>

namespace softkin::estimate {

/// Is it a function of the shape alone: a coordinate, a length, a volume, an angle?
[[nodiscard]] bool is_of_shape(const PoseColumn& column);

/// Returns the computed value of a reading at an equilibrium, in the unit of its kind.
///
/// state      with multipliers [N or kPa]
/// reactions  on the vertices, #V by 3 [N], as Statics::measured() has them; read where the reading is a support's
[[nodiscard]] double reading_at(const Model& model, const PoseColumn& column, const State& state,
                                const Points& reactions);

/// The derivative of an equilibrium by a parameter.
struct ShapeChange {
  const Points& moves;                 // #V by 3 [mm per unit]
  const Eigen::VectorXd& multipliers;  // m [N or kPa per unit]
  const Points& reactions;             // #V by 3 [N per unit]
};

/// Returns the derivative of a reading along that change; lengths of cables and volumes by central differences along
/// the moves, exact to 1e-9.
[[nodiscard]] double reading_change(const Model& model, const PoseColumn& column, const State& state,
                                    const ShapeChange& change);

/// Returns the derivative of a marker's coordinate or of a sensor's value by the vertex positions, #V by 3.
[[nodiscard]] Points reading_gradient(const Model& model, const PoseColumn& column, const Points& positions);

}  // namespace softkin::estimate
