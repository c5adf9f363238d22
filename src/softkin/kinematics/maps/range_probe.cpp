#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/maps/range_probe.hpp>
#include <softkin/kinematics/sampling.hpp>

namespace softkin::maps {

namespace {

constexpr double min_coverage = 0.8;  // of a range, below which much of the work would be lost on the rest
constexpr double safe = 0.8;          // of the distance to where equilibria end: slopes grow without bound there
constexpr Index max_corners = 16;
constexpr int max_trials = 4;  // of an end that is suggested

/// Towards rest, to two digits of the distance.
double safe_end(double rest, double end) {
  const double distance = safe * std::abs(end - rest);
  if (!(distance > 0)) return rest;
  const double step = std::pow(10, std::floor(std::log10(distance)) - 1);
  const double rounded = std::floor(distance / step * (1 + 1e-12)) * step;
  return end < rest ? rest - rounded : rest + rounded;
}

}  // namespace

Actuation RangeProbe::actuation_of(const Eigen::VectorXd& commands) const {
  Actuation actuation = data_.actuation;
  for (Index i = 0; i < commands.size(); ++i) actuation[data_.inputs[i].actuator] = commands[i];
  return actuation;
}

bool RangeProbe::solve_rest() {
  if (at_rest_) return true;
  rest_.resize(std::ssize(data_.inputs));
  for (Index i = 0; i < rest_.size(); ++i)
    rest_[i] = std::clamp(data_.actuation[data_.inputs[i].actuator], data_.inputs[i].low, data_.inputs[i].high);
  at_rest_ = statics_.solve(actuation_of(rest_), statics_.rest(), one_of_many(options_.statics), crew_.patience());
  return !at_rest_->report.stopped;
}

std::optional<double> RangeProbe::reach(const Eigen::VectorXd& commands) {
  if (at_rest_->report.status != Status::converged) return 0;
  const Equilibrium found =
      statics_.solve(actuation_of(commands), at_rest_->state, one_of_many(options_.statics), crew_.patience());
  const SolveReport& report = found.report;
  if (report.stopped) return std::nullopt;
  double reached = report.status == Status::converged ? 1 : std::isfinite(report.reached) ? report.reached : 0;
  // a map has the equilibria that are continuous with those at rest
  if (report.physical.snapped_mm > 0) reached = std::min(reached, report.physical.snapped_from);
  return std::clamp(reached, 0.0, 1.0);
}

bool RangeProbe::probe_inputs() {
  if (!solve_rest()) return false;
  const Index count = rest_.size();
  inputs_.assign(static_cast<std::size_t>(count), {});
  for (Index i = 0; i < count; ++i) {
    const MapInput& input = data_.inputs[i];
    inputs_[i] = {rest_[i], input.low, input.high};
  }
  const auto probe_end = [&](Index k) {
    const Index i = k / 2;
    const bool upper = k % 2 == 1;
    const MapInput& input = data_.inputs[i];
    Eigen::VectorXd commands = rest_;
    commands[i] = upper ? input.high : input.low;
    if (commands[i] == rest_[i]) return true;
    std::optional<double> reached = reach(commands);
    if (!reached) return false;
    InputReach& of = inputs_[i];
    (upper ? of.high_end : of.low_end) = *reached >= 1;
    double& end = upper ? of.high : of.low;
    // a long step may pass a limit where a shorter one ends, so the suggested range is tried
    for (int trial = 0; *reached < 1 && trial < max_trials; ++trial) {
      end = rest_[i] + *reached * (commands[i] - rest_[i]);
      commands[i] = safe_end(rest_[i], end);
      if (commands[i] == rest_[i]) break;
      reached = reach(commands);
      if (!reached) return false;
    }
    return true;
  };
  const MapProgress from{crew_.reported().equilibria, 0, crew_.reported().error, "probing the ranges"};
  return crew_.each(2 * count, from, &MapProgress::equilibria, probe_end);
}

bool RangeProbe::probe_corners() {
  if (!solve_rest()) return false;
  const Index count = rest_.size(), all = Index{1} << count, corners = std::min(all, max_corners);
  std::vector<Eigen::VectorXd> ends(corners);
  std::vector<double> reached(corners, 1);
  const auto probe_corner = [&](Index k) {
    const Index bits = k * (all / corners) + (all > corners ? k % (all / corners) : 0);  // spread over all of them
    ends[k].resize(count);
    for (Index i = 0; i < count; ++i) ends[k][i] = (bits >> i) & 1 ? data_.inputs[i].high : data_.inputs[i].low;
    const std::optional<double> found = ends[k] == rest_ ? std::optional(1.0) : reach(ends[k]);
    if (found) reached[k] = *found;
    return found.has_value();
  };
  const MapProgress from{crew_.reported().equilibria, 0, crew_.reported().error, "probing corners of the ranges"};
  if (!crew_.each(corners, from, &MapProgress::equilibria, probe_corner)) return false;
  const auto nearest = std::min_element(reached.begin(), reached.end());
  corner_reach_ = *nearest;
  corner_ = ends[nearest - reached.begin()];
  return true;
}

std::string RangeProbe::named(std::size_t input, double value) const {
  const MapInput& of = data_.inputs[input];
  return number(value, 3) + (of.unit.empty() ? "" : " " + of.unit);
}

std::string RangeProbe::wrong_inputs() const {
  std::string text;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const MapInput& input = data_.inputs[i];
    const InputReach& of = inputs_[i];
    if (of.high - of.low >= min_coverage * (input.high - input.low)) continue;
    const double low = of.low_end ? of.low : safe_end(of.rest, of.low);
    const double high = of.high_end ? of.high : safe_end(of.rest, of.high);
    text += (text.empty() ? "" : "; ") + std::string("input '") + input.name + "': with the other inputs at rest, " +
            "equilibria end at " +
            (of.low_end    ? named(i, of.high)
             : of.high_end ? named(i, of.low)
                           : named(i, of.low) + " and " + named(i, of.high)) +
            " of its range " + number(input.low) + " to " + named(i, input.high);
    text += low < high ? ", so give it a smaller range, such as [" + number(low, 4) + ", " + number(high, 4) + "]"
                       : ", so it has no range that can be mapped";
  }
  return text;
}

std::string RangeProbe::wrong_corner() const {
  if (corner_reach_ >= 1) return "";
  std::string corner, ranges;
  for (std::size_t i = 0; i < data_.inputs.size(); ++i) {
    const MapInput& input = data_.inputs[i];
    const Index at = i;
    const auto end = [&](double value) { return safe_end(rest_[at], rest_[at] + corner_reach_ * (value - rest_[at])); };
    corner += (i == 0 ? "" : ", ") + input.name + " = " + named(i, corner_[at]);
    ranges +=
        (i == 0 ? "" : ", ") + input.name + " [" + number(end(input.low), 4) + ", " + number(end(input.high), 4) + "]";
  }
  if (corner_reach_ <= 0) return "from rest towards " + corner + " there are no equilibria";
  return "from rest towards " + corner + " equilibria end at " + number(100 * corner_reach_, 3) +
         " % of the path, so give the inputs smaller ranges, such as " + ranges;
}

std::string RangeProbe::suspected_input(const MapPiece& piece, const std::vector<Sample>& samples) const {
  double largest = -2;
  Index suspected = 0;
  for (std::size_t j = 0; j < piece.inputs.size(); ++j) {
    const MapInput& input = data_.inputs[piece.inputs[j]];
    double sums[2] = {0, 0}, counts[2] = {0, 0};  // of distances from rest over the range: missing ones, others
    for (const Sample& sample : samples) {
      const int which = sample.is_good() ? 1 : 0;
      sums[which] +=
          std::abs(sample.commands[static_cast<Index>(j)] - rest_[piece.inputs[j]]) / (input.high - input.low);
      counts[which] += 1;
    }
    const double difference = sums[0] / std::max(counts[0], 1.0) - sums[1] / std::max(counts[1], 1.0);
    if (!(difference > largest)) continue;
    largest = difference;
    suspected = piece.inputs[j];
  }
  const MapInput& input = data_.inputs[suspected];
  const auto half = [&](double end) { return number(rest_[suspected] + 0.5 * (end - rest_[suspected]), 4); };
  return "the missing ones are far from rest along input '" + input.name + "', so give it a smaller range, such as [" +
         half(input.low) + ", " + half(input.high) + "]";
}

}  // namespace softkin::maps
