#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/continuation.hpp>

namespace softkin::physical {

namespace {

/// First step over the measure at hand, how steps grow, their bounds, and how many there may be.
constexpr double first_step = 0.02, growth = 1.6, most_growth = 0.5, shortest_step = 1e-5;
constexpr int most_steps = 200;
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

/// The one load that changes where nothing else does; -1: none.
Index Continuation::only_load(const Demand& from, const Demand& to) const {
  const Model& model = system_.model();
  if (from.fading != to.fading) return -1;
  if (from.share != to.share && (system_.any_dead_load() || system_.prestretched() || model.held != model.rest))
    return -1;
  Index found = -1;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (from.actuation[a] == to.actuation[a]) continue;
    if (found >= 0 || system_.constrains(a) || !system_.measures().measures(a)) return -1;
    found = a;
  }
  return found;
}

/// The equilibrium at which the load's actuator has so large a measure, over that at rest; none where there is none, or
/// an unstable one.
///
/// prepared  the workspace is as slope_at(from) left it
std::optional<Continuation::Measured> Continuation::at_measure(Index a, double measure, const Demand& load,
                                                               const Measured& from, bool prepared) {
  Demand here = load, there = load;
  here.actuation[a] = from.measure;
  there.actuation[a] = measure;
  active_[a] = true;
  from_ = from.at.positions;
  std::optional<Measured> found;
  if (prepared || prepare(here, from.at) >= 0) {
    Iterate trial = from.at;
    tracer_.begin(from.measure, measure, std::abs(measure - from.measure), system_.model().actuators[a].name);
    const bool clear = predict_clear(system_, here, there, active_, work_, team_, trial, predicted_).has_value();
    const Points begun = trial.positions;
    const auto outcome = clear ? settle(there, Newton::Policy::descend, trial) : Newton::Outcome::stuck;
    interrupted_ = outcome == Newton::Outcome::interrupted;
    if (outcome == Newton::Outcome::converged && (!newton_.inverted() || last_.inverted)) {
      system_.slide_friction(trial, work_, team_);
      found = Measured{measure, trial.multipliers[a] / system_.unit(a), std::move(trial), judged()};
    }
    const Points& end = found ? found->at.positions : begun;
    tracer_.end(found.has_value(),
                found                                   ? ""
                : !clear                                ? "something is in the way"
                : outcome == Newton::Outcome::unstable  ? "it is unstable"
                : outcome == Newton::Outcome::converged ? "an element is inverted"
                                                        : newton_.why_stuck(),
                largest_move(from.at.positions, predicted_), largest_move(begun, end));
  }
  active_[a] = false;
  return found;
}

/// Change of the load by the measure; NaN where it is not known.
double Continuation::slope_at(Index a, const Demand& load, const Measured& point) {
  Demand here = load, there = load;
  here.actuation[a] = point.measure;
  there.actuation[a] = (1 + first_step) * point.measure;
  active_[a] = true;
  const InPrecision twice(work_, linear::MixedLdlt::Precision::twice);
  double slope = std::numeric_limits<double>::quiet_NaN();
  if (prepare(here, point.at) >= 0) {
    Iterate beside = point.at;
    (void)predict(system_, here, there, active_, work_, team_, beside);
    slope = (beside.multipliers[a] - point.at.multipliers[a]) / system_.unit(a) / (first_step * point.measure);
  }
  active_[a] = false;
  return slope;
}

/// Riks' idea with the load's own measure as the parameter: a maximum of the load is no end of the way along the volume
/// or the length. Where the load's slope by the measure is zero it is at its maximum.
Continuation::Climb Continuation::climb(Index a, const Demand& from, const Demand& here, const Demand& to,
                                        Iterate& at) {
  const double up = to.actuation[a] > here.actuation[a] ? 1 : -1;  // a chamber grows with its pressure, a cable
  const double way = -up * system_.sign(a);                        // shortens with its tension
  const double begin = system_.measures().value(a, at.positions) / system_.measures().rest(a);
  Measured low{begin, here.actuation[a], at, last_};
  low.at.multipliers[a] = system_.unit(a) * low.load;
  const auto gain = [&](const Measured& point) { return up * way * slope_at(a, here, point); };
  const auto at_maximum = [&](const Measured& point) {
    return std::abs(point.gain) * point.measure < flat * std::abs(point.load);
  };
  low.gain = gain(low);
  if (!std::isfinite(low.gain)) return Climb::lost;
  const bool may_stand_there = at_maximum(low);
  if (low.gain < 0 && !may_stand_there) return Climb::lost;
  std::optional<Measured> high;
  double length = first_step * begin;
  if (!may_stand_there) length = std::clamp(up * (to.actuation[a] - low.load) / low.gain, length, most_growth * begin);
  bool prepared = true;
  for (int i = 0; i < most_steps && length > shortest_step * begin; ++i) {
    if (report_.iterations >= max_iterations_) return Climb::lost;
    std::optional<Measured> next = at_measure(a, low.measure + way * length, here, low, prepared);
    if (interrupted_) {
      keep(a, from, to, low, at);
      return Climb::interrupted;
    }
    prepared = false;
    if (!next) {
      length *= 0.4;
      continue;
    }
    if (up * (next->load - to.actuation[a]) >= 0) return arrive_at(to, *next, at);
    next->gain = gain(*next);
    if (!std::isfinite(next->gain)) return Climb::lost;
    if (may_stand_there && i == 0 && next->gain < 0) return stop_at(a, way, begin, from, to, low, at);
    if (at_maximum(*next) && !(may_stand_there && next->gain > low.gain))
      return stop_at(a, way, begin, from, to, *next, at);
    // where the slope would be zero if it went on as between the two
    const double went = way * (next->measure - low.measure), fell = low.gain - next->gain;
    double summit = fell > 0 ? went * low.gain / fell : std::numeric_limits<double>::infinity();  // from low on
    if (next->gain < 0) {
      high = std::move(next);
      length = std::clamp(summit, margin * went, (1 - margin) * went);
      continue;
    }
    summit -= went;
    low = std::move(*next);
    prepared = true;
    length = std::min({growth * went, most_growth * low.measure, ahead * summit});
    if (high) length = std::min(length, (1 - margin) * way * (high->measure - low.measure));
  }
  return Climb::lost;
}

Continuation::Climb Continuation::arrive_at(const Demand& to, const Measured& near, Iterate& at) {
  Iterate trial = near.at;
  for (Index a = 0; a < system_.actuators(); ++a)
    if (system_.given_load(a)) trial.multipliers[a] = system_.unit(a) * to.actuation[a];
  const auto outcome = settle(to, Newton::Policy::descend, trial);
  if (outcome == Newton::Outcome::interrupted) return Climb::interrupted;
  if (outcome != Newton::Outcome::converged || (newton_.inverted() && !last_.inverted)) return Climb::lost;
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
  if (summit.measure == begin) return Climb::summit;
  const std::optional<Measured> kept =
      at_measure(a, summit.measure - way * before_summit * std::abs(summit.measure - begin), from, summit, false);
  if (interrupted_) {
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
  way_.done = (kept.load - from.actuation[a]) / (to.actuation[a] - from.actuation[a]);
  report_.reached = whole(way_.done);
}

void Continuation::tell_summit(Index a, const Demand& from, const Demand& to, const Measured& summit) {
  const Actuator& actuator = system_.model().actuators[a];
  const bool cable = actuator.kind == ActuatorKind::cable;
  report_.remark = std::string(cable ? "the tension of cable '" : "the pressure of chamber '") + actuator.name +
                   "' has its " + (to.actuation[a] > from.actuation[a] ? "maximum" : "minimum") + " there, " +
                   number(summit.load, 5) + (cable ? " N at " : " kPa at ") + number(summit.measure, 4) +
                   (cable ? " of its length" : " times its volume") + "; command its " +
                   (cable ? "length (control: length)" : "volume (control: volume)") + " to go on beyond it";
}

}  // namespace softkin::physical
