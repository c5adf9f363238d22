#pragma once

#include <algorithm>
#include <softkin/calibration/robot_problem.hpp>

// Declarations for the .cpp files of a robot's problem; no header of the module includes this one.

namespace softkin::calibration {

/// By which numbers are perturbed, of what they are of the order of.
constexpr double perturbed_by = 1e-5;

/// Robots with a number a little larger and smaller, and the frame's changes.
struct RobotProblem::Changes {
  std::vector<Model> models;  // those of a number side by side
  std::vector<Perturbed> perturbed;
  std::vector<Index> numbers;                  // of which they are
  std::vector<std::vector<Actuation>> acting;  // per such number, per pose: the derivative of the acting commands
  std::unique_ptr<Perturbations> perturbations;
  std::vector<double> differences;  // per number of the robot
  std::vector<MeasuringFrame> more, less;

  /// Of the measuring frame, by a number.
  [[nodiscard]] Mat3 turn(std::size_t number) const {
    return (more[number].rotation - less[number].rotation) / differences[number];
  }
  [[nodiscard]] Vec3 shift(std::size_t number) const {
    return (more[number].place - less[number].place) / differences[number];
  }

  Changes(const NumberedRobot& robot, const RobotPoint& point) {
    const Index count = robot.numbers().size();
    models.reserve(2 * robot.numbers().size());
    for (Index i = 0; i < count; ++i) {
      const double half = perturbed_by * robot.size(i);
      Eigen::VectorXd above = point.values, below = point.values;
      const FittedNumber& number = robot.numbers()[i];
      above[i] = std::min(number.high, above[i] + half);
      below[i] = std::max(number.low, below[i] - half);
      differences.push_back(above[i] - below[i]);
      more.push_back(robot.frame(above));
      less.push_back(robot.frame(below));
      if (robot.of_camera(i)) continue;
      const Model& larger = models.emplace_back(robot.model(above));
      const Model& smaller = models.emplace_back(robot.model(below));
      perturbed.push_back({larger, smaller, differences.back()});
      numbers.push_back(i);
    }
    perturbations = std::make_unique<Perturbations>(*point.statics, perturbed);
  }
};

}  // namespace softkin::calibration
