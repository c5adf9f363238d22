#pragma once

#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/nearest.hpp>
#include <softkin/model/paths.hpp>
#include <softkin/statics/viscous_clock.hpp>
#include <variant>

namespace softkin {

/// The path with waypoints inserted, evenly on the straight lines between those given, so that no marker is to move
/// farther from one to the next than a distance [mm]; times likewise.
///
/// throws  InvalidInput where the distance is not > 0, or more than a million waypoints would come of it
[[nodiscard]] MarkerPath densified(const MarkerPath& path, double max_step_mm);

/// Returns the goals of a waypoint: the markers of the path at their targets.
[[nodiscard]] std::vector<Goal> goals_of(const MarkerPath& path, const Waypoint& waypoint);

/// The sampled workspace from which each waypoint takes the nearest sample instead of an inverse solution: given
/// samples, or a grid of this number of samples over the ranges, which is solved for before the first waypoint.
using NearestOf = std::variant<std::vector<WorkspaceSample>, Index>;

/// How a path is followed.
struct TrajectoryOptions {
  InverseOptions inverse{};  // start_sensitivity is set here; other_starts is for the first waypoint alone, as a jump
                             // to another shape would tear the path
  bool predict = true;       // newton: the next actuation from the Jacobian and its change, where
                             // Statics::extrapolate is not available
  Actuation start{};         // m: from where the first waypoint is searched, such as that of the nearest sample of a
                             // workspace; empty: rest
  std::optional<NearestOf> nearest{};  // in place of inverse kinematics, of which the tolerance alone counts

  /// "newton", "gradient" or "nearest".
  [[nodiscard]] const char* method() const { return nearest ? "nearest" : name_of(inverse.method); }
};

/// Follows a path: inverse kinematics waypoint by waypoint, each from the solution before.
class PathFollower {
 public:
  /// statics and path must outlive it. throws InvalidInput on a path without markers or waypoints, a waypoint
  /// with other numbers of targets than markers, and as solve_inverse does; nearest: as NearestSamples and
  /// sample_actuations do
  PathFollower(const Statics& statics, const MarkerPath& path, const TrajectoryOptions& options);

  [[nodiscard]] std::size_t next() const { return next_; }  // waypoint
  /// Were all waypoints solved?
  [[nodiscard]] bool done() const { return next_ == path_.waypoints.size(); }

  /// Continues with a waypoint as if the ones before it had just been done. at: the equilibrium of the one before.
  void resume(std::size_t waypoint, State at);
  /// Records a waypoint that was solved before, in their order: the state of a viscous material depends on all of them.
  /// at: its actuation and positions
  void recall(const Waypoint& waypoint, State at) { clock_.recall(waypoint.time, std::move(at)); }

  /// Returns the energy that a viscous material dissipated on the path to the last waypoint [mJ]; none where the path
  /// has no times.
  [[nodiscard]] const std::optional<double>& lost_mJ() const { return lost_mJ_; }

  /// Solves the next waypoint; equilibria counts those of the prediction too. Where it is interrupted the next waypoint
  /// stays the same. A waypoint that cannot be reached ends at the nearest point that the ranges allow.
  ///
  /// Nearest: the equilibrium at the commands of the nearest sample, from the waypoint before; the first waypoint's
  /// equilibria and seconds have those of the samples, where these were not known.
  ///
  /// source  Fang et al. 2020, Alg. 3; prediction: Taylor series of the markers along the path to second order;
  ///         nearest: what Section V-B compares with
  [[nodiscard]] InverseResult advance(const ProgressCallback& progress = {});

 private:
  [[nodiscard]] Eigen::VectorXd fractions_of(const Actuation& actuation) const;
  [[nodiscard]] Actuation actuation_of(const Eigen::VectorXd& fractions) const;
  [[nodiscard]] ProgressCallback reported(const ProgressCallback& progress) const;
  [[nodiscard]] bool first(InverseResult& spent, const ProgressCallback& progress);
  [[nodiscard]] std::optional<Actuation> predicted(const std::vector<Goal>& goals) const;
  void learn(const std::vector<Goal>& goals, const InverseResult& found);
  [[nodiscard]] bool sample(InverseResult& spent, const ProgressCallback& progress);
  [[nodiscard]] InverseResult advance_nearest(const ProgressCallback& progress);

  const Model& model_;
  const Statics& statics_;
  const MarkerPath& path_;
  TrajectoryOptions options_;
  std::optional<NearestSamples> samples_;
  std::size_t next_ = 0;
  ViscousClock clock_;
  std::optional<double> lost_mJ_{};
  State state_;                    // from which the next waypoint is searched
  Sensitivity sensitivity_;        // there; not regular: not known
  Eigen::MatrixXd slopes_;         // there, of the goals' terms by fractions of the ranges [mm]; empty: not known
  Eigen::MatrixXd slopes_before_;  // at the waypoint before that
  Eigen::VectorXd move_;           // from there [fractions]
};

/// Follows the whole path; returns the waypoints done before progress stopped it. Throws as PathFollower does.
[[nodiscard]] std::vector<InverseResult> follow_path(const Statics& statics, const MarkerPath& path,
                                                     const TrajectoryOptions& options = {},
                                                     const ProgressCallback& progress = {});

}  // namespace softkin
