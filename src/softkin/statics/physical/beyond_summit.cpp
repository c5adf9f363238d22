#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/continuation.hpp>
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
Continuation::Passed Continuation::go_along(Index a, double way, double end, double longest, const Demand& to,
                                            Measured& last, std::optional<Measured>& next) {
  const double asked = to.actuation[a];
  const bool below = last.load < asked;
  double length = std::min(first_beyond * last.measure, longest);
  std::optional<Measured> before;
  int missed = 0;
  for (int i = 0; i < most_steps_beyond && report_.iterations < max_iterations_; ++i) {
    const double left = way * (end - last.measure);
    if (!(left > 1e-9 * std::abs(end))) return Passed::end;
    const double there = length > 0.9 * left ? end : last.measure + way * length;
    Search<Measured> step = at_measure(a, there, to, last, false, before ? &*before : nullptr);
    if (step.interrupted) return Passed::interrupted;
    next = std::move(step.found);
    if (!next) {
      length *= 0.4;
      if (length < shortest_beyond * last.measure || ++missed > most_missed_beyond) return Passed::nowhere;
      continue;
    }
    note_branch(a, *next);
    if (below != (next->load < asked)) return Passed::asked;
    length = std::min({growth_beyond * std::abs(there - last.measure), most_beyond * next->measure, longest});
    before = std::exchange(last, std::move(*next));
  }
  return Passed::nowhere;
}

/// The equilibrium under the load that is asked, between two at which it is less and more.
Continuation::Climb Continuation::arrive_between(Index a, const Demand& to, Measured low, Measured high, Iterate& at) {
  const double asked = to.actuation[a];
  const double reach = near_load * std::max(std::abs(low.load), std::abs(high.load));
  double low_miss = low.load - asked, high_miss = high.load - asked;  // as the false position weighs them
  for (int i = 0; i < most_halvings && std::abs(high.load - asked) > reach; ++i) {
    const double share = std::clamp(low_miss / (low_miss - high_miss), 0.05, 0.95);
    auto [middle, interrupted] =
        at_measure(a, low.measure + share * (high.measure - low.measure), to, low, false, &high);
    if (interrupted) return Climb::interrupted;
    if (!middle) return Climb::lost;
    note_branch(a, *middle);
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
  return arrive_at(to, high, at, Newton::Policy::follow);
}

/// On the far side of a maximum, to where the load is as asked again, or to the measure that is asked for.
Continuation::Climb Continuation::go_beyond(Index a, double way, const Demand& from, const Demand& to,
                                            const Measured& summit, Iterate& at) {
  const double end = beyond_ > 0 ? beyond_ : way > 0 ? far_beyond * summit.measure : summit.measure / far_beyond;
  if (!(way * (end - summit.measure) > 0)) {
    report_.remark += "; " + measure_text(a, end) + " is not beyond it";
    return Climb::lost;
  }
  const double longest =
      beyond_ > 0 ? std::abs(end - summit.measure) / points_beyond : std::numeric_limits<double>::infinity();
  Measured last = summit;
  std::optional<Measured> next;
  const Passed passed = go_along(a, way, end, longest, to, last, next);
  if (passed == Passed::interrupted) {
    keep(a, from, to, last, at);
    return Climb::interrupted;
  }
  if (passed == Passed::asked) {
    const Climb arrived = arrive_between(a, to, std::move(last), std::move(*next), at);
    if (arrived == Climb::interrupted) keep(a, from, to, summit, at);
    if (arrived == Climb::arrived) {
      tell_snap(system_.largest_move(summit.at.positions, at.positions), whole(share_of(a, from, to, summit.load)));
      report_.remark.clear();
    }
    return arrived;
  }
  if (!(beyond_ > 0)) {
    report_.remark += "; no shape up to " + measure_text(a, last.measure) + " carries as much again";
    return Climb::lost;
  }
  if (last.measure == summit.measure) return Climb::lost;
  tell_beyond(a, last, passed == Passed::end);
  keep(a, from, to, last, at);
  report_.unstable_modes = std::max(0, prepare(way_.here, at));
  return Climb::summit;
}

/// From a shape beyond a maximum, along what the load does to where it is as asked; lost: it is not beyond one.
Continuation::Climb Continuation::go_back(Index a, const Demand& from, const Demand& to, Iterate& at) {
  const double begin = system_.measures().value(a, at.positions) / system_.measures().rest(a);
  Measured last{begin, from.actuation[a], at, last_, 0, from.share};
  last.at.multipliers[a] = system_.measures().given(a, last.load);
  const double slope = slope_at(a, from, last),
               grows = -system_.measures().sign(a);  // the load with the measure, at rest
  if (!std::isfinite(slope) || slope * grows >= 0) return Climb::lost;
  const double way = to.actuation[a] > from.actuation[a] ? -grows : grows;
  const double end = way == grows ? beyond_ : 1;
  report_.branch = {};
  note_branch(a, last);
  std::optional<Measured> next;
  const Passed passed = go_along(a, way, end, most_beyond * begin, to, last, next);
  Climb arrived = Climb::lost;
  if (passed == Passed::interrupted) {
    keep(a, from, to, last, at);
    return Climb::interrupted;
  }
  if (passed == Passed::asked) arrived = arrive_between(a, to, std::move(last), std::move(*next), at);
  if (arrived == Climb::arrived) report_.remark.clear();
  return arrived;
}

void Continuation::note_branch(Index a, const Measured& point) {
  report_.branch.actuator = a;
  report_.branch.points.push_back({point.measure, point.load});
}

/// In the order of the measure; nothing where the way did not go along it.
void Continuation::sort_branch() {
  auto& points = report_.branch.points;
  const double way = report_.branch.actuator >= 0 ? -system_.measures().sign(report_.branch.actuator) : 1;
  std::sort(points.begin(), points.end(),
            [way](const auto& a, const auto& b) { return way * a.measure < way * b.measure; });
}

/// "3.01 times its volume", "0.7 of its length"
std::string Continuation::measure_text(Index a, double measure) const {
  return number(measure, 4) + (system_.model().actuators[a].is<CableDrive>() ? " of its length" : " times its volume");
}

std::string Continuation::load_text(Index a, double load) const {
  return number(load, 5) + (system_.model().actuators[a].is<CableDrive>() ? " N" : " kPa");
}

void Continuation::tell_beyond(Index a, const Measured& last, bool asked) {
  report_.remark += "; beyond it, at " + measure_text(a, last.measure) + ", it is " + load_text(a, last.load);
  if (!asked) report_.remark += ", and no equilibrium follows there";
}

}  // namespace softkin::physical
