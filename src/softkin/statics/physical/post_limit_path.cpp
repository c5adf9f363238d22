#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/measure_continuation.hpp>
#include <utility>

namespace softkin::physical {

/// Follows equilibria from `last` until one has passed the requested load; `next` is then that one.
///
/// longest  longest step of the measure, over its value at rest
MeasureContinuation::Passed MeasureContinuation::go_along(double path, double end, double longest, Measured& last,
                                                          std::optional<Measured>& next) {
  const double requested = requested_load();
  const bool below = last.load < requested;
  double length = std::min(tuning_.post_limit.first_step * last.measure, longest);
  std::optional<Measured> before;
  int missed = 0;
  for (int i = 0; i < tuning_.post_limit.max_steps; ++i) {
    const double left = path * (end - last.measure);
    if (!(left > 1e-9 * std::abs(end))) return Passed::end;
    const double there = length > 0.9 * left ? end : last.measure + path * length;
    Search<Measured> step = at_measure(there, last, false, before ? &*before : nullptr);
    if (step.interrupted) return Passed::interrupted;
    next = std::move(step.found);
    if (!next) {
      length *= tuning_.step.shortening;
      if (length < tuning_.post_limit.min_step * last.measure || ++missed > tuning_.post_limit.max_failures)
        return Passed::nowhere;
      continue;
    }
    note_branch(*next);
    if (below != (next->load < requested)) return Passed::requested;
    length = std::min({tuning_.post_limit.growth * std::abs(there - last.measure),
                       tuning_.post_limit.max_step * next->measure, longest});
    before = std::exchange(last, std::move(*next));
  }
  return Passed::nowhere;
}

/// Finds the equilibrium under the requested load, between one with a lower and one with a higher load.
MeasureContinuation::End MeasureContinuation::arrive_between(Measured low, Measured high, Iterate& at) {
  const double requested = requested_load();
  const double reach = tuning_.post_limit.load_tolerance * std::max(std::abs(low.load), std::abs(high.load));
  double low_miss = low.load - requested, high_miss = high.load - requested;  // weighted for the regula falsi
  for (int i = 0; i < tuning_.post_limit.max_bisections && std::abs(high.load - requested) > reach; ++i) {
    const double fraction = std::clamp(low_miss / (low_miss - high_miss), 0.05, 0.95);
    auto [middle, interrupted] = at_measure(low.measure + fraction * (high.measure - low.measure), low, false, &high);
    if (interrupted) return End::interrupted;
    if (!middle) return End::lost;
    note_branch(*middle);
    const double miss = middle->load - requested;
    if ((miss < 0) == (high_miss < 0)) {
      low_miss *= 0.5;
    } else {  // the Illinois algorithm: less weight for the end that stays
      low = std::move(high);
      low_miss = high_miss;
    }
    high = std::move(*middle);
    high_miss = miss;
  }
  return arrive_at(high, at, Newton::Policy::follow);
}

/// Follows the post-limit-point branch until the load has the requested value again, or up to the requested measure.
MeasureContinuation::End MeasureContinuation::go_beyond(double path, const Measured& limit_point, Iterate& at) {
  const double end = options_.beyond > 0 ? options_.beyond
                     : path > 0          ? tuning_.post_limit.search_range * limit_point.measure
                                         : limit_point.measure / tuning_.post_limit.search_range;
  if (!(path * (end - limit_point.measure) > 0)) {
    remark_ += "; " + measure_text(end) + " is not beyond it";
    return End::lost;
  }
  const double longest = options_.beyond > 0 ? std::abs(end - limit_point.measure) / tuning_.post_limit.min_points
                                             : std::numeric_limits<double>::infinity();
  Measured last = limit_point;
  std::optional<Measured> next;
  const Passed passed = go_along(path, end, longest, last, next);
  if (passed == Passed::interrupted) {
    keep(last, at);
    return End::interrupted;
  }
  if (passed == Passed::requested) {
    const End arrived = arrive_between(std::move(last), std::move(*next), at);
    if (arrived == End::interrupted) keep(limit_point, at);
    if (arrived == End::arrived) {
      record_.note_snap(system_.largest_move(limit_point.at.positions, at.positions),
                        route_.whole(fraction_of(limit_point.load)));
      remark_.clear();
    }
    return arrived;
  }
  if (!(options_.beyond > 0)) {
    remark_ += "; no shape up to " + measure_text(last.measure) + " carries as much again";
    return End::lost;
  }
  if (last.measure == limit_point.measure) return End::lost;
  report_beyond(last, passed == Passed::end);
  keep(last, at);
  report_.physical.unstable_modes = std::max(0, corrector_.prepare(route_.here, at));
  return End::limit_point;
}

MeasureContinuation::End MeasureContinuation::back(Iterate& at) {
  const double begin = system_.measures().value(load_, at.positions) / system_.measures().rest(load_);
  Measured last{begin, first_load(), at, corrector_.last, 0, route_.from.load_factor};
  last.at.multipliers[load_] = system_.measures().given(load_, last.load);
  const double slope = slope_at(route_.from, last),
               grows = -system_.measures().sign(load_);  // the load with the measure, at rest
  if (!std::isfinite(slope) || slope * grows >= 0) return End::lost;
  const double path = requested_load() > first_load() ? -grows : grows;
  const double end = path == grows ? options_.beyond : 1;
  record_.branch = {};
  note_branch(last);
  std::optional<Measured> next;
  const Passed passed = go_along(path, end, tuning_.post_limit.max_step * begin, last, next);
  End arrived = End::lost;
  if (passed == Passed::interrupted) {
    keep(last, at);
    return End::interrupted;
  }
  if (passed == Passed::requested) arrived = arrive_between(std::move(last), std::move(*next), at);
  if (arrived == End::arrived) remark_.clear();
  return arrived;
}

void MeasureContinuation::note_branch(const Measured& point) {
  record_.branch.actuator = load_;
  record_.branch.points.push_back({point.measure, point.load});
}

/// "3.01 times its volume", "0.7 of its length"
std::string MeasureContinuation::measure_text(double measure) const {
  return number(measure, 4) +
         (system_.model().actuators[load_].is<CableDrive>() ? " of its length" : " times its volume");
}

std::string MeasureContinuation::load_text(double load) const {
  return number(load, 5) + (system_.model().actuators[load_].is<CableDrive>() ? " N" : " kPa");
}

void MeasureContinuation::report_beyond(const Measured& last, bool requested) {
  remark_ += "; beyond it, at " + measure_text(last.measure) + ", it is " + load_text(last.load);
  if (!requested) remark_ += ", and no equilibrium follows there";
}

void sort_branch(const System& system, LoadBranch& branch) {
  auto& points = branch.points;
  const double path = branch.actuator >= 0 ? -system.measures().sign(branch.actuator) : 1;
  std::sort(points.begin(), points.end(),
            [path](const auto& a, const auto& b) { return path * a.measure < path * b.measure; });
}

}  // namespace softkin::physical
