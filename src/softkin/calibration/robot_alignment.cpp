#include <algorithm>
#include <softkin/calibration/robot_problem.hpp>
#include <softkin/core/dense.hpp>

namespace softkin::calibration {

namespace {

constexpr int max_alignments = 200;
constexpr double first_alignment_damping = 1e-3, max_alignment_damping = 1e6;
constexpr double gained_by_alignment = 1e-9;  // of the sum of squares, less is none
constexpr double frame_step = 1e-4;           // for differences [mm, degrees]
constexpr double known_within = 3;            // deviations of a prior

/// Numbers of the frame within their bounds, and as near to what is known of them before.
Eigen::VectorXd allowed(const NumberedRobot& robot, Eigen::VectorXd values) {
  for (std::size_t i = 0; i < robot.numbers().size(); ++i) {
    const FittedNumber& number = robot.numbers()[i];
    double& value = values[i];
    if (number.deviation && robot.of_frame(i))
      value = std::clamp(value, *number.start - known_within * *number.deviation,
                         *number.start + known_within * *number.deviation);
    value = std::clamp(value, number.low, number.high);
  }
  return values;
}

}  // namespace

/// How far off markers are that were seen, coordinate by coordinate, with derivatives by some numbers of the frame.
struct RobotProblem::MarkerMisses {
  std::vector<double> off;
  std::vector<Eigen::RowVectorXd> slopes;

  [[nodiscard]] double sum() const {
    double all = 0;
    for (const double each : off) all += each * each;
    return all;
  }
  [[nodiscard]] Eigen::VectorXd step(double damping) const {
    const Eigen::Index count = slopes.front().size();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (std::size_t i = 0; i < off.size(); ++i) {
      matrix += slopes[i].transpose() * slopes[i];
      right -= off[i] * slopes[i].transpose();
    }
    matrix.diagonal() *= 1 + damping;
    matrix.diagonal().array() += damping * 1e-6 * matrix.trace();
    return solve_symmetric(matrix, right);
  }
};

RobotProblem::MarkerMisses RobotProblem::marker_misses(const RobotPoint& point,
                                                       const std::vector<Index>& numbers) const {
  std::vector<MeasuringFrame> more, less;
  for (const Index i : numbers) {
    Eigen::VectorXd values = point.values;
    values[i] += frame_step;
    more.push_back(robot_.frame(values));
    values[i] -= 2 * frame_step;
    less.push_back(robot_.frame(values));
  }
  MarkerMisses misses;
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose)
    for (Index c = 0; c < std::ssize(poses_.columns); ++c) {
      const PoseColumn& column = poses_.columns[c];
      const Equilibrium& found = point.equilibria[pose];
      if (column.marker < 0 || !fits(pose) || !read(pose, c) || found.report.status != Status::converged) continue;
      const Vec3 place = point.model->markers[column.marker].at(found.state.positions);
      Eigen::RowVectorXd slope(numbers.size());
      for (std::size_t i = 0; i < numbers.size(); ++i)
        slope[i] = ((more[i].rotation - less[i].rotation) * place + more[i].place - less[i].place)[column.axis] /
                   (2 * frame_step);
      misses.off.push_back(point.computed(pose, c) - poses_.values(pose, c));
      misses.slopes.push_back(slope);
    }
  return misses;
}

/// The same shapes where the frame has other numbers.
void RobotProblem::put(RobotPoint& point, const Eigen::VectorXd& values) const {
  point.values = values;
  point.frame = robot_.frame(values);
  for (Index pose = 0; pose < std::ssize(poses_.commands); ++pose)
    for (Index c = 0; c < std::ssize(poses_.columns); ++c) {
      const PoseColumn& column = poses_.columns[c];
      const Equilibrium& found = point.equilibria[pose];
      if (column.marker < 0 || found.report.status != Status::converged) continue;
      const Vec3 place = point.model->markers[column.marker].at(found.state.positions);
      point.computed(pose, c) = (point.frame.rotation * place + point.frame.place)[column.axis];
    }
}

Eigen::VectorXd RobotProblem::aligned(const RobotPoint& start) {
  std::vector<Index> numbers;
  for (std::size_t i = 0; i < robot_.numbers().size(); ++i)
    if (robot_.of_frame(i)) numbers.push_back(i);
  if (!dots_.any() || numbers.empty()) return start.values;
  RobotPoint point = start;
  (void)match(point, false);
  double damping = first_alignment_damping;
  for (int i = 0; i < max_alignments; ++i) {
    const MarkerMisses misses = marker_misses(point, numbers);
    if (misses.off.empty()) break;
    bool moved = false;
    for (; !moved && damping < max_alignment_damping; damping *= 8) {
      Eigen::VectorXd values = point.values;
      const Eigen::VectorXd step = misses.step(damping);
      for (std::size_t k = 0; k < numbers.size(); ++k) values[numbers[k]] += step[k];
      RobotPoint next = point;
      put(next, allowed(robot_, values));
      if (!(marker_misses(next, {}).sum() < (1 - gained_by_alignment) * misses.sum())) continue;
      moved = true;
      point = std::move(next);
      damping /= 64;
    }
    const bool matched_anew = match(point, false);
    if (!moved && !matched_anew) break;
    if (!moved) damping = first_alignment_damping;
  }
  return point.values;
}

}  // namespace softkin::calibration
