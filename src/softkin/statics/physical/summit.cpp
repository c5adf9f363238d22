#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/summit.hpp>

namespace softkin::physical {

namespace {

/// First step over the measure at hand, how steps grow, their bounds, and how many there may be.
constexpr double first_step = 0.02, growth = 1.6, first_growth = 0.5, most_growth = 0.6, shortest_step = 1e-5;
constexpr int most_steps = 200, most_missed = 6;
/// The load is at its maximum where its relative change is this share of its measure's.
constexpr double flat = 0.01;
/// Of two points with a maximum between them, that it is at least away from either.
constexpr double margin = 0.05;
/// Slopes fall less and less: the maximum is looked for so many times as far as the last two tell.
constexpr double ahead = 1.5;
/// The shape that is kept stands so far before the maximum, over the way from where the search began: at it the
/// stiffness is singular.
constexpr double before_summit = 0.01;
/// What leads on to the maximum may be so many times as far from its equilibrium as what is kept.
constexpr double on_the_way = 6000;
/// A step along the measure that passed the load after this share of it led near enough.
constexpr double whole_step = 0.9;

}  // namespace

Climb::Climb(Settler& settler, StepTracer& tracer, const Equilibria::Options& options, const Route& route)
    : Follower(settler, tracer, options), route_(route), load_(route.load) {}

/// The equilibrium at which the load's actuator has so large a measure, over that at rest; none where there is none, or
/// an unstable one.
///
/// prepared  the workspace is as slope_at(from) left it
/// beside    another equilibrium, by which the prediction bends
Search<Climb::Measured> Climb::at_measure(double measure, const Measured& from, bool prepared, const Measured* beside) {
  if (!prepared && !settler_.newton().goes_on()) return {.interrupted = true};
  Demand here = route_.to, there = route_.to;
  here.actuation[load_] = from.measure;
  here.share = from.share;
  there.actuation[load_] = measure;
  settler_.active[load_] = true;
  settler_.good_shape = from.at.positions;
  Search<Measured> search;
  std::optional<Measured>& found = search.found;
  if (prepared || settler_.prepare(here, from.at) >= 0) {
    Iterate trial = from.at;
    tracer_.begin(from.measure, measure, std::abs(measure - from.measure), system_.model().actuators[load_].name);
    const ClearPrediction prediction = predict_clear(system_, here, there, settler_.active, work_, team_, trial);
    const bool clear = prediction.move_mm.has_value();
    if (clear && beside && beside->share == there.share) bend(here, there, from, *beside, trial);
    const Points begun = trial.positions;
    const auto outcome = clear ? settler_.settle(there, Newton::Policy::descend, trial) : Newton::Outcome::stuck;
    search.interrupted = outcome == Newton::Outcome::interrupted;
    if (outcome == Newton::Outcome::converged && (!settler_.newton().inverted() || settler_.last.inverted)) {
      slide_friction(system_, trial, work_, team_);
      found = Measured{measure,
                       system_.measures().command(load_, trial.multipliers[load_]),
                       std::move(trial),
                       settler_.judged(),
                       0,
                       there.share};
    }
    const Points& end = found ? found->at.positions : begun;
    tracer_.end(found.has_value(),
                found                                   ? ""
                : !clear                                ? "something is in the way"
                : outcome == Newton::Outcome::unstable  ? "it is unstable"
                : outcome == Newton::Outcome::converged ? "an element is inverted"
                                                        : settler_.newton().why_stuck(),
                system_.largest_move(from.at.positions, prediction.predicted), system_.largest_move(begun, end));
  }
  settler_.active[load_] = false;
  return search;
}

/// The same, as near to its equilibrium as what only leads on is to be.
Search<Climb::Measured> Climb::nearly_at(double measure, const Measured& from, bool prepared, const Measured* beside) {
  const auto loosely = settler_.newton().loosely(on_the_way);
  return at_measure(measure, from, prepared, beside);
}

/// Adds to a first-order prediction what one back to another equilibrium misses, which grows with the square of the
/// way.
void Climb::bend(const Demand& here, const Demand& there, const Measured& from, const Measured& beside,
                 Iterate& trial) {
  constexpr double farthest = 3, most = 0.5;  // over the way back, and of the first order
  const double ratio = (there.actuation[load_] - from.measure) / (from.measure - beside.measure);
  if (system_.contact() || here.share != there.share || !(std::abs(ratio) < farthest)) return;
  Demand behind = here;
  behind.actuation[load_] = beside.measure;
  Iterate back = from.at;
  (void)predict(system_, here, behind, settler_.active, work_, team_, back);
  const Points miss = ratio * ratio * (beside.at.positions - back.positions);
  if (!(miss.rowwise().norm().maxCoeff() < most * system_.largest_move(from.at.positions, trial.positions))) return;
  trial.positions += miss;
  system_.placement().hold(there, trial.positions);
  trial.multipliers += ratio * ratio * (beside.at.multipliers - back.multipliers);
}

/// How far it is from the last point to where the slope of the load is zero, by a line through the last two, or by the
/// measure as a parabola of the slope, which falls less and less, through three. Infinite where it does not fall.
double Climb::left_to_summit(double way, const Measured* beside, const Measured& low, const Measured& next) {
  const double fell = low.gain - next.gain, went = way * (next.measure - low.measure);
  if (!(fell > 0)) return std::numeric_limits<double>::infinity();
  const double line = went * next.gain / fell;
  if (!beside || beside->gain == low.gain || beside->gain == next.gain) return line;
  const std::array<const Measured*, 3> at{beside, &low, &next};
  double curve = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    double term = way * (at[i]->measure - next.measure);
    for (std::size_t j = 0; j < 3; ++j)
      if (j != i) term *= at[j]->gain / (at[j]->gain - at[i]->gain);
    curve += term;
  }
  return curve / line > 0.3 && curve / line < 3 ? curve : line;
}

/// Change of the load by the measure; NaN where it is not known.
double Climb::slope_at(const Demand& load, const Measured& point) {
  Demand here = load, there = load;
  here.actuation[load_] = point.measure;
  there.actuation[load_] = (1 + first_step) * point.measure;
  here.share = there.share = point.share;
  settler_.active[load_] = true;
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  double slope = std::numeric_limits<double>::quiet_NaN();
  if (settler_.prepare(here, point.at) >= 0) {
    Iterate beside = point.at;
    (void)predict(system_, here, there, settler_.active, work_, team_, beside);
    slope = (beside.multipliers[load_] - point.at.multipliers[load_]) / system_.measures().rate(load_, point.load) /
            (first_step * point.measure);
  }
  settler_.active[load_] = false;
  return slope;
}

bool Climb::at_maximum(const Measured& point) {
  return std::abs(point.gain) * point.measure < flat * std::abs(point.load);
}

/// An ascent where it begins.
Climb::Ascent Climb::ascent_from(const Iterate& at) {
  Ascent ascent;
  ascent.up = asked_load() > route_.here.actuation[load_] ? 1 : -1;  // a chamber grows with its pressure, a cable
  ascent.way = -ascent.up * system_.measures().sign(load_);          // shortens with its tension
  ascent.begin = system_.measures().value(load_, at.positions) / system_.measures().rest(load_);
  ascent.length = first_step * ascent.begin;
  ascent.low = {ascent.begin, route_.here.actuation[load_], at, settler_.last, 0, route_.here.share};
  ascent.low.at.multipliers[load_] = system_.measures().given(load_, ascent.low.load);
  ascent.low.gain = ascent.up * ascent.way * slope_at(route_.here, ascent.low);
  return ascent;
}

/// Goes on from a point that is not yet at the maximum, or before it from one beyond it; chooses the next step.
void Climb::Ascent::take(Measured&& next) {
  const double went = way * (next.measure - low.measure), left = next.short_of;
  if (next.gain < 0) {
    high = std::move(next);
    length = std::clamp(went + left, margin * went, (1 - margin) * went);
    return;
  }
  const bool by_three = beside() != nullptr;
  passed = std::move(low);
  low = std::move(next);
  length = std::min({growth * went, most_growth * low.measure, by_three ? left : ahead * left});
  if (high) length = std::min(length, (1 - margin) * way * (high->measure - low.measure));
}

Climb::End Climb::up(Iterate& at) {
  Ascent ascent = ascent_from(at);
  const double up = ascent.up, way = ascent.way, begin = ascent.begin;
  const Measured& low = ascent.low;
  if (!std::isfinite(low.gain)) return End::lost;
  report_.physical.branch = {};
  note_branch(low);
  const bool may_stand_there = at_maximum(low);
  if (low.gain < 0 && !may_stand_there) return End::lost;
  if (!may_stand_there)
    ascent.length = std::clamp(up * (asked_load() - low.load) / low.gain, ascent.length, first_growth * begin);
  const auto passes = [&](const Measured& point) { return up * (point.load - asked_load()) >= 0; };
  const auto keep_where_stopped = [&](End end) {
    if (end == End::interrupted) keep(low, at);
    return end;
  };
  bool prepared = true;
  for (int i = 0, missed = 0; i < most_steps && ascent.length > shortest_step * begin; ++i) {
    auto [next, interrupted] = nearly_at(low.measure + way * ascent.length, low, prepared, ascent.beside());
    if (interrupted) return keep_where_stopped(End::interrupted);
    prepared = false;
    if (!next) {
      ascent.length *= 0.4;
      if (++missed > most_missed) break;
      continue;
    }
    note_branch(*next);
    if (passes(*next)) return keep_where_stopped(arrive_before(std::move(*next), ascent, at));
    next->gain = up * way * slope_at(route_.here, *next);
    if (!std::isfinite(next->gain)) return End::lost;
    if (may_stand_there && i == 0 && next->gain < 0) return stop_at(way, begin, low, at);
    next->short_of = left_to_summit(way, ascent.beside(), low, *next);
    if (at_maximum(*next) && !(may_stand_there && next->gain > low.gain)) {
      const Search<Measured> top = exactly(std::move(*next));
      if (top.interrupted) return keep_where_stopped(End::interrupted);
      return passes(*top.found) ? keep_where_stopped(arrive_at(*top.found, at, Newton::Policy::descend))
                                : stop_at(way, begin, *top.found, at);
    }
    prepared = next->gain >= 0;
    ascent.take(std::move(*next));
    if (prepared) report_.reached = route_.whole(share_of(low.load));
  }
  if (low.measure == begin) return End::lost;
  const Search<Measured> last = exactly(low);
  keep(last.found ? *last.found : low, at);  // and loads go on from there
  return last.interrupted ? End::interrupted : End::lost;
}

/// The equilibrium under the load that is asked, before a point that has passed it: from where a parabola of the load
/// has it, as Newton's method under loads takes many iterations from as far as a step along the measure.
Climb::End Climb::arrive_before(Measured next, const Ascent& ascent, Iterate& at) {
  const Measured& low = ascent.low;
  const double went = ascent.way * (next.measure - low.measure), rose = ascent.up * (next.load - low.load);
  const double asked = ascent.up * (asked_load() - low.load), bends = (rose - low.gain * went) / (went * went);
  const double share = 2 * asked / (low.gain + std::sqrt(low.gain * low.gain + 4 * bends * asked)) / went;
  if (share < whole_step) {
    const bool from_low = share < 0.5;
    const Measured &from = from_low ? low : next, &beside = from_low ? next : low;
    auto [nearer, interrupted] = nearly_at(low.measure + share * (next.measure - low.measure), from, false, &beside);
    if (interrupted) return End::interrupted;
    if (nearer) {
      note_branch(*nearer);
      next = std::move(*nearer);
    }
  }
  return arrive_at(next, at, Newton::Policy::descend);
}

/// policy: follow where it may be unstable under its load
Climb::End Climb::arrive_at(const Measured& near, Iterate& at, Newton::Policy policy) {
  Iterate trial = near.at;
  for (Index a = 0; a < system_.actuators(); ++a)
    if (system_.measures().given_load(a)) trial.multipliers[a] = system_.measures().given(a, route_.to.actuation[a]);
  const auto outcome = settler_.settle(route_.to, policy, trial);
  if (outcome == Newton::Outcome::interrupted) return End::interrupted;
  const bool found = outcome == Newton::Outcome::converged ||
                     (policy == Newton::Policy::follow && outcome == Newton::Outcome::unstable);
  if (!found || (settler_.newton().inverted() && !settler_.last.inverted)) return End::lost;
  settler_.take(at, std::move(trial));
  settler_.last = settler_.judged();
  ++report_.continuation_steps;
  route_.here = route_.to;
  report_.reached = 1;
  return End::arrived;
}

Climb::End Climb::stop_at(double way, double begin, const Measured& summit, Iterate& at) {
  tell_summit(summit);
  at_summit_ = true;
  if (options_.beyond > 0 || options_.stable) {
    const End end = go_beyond(way, summit, at);
    if (end != End::lost) return end;
  }
  if (summit.measure == begin) return End::summit;
  const double before = before_summit * std::abs(summit.measure - begin);
  if (summit.short_of > 0.1 * before) {
    keep(summit, at);
    return End::summit;
  }
  const Temporarily twice(work_.saddle.precision(),
                          linear::MixedLdlt::Precision::twice);  // so short a step is near what rounding hides
  const auto [kept, interrupted] = at_measure(summit.measure - way * before, summit, false, nullptr);
  if (interrupted) {
    keep(summit, at);
    return End::interrupted;
  }
  if (!kept) return End::lost;
  keep(*kept, at);
  return End::summit;
}

/// The equilibrium at a measure is that under its load.
void Climb::keep(const Measured& kept, Iterate& at) {
  at = kept.at;
  settler_.last = kept.last;
  ++report_.continuation_steps;
  route_.here.actuation[load_] = kept.load;
  route_.here.share = kept.share;
  route_.done = share_of(kept.load);
  report_.reached = route_.whole(route_.done);
}

/// What was found on the way as near to its equilibrium as is asked for; as it is where that leads nowhere.
Search<Climb::Measured> Climb::exactly(Measured found) {
  Search<Measured> exact = at_measure(found.measure, found, false, nullptr);
  if (exact.found) {
    exact.found->gain = found.gain;
    exact.found->short_of = found.short_of;
  } else if (!exact.interrupted) {
    exact.found = std::move(found);
  }
  return exact;
}

/// Of the way from one load to another; beyond a maximum it may have fallen below the first.
double Climb::share_of(double load) const {
  return std::clamp((load - first_load()) / (asked_load() - first_load()), 0.0, 1.0);
}

void Climb::tell_summit(const Measured& summit) {
  const Actuator& actuator = system_.model().actuators[load_];
  const bool cable = actuator.is<CableDrive>();
  report_.remark = std::string(cable ? "the tension of cable '" : "the pressure of chamber '") + actuator.name +
                   "' has its " + (asked_load() > first_load() ? "maximum" : "minimum") + " there, " +
                   load_text(summit.load) + " at " + measure_text(summit.measure);
  if (options_.beyond > 0) return;
  report_.remark += std::string("; command its ") + (cable ? "length (control: length)" : "volume (control: volume)") +
                    " to go on beyond it";
}

}  // namespace softkin::physical
