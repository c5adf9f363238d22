#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <softkin/calibration/robot_problem.hpp>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/estimate/readings.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/model/backlash.hpp>
#include <softkin/model/sensor.hpp>
#include <softkin/statics/deformation.hpp>
#include <thread>

namespace softkin::calibration {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
/// By which numbers are perturbed, of what they are of the order of.
constexpr double perturbation = 1e-5;
constexpr double slopes_accuracy = 1e-8;
/// Of the distances of readings whose deviation is not known: median over deviation, of one, two and three coordinates.
constexpr double medians[3] = {0.6745, 1.1774, 1.5382};
/// Distances over the deviation from which a reading counts less: 95 % efficiency where all errors are normal.
/// source  Huber 1981; Rey 1983
constexpr double huber_at = 1.345, cauchy_at = 2.385;

/// Is it a component of a sensor's direction?
bool points_along(const PoseColumn& column) {
  return column.kind == Reading::direction;
}

/// The direction, in the frame of the scene.
Vec3 direction_of(const Model& model, const PoseColumn& column, const Points& positions) {
  const Sensor& sensor = *model.sensors[static_cast<std::size_t>(column.sensor)];
  return {sensor.at(positions, 0), sensor.at(positions, 1), sensor.at(positions, 2)};
}

/// By a number of the robots, and by its moves.
Vec3 direction_slope(const Perturbed& number, const Model& model, const PoseColumn& column, const Points& positions,
                     const Points& moves) {
  const Sensor& sensor = *model.sensors[static_cast<std::size_t>(column.sensor)];
  const Vec3 own =
      (direction_of(number.more, column, positions) - direction_of(number.less, column, positions)) / number.difference;
  return own + Vec3(sensor.velocity(positions, moves, 0), sensor.velocity(positions, moves, 1),
                    sensor.velocity(positions, moves, 2));
}

/// Is it a length, a volume or an angle, which turns with no frame?
bool measures(const PoseColumn& column) {
  return column.marker < 0 && !points_along(column) && estimate::is_of_shape(column);
}

/// On the robot, of a support.
Vec3 force_of(const Model& model, const PoseColumn& column, const Points& positions, const Points& at_vertices) {
  ElementDeformation deformation;
  deformation.reactions = at_vertices;
  return reactions(model, positions, deformation)[static_cast<std::size_t>(column.support)].force;
}

/// Is it a component of a vector, which turns with the frame: of a marker's place, a direction, a support's force?
bool turns(const PoseColumn& column) {
  return column.marker >= 0 || column.support >= 0 || points_along(column);
}

/// That vector, in the frame of the scene.
Vec3 vector_of(const Model& model, const PoseColumn& column, const Points& positions, const Points& at_vertices) {
  if (column.marker >= 0) return model.markers[static_cast<std::size_t>(column.marker)].at(positions);
  return points_along(column) ? direction_of(model, column, positions)
                              : force_of(model, column, positions, at_vertices);
}

double measure_of(const Model& model, const PoseColumn& column, const State& state) {
  return estimate::reading_at(model, column, state, {});
}

}  // namespace

/// Robots with a number a little larger and smaller, and the frame's changes.
struct RobotProblem::Changes {
  std::vector<Model> models;  // those of a number side by side
  std::vector<Perturbed> perturbed;
  std::vector<Index> numbers;                  // of which they are
  std::vector<std::vector<Actuation>> acting;  // per such number, per pose: the derivative of what acts
  std::unique_ptr<Perturbations> perturbations;
  std::vector<double> differences;  // per number of the robot
  std::vector<MeasuringFrame> more, less;

  Changes(const NumberedRobot& robot, const RobotPoint& point) {
    const auto count = static_cast<Index>(robot.numbers().size());
    models.reserve(2 * robot.numbers().size());
    for (Index i = 0; i < count; ++i) {
      const double half = perturbation * robot.size(static_cast<std::size_t>(i));
      Eigen::VectorXd above = point.values, below = point.values;
      const FittedNumber& number = robot.numbers()[static_cast<std::size_t>(i)];
      above[i] = std::min(number.high, above[i] + half);
      below[i] = std::max(number.low, below[i] - half);
      differences.push_back(above[i] - below[i]);
      more.push_back(robot.frame(above));
      less.push_back(robot.frame(below));
      if (robot.of_camera(static_cast<std::size_t>(i))) continue;
      const Model& larger = models.emplace_back(robot.model(above));
      const Model& smaller = models.emplace_back(robot.model(below));
      perturbed.push_back({larger, smaller, differences.back()});
      numbers.push_back(i);
    }
    perturbations = std::make_unique<Perturbations>(*point.statics, perturbed);
  }
};

RobotProblem::RobotProblem(const NumberedRobot& robot, const MeasuredPoses& poses, const RobotFitOptions& options,
                           const FitCallback& progress)
    : robot_(robot),
      options_(options),
      progress_(progress),
      first_model_(std::make_shared<const Model>(robot.model(robot.start()))),
      dots_(poses, *first_model_, options.match_within_mm),
      poses_(dots_.poses()) {
  for (Index c = 0; c < static_cast<Index>(poses_.columns.size()); ++c) {
    const PoseColumn& column = poses_.columns[static_cast<std::size_t>(c)];
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
  for (Index pose = 0; pose < static_cast<Index>(poses_.commands.size()); ++pose)
    if (fits(pose)) dots_seen_ += dots_.seen(pose);
  count();
}

void RobotProblem::count() {
  readings_ = rows_ = 0;
  each_reading([&](Index pose, const Group& group, Index) {
    ++readings_;
    for (const Index c : group.columns) rows_ += read(pose, c);
  });
  for (const FittedNumber& number : robot_.numbers()) rows_ += number.deviation.has_value();
}

bool RobotProblem::match(const RobotPoint& point, bool strict) {
  strict_ = strict_ || strict;
  std::vector<bool> counts(poses_.commands.size());
  for (std::size_t pose = 0; pose < counts.size(); ++pose) counts[pose] = fits(static_cast<Index>(pose));
  const bool changed = dots_.match(point.computed, strict_ ? nullptr : &counts);
  count();
  return changed;
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
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Index>(all.size()));
}

template <class Visit>
void RobotProblem::each_reading(const Visit& visit) const {
  Index row = 0;
  for (Index pose = 0; pose < static_cast<Index>(poses_.commands.size()); ++pose) {
    if (!fits(pose)) continue;
    for (const Group& group : groups_) {
      const auto count =
          std::count_if(group.columns.begin(), group.columns.end(), [&](Index column) { return read(pose, column); });
      if (count == 0) continue;
      visit(pose, group, row);
      row += static_cast<Index>(count);
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
    count += static_cast<std::size_t>(off.size());
    distances.push_back(off.norm() / medians[std::min<Eigen::Index>(off.size(), 3) - 1]);
  });
  if (count == 0) return 0;
  if (given > 0) return given;
  constexpr double least = 1e-9;  // of what is fitted without any miss
  if (options_.loss == Loss::squares) {
    std::size_t told = 0;  // freedoms that the numbers take
    for (const FittedNumber& number : robot_.numbers()) told += !number.deviation;
    const double freedoms = std::max(1.0, static_cast<double>(count) - static_cast<double>(told));
    return std::max(least, std::sqrt(squares / freedoms));
  }
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  return std::max(least, distances[distances.size() / 2]);
}

Scales RobotProblem::scales(const RobotPoint& point) const {
  Scales scales{};
  for (int kind = 0; kind < softkin::readings; ++kind)
    scales[static_cast<std::size_t>(kind)] = scale(point, static_cast<Reading>(kind));
  return scales;
}

Eigen::VectorXd RobotProblem::residuals(const RobotPoint& point, const Eigen::VectorXd& weights) const {
  Eigen::VectorXd all(static_cast<Index>(rows_));
  Index rows = 0;
  each_reading([&](Index pose, const Group& group, Index row) {
    const Eigen::VectorXd off = miss(point, pose, group);
    all.segment(row, off.size()) = off;
    rows = row + static_cast<Index>(off.size());
  });
  for (std::size_t i = 0; i < robot_.numbers().size(); ++i)
    if (robot_.numbers()[i].deviation) all[rows++] = point.values[static_cast<Index>(i)] - *robot_.numbers()[i].start;
  for (Index i = 0; i < static_cast<Index>(all.size()); ++i)
    if (!std::isfinite(all[i])) all[i] = 0;  // of a pose without equilibrium, which is told apart
  return weights.cwiseSqrt().cwiseProduct(all);
}

Linearised RobotProblem::linearised(const RobotPoint& point) const {
  Linearised linear;
  const auto count = static_cast<Index>(robot_.numbers().size());
  linear.weights.setZero(static_cast<Index>(rows_));
  linear.slopes.setZero(static_cast<Index>(rows_), count);
  const Scales of = scales(point);
  Index rows = 0;
  each_reading([&](Index pose, const Group& group, Index row) {
    const Eigen::VectorXd off = miss(point, pose, group);
    const double scale = of[static_cast<std::size_t>(group.kind)];
    const double distance = off.norm() / scale;
    double weight = 1 / (scale * scale);
    if (options_.loss == Loss::huber && distance > huber_at) weight *= huber_at / distance;
    if (options_.loss == Loss::cauchy) weight /= 1 + distance * distance / (cauchy_at * cauchy_at);
    const bool known = off.allFinite();
    Index r = row;
    for (const Index c : group.columns) {
      if (!read(pose, c)) continue;
      linear.weights[r] = known ? weight : 0;
      if (known) linear.slopes.row(r) = point.slopes[static_cast<std::size_t>(pose)].row(c);
      ++r;
    }
    rows = r;
  });
  for (std::size_t i = 0; i < robot_.numbers().size(); ++i)
    if (robot_.numbers()[i].deviation) {
      linear.weights[rows] = 1 / (*robot_.numbers()[i].deviation * *robot_.numbers()[i].deviation);
      linear.slopes(rows++, static_cast<Index>(i)) = 1;
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
  for (Index pose = 0; pose < static_cast<Index>(poses_.commands.size()); ++pose) {
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

/// Poses side by side, or one after another. False: the user stopped it.
bool RobotProblem::each_pose(int most_threads, const std::function<bool(Index, const ProgressCallback&)>& act) {
  const auto count = static_cast<int>(poses_.commands.size());
  const int asked = options_.threads > 0 ? options_.threads : static_cast<int>(std::thread::hardware_concurrency());
  std::atomic<int> next = 0, done = 0;
  std::atomic<bool> stopped = false;
  std::mutex mutex;
  std::exception_ptr error;
  const ProgressCallback go_on = [&](const Progress&) {
    const std::lock_guard lock(mutex);
    if (stopped || !progress_) return !stopped;
    progress_state_.poses = count;
    progress_state_.poses_done = done;
    stopped = !progress_(progress_state_);
    return !stopped;
  };
  const auto work = [&] {
    for (int pose = next++; pose < count && !stopped; pose = next++) {
      try {
        if (!act(pose, go_on)) stopped = true;
      } catch (...) {
        const std::lock_guard lock(mutex);
        error = std::current_exception();
        stopped = true;
      }
      ++done;
      (void)go_on({});
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < std::clamp(asked, 1, std::min(count, most_threads)); ++t) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
  return !stopped;
}

/// What was read, as the robot does it.
void RobotProblem::compute(RobotPoint& point, const Changes* changes, Index pose) const {
  const Equilibrium& found = point.equilibria[static_cast<std::size_t>(pose)];
  ElementDeformation reactions;
  if (reads_forces() && found.report.status == Status::converged) reactions = point.statics->measured(found.state);
  for (Index c = 0; c < static_cast<Index>(poses_.columns.size()); ++c) {
    const PoseColumn& column = poses_.columns[static_cast<std::size_t>(c)];
    double& value = point.computed(pose, c);
    if (found.report.status != Status::converged)
      value = nan;
    else if (turns(column))
      value = (point.frame.rotation * vector_of(*point.model, column, found.state.positions, reactions.reactions) +
               (column.marker >= 0 ? point.frame.place : Vec3(0, 0, 0)))[column.axis];
    else if (measures(column))
      value = measure_of(*point.model, column, found.state);
    else
      value = found.state.multipliers[column.actuator];
  }
  if (changes && found.report.status == Status::converged) add_slopes(point, *changes, pose, reactions.reactions);
}

/// Of the commands: one after another where the poses are, else each from rest.
std::vector<Actuation> RobotProblem::acting(const Model& model) const {
  if (options_.ordered) return acting_in_order(model, model.rest_actuation(), poses_.commands);
  std::vector<Actuation> all;
  for (const Actuation& told : poses_.commands) all.push_back(softkin::acting(model, model.rest_actuation(), told));
  return all;
}

/// Numbers change what acts of commands, too, where there is backlash.
void RobotProblem::add_changes_of_acting(ParameterSensitivity& found, const RobotPoint& point, const Changes& changes,
                                         Index pose) const {
  const auto p = static_cast<std::size_t>(pose);
  std::vector<Actuation> along;
  std::vector<std::size_t> of;
  for (std::size_t k = 0; k < changes.acting.size(); ++k) {
    if (changes.acting[k][p].isZero(0)) continue;
    along.push_back(changes.acting[k][p]);
    of.push_back(k);
  }
  if (along.empty()) return;
  StaticsOptions solver = options_.solver;
  solver.threads = 1;
  const ParameterSensitivity more =
      point.statics->sensitivity_along(point.equilibria[p].state, along, solver, slopes_accuracy, reads_forces());
  for (std::size_t i = 0; i < of.size(); ++i) {
    found.positions[of[i]] += more.positions[i];
    found.multipliers.col(static_cast<Index>(of[i])) += more.multipliers.col(static_cast<Index>(i));
    if (reads_forces()) found.reactions[of[i]] += more.reactions[i];
  }
  found.regular = more.regular;
}

void RobotProblem::add_slopes(RobotPoint& point, const Changes& changes, Index pose, const Points& reactions) const {
  const State& state = point.equilibria[static_cast<std::size_t>(pose)].state;
  StaticsOptions solver = options_.solver;
  solver.threads = 1;
  ParameterSensitivity found = changes.perturbations->at(state, solver, slopes_accuracy, reads_forces());
  if (found.regular) add_changes_of_acting(found, point, changes, pose);
  const auto count = static_cast<Index>(robot_.numbers().size());
  Eigen::MatrixXd& slopes = point.slopes[static_cast<std::size_t>(pose)];
  slopes.setZero(static_cast<Index>(poses_.columns.size()), count);
  for (Index c = 0; c < static_cast<Index>(slopes.rows()); ++c) {
    const PoseColumn& column = poses_.columns[static_cast<std::size_t>(c)];
    if (!turns(column)) continue;
    const bool marker = column.marker >= 0;
    const Vec3 place = vector_of(*point.model, column, state.positions, reactions);
    for (Index i = 0; i < count; ++i) {
      const MeasuringFrame &more = changes.more[static_cast<std::size_t>(i)],
                           &less = changes.less[static_cast<std::size_t>(i)];
      const Vec3 shift = marker ? Vec3(more.place - less.place) : Vec3(Vec3::Zero());
      slopes(c, i) = ((more.rotation - less.rotation) * place + shift)[column.axis] /
                     changes.differences[static_cast<std::size_t>(i)];
    }
  }
  if (!found.regular) return;
  for (std::size_t k = 0; k < changes.numbers.size(); ++k) {
    const Index i = changes.numbers[k];
    const auto p = static_cast<Index>(k);
    for (Index c = 0; c < static_cast<Index>(slopes.rows()); ++c) {
      const PoseColumn& column = poses_.columns[static_cast<std::size_t>(c)];
      if (measures(column)) {
        const Perturbed& number = changes.perturbed[k];
        const double own =
            (measure_of(number.more, column, state) - measure_of(number.less, column, state)) / number.difference;
        const Eigen::VectorXd none;
        slopes(c, i) += own + estimate::reading_change(*point.model, column, state, {found.positions[k], none, {}});
        continue;
      }
      if (!turns(column)) {
        slopes(c, i) += found.multipliers(column.actuator, p);
        continue;
      }
      const Vec3 moved = points_along(column) ? direction_slope(changes.perturbed[k], *point.model, column,
                                                                state.positions, found.positions[k])
                         : column.support >= 0
                             ? force_of(*point.model, column, state.positions, found.reactions[k])
                             : marker_slope(*point.model, changes.perturbed[k], static_cast<std::size_t>(column.marker),
                                            state.positions, found.positions[k]);
      slopes(c, i) += (point.frame.rotation * moved)[column.axis];
    }
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
    if (slopes) changes.emplace(robot_, point);
    for (std::size_t k = 0; changes && k < changes->perturbed.size(); ++k) {
      const Perturbed& number = changes->perturbed[k];
      changes->acting.push_back(acting(number.more));
      const std::vector<Actuation> less = acting(number.less);
      for (std::size_t pose = 0; pose < less.size(); ++pose)
        changes->acting[k][pose] = (changes->acting[k][pose] - less[pose]) / number.difference;
    }
  } catch (const InvalidInput& error) {
    if (!near) throw;
    point.refusal = error.what();
    return point;
  }
  const auto count = poses_.commands.size();
  point.equilibria.resize(count);
  point.slopes.resize(slopes ? count : 0);
  point.computed.resize(static_cast<Index>(count), static_cast<Index>(poses_.columns.size()));
  StaticsOptions solver = options_.solver;
  solver.threads = 1;
  solver.keep_history = false;
  // what rubs is elsewhere on another way
  const bool way_counts = rubs(*point.model), chained = way_counts && options_.ordered;
  if (chained) solver.threads = options_.threads;
  const bool whole =
      each_pose(chained ? 1 : static_cast<int>(count), [&](Index pose, const ProgressCallback& progress) {
        const auto p = static_cast<std::size_t>(pose);
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
