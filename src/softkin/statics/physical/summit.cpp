#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/continuation.hpp>

namespace softkin::physical {

namespace {

/// First step over the measure at hand, how it grows, its bounds, and how many there may be.
constexpr double first_step = 0.02, growth = 1.6, most_growth = 0.3, shortest_step = 1e-5;
constexpr int most_steps = 200;
/// A maximum is looked for until it gains less than this share.
constexpr double precise = 1e-6;
constexpr int most_refinements = 8;
/// The shape that is kept stands so far before the maximum, over the way from where the search began: at it the
/// stiffness is singular.
constexpr double before_summit = 0.01;

/// Where the parabola through three points has its vertex, within the outer two.
double vertex_of(double x0, double y0, double x1, double y1, double x2, double y2) {
  const double a = (x1 - x0) * (y1 - y2), b = (x1 - x2) * (y1 - y0);
  const double vertex = a != b ? x1 - 0.5 * ((x1 - x0) * a - (x1 - x2) * b) / (a - b) : x1;
  const double low = std::min(x0, x2), high = std::max(x0, x2), margin = 0.05 * (high - low);
  return std::clamp(vertex, low + margin, high - margin);
}

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
std::optional<Continuation::Measured> Continuation::at_measure(Index a, double measure, const Demand& load,
                                                               const Measured& from) {
  Demand here = load, there = load;
  here.actuation[a] = from.measure;
  there.actuation[a] = measure;
  active_[a] = true;
  from_ = from.at.positions;
  std::optional<Measured> found;
  if (prepare(here, from.at) >= 0) {
    Iterate trial = from.at;
    const bool clear = predict_clear(system_, here, there, active_, work_, team_, trial, predicted_).has_value();
    const auto outcome = clear ? settle(there, Newton::Policy::descend, trial) : Newton::Outcome::stuck;
    interrupted_ = outcome == Newton::Outcome::interrupted;
    if (outcome == Newton::Outcome::converged && (!newton_.inverted() || last_.inverted)) {
      system_.slide_friction(trial, work_, team_);
      found = Measured{measure, trial.multipliers[a] / system_.unit(a), std::move(trial), judged()};
    }
  }
  active_[a] = false;
  return found;
}

/// Riks' idea with the load's own measure as the parameter: a maximum of the load is no end of the way along the volume
/// or the length.
Continuation::Climb Continuation::climb(Index a, const Demand& from, const Demand& here, const Demand& to,
                                        Iterate& at) {
  const double up = to.actuation[a] > here.actuation[a] ? 1 : -1;  // a chamber grows with its pressure, a cable
  const double way = -up * system_.sign(a);                        // shortens with its tension
  const double begin = system_.measures().value(a, at.positions) / system_.measures().rest(a);
  const auto beyond = [&](const Measured& point) { return up * (point.load - to.actuation[a]) >= 0; };
  Measured last{begin, here.actuation[a], at, last_};
  std::optional<Measured> before;
  double length = first_step * begin;
  for (int i = 0; i < most_steps && length > shortest_step * begin; ++i) {
    if (report_.iterations >= max_iterations_) return Climb::lost;
    std::optional<Measured> next = at_measure(a, last.measure + way * length, here, last);
    if (interrupted_) return Climb::interrupted;
    const bool falls = next && up * (next->load - last.load) <= 0;
    if (!next || (falls && !before)) {
      length *= 0.4;
      continue;
    }
    if (falls) {
      if (!refine(a, up, here, *before, last, *next)) return Climb::interrupted;
      if (!beyond(last)) return stop_at(a, way, begin, from, to, last, at);
    }
    if (falls || beyond(*next)) return arrive_at(to, falls ? last : *next, at);
    before = std::exchange(last, std::move(*next));
    length = std::min(growth * length, most_growth * last.measure);
  }
  return interrupted_ ? Climb::interrupted : Climb::lost;
}

/// Narrows a maximum of the load between two points, the best of which is in the middle. False: interrupted.
bool Continuation::refine(Index a, double up, const Demand& load, Measured& low, Measured& middle, Measured& high) {
  for (int i = 0; i < most_refinements; ++i) {
    const double measure =
        vertex_of(low.measure, up * low.load, middle.measure, up * middle.load, high.measure, up * high.load);
    std::optional<Measured> found = at_measure(a, measure, load, middle);
    if (interrupted_) return false;
    if (!found) return true;
    const double gain = up * (found->load - middle.load);
    const bool past = (measure - middle.measure) * (high.measure - middle.measure) > 0;
    if (gain > 0) {
      (past ? low : high) = std::exchange(middle, std::move(*found));
    } else {
      (past ? high : low) = std::move(*found);
    }
    if (std::abs(gain) < precise * std::abs(middle.load)) return true;
  }
  return true;
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
  report_.reached = 1;
  return Climb::arrived;
}

Continuation::Climb Continuation::stop_at(Index a, double way, double begin, const Demand& from, const Demand& to,
                                          const Measured& summit, Iterate& at) {
  Demand load = from;
  const std::optional<Measured> kept =
      at_measure(a, summit.measure - way * before_summit * std::abs(summit.measure - begin), load, summit);
  if (interrupted_) return Climb::interrupted;
  if (!kept) return Climb::lost;
  at = kept->at;
  last_ = kept->last;
  ++report_.continuation_steps;
  report_.reached = (kept->load - from.actuation[a]) / (to.actuation[a] - from.actuation[a]);
  const Actuator& actuator = system_.model().actuators[a];
  const bool cable = actuator.kind == ActuatorKind::cable;
  report_.remark = std::string(cable ? "the tension of cable '" : "the pressure of chamber '") + actuator.name +
                   "' has its " + (to.actuation[a] > from.actuation[a] ? "maximum" : "minimum") + " there, " +
                   number(summit.load, 5) + (cable ? " N at " : " kPa at ") + number(summit.measure, 4) +
                   (cable ? " of its length" : " times its volume") + "; command its " +
                   (cable ? "length (control: length)" : "volume (control: volume)") + " to go on beyond it";
  return Climb::summit;
}

}  // namespace softkin::physical
