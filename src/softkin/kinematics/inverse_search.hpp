#pragma once

#include <softkin/kinematics/inverse_response.hpp>

namespace softkin::inverse {

struct SearchSettings {
  Eigen::VectorXd preferred;          // f, shares
  double resolution_mm = 1e-4;        // see StepLimits
  double accuracy_mm = 1e-5;          // to which poses are known
  double preferred_tolerance = 1e-3;  // share of a range that may be missing to the nearest actuation
};

/// reached: every goal, as near to the preferred actuation as can be. stationary: no move helps, to first order.
/// no_left: of the poses it may ask for. stuck: no shorter step leads on.
enum class SearchEnd { reached, stationary, none_left, stuck, interrupted };

struct SearchResult {
  SearchEnd end = SearchEnd::stuck;
  Pose pose;
  Slopes slopes;     // at the pose
  double slope = 0;  // projected_slope
  int iterations = 0;
};

/// Least sum of squares in the ranges, nearest to the preferred actuation of all that reach the goals.
///
/// source  Gauss-Newton in a trust region (More 1978); where the errors stay, with the secant curvature of Dennis, Gay
///         and Welsch 1981 (NL2SOL); between poses that reach their goals Broyden's update instead of new slopes
[[nodiscard]] SearchResult search_inverse(Response& response, const Pose& start, const SearchSettings& settings);

}  // namespace softkin::inverse
