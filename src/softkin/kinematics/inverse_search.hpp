#pragma once

#include <softkin/kinematics/inverse_response.hpp>
#include <softkin/kinematics/inverse_robot.hpp>

namespace softkin::inverse {

struct SearchSettings {
  Eigen::VectorXd preferred;          // f, fractions
  double resolution_mm = 1e-4;        // see StepLimits
  double accuracy_mm = 1e-5;          // of poses
  double preferred_tolerance = 1e-3;  // fraction of a range by which the nearest actuation may be missed
};

/// reached: every goal, as near to the preferred actuation as possible. stationary: no move helps, to first order.
/// none_left: the limit of poses is reached. stuck: no shorter step succeeds.
enum class SearchEnd { reached, stationary, none_left, stuck, interrupted };

struct SearchResult {
  SearchEnd end = SearchEnd::stuck;
  Pose pose;
  Slopes slopes;     // at the pose
  double slope = 0;  // projected_slope
  int iterations = 0;
};

/// Finds the minimum of the sum of squares in the ranges; of all poses that reach the goals, the one nearest to the
/// preferred actuation.
///
/// source  Gauss-Newton in a trust region (More 1978); where errors remain, with the secant curvature of Dennis, Gay
///         and Welsch 1981 (NL2SOL); between poses that reach their goals Broyden's update instead of new slopes
[[nodiscard]] SearchResult search_inverse(Response& response, const Pose& start, const SearchSettings& settings);

/// Algorithm 2 of Fang et al. 2020 from a pose: descends along the gradient of the sum of squares J by central
/// differences, shrinking and expanding its step. Trials outside the ranges are brought back to them.
///
/// response    keeps cables slack
/// returns     the best pose; false where it stopped before a goal's error was within the tolerance
/// deviation   descends, sets J_opt and refreshes J_0, which the printed one does not; fractions of the ranges instead
///             of the commands' own units; the step of the differences as below
/// difference  c = cbrt(6 a sqrt(J) / d^2) of a range, 1e-5 <= c <= 1e-2: where the noise of J, 2 a sqrt(J) with a [mm]
///             the accuracy of the poses, equals the truncation error of the differences, with d^2 for the third
///             derivative, d the robot's diagonal [mm]; one-sided at the end of a range
[[nodiscard]] bool descend(RobotResponse& response, double diagonal_mm, double accuracy_mm, int max_iterations,
                           Pose& pose, int& iterations, std::string& remark);

}  // namespace softkin::inverse
