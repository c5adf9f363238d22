#include <algorithm>
#include <cmath>
#include <softkin/calibration/robot_changes.hpp>
#include <softkin/kinematics/estimate/readings.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/model/sensor.hpp>
#include <softkin/statics/deformation.hpp>

namespace softkin::calibration {

namespace {

constexpr double slopes_accuracy = 1e-8;

/// Is it a component of a sensor's direction?
bool points_along(const PoseColumn& column) {
  return column.kind == Reading::direction;
}

/// The direction, in the frame of the scene.
Vec3 direction_of(const Model& model, const PoseColumn& column, const Points& positions) {
  const Sensor& sensor = *model.sensors[column.sensor];
  return {sensor.at(positions, 0), sensor.at(positions, 1), sensor.at(positions, 2)};
}

/// By a number of the robots, and by its moves.
Vec3 direction_slope(const Perturbed& number, const Model& model, const PoseColumn& column, const Points& positions,
                     const Points& moves) {
  const Sensor& sensor = *model.sensors[column.sensor];
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
  return reactions(model, positions, deformation)[column.support].force;
}

/// Is it a component of a vector, which turns with the frame: of a marker's place, a direction, a support's force?
bool turns(const PoseColumn& column) {
  return column.marker >= 0 || column.support >= 0 || points_along(column);
}

/// That vector, in the frame of the scene.
Vec3 vector_of(const Model& model, const PoseColumn& column, const Points& positions, const Points& at_vertices) {
  if (column.marker >= 0) return model.markers[column.marker].at(positions);
  return points_along(column) ? direction_of(model, column, positions)
                              : force_of(model, column, positions, at_vertices);
}

double measure_of(const Model& model, const PoseColumn& column, const State& state) {
  return estimate::reading_at(model, column, state, {});
}

}  // namespace

/// What was read, as the robot does it.
void RobotProblem::compute(RobotPoint& point, const Changes* changes, Index pose) const {
  const Equilibrium& found = point.equilibria[pose];
  ElementDeformation reactions;
  if (reads_forces() && found.report.status == Status::converged) reactions = point.statics->measured(found.state);
  for (Index c = 0; c < std::ssize(poses_.columns); ++c) {
    const PoseColumn& column = poses_.columns[c];
    double& value = point.computed(pose, c);
    if (found.report.status != Status::converged)
      value = std::nan("");
    else if (turns(column))
      value = (point.frame.rotation * vector_of(*point.model, column, found.state.positions, reactions.reactions) +
               (column.marker >= 0 ? point.frame.place : Vec3(0, 0, 0)))[column.axis];
    else if (measures(column))
      value = measure_of(*point.model, column, found.state);
    else
      value = found.state.multipliers[column.actuator];
  }
  if (found.report.status != Status::converged) return;
  point.outline_misses[pose] = outlines_.misses(pose, found.state.positions, point.frame);
  if (changes) add_slopes(point, *changes, pose, reactions.reactions);
}

/// With backlash, numbers also change the acting commands.
void RobotProblem::add_changes_of_acting(ParameterSensitivity& found, const RobotPoint& point, const Changes& changes,
                                         Index pose) const {
  const std::size_t p = pose;
  std::vector<Actuation> along;
  std::vector<std::size_t> of;
  for (std::size_t k = 0; k < changes.acting.size(); ++k) {
    if (changes.acting[k][p].isZero(0)) continue;
    along.push_back(changes.acting[k][p]);
    of.push_back(k);
  }
  if (along.empty()) return;
  const ParameterSensitivity more = point.statics->sensitivity_along(
      point.equilibria[p].state, along, one_of_many(options_.solver), slopes_accuracy, reads_forces());
  for (std::size_t i = 0; i < of.size(); ++i) {
    found.positions[of[i]] += more.positions[i];
    found.multipliers.col(of[i]) += more.multipliers.col(i);
    if (reads_forces()) found.reactions[of[i]] += more.reactions[i];
  }
  found.regular = more.regular;
}

/// By the measuring frame's part of each number; vectors turn with it, places are moved, too.
void RobotProblem::add_slopes_of_frame(RobotPoint& point, const Changes& changes, Index pose,
                                       const Points& reactions) const {
  const State& state = point.equilibria[pose].state;
  const Index count = robot_.numbers().size();
  Eigen::MatrixXd& slopes = point.slopes[pose];
  slopes.setZero(poses_.columns.size(), count);
  for (Index c = 0; c < slopes.rows(); ++c) {
    const PoseColumn& column = poses_.columns[c];
    if (!turns(column)) continue;
    const bool marker = column.marker >= 0;
    const Vec3 place = vector_of(*point.model, column, state.positions, reactions);
    for (Index i = 0; i < count; ++i) {
      const std::size_t k = i;
      const Vec3 shift = marker ? changes.shift(k) : Vec3(Vec3::Zero());
      slopes(c, i) = (changes.turn(k) * place + shift)[column.axis];
    }
  }
}

/// Of the distances of outlines, by the frame and, where the robot moves with numbers, by its moves.
void RobotProblem::add_outline_slopes(RobotPoint& point, const Changes& changes, Index pose,
                                      const ParameterSensitivity& found) const {
  const std::size_t p = pose;
  const std::vector<OutlineMiss>& misses = point.outline_misses[p];
  const Index count = robot_.numbers().size();
  point.outline_slopes[p].setZero(misses.size(), count);
  for (Index i = 0; i < count && !misses.empty(); ++i) {
    const auto own = std::find(changes.numbers.begin(), changes.numbers.end(), i);
    const bool moves = found.regular && own != changes.numbers.end();
    const std::size_t k = i;
    point.outline_slopes[p].col(i) = calibration::outline_slopes(
        misses, point.equilibria[p].state.positions, point.frame, changes.turn(k), changes.shift(k),
        moves ? &found.positions[own - changes.numbers.begin()] : nullptr);
  }
}

void RobotProblem::add_slopes(RobotPoint& point, const Changes& changes, Index pose, const Points& reactions) const {
  const State& state = point.equilibria[pose].state;
  ParameterSensitivity found =
      changes.perturbations->at(state, one_of_many(options_.solver), slopes_accuracy, reads_forces());
  if (found.regular) add_changes_of_acting(found, point, changes, pose);
  add_slopes_of_frame(point, changes, pose, reactions);
  add_outline_slopes(point, changes, pose, found);
  Eigen::MatrixXd& slopes = point.slopes[pose];
  if (!found.regular) return;
  for (std::size_t k = 0; k < changes.numbers.size(); ++k) {
    const Index i = changes.numbers[k];
    const Index p = k;
    for (Index c = 0; c < slopes.rows(); ++c) {
      const PoseColumn& column = poses_.columns[c];
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
      const Vec3 moved =
          points_along(column)
              ? direction_slope(changes.perturbed[k], *point.model, column, state.positions, found.positions[k])
          : column.support >= 0
              ? force_of(*point.model, column, state.positions, found.reactions[k])
              : marker_slope(*point.model, changes.perturbed[k], column.marker, state.positions, found.positions[k]);
      slopes(c, i) += (point.frame.rotation * moved)[column.axis];
    }
  }
}

}  // namespace softkin::calibration
