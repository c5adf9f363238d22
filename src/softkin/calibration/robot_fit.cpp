#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/calibration/robot_fit.hpp>
#include <softkin/calibration/robot_problem.hpp>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>

namespace softkin::calibration {

namespace {

using Eigen::VectorXd;

constexpr double enough = 1e-6;     // of the sum of squares, that an iteration gains
constexpr double max_step = 0.5;    // of what a number began with: a robot that is much softer at once is a knot
constexpr double no_effect = 1e-8;  // of the largest: rounding, which would ask for steps beyond all measure
constexpr double min_damping = 1e-10, max_damping = 1e8;

VectorXd within_bounds(const NumberedRobot& robot, VectorXd values) {
  for (std::size_t i = 0; i < robot.numbers().size(); ++i) {
    double& value = values[i];
    value = std::clamp(value, robot.numbers()[i].low, robot.numbers()[i].high);
  }
  return values;
}

/// A step, as long as it may be.
VectorXd limited(const NumberedRobot& robot, const VectorXd& step) {
  double longest = 0;
  for (std::size_t i = 0; i < robot.numbers().size(); ++i)
    if (*robot.numbers()[i].start != 0) longest = std::max(longest, std::abs(step[i]) / robot.size(i));
  return longest > max_step ? VectorXd(max_step / longest * step) : step;
}

int side(const FittedNumber& number, double value) {
  return value <= number.low ? -1 : value >= number.high ? 1 : 0;
}

/// J^T J and J^T r over the numbers that move, each in units of its size.
struct RobotEquations {
  RobotEquations(const NumberedRobot& robot, const VectorXd& values, const Linearised& at)
      : size(values.size()), scales(values.size()) {
    const VectorXd gradient = at.slopes.transpose() * at.residuals;
    for (Index u = 0; u < static_cast<Index>(size); ++u) scales[u] = robot.size(u);
    const VectorXd effects = scales.cwiseProduct(at.slopes.colwise().norm().transpose());
    for (Index u = 0; u < static_cast<Index>(size); ++u) {
      const int bound = side(robot.numbers()[u], values[u]);
      const bool held = bound != 0 && bound * gradient[u] < 0;
      if (!held && effects[u] > no_effect * effects.maxCoeff()) moving.push_back(u);
    }
    const Index count = moving.size();
    Eigen::MatrixXd some(at.slopes.rows(), count);
    for (Index i = 0; i < count; ++i) some.col(i) = scales[moving[i]] * at.slopes.col(moving[i]);
    matrix = some.transpose() * some;
    right = some.transpose() * at.residuals;
  }

  [[nodiscard]] VectorXd step(double damping) const {
    Eigen::MatrixXd damped = matrix;
    damped.diagonal() *= 1 + damping;
    const VectorXd some = -solve_symmetric(damped, right);
    VectorXd all = VectorXd::Zero(size);
    for (std::size_t i = 0; i < moving.size(); ++i) all[moving[i]] = scales[moving[i]] * some[i];
    return all;
  }

  Eigen::Index size;
  VectorXd scales;
  std::vector<Index> moving;
  Eigen::MatrixXd matrix;
  VectorXd right;
};

/// Deviations and correlations; a combination that the readings do not determine has none.
void report_deviations(const RobotEquations& equations, RobotFit& fit) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), singular = 1e-12, part = 1e-2;
  fit.deviations = VectorXd::Constant(equations.size, nan);
  fit.correlations = Eigen::MatrixXd::Identity(equations.size, equations.size);
  const Index count = equations.moving.size();
  if (count == 0) return;
  const VectorXd root = equations.matrix.diagonal().cwiseSqrt().cwiseInverse();
  const SymmetricEigen eigen = symmetric_eigen(root.asDiagonal() * equations.matrix * root.asDiagonal());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  std::vector<bool> reported(count, true);
  for (Index k = 0; k < std::ssize(eigen.values); ++k) {
    if (eigen.values[k] > singular * eigen.values.maxCoeff()) {
      covariance += eigen.vectors.col(k) * eigen.vectors.col(k).transpose() / eigen.values[k];
      continue;
    }
    for (Index i = 0; i < count; ++i)
      if (std::abs(eigen.vectors(i, k)) > part) reported[i] = false;
  }
  for (Index i = 0; i < count; ++i) {
    const Index u = equations.moving[i];
    if (reported[i]) fit.deviations[u] = equations.scales[u] * root[i] * std::sqrt(covariance(i, i));
    for (Index j = 0; j < i; ++j) {
      if (!reported[i] || !reported[j]) continue;
      const Index v = equations.moving[j];
      fit.correlations(u, v) = fit.correlations(v, u) =
          covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
    }
  }
}

/// Returns how many numbers only the readings determine.
std::size_t free_numbers(const NumberedRobot& robot) {
  return std::count_if(robot.numbers().begin(), robot.numbers().end(),
                       [](const FittedNumber& n) { return !n.deviation; });
}

void check(const NumberedRobot& robot, const MeasuredPoses& poses, const RobotProblem& problem, bool fits) {
  if (problem.readings() == 0) throw InvalidInput({poses.file}, "no reading is left to fit to");
  if (fits && robot.numbers().empty()) throw InvalidInput("there is no number to fit");
  const std::size_t free = free_numbers(robot);
  if (fits && problem.readings() < free)
    throw InvalidInput({poses.file}, "there are fewer readings, " + std::to_string(problem.readings()) +
                                         ", than numbers to be fitted without a prior, " + std::to_string(free));
}

void finish(RobotProblem& problem, const RobotPoint& point, RobotFit& fit) {
  problem.match(point, true);
  fit.scales = problem.scales(point);
  fit.named = problem.dots().poses();
  fit.dots = problem.dots().matches(point.computed, fit.scales[static_cast<std::size_t>(Reading::coordinate)]);
  fit.values = point.values;
  fit.computed = {point.computed, point.equilibria};
  fit.markers_mm = problem.marker_misfit(point, false);
  fit.kept_mm = problem.marker_misfit(point, true);
  fit.outlines = problem.outline_fit(point);
  fit.without_equilibrium = point.without_equilibrium;
}

/// Of the markers, or where there are none of the outlines.
double rms_mm(const RobotProblem& problem, const RobotPoint& point) {
  const Misfit markers = problem.marker_misfit(point, false);
  return markers.readings > 0 ? markers.rms : problem.outline_fit(point).fitted_mm.rms;
}

/// Where the search begins. None: the user stopped it.
std::optional<RobotPoint> first_point(const NumberedRobot& robot, RobotProblem& problem) {
  const VectorXd start = within_bounds(robot, robot.start());
  std::optional<RobotPoint> point = problem.solve(start, nullptr, true);
  if (!point) return point;
  const VectorXd aligned = problem.aligned(*point);
  if (aligned != start) {
    std::optional<RobotPoint> next = problem.solve(aligned, &*point, true);
    if (!next) return next;
    const bool worse = !next->refusal.empty() || next->without_equilibrium > point->without_equilibrium;
    if (!worse) point = std::move(next);
  }
  problem.match(*point, false);
  return point;
}

/// What a fit is worth that ended.
void conclude(const NumberedRobot& robot, const RobotPoint& point, const RobotFitOptions& options,
              RobotProblem& problem, RobotFit& fit) {
  if (fit.status == Status::interrupted && fit.iterations >= options.max_iterations) {
    fit.status = Status::not_converged;
    fit.remark = "its iterations were not enough";
  }
  finish(problem, point, fit);
  report_deviations(RobotEquations(robot, point.values, problem.linearised(point)), fit);
  for (std::size_t i = 0; i < robot.numbers().size(); ++i)
    fit.at_bound.push_back(side(robot.numbers()[i], point.values[i]));
  if (fit.status == Status::converged && problem.matched_readings() < free_numbers(robot)) {
    fit.status = Status::not_converged;
    fit.remark = "no more than " + counted(problem.matched_readings(), "reading") +
                 " left, as few dots or points of outlines are near enough to the robot";
  }
  if (fit.status == Status::converged && fit.without_equilibrium > 0) {
    fit.status = Status::not_converged;
    fit.remark = std::to_string(fit.without_equilibrium) + " poses have no equilibrium";
  }
}

}  // namespace

RobotFit predict_poses(const NumberedRobot& robot, const MeasuredPoses& poses, const VectorXd& values,
                       const RobotFitOptions& options, const FitCallback& progress) {
  RobotProblem problem(robot, poses, options, progress);
  RobotFit fit;
  const std::optional<RobotPoint> point = problem.solve(values, nullptr, false);
  fit.status = point ? Status::converged : Status::interrupted;
  if (point) finish(problem, *point, fit);
  fit.seconds = problem.seconds();
  return fit;
}

std::vector<bool> kept_aside(const std::string& option, int keep, std::size_t poses) {
  if (keep == 0) return {};
  if (static_cast<std::size_t>(keep) >= poses)
    throw InvalidInput(option + " " + std::to_string(keep) + ": there are " + counted(poses, "pose") +
                       ", of which some must be left to fit to");
  std::vector<bool> kept(poses);
  for (int k = 0; k < keep; ++k)
    kept[(2 * static_cast<std::size_t>(k) + 1) * poses / (2 * static_cast<std::size_t>(keep))] = true;
  return kept;
}

RobotFit fit_robot(const NumberedRobot& robot, const MeasuredPoses& poses, const RobotFitOptions& options,
                   const FitCallback& progress) {
  RobotProblem problem(robot, poses, options, progress);
  check(robot, poses, problem, true);
  RobotFit fit;
  std::optional<RobotPoint> point = first_point(robot, problem);
  fit.status = Status::interrupted;
  constexpr double first_damping = 1e-3;
  double damping = first_damping;
  while (point && fit.iterations < options.max_iterations) {
    const Linearised linear = problem.linearised(*point);
    ++fit.iterations;
    problem.begin_iteration(fit.iterations, rms_mm(problem, *point));
    const RobotEquations equations(robot, point->values, linear);
    double gained = 0;
    bool stopped = false;
    std::string refusal;
    for (; !(gained > 0) && damping <= max_damping && !stopped; damping *= 8) {
      const VectorXd tried = within_bounds(robot, point->values + limited(robot, equations.step(damping)));
      if ((tried - point->values).cwiseQuotient(equations.scales).norm() < 1e-12) break;
      std::optional<RobotPoint> next = problem.solve(tried, &*point, true);
      stopped = !next;
      if (next && !next->refusal.empty()) refusal = next->refusal;
      if (stopped || !next->refusal.empty() || next->without_equilibrium > point->without_equilibrium) continue;
      const double before = problem.cost(*point, linear.weights), after = problem.cost(*next, linear.weights);
      if (!(after < before)) continue;
      gained = 1 - after / before;
      point = std::move(next);
      damping = std::max(damping / 64, min_damping);  // the loop multiplies it once more
    }
    if (stopped) break;
    const bool stationary = gained < enough, matched_anew = problem.match(*point, stationary);
    if (stationary && matched_anew) {
      damping = first_damping;
      continue;
    }
    if (stationary) {
      fit.status = refusal.empty() ? Status::converged : Status::not_converged;
      if (!refusal.empty()) fit.remark = "what would fit better is refused, so give bounds: " + refusal;
      break;
    }
  }
  if (point) conclude(robot, *point, options, problem, fit);
  fit.seconds = problem.seconds();
  return fit;
}

}  // namespace softkin::calibration
