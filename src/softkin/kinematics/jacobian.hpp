#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// Derivatives of marker positions by the commands of the actuators.
///
/// sensitivity  of an equilibrium of the model, m actuators
/// markers      p indices into model.markers
/// returns      3p x m: x, y, z of each marker [mm per unit of command: 1 (ratio), N or kPa]
/// throws       InvalidInput on a marker that the model does not have
[[nodiscard]] Eigen::MatrixXd jacobian(const Model& model, const Points& positions, const Sensitivity& sensitivity,
                                       const std::vector<Index>& markers);

/// The same at an equilibrium that statics.solve() returned; zero where its sensitivity is not regular.
///
/// throws  as the above and Statics::sensitivity do
[[nodiscard]] Eigen::MatrixXd jacobian(const Statics& statics, const Equilibrium& equilibrium,
                                       const std::vector<Index>& markers);

/// Returns the derivative of a marker by a parameter of the robot, through the motion of the vertices and through its
/// place among them [mm per unit of the number].
///
/// number  the robot with it a little larger and smaller
/// moves   of the vertices, #V by 3 [mm per unit of the number]
[[nodiscard]] Vec3 marker_slope(const Model& model, const Perturbed& number, std::size_t marker,
                                const Points& positions, const Points& moves);

}  // namespace softkin
