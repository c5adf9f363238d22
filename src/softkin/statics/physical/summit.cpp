#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>

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

}  // namespace

/// The one load that changes, where nothing else does but weights and forces; -1: none.
Index Continuation::only_load(const Demand& from, const Demand& to) const {
  const Model& model = system_.model();
  if (from.fading != to.fading) return -1;
  if (from.share != to.share && (system_.prestretched() || model.held != model.rest || !model.turns.empty())) return -1;
  Index found = -1;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (from.actuation[a] == to.actuation[a]) continue;
    if (found >= 0 || system_.measures().constrains(a) || !system_.measures().measures(a)) return -1;
    found = a;
  }
  return found;
}

/// Does the load that alone changes do so much, by the slope of what it does, that it is better climbed along that?
bool Continuation::leads_too_far(const Demand& here, const Demand& there, const Iterate& at) {
  constexpr double share = 0.01, most = 0.4;  // of the way, that the slope is taken on; of the measure
  const Index a = way_.load;
  if (a < 0 || system_.contact()) return false;
  Iterate near = at;
  (void)predict(system_, here, between(here, there, share), active_, work_, team_, near);
  const double before = system_.measures().value(a, at.positions);
  const double change = (system_.measures().value(a, near.positions) - before) / share;
  return !(change < most * before && change > -0.5 * most * before);
}

/// The equilibrium at which the load's actuator has so large a measure, over that at rest; none where there is none, or
/// an unstable one.
///
/// prepared  the workspace is as slope_at(from) left it
/// beside    another equilibrium, by which the prediction bends
Continuation::Search<Continuation::Measured> Continuation::at_measure(Index a, double measure, const Demand& load,
                                                                      const Measured& from, bool prepared,
                                                                      const Measured* beside) {
  Demand here = load, there = load;
  here.actuation[a] = from.measure;
  here.share = from.share;
  there.actuation[a] = measure;
  active_[a] = true;
  from_ = from.at.positions;
  Search<Measured> search;
  std::optional<Measured>& found = search.found;
  if (prepared || prepare(here, from.at) >= 0) {
    Iterate trial = from.at;
    tracer_.begin(from.measure, measure, std::abs(measure - from.measure), system_.model().actuators[a].name);
    const ClearPrediction prediction = predict_clear(system_, here, there, active_, work_, team_, trial);
    const bool clear = prediction.move_mm.has_value();
    predicted_ = prediction.predicted;
    if (clear && beside && beside->share == there.share) bend(a, here, there, from, *beside, trial);
    const Points begun = trial.positions;
    const auto outcome = clear ? settle(there, Newton::Policy::descend, trial) : Newton::Outcome::stuck;
    search.interrupted = outcome == Newton::Outcome::interrupted;
    if (outcome == Newton::Outcome::converged && (!newton_.inverted() || last_.inverted)) {
      slide_friction(system_, trial, work_, team_);
      found = Measured{measure,    system_.measures().command(a, trial.multipliers[a]), std::move(trial), judged(), 0,
                       there.share};
    }
    const Points& end = found ? found->at.positions : begun;
    tracer_.end(found.has_value(),
                found                                   ? ""
                : !clear                                ? "something is in the way"
                : outcome == Newton::Outcome::unstable  ? "it is unstable"
                : outcome == Newton::Outcome::converged ? "an element is inverted"
                                                        : newton_.why_stuck(),
                system_.largest_move(from.at.positions, predicted_), system_.largest_move(begun, end));
  }
  active_[a] = false;
  return search;
}

/// Adds to a first-order prediction what one back to another equilibrium misses, which grows with the square of the
/// way.
void Continuation::bend(Index a, const Demand& here, const Demand& there, const Measured& from, const Measured& beside,
                        Iterate& trial) {
  constexpr double farthest = 3, most = 0.5;  // over the way back, and of the first order
  const double ratio = (there.actuation[a] - from.measure) / (from.measure - beside.measure);
  if (system_.contact() || here.share != there.share || !(std::abs(ratio) < farthest)) return;
  Demand behind = here;
  behind.actuation[a] = beside.measure;
  Iterate back = from.at;
  (void)predict(system_, here, behind, active_, work_, team_, back);
  const Points miss = ratio * ratio * (beside.at.positions - back.positions);
  if (!(miss.rowwise().norm().maxCoeff() < most * system_.largest_move(from.at.positions, trial.positions))) return;
  trial.positions += miss;
  system_.placement().hold(there, trial.positions);
  trial.multipliers += ratio * ratio * (beside.at.multipliers - back.multipliers);
}

/// How far it is from the last point to where the slope of the load is zero, by a line through the last two, or by the
/// measure as a parabola of the slope, which falls less and less, through three. Infinite where it does not fall.
double Continuation::left_to_summit(double way, const Measured* beside, const Measured& low, const Measured& next) {
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
double Continuation::slope_at(Index a, const Demand& load, const Measured& point) {
  Demand here = load, there = load;
  here.actuation[a] = point.measure;
  there.actuation[a] = (1 + first_step) * point.measure;
  here.share = there.share = point.share;
  active_[a] = true;
  const InPrecision twice(work_.saddle, linear::MixedLdlt::Precision::twice);
  double slope = std::numeric_limits<double>::quiet_NaN();
  if (prepare(here, point.at) >= 0) {
    Iterate beside = point.at;
    (void)predict(system_, here, there, active_, work_, team_, beside);
    slope =
        (beside.multipliers[a] - point.at.multipliers[a]) / system_.measures().rate(a) / (first_step * point.measure);
  }
  active_[a] = false;
  return slope;
}

bool Continuation::at_maximum(const Measured& point) {
  return std::abs(point.gain) * point.measure < flat * std::abs(point.load);
}

/// An ascent where it begins.
Continuation::Ascent Continuation::ascent_from(Index a, const Demand& here, const Demand& to, const Iterate& at) {
  Ascent ascent;
  ascent.up = to.actuation[a] > here.actuation[a] ? 1 : -1;  // a chamber grows with its pressure, a cable
  ascent.way = -ascent.up * system_.measures().sign(a);      // shortens with its tension
  ascent.begin = system_.measures().value(a, at.positions) / system_.measures().rest(a);
  ascent.length = first_step * ascent.begin;
  ascent.low = {ascent.begin, here.actuation[a], at, last_, 0, here.share};
  ascent.low.at.multipliers[a] = system_.measures().given(a, ascent.low.load);
  ascent.low.gain = ascent.up * ascent.way * slope_at(a, here, ascent.low);
  return ascent;
}

/// Goes on from a point that is not yet at the maximum, or before it from one beyond it; chooses the next step.
void Continuation::Ascent::take(Measured&& next) {
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

/// Riks' idea with the load's own measure as the parameter: a maximum of the load is no end of the way along the volume
/// or the length. Where the load's slope by the measure is zero it is at its maximum.
Continuation::Climb Continuation::climb(Index a, const Demand& from, const Demand& here, const Demand& to,
                                        Iterate& at) {
  Ascent ascent = ascent_from(a, here, to, at);
  const double up = ascent.up, way = ascent.way, begin = ascent.begin;
  const Measured& low = ascent.low;
  if (!std::isfinite(low.gain)) return Climb::lost;
  report_.branch = {};
  note_branch(a, low);
  const bool may_stand_there = at_maximum(low);
  if (low.gain < 0 && !may_stand_there) return Climb::lost;
  if (!may_stand_there)
    ascent.length = std::clamp(up * (to.actuation[a] - low.load) / low.gain, ascent.length, first_growth * begin);
  bool prepared = true;
  int missed = 0;
  for (int i = 0; i < most_steps && ascent.length > shortest_step * begin; ++i) {
    if (report_.iterations >= max_iterations_) return Climb::lost;
    auto [next, interrupted] = at_measure(a, low.measure + way * ascent.length, to, low, prepared, ascent.beside());
    if (interrupted) {
      keep(a, from, to, low, at);
      return Climb::interrupted;
    }
    prepared = false;
    if (!next) {
      ascent.length *= 0.4;
      if (++missed > most_missed) break;
      continue;
    }
    note_branch(a, *next);
    if (up * (next->load - to.actuation[a]) >= 0) {
      const Climb end = arrive_at(to, *next, at, Newton::Policy::descend);
      if (end == Climb::interrupted) keep(a, from, to, low, at);
      return end;
    }
    next->gain = up * way * slope_at(a, here, *next);
    if (!std::isfinite(next->gain)) return Climb::lost;
    if (may_stand_there && i == 0 && next->gain < 0) return stop_at(a, way, begin, from, to, low, at);
    next->short_of = left_to_summit(way, ascent.beside(), low, *next);
    if (at_maximum(*next) && !(may_stand_there && next->gain > low.gain))
      return stop_at(a, way, begin, from, to, *next, at);
    prepared = next->gain >= 0;
    ascent.take(std::move(*next));
    if (prepared) report_.reached = whole(share_of(a, from, to, low.load));
  }
  if (low.measure != begin) keep(a, from, to, low, at);  // and loads go on from there
  return Climb::lost;
}

/// policy: follow where it may be unstable under its load
Continuation::Climb Continuation::arrive_at(const Demand& to, const Measured& near, Iterate& at,
                                            Newton::Policy policy) {
  Iterate trial = near.at;
  for (Index a = 0; a < system_.actuators(); ++a)
    if (system_.measures().given_load(a)) trial.multipliers[a] = system_.measures().given(a, to.actuation[a]);
  const auto outcome = settle(to, policy, trial);
  if (outcome == Newton::Outcome::interrupted) return Climb::interrupted;
  const bool found = outcome == Newton::Outcome::converged ||
                     (policy == Newton::Policy::follow && outcome == Newton::Outcome::unstable);
  if (!found || (newton_.inverted() && !last_.inverted)) return Climb::lost;
  take(at, std::move(trial));
  last_ = judged();
  ++report_.continuation_steps;
  way_.here = to;
  report_.reached = 1;
  return Climb::arrived;
}

Continuation::Climb Continuation::stop_at(Index a, double way, double begin, const Demand& from, const Demand& to,
                                          const Measured& summit, Iterate& at) {
  tell_summit(a, from, to, summit);
  at_summit_ = true;
  if (beyond_ > 0 || stable_) {
    const Climb end = go_beyond(a, way, from, to, summit, at);
    if (end != Climb::lost) return end;
  }
  if (summit.measure == begin) return Climb::summit;
  const double before = before_summit * std::abs(summit.measure - begin);
  if (summit.short_of > 0.1 * before) {
    keep(a, from, to, summit, at);
    return Climb::summit;
  }
  const InPrecision twice(work_.saddle,
                          linear::MixedLdlt::Precision::twice);  // so short a step is near what rounding hides
  const auto [kept, interrupted] = at_measure(a, summit.measure - way * before, to, summit, false, nullptr);
  if (interrupted) {
    keep(a, from, to, summit, at);
    return Climb::interrupted;
  }
  if (!kept) return Climb::lost;
  keep(a, from, to, *kept, at);
  return Climb::summit;
}

/// The equilibrium at a measure is that under its load.
void Continuation::keep(Index a, const Demand& from, const Demand& to, const Measured& kept, Iterate& at) {
  at = kept.at;
  last_ = kept.last;
  ++report_.continuation_steps;
  way_.here.actuation[a] = kept.load;
  way_.here.share = kept.share;
  way_.done = share_of(a, from, to, kept.load);
  report_.reached = whole(way_.done);
}

/// Of the way from one load to another; beyond a maximum it may have fallen below the first.
double Continuation::share_of(Index a, const Demand& from, const Demand& to, double load) const {
  return std::clamp((load - from.actuation[a]) / (to.actuation[a] - from.actuation[a]), 0.0, 1.0);
}

void Continuation::tell_summit(Index a, const Demand& from, const Demand& to, const Measured& summit) {
  const Actuator& actuator = system_.model().actuators[a];
  const bool cable = actuator.is<CableDrive>();
  report_.remark = std::string(cable ? "the tension of cable '" : "the pressure of chamber '") + actuator.name +
                   "' has its " + (to.actuation[a] > from.actuation[a] ? "maximum" : "minimum") + " there, " +
                   load_text(a, summit.load) + " at " + measure_text(a, summit.measure);
  if (beyond_ > 0) return;
  report_.remark += std::string("; command its ") + (cable ? "length (control: length)" : "volume (control: volume)") +
                    " to go on beyond it";
}

}  // namespace softkin::physical
