#pragma once

#include <softkin/kinematics/goal.hpp>
#include <softkin/statics/sensitivity.hpp>

namespace softkin::inverse {

/// Goals as terms whose squares are summed, Eq. (12): each coordinate's error times the root of its goal's weight [mm].
///
/// The goals are checked already.
[[nodiscard]] Eigen::VectorXd goal_terms(const Model& model, const std::vector<Goal>& goals, const Points& positions);

/// Derivative of the terms by the commands, #terms by m [mm per unit of command].
[[nodiscard]] Eigen::MatrixXd goal_slopes(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                          const Sensitivity& sensitivity);

}  // namespace softkin::inverse
