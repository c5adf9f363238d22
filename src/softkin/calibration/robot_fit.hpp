#pragma once

#include <functional>
#include <softkin/calibration/robot_dots.hpp>
#include <softkin/calibration/robot_outlines.hpp>
#include <softkin/model/measured_poses.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin::calibration {

/// The loss of an outlier: its squared distance; or its distance (huber); or hardly more than that of a good reading
/// (cauchy).
enum class Loss { squares, huber, cauchy };

/// The names of Loss in options.
constexpr const char* loss_names[] = {"squares", "huber", "cauchy"};

/// How a robot is fitted to its poses.
struct RobotFitOptions {
  StaticsOptions solver{};                    // of each equilibrium
  Loss loss = Loss::squares;                  // of outliers
  std::array<double, readings> deviations{};  // of each kind of reading; 0: estimated from the residuals
  int max_iterations = 30;                    // of the fit
  int threads = 0;                            // poses side by side; 0: as many as the machine has
  bool ordered = false;                       // with friction or backlash: each pose starts from the one before, the
                                              // first from rest; else each from rest
  std::vector<bool> kept{};                   // per pose: not fitted to; empty: none
  double match_within_mm = 0;  // how far a dot without a name may be from its marker; 0: there are no such dots
  OutlineOptions outlines{};   // of pictures
};

/// The poses of the robot with given numbers.
struct ComputedPoses {
  Eigen::MatrixXd values;               // as values of the named poses; NaN where a pose has no equilibrium
  std::vector<Equilibrium> equilibria;  // per pose
};

/// The root mean square of readings.
struct Misfit {
  double rms = 0, largest = 0;  // [unit of the readings]
  std::size_t readings = 0;     // that it is of
};

/// Outlines in pictures compared with the robot's.
struct OutlineFit {
  std::vector<std::vector<OutlineReading>> poses;  // per pose: the points that are fitted to or predicted
  std::vector<OutlineLines> lines;                 // per pose: the outline of the robot [mm]
  double within_mm = 0;                            // farther off a point does not count
  double scale_mm = 0;                             // deviation of a distance: given, or from the residuals; 0: none
  Misfit fitted_mm, kept_mm;                       // distances of points that count, of poses fitted to, of the others
};

/// The numbers of a robot that fit its poses best, how well they are known, and what the robot then does.
struct RobotFit {
  Status status = Status::not_converged;  // interrupted: the best so far
  std::string remark{};                   // why it is not converged
  Eigen::VectorXd values, deviations;     // deviation NaN: the poses do not determine it
  Eigen::MatrixXd correlations;           // of those that are determined; else 0
  std::vector<int> at_bound;              // per number: -1 low, +1 high, else 0
  MeasuredPoses named;                    // the poses, dots as readings of the markers that they are matched to
  DotMatches dots;                        // which these are
  ComputedPoses computed;                 // at the values
  std::array<double, readings> scales{};  // deviation of each kind of reading: given, or by what is left; 0: none of it
  Misfit markers_mm;                      // distances of markers, of poses that were fitted to
  Misfit kept_mm;                         // of the others
  OutlineFit outlines;                    // empty without pictures
  int iterations = 0;                     // that the fit took
  int without_equilibrium = 0;            // poses
  double seconds = 0;                     // that it took [s]
};

/// The progress report of a fit.
struct FitProgress {
  int iteration = 0, poses_done = 0, poses = 0;  // from 1; poses solved in it, of so many
  double rms_mm = 0;                             // of the last iteration; 0: none yet
};
/// Returns false to stop.
using FitCallback = std::function<bool(const FitProgress&)>;

/// Chooses poses, spread evenly, that are not fitted to.
///
/// throws  InvalidInput naming the option: none would be left
[[nodiscard]] std::vector<bool> kept_aside(const std::string& option, int keep, std::size_t poses);

/// Finds the numbers at which the robot reproduces the measurements, by Levenberg's and Marquardt's method through
/// equilibria, with exact derivatives.
///
/// minimises  sum over readings of loss((computed - measured) / scale) + sum over priors of
///            ((value - mean) / deviation)^2 within the bounds; a marker's coordinates are one reading; dots without
///            names and points of outlines are matched anew after each step, until the match stays, and then within the
///            requested distance; the distance of a point is by the nearest place of the outline wherever the robot is
/// deviations of the normal equations at the end, scaled by the deviation of readings
/// throws     InvalidInput: a target-shape robot, no pose to fit to, fewer readings than numbers, and the exceptions of
///            DotMatcher and RobotOutlines
[[nodiscard]] RobotFit fit_robot(const NumberedRobot& robot, const MeasuredPoses& poses, const RobotFitOptions& options,
                                 const FitCallback& progress = {});

/// The poses of a robot whose numbers are given, and how far they are from what was measured.
[[nodiscard]] RobotFit predict_poses(const NumberedRobot& robot, const MeasuredPoses& poses,
                                     const Eigen::VectorXd& values, const RobotFitOptions& options,
                                     const FitCallback& progress = {});

}  // namespace softkin::calibration
