#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/estimate/fit.hpp>
#include <softkin/kinematics/estimate/outliers.hpp>
#include <softkin/kinematics/inverse_step.hpp>
#include <softkin/kinematics/map_estimate.hpp>

namespace softkin {

namespace {

constexpr int max_steps = 100;
constexpr double arrived = 1e-3;  // length of a step, in standard deviations of the estimate

void check_estimate(const KinematicMap& map, const std::vector<MapUnknown>& unknowns, const Eigen::VectorXd& commands,
                    const Eigen::VectorXd& values, const Eigen::VectorXd& deviations) {
  if (commands.size() != map.inputs() || !commands.allFinite())
    throw InvalidInput("commands must be " + std::to_string(map.inputs()) + " finite numbers, one for each input");
  if (values.size() != map.outputs() || deviations.size() != map.outputs() || values.array().isInf().any())
    throw InvalidInput("readings and deviations must be " + std::to_string(map.outputs()) +
                       " numbers each, one for each output");
  for (Index q = 0; q < values.size(); ++q)
    if (!std::isnan(values[q]) && !(deviations[q] > 0 && std::isfinite(deviations[q])))
      throw InvalidInput("the reading of '" + map.data().outputs[q].name + "' needs a deviation above 0, not " +
                         number(deviations[q]));
  std::set<Index> seen;
  for (const MapUnknown& unknown : unknowns) {
    if (unknown.input < 0 || unknown.input >= map.inputs() || !seen.insert(unknown.input).second)
      throw InvalidInput("an unknown is no input of the map, or is given twice");
    if (!std::isfinite(unknown.mean) || !(unknown.deviation > 0 && std::isfinite(unknown.deviation)))
      throw InvalidInput("'" + map.data().inputs[unknown.input].name + "' needs a mean and a deviation above 0");
  }
}

/// The problem in unknowns scaled by their prior standard deviations.
class MapProblem {
 public:
  MapProblem(const KinematicMap& map, const std::vector<MapUnknown>& unknowns, const Eigen::VectorXd& values,
             const Eigen::VectorXd& deviations)
      : map_(map), unknowns_(unknowns), values_(values), deviations_(deviations) {}

  struct Point {
    Eigen::VectorXd commands{}, outputs{};
    Eigen::MatrixXd matrix{};    // of the normal equations
    Eigen::VectorXd gradient{};  // of half the cost
    double cost = 0, chi_square = 0;
  };

  /// False outside the map.
  bool look(Point& at) const {
    at.outputs.resize(map_.outputs());
    maps::RowMatrix slopes(map_.inputs(), map_.outputs());
    if (!map_.evaluate(at.commands.data(), at.outputs.data(), slopes.data())) return false;
    at.matrix = Eigen::MatrixXd::Identity(count(), count());
    at.gradient = off(at.commands);
    at.chi_square = 0;
    at.cost = at.gradient.squaredNorm();
    Eigen::VectorXd row(count());
    for (Index q = 0; q < values_.size(); ++q) {
      if (std::isnan(values_[q])) continue;
      for (Index i = 0; i < count(); ++i) row[i] = slopes(unknown(i).input, q) * unknown(i).deviation / deviations_[q];
      const double miss = (at.outputs[q] - values_[q]) / deviations_[q];
      at.matrix += row * row.transpose();
      at.gradient += miss * row;
      at.chi_square += miss * miss;
    }
    at.cost += at.chi_square;
    return true;
  }

  /// Returns the step to the minimum of the quadratic model inside the ranges, damped by `hold` times the prior.
  [[nodiscard]] Eigen::VectorXd step(const Point& at, double hold) const {
    const Index n = count();
    Eigen::MatrixXd rows(2 * n, n);
    rows << Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd bounds(2 * n);
    for (Index i = 0; i < n; ++i) {
      const MapInput& input = map_.data().inputs[unknown(i).input];
      const double command = at.commands[unknown(i).input];
      bounds[i] = std::min(0.0, (input.low - command) / unknown(i).deviation);
      bounds[n + i] = std::min(0.0, (command - input.high) / unknown(i).deviation);
    }
    return inverse::solve_small_program(at.matrix + hold * Eigen::MatrixXd::Identity(n, n), at.gradient, rows, bounds);
  }

  [[nodiscard]] Eigen::VectorXd moved(Eigen::VectorXd commands, const Eigen::VectorXd& step) const {
    for (Index i = 0; i < count(); ++i) {
      const MapInput& input = map_.data().inputs[unknown(i).input];
      double& command = commands[unknown(i).input];
      command = std::clamp(command + unknown(i).deviation * step[i], input.low, input.high);
    }
    return commands;
  }

  /// Sets the covariance and the degrees of freedom: the number of readings less that of the unknowns they determine,
  /// the trace of the reduction of the prior covariance.
  void describe(const Point& at, MapEstimate& reported) const {
    const Eigen::MatrixXd left =
        CholeskyFactor(at.matrix).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(count(), count())));
    Eigen::VectorXd units(count());
    for (Index i = 0; i < count(); ++i) units[i] = unknown(i).deviation;
    reported.covariance = units.asDiagonal() * left * units.asDiagonal();
    reported.freedoms =
        static_cast<double>((!values_.array().isNaN()).count()) - (static_cast<double>(count()) - left.trace());
  }

 private:
  [[nodiscard]] Index count() const { return unknowns_.size(); }
  [[nodiscard]] const MapUnknown& unknown(Index i) const { return unknowns_[i]; }
  [[nodiscard]] Eigen::VectorXd off(const Eigen::VectorXd& commands) const {
    Eigen::VectorXd off(count());
    for (Index i = 0; i < count(); ++i) off[i] = (commands[unknown(i).input] - unknown(i).mean) / unknown(i).deviation;
    return off;
  }

  const KinematicMap& map_;
  const std::vector<MapUnknown>& unknowns_;
  const Eigen::VectorXd& values_;
  const Eigen::VectorXd& deviations_;
};

}  // namespace

double MapEstimate::misfit() const {
  return estimate::excess(chi_square, freedoms);
}

std::optional<MapEstimate> estimate_by_map(const KinematicMap& map, const std::vector<MapUnknown>& unknowns,
                                           const Eigen::VectorXd& commands, const Eigen::VectorXd& values,
                                           const Eigen::VectorXd& deviations) {
  check_estimate(map, unknowns, commands, values, deviations);
  const MapProblem problem(map, unknowns, values, deviations);
  MapProblem::Point at{.commands = commands};
  if (!problem.look(at)) return std::nullopt;
  MapEstimate reported;
  estimate::Damping hold(1);
  while (reported.iterations < max_steps) {
    const Eigen::VectorXd step = problem.step(at, hold.value());
    const double length = std::sqrt(std::max(0.0, step.dot(at.matrix * step)));
    reported.converged = length <= arrived;  // held: at a kink, or an end of the map
    if (reported.converged) break;
    ++reported.iterations;
    MapProblem::Point next{.commands = problem.moved(at.commands, step)};
    if (problem.look(next) && next.cost < at.cost) {
      at = std::move(next);
      hold.relax();
    } else if (!hold.tighten()) {
      break;
    }
  }
  reported.commands = at.commands;
  reported.computed = at.outputs;
  reported.chi_square = at.chi_square;
  problem.describe(at, reported);
  return reported;
}

}  // namespace softkin
