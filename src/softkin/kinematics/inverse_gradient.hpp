#pragma once

#include <softkin/kinematics/inverse_robot.hpp>

namespace softkin::inverse {

/// Algorithm 2 of Fang et al. 2020 from a pose: descends along the gradient of the sum of squares J by central
/// differences, shrinking and expanding its step. Trials outside the ranges are brought back to them.
///
/// response    keeps cables slack
/// returns     the best pose; false where it stopped before a goal's error was within the tolerance
/// deviation   descends, sets J_opt and refreshes J_0, which the printed one does not; shares of the ranges instead of
///             the commands' own units; the step of the differences as below
/// difference  c = cbrt(6 a sqrt(J) / d^2) of a range, 1e-5 <= c <= 1e-2: where the noise of J, 2 a sqrt(J) with a [mm]
///             the accuracy of the poses, is as large as what the differences leave out, taking the third derivative
///             for d^2, d the robot's diagonal [mm]; one-sided at the end of a range
[[nodiscard]] bool descend(RobotResponse& response, double diagonal_mm, double accuracy_mm, int max_iterations,
                           Pose& pose, int& iterations, std::string& remark);

}  // namespace softkin::inverse
