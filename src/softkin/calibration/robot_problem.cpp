#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <softkin/calibration/robot_changes.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/together.hpp>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/model/backlash.hpp>
#include <thread>

namespace softkin::calibration {

namespace {

/// Of the distances of readings whose deviation is not known: median over deviation, of one, two and three coordinates.
constexpr double medians[3] = {0.6745, 1.1774, 1.5382};
/// Distances over the deviation from which a reading counts less: 95 % efficiency where all errors are normal.
/// source  Huber 1981; Rey 1983
constexpr double huber_at = 1.345, cauchy_at = 2.385;

}  // namespace

RobotProblem::RobotProblem(const NumberedRobot& robot, const MeasuredPoses& poses, const RobotFitOptions& options,
                           const FitCallback& progress)
    : robot_(robot),
      options_(options),
      progress_(progress),
      first_model_(std::make_shared<const Model>(robot.model(robot.start()))),
      dots_(poses, *first_model_, options.match_within_mm),
      outlines_(poses, *first_model_, options.outlines),
      poses_(dots_.poses()) {
  for (Index c = 0; c < std::ssize(poses_.columns); ++c) {
    const PoseColumn& column = poses_.columns[c];
    const auto same = std::find_if(groups_.begin(), groups_.end(), [&](const Group& group) {
      return column.marker >= 0 && group.marker == column.marker;
    });
    if (same == groups_.end())
      groups_.push_back({{c}, column.marker, column.kind});
    else
      same->columns.push_back(c);
  }
  if (first_model_->formulation != Formulation::physical)
    throw InvalidInput({.file = first_model_->name},
                       "a robot is fitted in the physical formulation; this scene is of target shapes");
  first_statics_ = std::make_shared<const Statics>(*first_model_);
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose)
    if (fits(pose)) dots_seen_ += dots_.seen(pose);
  count();
}

void RobotProblem::count() {
  readings_ = reading_rows_ = outline_rows_ = 0;
  each_reading([&](Index pose, const Group& group, Index) {
    ++readings_;
    for (const Index c : group.columns) reading_rows_ += read(pose, c);
  });
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose)
    if (fits(pose)) outline_rows_ += outlines_.points(pose);
  rows_ = reading_rows_ + outline_rows_;
  for (const FittedNumber& number : robot_.numbers()) rows_ += number.deviation.has_value();
}

bool RobotProblem::match(const RobotPoint& point, bool strict) {
  strict_ = strict_ || strict;
  std::vector<bool> counts(poses_.commands.size());
  for (std::size_t pose = 0; pose < counts.size(); ++pose) counts[pose] = fits(pose);
  const bool dots = dots_.match(point.computed, strict_ ? nullptr : &counts),
             outlines = outlines_.match(point.outline_misses, strict_ ? nullptr : &counts);
  count();
  return dots || outlines;
}

bool RobotProblem::reads_forces() const {
  return std::any_of(poses_.columns.begin(), poses_.columns.end(),
                     [](const PoseColumn& column) { return column.support >= 0; });
}

bool RobotProblem::read(Index pose, Index column) const {
  return !std::isnan(poses_.values(pose, column));
}

Eigen::VectorXd RobotProblem::miss(const RobotPoint& point, Index pose, const Group& group) const {
  std::vector<double> all;
  for (const Index c : group.columns)
    if (read(pose, c)) all.push_back(point.computed(pose, c) - poses_.values(pose, c));
  return Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
}

template <class Visit>
void RobotProblem::each_reading(const Visit& visit) const {
  Index row = 0;
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose) {
    if (!fits(pose)) continue;
    for (const Group& group : groups_) {
      const auto count =
          std::count_if(group.columns.begin(), group.columns.end(), [&](Index column) { return read(pose, column); });
      if (count == 0) continue;
      visit(pose, group, row);
      row += count;
    }
  }
}

/// That of a coordinate: as given, or by the median of distances, which a few wrong readings do not move.
double RobotProblem::scale(const RobotPoint& point, Reading kind) const {
  const double given = options_.deviations[static_cast<std::size_t>(kind)];
  std::vector<double> distances;
  double squares = 0;
  std::size_t count = 0;
  each_reading([&](Index pose, const Group& group, Index) {
    if (group.kind != kind) return;
    const Eigen::VectorXd off = miss(point, pose, group);
    if (!off.allFinite()) return;
    squares += off.squaredNorm();
    count += off.size();
    distances.push_back(off.norm() / medians[std::min<Eigen::Index>(off.size(), 3) - 1]);
  });
  if (count == 0) return 0;
  return given > 0 ? given : scale_of(std::move(distances), squares, count);
}

/// By distances over what their medians are, their squares and how many coordinates they have together.
double RobotProblem::scale_of(std::vector<double> distances, double squares, std::size_t count) const {
  constexpr double least = 1e-9;  // of what is fitted without any miss
  if (options_.loss == Loss::squares) {
    std::size_t reported = 0;  // freedoms that the numbers take
    for (const FittedNumber& number : robot_.numbers()) reported += !number.deviation;
    const double freedoms = std::max(1.0, static_cast<double>(count) - static_cast<double>(reported));
    return std::max(least, std::sqrt(squares / freedoms));
  }
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  return std::max(least, distances[distances.size() / 2]);
}

Scales RobotProblem::scales(const RobotPoint& point) const {
  Scales scales{};
  for (int kind = 0; kind < softkin::readings; ++kind) scales[kind] = scale(point, static_cast<Reading>(kind));
  return scales;
}

double RobotProblem::fraction_by_loss(double distance) const {
  if (options_.loss == Loss::huber && distance > huber_at) return huber_at / distance;
  return options_.loss == Loss::cauchy ? 1 / (1 + distance * distance / (cauchy_at * cauchy_at)) : 1;
}

Eigen::VectorXd RobotProblem::residuals(const RobotPoint& point, const Eigen::VectorXd& weights) const {
  Eigen::VectorXd all(rows_);
  each_reading([&](Index pose, const Group& group, Index row) {
    const Eigen::VectorXd off = miss(point, pose, group);
    all.segment(row, off.size()) = off;
  });
  each_outline_point([&](Index pose, std::size_t k, Index row) { all[row] = off_outline(point, pose, k); });
  Index rows = reading_rows_ + outline_rows_;
  for (std::size_t i = 0; i < robot_.numbers().size(); ++i)
    if (robot_.numbers()[i].deviation) all[rows++] = point.values[i] - *robot_.numbers()[i].start;
  for (Index i = 0; i < std::ssize(all); ++i)
    if (!std::isfinite(all[i])) all[i] = 0;  // of a pose without equilibrium, which is counted separately
  return weights.cwiseSqrt().cwiseProduct(all);
}

Linearised RobotProblem::linearised(const RobotPoint& point) const {
  Linearised linear;
  const Index count = robot_.numbers().size();
  linear.weights.setZero(rows_);
  linear.slopes.setZero(rows_, count);
  const Scales of = scales(point);
  each_reading([&](Index pose, const Group& group, Index row) {
    const Eigen::VectorXd off = miss(point, pose, group);
    const double scale = of[static_cast<std::size_t>(group.kind)];
    const double weight = fraction_by_loss(off.norm() / scale) / (scale * scale);
    const bool known = off.allFinite();
    Index r = row;
    for (const Index c : group.columns) {
      if (!read(pose, c)) continue;
      linear.weights[r] = known ? weight : 0;
      if (known) linear.slopes.row(r) = point.slopes[pose].row(c);
      ++r;
    }
  });
  linearise_outlines(point, linear);
  Index rows = reading_rows_ + outline_rows_;
  for (std::size_t i = 0; i < robot_.numbers().size(); ++i)
    if (robot_.numbers()[i].deviation) {
      linear.weights[rows] = 1 / (*robot_.numbers()[i].deviation * *robot_.numbers()[i].deviation);
      linear.slopes(rows++, i) = 1;
    }
  linear.slopes = linear.weights.cwiseSqrt().asDiagonal() * linear.slopes;
  linear.residuals = residuals(point, linear.weights);
  return linear;
}

double RobotProblem::cost(const RobotPoint& point, const Eigen::VectorXd& weights) const {
  return residuals(point, weights).squaredNorm();
}

Misfit RobotProblem::marker_misfit(const RobotPoint& point, bool kept) const {
  Misfit misfit;
  double squares = 0;
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose) {
    if (fits(pose) == kept) continue;
    for (const Group& group : groups_) {
      const Eigen::VectorXd off = miss(point, pose, group);
      if (group.marker < 0 || off.size() == 0 || !off.allFinite()) continue;
      squares += off.squaredNorm();
      misfit.largest = std::max(misfit.largest, off.norm());
      ++misfit.readings;
    }
  }
  misfit.rms = misfit.readings > 0 ? std::sqrt(squares / static_cast<double>(misfit.readings)) : 0;
  return misfit;
}

template <class Visit>
void RobotProblem::each_outline_point(const Visit& visit) const {
  Index row = reading_rows_;
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose)
    for (std::size_t k = 0; fits(pose) && k < outlines_.points(pose); ++k) visit(pose, k, row++);
}

std::size_t RobotProblem::outline_points_that_count() const {
  std::size_t count = 0;
  each_outline_point([&](Index pose, std::size_t k, Index) { count += outlines_.counts(pose, k); });
  return count;
}

/// NaN: the pose has no equilibrium.
double RobotProblem::off_outline(const RobotPoint& point, Index pose, std::size_t k) const {
  const std::vector<OutlineMiss>& misses = point.outline_misses[pose];
  return misses.empty() ? std::nan("") : misses[k].off_mm;
}

/// As that of a coordinate, but of outlines alone where it is by what is left.
double RobotProblem::outline_scale(const RobotPoint& point) const {
  const double given = options_.deviations[static_cast<std::size_t>(Reading::coordinate)];
  std::vector<double> distances;
  double squares = 0;
  each_outline_point([&](Index pose, std::size_t k, Index) {
    const double off = off_outline(point, pose, k);
    if (!outlines_.counts(pose, k) || !std::isfinite(off)) return;
    squares += off * off;
    distances.push_back(std::abs(off) / medians[0]);
  });
  if (distances.empty()) return 0;
  const std::size_t count = distances.size();
  return given > 0 ? given : scale_of(std::move(distances), squares, count);
}

void RobotProblem::linearise_outlines(const RobotPoint& point, Linearised& linear) const {
  const double scale = outline_scale(point);
  each_outline_point([&](Index pose, std::size_t k, Index row) {
    const double off = off_outline(point, pose, k);
    if (!outlines_.counts(pose, k) || !std::isfinite(off)) return;
    linear.weights[row] = fraction_by_loss(std::abs(off) / scale) / (scale * scale);
    linear.slopes.row(row) = point.outline_slopes[pose].row(k);
  });
}

OutlineFit RobotProblem::outline_fit(const RobotPoint& point) const {
  OutlineFit fit;
  if (!outlines_.any()) return fit;
  fit.within_mm = outlines_.requested_mm();
  fit.scale_mm = outline_scale(point);
  double squares[2] = {0, 0};
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose) {
    const std::size_t p = pose;
    fit.poses.push_back(outlines_.readings(pose, point.outline_misses[p]));
    const bool drawn = !point.outline_misses[p].empty();
    fit.lines.push_back(drawn ? outlines_.lines(point.equilibria[p].state.positions, point.frame) : OutlineLines());
    Misfit& misfit = fits(pose) ? fit.fitted_mm : fit.kept_mm;
    for (const OutlineReading& reading : fit.poses.back()) {
      if (!reading.counts) continue;
      squares[!fits(pose)] += reading.off_mm * reading.off_mm;
      misfit.largest = std::max(misfit.largest, std::abs(reading.off_mm));
      ++misfit.readings;
    }
  }
  const auto rms = [](double sum, std::size_t count) { return count > 0 ? std::sqrt(sum / double(count)) : 0; };
  fit.fitted_mm.rms = rms(squares[0], fit.fitted_mm.readings);
  fit.kept_mm.rms = rms(squares[1], fit.kept_mm.readings);
  return fit;
}

/// Poses side by side, or one after another. False: the user stopped it.
bool RobotProblem::each_pose(int max_threads, const std::function<bool(Index, const ProgressCallback&)>& act) {
  const auto count = static_cast<int>(poses_.commands.size());
  const int requested = options_.threads > 0 ? options_.threads : static_cast<int>(std::thread::hardware_concurrency());
  std::atomic<int> next = 0, done = 0;
  std::atomic<bool> stopped = false;
  std::mutex mutex;
  const ProgressCallback go_on = [&](const Progress&) {
    const std::lock_guard lock(mutex);
    if (stopped || !progress_) return !stopped;
    progress_state_.poses = count;
    progress_state_.poses_done = done;
    stopped = !progress_(progress_state_);
    return !stopped;
  };
  work_together(std::clamp(requested, 1, std::min(count, max_threads)), stopped, [&] {
    const int pose = next++;
    if (pose >= count) return false;
    if (!act(pose, go_on)) stopped = true;
    ++done;
    return go_on({});
  });
  return !stopped;
}

/// Of the commands: one after another where the poses are, else each from rest.
std::vector<Actuation> RobotProblem::acting(const Model& model) const {
  if (options_.ordered) return acting_in_order(model, model.rest_actuation(), poses_.commands);
  std::vector<Actuation> all;
  for (const Actuation& reported : poses_.commands)
    all.push_back(softkin::acting(model, model.rest_actuation(), reported));
  return all;
}

/// By each number that changes.
void RobotProblem::find_acting(Changes& changes) const {
  for (const Perturbed& number : changes.perturbed) {
    std::vector<Actuation>& slopes = changes.acting.emplace_back(acting(number.more));
    const std::vector<Actuation> less = acting(number.less);
    for (std::size_t pose = 0; pose < less.size(); ++pose)
      slopes[pose] = (slopes[pose] - less[pose]) / number.difference;
  }
}

std::optional<RobotPoint> RobotProblem::solve(const Eigen::VectorXd& values, const RobotPoint* near, bool slopes) {
  RobotPoint point;
  point.values = values;
  point.frame = robot_.frame(values);
  std::optional<Changes> changes;
  try {
    point.model = std::make_shared<const Model>(robot_.model(values));
    point.statics = std::make_shared<const Statics>(*point.model, *first_statics_);
    point.acting = acting(*point.model);
    if (slopes) find_acting(changes.emplace(robot_, point));
  } catch (const InvalidInput& error) {
    if (!near) throw;
    point.refusal = error.what();
    return point;
  }
  const auto count = poses_.commands.size();
  point.equilibria.resize(count);
  point.slopes.resize(slopes ? count : 0);
  point.outline_misses.resize(count);
  point.outline_slopes.resize(slopes ? count : 0);
  point.computed.resize(count, poses_.columns.size());
  StaticsOptions solver = one_of_many(options_.solver);
  // with friction, equilibria depend on the path
  const bool way_counts = has_friction(*point.model), chained = way_counts && options_.ordered;
  if (chained) solver.threads = options_.threads;
  const bool whole =
      each_pose(chained ? 1 : static_cast<int>(count), [&](Index pose, const ProgressCallback& progress) {
        const std::size_t p = pose;
        const Equilibrium* from = chained               ? (p > 0 ? &point.equilibria[p - 1] : nullptr)
                                  : way_counts || !near ? nullptr
                                                        : &near->equilibria[p];
        const bool begun = from && from->report.status == Status::converged;
        State start = begun ? from->state : point.statics->rest();
        if (!chained) start.eyelets.clear(), start.anchors.clear();
        point.equilibria[p] = point.statics->solve(point.acting[p], start, solver, progress);
        if (begun && point.equilibria[p].report.status != Status::converged && !point.equilibria[p].report.stopped)
          point.equilibria[p] = point.statics->solve(point.acting[p], point.statics->rest(), solver, progress);
        if (point.equilibria[p].report.stopped) return false;
        compute(point, changes ? &*changes : nullptr, pose);
        return true;
      });
  if (!whole) return std::nullopt;
  for (const Equilibrium& found : point.equilibria)
    point.without_equilibrium += found.report.status != Status::converged;
  return point;
}

}  // namespace softkin::calibration
