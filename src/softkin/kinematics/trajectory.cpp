#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/inverse_response.hpp>
#include <softkin/kinematics/inverse_step.hpp>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/kinematics/workspace.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr double max_waypoints = 1e6;
constexpr double damping = 1e-5;       // of the largest slope: below it a direction has no effect
constexpr double trusted_move = 0.5;   // of a range, the largest move that a prediction may make
constexpr double largest_stretch = 2;  // of the last move, over which its curvature is trusted
constexpr double min_move = 1e-6;      // fractions, over which a change of slopes can be computed

Eigen::VectorXd widths(const Model& model) {
  Eigen::VectorXd widths(model.actuators.size());
  for (Index a = 0; a < widths.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    widths[a] = drives(actuator) ? actuator.high - actuator.low : 0;
  }
  return widths;
}

/// Returns the shortest move of the fractions, inside the ranges, that minimises the norm of terms + slopes * move.
Eigen::VectorXd move_to(const Eigen::VectorXd& terms, const Eigen::MatrixXd& slopes, const Eigen::VectorXd& fractions) {
  const Index m = fractions.size();
  const double size = slopes.colwise().norm().maxCoeff();
  if (!(size > 0)) return Eigen::VectorXd::Zero(m);
  Eigen::MatrixXd h = slopes.transpose() * slopes, rows(2 * m, m);
  h.diagonal().array() += std::pow(damping * size, 2);
  rows << Eigen::MatrixXd::Identity(m, m), -Eigen::MatrixXd::Identity(m, m);
  Eigen::VectorXd bounds(2 * m);
  bounds << -fractions, fractions.array() - 1;
  bounds = bounds.cwiseMin(0);  // rounding
  return inverse::solve_small_program(h, slopes.transpose() * terms, rows, bounds);
}

void check_path(const MarkerPath& path) {
  if (path.markers.empty() || path.axes.size() != path.markers.size())
    throw InvalidInput("the path has no markers, or not the axes of each");
  if (path.waypoints.empty()) throw InvalidInput("the path has no waypoints");
  for (std::size_t i = 0; i < path.waypoints.size(); ++i)
    if (path.waypoints[i].targets.size() != path.markers.size())
      throw InvalidInput("waypoint " + std::to_string(i) + " has " + std::to_string(path.waypoints[i].targets.size()) +
                         " targets, the path " + std::to_string(path.markers.size()) + " markers");
}

/// Returns the path length of the marker that moves farthest [mm].
double longest_path(const Waypoint& from, const Waypoint& to) {
  double longest = 0;
  for (std::size_t m = 0; m < from.targets.size(); ++m)
    longest = std::max(longest, (to.targets[m] - from.targets[m]).norm());
  return longest;
}

Waypoint between(const Waypoint& from, const Waypoint& to, double fraction) {
  Waypoint waypoint;
  waypoint.inserted = true;
  waypoint.line = to.line;
  for (std::size_t m = 0; m < from.targets.size(); ++m)
    waypoint.targets.emplace_back((1 - fraction) * from.targets[m] + fraction * to.targets[m]);
  if (from.time && to.time) waypoint.time = (1 - fraction) * *from.time + fraction * *to.time;
  return waypoint;
}

}  // namespace

MarkerPath densified(const MarkerPath& path, double max_step_mm) {
  if (!(max_step_mm > 0)) throw InvalidInput("the longest step must be > 0 mm");
  MarkerPath dense{path.markers, path.axes, {}};
  double count = 0;
  for (std::size_t i = 0; i < path.waypoints.size(); ++i) {
    if (i > 0) {
      const Waypoint &from = path.waypoints[i - 1], &to = path.waypoints[i];
      const double parts = std::max(1.0, std::ceil(longest_path(from, to) / max_step_mm * (1 - 1e-12)));
      count += parts;
      if (!(count < max_waypoints))
        throw InvalidInput("a step of " + std::to_string(max_step_mm) + " mm makes more than a million waypoints");
      for (double part = 1; part < parts; ++part) dense.waypoints.push_back(between(from, to, part / parts));
    }
    dense.waypoints.push_back(path.waypoints[i]);
  }
  return dense;
}

std::vector<Goal> goals_of(const MarkerPath& path, const Waypoint& waypoint) {
  std::vector<Goal> goals;
  for (std::size_t m = 0; m < path.markers.size(); ++m)
    goals.push_back({PositionGoal{path.markers[m], waypoint.targets[m], path.axes[m]}, 1});
  return goals;
}

PathFollower::PathFollower(const Statics& statics, const MarkerPath& path, const TrajectoryOptions& options)
    : model_(statics.model()),
      statics_(statics),
      path_(path),
      options_(options),
      clock_(statics),
      state_(statics.rest()) {
  check_path(path);
  for (const Waypoint& waypoint : path.waypoints) check_goals(model_, goals_of(path, waypoint));
  if (options_.start.size() > 0) check_actuation(model_, options_.start);
  if (!options_.nearest) return;
  if (auto* known = std::get_if<std::vector<WorkspaceSample>>(&*options_.nearest))
    samples_.emplace(model_, std::move(*known));
  else
    (void)plan_workspace(model_, {.samples = std::get<Index>(*options_.nearest)});  // throws where there is none
}

Eigen::VectorXd PathFollower::fractions_of(const Actuation& actuation) const {
  Eigen::VectorXd fractions = Eigen::VectorXd::Zero(actuation.size());
  for (Index a = 0; a < fractions.size(); ++a) {
    const Actuator& actuator = model_.actuators[a];
    if (varies(actuator)) fractions[a] = (actuation[a] - actuator.low) / (actuator.high - actuator.low);
  }
  return fractions;
}

Actuation PathFollower::actuation_of(const Eigen::VectorXd& fractions) const {
  Actuation actuation(fractions.size());
  for (Index a = 0; a < fractions.size(); ++a) {
    const Actuator& actuator = model_.actuators[a];
    if (!drives(actuator))
      actuation[a] = state_.actuation.size() > 0 ? state_.actuation[a] : actuator.rest;
    else
      actuation[a] =
          std::clamp(actuator.low + fractions[a] * (actuator.high - actuator.low), actuator.low, actuator.high);
  }
  return actuation;
}

void PathFollower::resume(std::size_t waypoint, State at) {
  next_ = waypoint;
  state_ = std::move(at);
  sensitivity_ = {};
  slopes_.resize(0, 0);
  slopes_before_.resize(0, 0);
}

/// Returns a callback that reports progress as solve_inverse does, before it has begun.
ProgressCallback PathFollower::reported(const ProgressCallback& progress) const {
  if (!progress) return {};
  const double error = goal_errors(model_, goals_of(path_, path_.waypoints.at(next_)), state_.positions).maxCoeff();
  return [&progress, error, tolerance = options_.inverse.tolerance_mm](const Progress&) {
    return progress({0, error, tolerance, -1});
  };
}

/// Solves for the equilibrium from which the first waypoint is searched; false where it was interrupted.
bool PathFollower::first(InverseResult& spent, const ProgressCallback& progress) {
  Equilibrium found = statics_.solve(options_.start, state_, options_.inverse.statics, reported(progress));
  ++spent.equilibria;
  spent.seconds += found.report.seconds;
  if (found.report.stopped) {
    spent.equilibrium = std::move(found);
    return false;
  }
  if (found.report.status == Status::converged) state_ = std::move(found.state);
  return true;
}

InverseResult PathFollower::advance(const ProgressCallback& progress) {
  if (options_.nearest) return advance_nearest(progress);
  const Waypoint& waypoint = path_.waypoints.at(next_);
  const std::vector<Goal> goals = goals_of(path_, waypoint);
  clock_.set(waypoint.time, options_.inverse.statics);
  InverseResult spent;
  spent.status = InverseStatus::interrupted;
  spent.stopped = true;
  const auto stopped = [&] {
    spent.errors_mm = goal_errors(model_, goals, spent.equilibrium.state.positions);
    spent.active.assign(model_.actuators.size(), 0);
    return spent;
  };
  if (next_ == 0 && options_.start.size() > 0 && !first(spent, progress)) return stopped();
  Equilibrium from{state_, {}, {}};
  bool moved = false;
  if (const std::optional<Actuation> guess = predicted(goals)) {
    Equilibrium there = statics_.solve(*guess, state_, options_.inverse.statics, reported(progress));
    ++spent.equilibria;
    spent.seconds += there.report.seconds;
    if (there.report.stopped) {
      spent.equilibrium = std::move(there);
      return stopped();
    }
    moved = there.report.status == Status::converged;
    if (moved) from = std::move(there);
  }
  InverseOptions inverse = options_.inverse;
  if (next_ > 0) inverse.other_starts = 0;
  const bool same_time = !clock_.counts(waypoint.time);
  inverse.start_sensitivity = sensitivity_.regular && !moved && same_time ? &sensitivity_ : nullptr;
  InverseResult found = solve_inverse(statics_, goals, from, inverse, progress);
  found.equilibria += spent.equilibria;
  found.seconds += spent.seconds;
  if (found.stopped) return found;
  learn(goals, found);
  lost_mJ_.reset();
  if (found.equilibrium.report.status == Status::converged) lost_mJ_ = clock_.pass(waypoint.time, state_);
  ++next_;
  return found;
}

/// Commands for the goals by the markers' Taylor series from the waypoint before: slopes, and along the last move their
/// change. Nothing where that change is not known, as solve_inverse itself begins with the slopes, and where that looks
/// ahead to second order.
std::optional<Actuation> PathFollower::predicted(const std::vector<Goal>& goals) const {
  const bool search_looks_ahead = options_.inverse.method == InverseMethod::newton && statics_.extrapolates();
  if (!options_.predict || search_looks_ahead || slopes_.size() == 0 || slopes_before_.size() == 0) return std::nullopt;
  const Eigen::VectorXd fractions = fractions_of(state_.actuation);
  const Eigen::VectorXd terms = inverse::goal_terms(model_, goals, state_.positions);
  const Eigen::VectorXd straight = move_to(terms, slopes_, fractions);
  const double stretch = straight.dot(move_) / move_.squaredNorm();
  if (!(std::abs(stretch) <= largest_stretch)) return std::nullopt;
  const Eigen::VectorXd bend = 0.5 * stretch * stretch * (slopes_ - slopes_before_) * move_;
  const Eigen::VectorXd move = move_to(terms + bend, slopes_, fractions);
  if (!move.allFinite() || move.cwiseAbs().maxCoeff() > trusted_move) return std::nullopt;
  return actuation_of(fractions + move);
}

void PathFollower::learn(const std::vector<Goal>& goals, const InverseResult& found) {
  const Eigen::VectorXd before = fractions_of(state_.actuation.size() > 0 ? state_.actuation : model_.rest_actuation());
  state_ = found.equilibrium.state;
  sensitivity_ = found.sensitivity;
  slopes_before_ = std::exchange(slopes_, {});
  if (!sensitivity_.regular) return;
  slopes_ = inverse::goal_slopes(model_, goals, state_.positions, sensitivity_) * widths(model_).asDiagonal();
  for (std::size_t a = 0; a < options_.inverse.free.size(); ++a)
    if (!options_.inverse.free[a]) slopes_.col(a).setZero();
  move_ = fractions_of(state_.actuation) - before;
  if (slopes_before_.size() > 0 && !(move_.norm() > min_move)) slopes_before_.resize(0, 0);
}

std::vector<InverseResult> follow_path(const Statics& statics, const MarkerPath& path, const TrajectoryOptions& options,
                                       const ProgressCallback& progress) {
  PathFollower follower(statics, path, options);
  std::vector<InverseResult> waypoints;
  while (!follower.done()) {
    InverseResult found = follower.advance(progress);
    if (found.stopped) break;
    waypoints.push_back(std::move(found));
  }
  return waypoints;
}

}  // namespace softkin
