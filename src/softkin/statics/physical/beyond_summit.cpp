#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/summit.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// First step over the measure at hand, how steps grow, their bounds, and how many there may be.
constexpr double first_beyond = 0.1, growth_beyond = 1.6, most_beyond = 0.5, shortest_beyond = 1e-4;
constexpr int most_steps_beyond = 200, most_missed_beyond = 6;
/// Points on the way to the measure that was asked for, at least.
constexpr int points_beyond = 8;
/// Where the next stable shape is looked for, over the measure at the maximum.
constexpr double far_beyond = 10;
/// Of the load: near enough for Newton's method under it.
constexpr double near_load = 1e-3;
constexpr int most_halvings = 20;

}  // namespace

/// Equilibria from `last` on, until one has passed the load that is asked, which `next` then is.
///
/// longest  step, over the measure at hand
Climb::Passed Climb::go_along(double way, double end, double longest, Measured& last, std::optional<Measured>& next) {
  const double asked = asked_load();
  const bool below = last.load < asked;
  double length = std::min(first_beyond * last.measure, longest);
  std::optional<Measured> before;
  int missed = 0;
  for (int i = 0; i < most_steps_beyond; ++i) {
    const double left = way * (end - last.measure);
    if (!(left > 1e-9 * std::abs(end))) return Passed::end;
    const double there = length > 0.9 * left ? end : last.measure + way * length;
    Search<Measured> step = at_measure(there, last, false, before ? &*before : nullptr);
    if (step.interrupted) return Passed::interrupted;
    next = std::move(step.found);
    if (!next) {
      length *= 0.4;
      if (length < shortest_beyond * last.measure || ++missed > most_missed_beyond) return Passed::nowhere;
      continue;
    }
    note_branch(*next);
    if (below != (next->load < asked)) return Passed::asked;
    length = std::min({growth_beyond * std::abs(there - last.measure), most_beyond * next->measure, longest});
    before = std::exchange(last, std::move(*next));
  }
  return Passed::nowhere;
}

/// The equilibrium under the load that is asked, between two at which it is less and more.
Climb::End Climb::arrive_between(Measured low, Measured high, Iterate& at) {
  const double asked = asked_load();
  const double reach = near_load * std::max(std::abs(low.load), std::abs(high.load));
  double low_miss = low.load - asked, high_miss = high.load - asked;  // as the false position weighs them
  for (int i = 0; i < most_halvings && std::abs(high.load - asked) > reach; ++i) {
    const double share = std::clamp(low_miss / (low_miss - high_miss), 0.05, 0.95);
    auto [middle, interrupted] = at_measure(low.measure + share * (high.measure - low.measure), low, false, &high);
    if (interrupted) return End::interrupted;
    if (!middle) return End::lost;
    note_branch(*middle);
    const double miss = middle->load - asked;
    if ((miss < 0) == (high_miss < 0)) {
      low_miss *= 0.5;
    } else {  // the end that stays counts for less
      low = std::move(high);
      low_miss = high_miss;
    }
    high = std::move(*middle);
    high_miss = miss;
  }
  return arrive_at(high, at, Newton::Policy::follow);
}

/// On the far side of a maximum, to where the load is as asked again, or to the measure that is asked for.
Climb::End Climb::go_beyond(double way, const Measured& summit, Iterate& at) {
  const double end = options_.beyond > 0 ? options_.beyond
                     : way > 0           ? far_beyond * summit.measure
                                         : summit.measure / far_beyond;
  if (!(way * (end - summit.measure) > 0)) {
    report_.remark += "; " + measure_text(end) + " is not beyond it";
    return End::lost;
  }
  const double longest =
      options_.beyond > 0 ? std::abs(end - summit.measure) / points_beyond : std::numeric_limits<double>::infinity();
  Measured last = summit;
  std::optional<Measured> next;
  const Passed passed = go_along(way, end, longest, last, next);
  if (passed == Passed::interrupted) {
    keep(last, at);
    return End::interrupted;
  }
  if (passed == Passed::asked) {
    const End arrived = arrive_between(std::move(last), std::move(*next), at);
    if (arrived == End::interrupted) keep(summit, at);
    if (arrived == End::arrived) {
      tell_snap(system_.largest_move(summit.at.positions, at.positions), route_.whole(share_of(summit.load)), report_);
      report_.remark.clear();
    }
    return arrived;
  }
  if (!(options_.beyond > 0)) {
    report_.remark += "; no shape up to " + measure_text(last.measure) + " carries as much again";
    return End::lost;
  }
  if (last.measure == summit.measure) return End::lost;
  tell_beyond(last, passed == Passed::end);
  keep(last, at);
  report_.physical.unstable_modes = std::max(0, settler_.prepare(route_.here, at));
  return End::summit;
}

Climb::End Climb::back(Iterate& at) {
  const double begin = system_.measures().value(load_, at.positions) / system_.measures().rest(load_);
  Measured last{begin, first_load(), at, settler_.last, 0, route_.from.share};
  last.at.multipliers[load_] = system_.measures().given(load_, last.load);
  const double slope = slope_at(route_.from, last),
               grows = -system_.measures().sign(load_);  // the load with the measure, at rest
  if (!std::isfinite(slope) || slope * grows >= 0) return End::lost;
  const double way = asked_load() > first_load() ? -grows : grows;
  const double end = way == grows ? options_.beyond : 1;
  report_.physical.branch = {};
  note_branch(last);
  std::optional<Measured> next;
  const Passed passed = go_along(way, end, most_beyond * begin, last, next);
  End arrived = End::lost;
  if (passed == Passed::interrupted) {
    keep(last, at);
    return End::interrupted;
  }
  if (passed == Passed::asked) arrived = arrive_between(std::move(last), std::move(*next), at);
  if (arrived == End::arrived) report_.remark.clear();
  return arrived;
}

void Climb::note_branch(const Measured& point) {
  report_.physical.branch.actuator = load_;
  report_.physical.branch.points.push_back({point.measure, point.load});
}

/// "3.01 times its volume", "0.7 of its length"
std::string Climb::measure_text(double measure) const {
  return number(measure, 4) +
         (system_.model().actuators[load_].is<CableDrive>() ? " of its length" : " times its volume");
}

std::string Climb::load_text(double load) const {
  return number(load, 5) + (system_.model().actuators[load_].is<CableDrive>() ? " N" : " kPa");
}

void Climb::tell_beyond(const Measured& last, bool asked) {
  report_.remark += "; beyond it, at " + measure_text(last.measure) + ", it is " + load_text(last.load);
  if (!asked) report_.remark += ", and no equilibrium follows there";
}

void sort_branch(const System& system, SolveReport& report) {
  auto& points = report.physical.branch.points;
  const double way =
      report.physical.branch.actuator >= 0 ? -system.measures().sign(report.physical.branch.actuator) : 1;
  std::sort(points.begin(), points.end(),
            [way](const auto& a, const auto& b) { return way * a.measure < way * b.measure; });
}

void tell_snap(double move_mm, double from, SolveReport& report) {
  if (move_mm <= report.physical.snapped_mm) return;
  report.physical.snapped_mm = move_mm;
  report.physical.snapped_from = from;
}

}  // namespace softkin::physical
