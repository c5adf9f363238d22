#pragma once

#include <chrono>
#include <softkin/calibration/robot_dots.hpp>
#include <softkin/calibration/robot_fit.hpp>
#include <softkin/calibration/robot_outlines.hpp>

namespace softkin::calibration {

/// The robot with some numbers, and its poses.
struct RobotPoint {
  Eigen::VectorXd values;
  std::shared_ptr<const Model> model;
  std::shared_ptr<const Statics> statics;
  MeasuringFrame frame;
  std::vector<Actuation> acting;                // per pose: the commands that act, behind any backlash
  std::vector<Equilibrium> equilibria;          // per pose
  Eigen::MatrixXd computed;                     // as MeasuredPoses::values; NaN where a pose has no equilibrium
  std::vector<Eigen::MatrixXd> slopes;          // per pose: of the computed by the numbers; none: not requested
  OutlineMisses outline_misses;                 // per pose; none where it has no equilibrium
  std::vector<Eigen::MatrixXd> outline_slopes;  // per pose: of their distances by the numbers; none: as slopes
  int without_equilibrium = 0;
  std::string refusal;  // why the scene refuses the values, of which then nothing is known; empty: it does not
};

/// Deviations of readings, per kind; 0: there is none of it.
using Scales = std::array<double, readings>;

/// Residuals of readings and priors, each times the root of its weight, and their derivatives.
struct Linearised {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd slopes;
  Eigen::VectorXd weights;  // per residual: by the loss, over the square of its scale
};

/// Least squares of the readings of poses in the numbers of a robot.
class RobotProblem {
 public:
  /// All must outlive the object.
  RobotProblem(const NumberedRobot& robot, const MeasuredPoses& poses, const RobotFitOptions& options,
               const FitCallback& progress);

  /// Readings that are fitted to, a marker's coordinates are one each; with the dots and points of outlines that were
  /// seen, and with those that are matched.
  [[nodiscard]] std::size_t readings() const { return readings_ + dots_seen_ + outline_rows_; }
  [[nodiscard]] std::size_t matched_readings() const { return readings_ + outline_points_that_count(); }
  /// Matches dots to the markers of a point, and points of outlines to its outline; from then on within the requested
  /// distance if strict, else within three times the median. Has the match changed? Outlines are reported by the last
  /// match.
  bool match(const RobotPoint& point, bool strict);
  [[nodiscard]] const DotMatcher& dots() const { return dots_; }
  /// Returns the readings and misfits of outlines at a point, with the computed outlines.
  [[nodiscard]] OutlineFit outline_fit(const RobotPoint& point) const;
  /// The numbers of a point with those of the measuring frame where its markers are nearest to what was seen, its
  /// shapes as they are: with dots without names, which else are matched to wrong markers at first. Else as they are.
  [[nodiscard]] Eigen::VectorXd aligned(const RobotPoint& point);
  /// near    a point from whose shapes the search begins; null: from rest
  /// none    the user stopped it
  /// throws  InvalidInput where it begins at rest and the scene refuses the values
  [[nodiscard]] std::optional<RobotPoint> solve(const Eigen::VectorXd& values, const RobotPoint* near, bool slopes);
  /// Of a point with slopes.
  [[nodiscard]] Linearised linearised(const RobotPoint& point) const;
  /// Sum of squares by weights that are held, with the priors: comparable between points.
  [[nodiscard]] double cost(const RobotPoint& point, const Eigen::VectorXd& weights) const;
  [[nodiscard]] Scales scales(const RobotPoint& point) const;
  /// Distances of markers. kept: of the poses that are not fitted to
  [[nodiscard]] Misfit marker_misfit(const RobotPoint& point, bool kept) const;

  void begin_iteration(int iteration, double rms_mm) {
    progress_state_.iteration = iteration;
    progress_state_.rms_mm = rms_mm;
  }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  /// Columns of a pose that were read together: a marker's coordinates, or a load.
  struct Group {
    std::vector<Index> columns;
    Index marker;
    Reading kind;
  };

  [[nodiscard]] bool fits(Index pose) const { return options_.kept.empty() || !options_.kept[pose]; }
  [[nodiscard]] bool read(Index pose, Index column) const;
  [[nodiscard]] bool reads_forces() const;
  /// Of a pose's readings together, what the robot does less what was read.
  [[nodiscard]] Eigen::VectorXd miss(const RobotPoint& point, Index pose, const Group& group) const;
  /// visit(pose, group, row of the first of its residuals) of what is fitted to.
  template <class Visit>
  void each_reading(const Visit& visit) const;
  /// visit(pose, point, row) of the points of outlines that are fitted to.
  template <class Visit>
  void each_outline_point(const Visit& visit) const;
  [[nodiscard]] std::size_t outline_points_that_count() const;
  [[nodiscard]] double off_outline(const RobotPoint& point, Index pose, std::size_t k) const;
  [[nodiscard]] double outline_scale(const RobotPoint& point) const;
  void linearise_outlines(const RobotPoint& point, Linearised& linear) const;
  /// Of a reading that is so many deviations off: by the loss.
  [[nodiscard]] double fraction_by_loss(double distance) const;
  [[nodiscard]] double scale(const RobotPoint& point, Reading kind) const;
  [[nodiscard]] double scale_of(std::vector<double> distances, double squares, std::size_t count) const;
  [[nodiscard]] Eigen::VectorXd residuals(const RobotPoint& point, const Eigen::VectorXd& weights) const;
  struct MarkerMisses;
  [[nodiscard]] MarkerMisses marker_misses(const RobotPoint& point, const std::vector<Index>& numbers) const;
  void put(RobotPoint& point, const Eigen::VectorXd& values) const;
  struct Changes;
  void compute(RobotPoint& point, const Changes* changes, Index pose) const;
  [[nodiscard]] std::vector<Actuation> acting(const Model& model) const;
  void find_acting(Changes& changes) const;
  void add_changes_of_acting(ParameterSensitivity& found, const RobotPoint& point, const Changes& changes,
                             Index pose) const;
  void add_slopes_of_frame(RobotPoint& point, const Changes& changes, Index pose, const Points& reactions) const;
  void add_outline_slopes(RobotPoint& point, const Changes& changes, Index pose,
                          const ParameterSensitivity& found) const;
  void add_slopes(RobotPoint& point, const Changes& changes, Index pose, const Points& reactions) const;
  bool each_pose(int max_threads, const std::function<bool(Index, const ProgressCallback&)>& act);

  void count();

  const NumberedRobot& robot_;
  const RobotFitOptions& options_;
  const FitCallback& progress_;
  std::shared_ptr<const Model> first_model_;  // all others use its patterns
  DotMatcher dots_;
  RobotOutlines outlines_;
  const MeasuredPoses& poses_;  // of the matcher of dots
  std::vector<Group> groups_;
  std::size_t readings_ = 0, dots_seen_ = 0;
  std::size_t reading_rows_ = 0, outline_rows_ = 0, rows_ = 0;  // one after another; rows_: with the priors
  bool strict_ = false;
  std::shared_ptr<const Statics> first_statics_;
  FitProgress progress_state_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace softkin::calibration
