#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/measure_continuation.hpp>

namespace softkin::physical {

MeasureContinuation::MeasureContinuation(Corrector& corrector, StepTracer& tracer, const Equilibria::Options& options,
                                         const Route& route)
    : Follower(corrector, tracer, options), route_(route), load_(route.load) {}

/// Finds the equilibrium at which the load's actuator has a given measure, relative to that at rest; none if there is
/// none or it is unstable.
///
/// prepared  the workspace is as slope_at(from) left it
/// beside    another equilibrium, for a prediction of second order
Search<MeasureContinuation::Measured> MeasureContinuation::at_measure(double measure, const Measured& from,
                                                                      bool prepared, const Measured* beside) {
  if (!prepared && !corrector_.newton().may_continue()) return {.interrupted = true};
  LoadState here = route_.to, there = route_.to;
  here.actuation[load_] = from.measure;
  here.load_factor = from.load_factor;
  there.actuation[load_] = measure;
  corrector_.active[load_] = true;
  corrector_.good_shape = from.at.positions;
  Search<Measured> search;
  std::optional<Measured>& found = search.found;
  if (prepared || corrector_.prepare(here, from.at) >= 0) {
    Iterate trial = from.at;
    tracer_.begin(from.measure, measure, std::abs(measure - from.measure), system_.model().actuators[load_].name);
    const ClearPrediction prediction = predict_clear(system_, here, there, corrector_.active, work_, team_, trial);
    const bool clear = prediction.move_mm.has_value();
    if (clear && beside && beside->load_factor == there.load_factor) bend(here, there, from, *beside, trial);
    const Points begun = trial.positions;
    const auto outcome = clear ? corrector_.correct(there, Newton::Policy::descend, trial) : Newton::Outcome::stuck;
    search.interrupted = outcome == Newton::Outcome::interrupted;
    if (outcome == Newton::Outcome::converged && (!corrector_.newton().inverted() || corrector_.last.inverted)) {
      slide_friction(system_, trial, work_, team_);
      found = Measured{measure,
                       system_.measures().command(load_, trial.multipliers[load_]),
                       std::move(trial),
                       corrector_.judged(),
                       0,
                       there.load_factor};
    }
    const Points& end = found ? found->at.positions : begun;
    tracer_.end(found.has_value(),
                found                                   ? ""
                : !clear                                ? "something is in the way"
                : outcome == Newton::Outcome::unstable  ? "it is unstable"
                : outcome == Newton::Outcome::converged ? "an element is inverted"
                                                        : corrector_.newton().why_stuck(),
                system_.largest_move(from.at.positions, prediction.predicted), system_.largest_move(begun, end));
  }
  corrector_.active[load_] = false;
  return search;
}

/// Does the same with the relaxed tolerance of intermediate equilibria.
Search<MeasureContinuation::Measured> MeasureContinuation::nearly_at(double measure, const Measured& from,
                                                                     bool prepared, const Measured* beside) {
  const auto relaxed = corrector_.newton().with_relaxed_tolerance(tuning_.measure.coarse_tolerance);
  return at_measure(measure, from, prepared, beside);
}

/// Corrects a first-order prediction by the error of one back to another equilibrium, which grows with the square of
/// the distance.
void MeasureContinuation::bend(const LoadState& here, const LoadState& there, const Measured& from,
                               const Measured& beside, Iterate& trial) {
  const double farthest = tuning_.measure.max_extrapolation, most = tuning_.measure.max_second_order;
  const double ratio = (there.actuation[load_] - from.measure) / (from.measure - beside.measure);
  if (system_.contact() || here.load_factor != there.load_factor || !(std::abs(ratio) < farthest)) return;
  LoadState behind = here;
  behind.actuation[load_] = beside.measure;
  Iterate back = from.at;
  (void)predict(system_, here, behind, corrector_.active, work_, team_, back);
  const Points miss = ratio * ratio * (beside.at.positions - back.positions);
  if (!(miss.rowwise().norm().maxCoeff() < most * system_.largest_move(from.at.positions, trial.positions))) return;
  trial.positions += miss;
  system_.placement().hold(there, trial.positions);
  trial.multipliers += ratio * ratio * (beside.at.multipliers - back.multipliers);
}

/// Estimates the distance from the last point to where the slope of the load is zero: by a line through the last two
/// points, or by the measure as a parabola of the slope, which decreases ever more slowly, through three. Infinite
/// where the slope does not decrease.
double MeasureContinuation::left_to_summit(double path, const Measured* beside, const Measured& low,
                                           const Measured& next) {
  const double fell = low.gain - next.gain, went = path * (next.measure - low.measure);
  if (!(fell > 0)) return std::numeric_limits<double>::infinity();
  const double line = went * next.gain / fell;
  if (!beside || beside->gain == low.gain || beside->gain == next.gain) return line;
  const std::array<const Measured*, 3> at{beside, &low, &next};
  double curve = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    double term = path * (at[i]->measure - next.measure);
    for (std::size_t j = 0; j < 3; ++j)
      if (j != i) term *= at[j]->gain / (at[j]->gain - at[i]->gain);
    curve += term;
  }
  return curve / line > 0.3 && curve / line < 3 ? curve : line;
}

/// Returns the derivative of the load by the measure; NaN where it cannot be computed.
double MeasureContinuation::slope_at(const LoadState& load, const Measured& point) {
  LoadState here = load, there = load;
  here.actuation[load_] = point.measure;
  there.actuation[load_] = (1 + tuning_.measure.first_step) * point.measure;
  here.load_factor = there.load_factor = point.load_factor;
  corrector_.active[load_] = true;
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  double slope = std::numeric_limits<double>::quiet_NaN();
  if (corrector_.prepare(here, point.at) >= 0) {
    Iterate beside = point.at;
    (void)predict(system_, here, there, corrector_.active, work_, team_, beside);
    slope = (beside.multipliers[load_] - point.at.multipliers[load_]) / system_.measures().rate(load_, point.load) /
            (tuning_.measure.first_step * point.measure);
  }
  corrector_.active[load_] = false;
  return slope;
}

bool MeasureContinuation::at_maximum(const Measured& point) const {
  return std::abs(point.gain) * point.measure < tuning_.measure.maximum_slope * std::abs(point.load);
}

/// Returns an ascent at its start.
MeasureContinuation::Ascent MeasureContinuation::ascent_from(const Iterate& at) {
  Ascent ascent;
  ascent.up = requested_load() > route_.here.actuation[load_] ? 1 : -1;  // a chamber grows with its pressure, a cable
  ascent.path = -ascent.up * system_.measures().sign(load_);             // shortens with its tension
  ascent.begin = system_.measures().value(load_, at.positions) / system_.measures().rest(load_);
  ascent.length = tuning_.measure.first_step * ascent.begin;
  ascent.low = {ascent.begin, route_.here.actuation[load_], at, corrector_.last, 0, route_.here.load_factor};
  ascent.low.at.multipliers[load_] = system_.measures().given(load_, ascent.low.load);
  ascent.low.gain = ascent.up * ascent.path * slope_at(route_.here, ascent.low);
  return ascent;
}

/// Takes a point before the maximum as the next start, or one past it as a bound, and chooses the next step.
void MeasureContinuation::Ascent::take(Measured&& next, const MeasureControlOptions& by) {
  const double went = path * (next.measure - low.measure), left = next.short_of;
  if (next.gain < 0) {
    high = std::move(next);
    length = std::clamp(went + left, by.bracket_margin * went, (1 - by.bracket_margin) * went);
    return;
  }
  const bool by_three = beside() != nullptr;
  passed = std::move(low);
  low = std::move(next);
  length = std::min({by.growth * went, by.max_step * low.measure, by_three ? left : by.slope_allowance * left});
  if (high) length = std::min(length, (1 - by.bracket_margin) * path * (high->measure - low.measure));
}

MeasureContinuation::End MeasureContinuation::up(Iterate& at) {
  Ascent ascent = ascent_from(at);
  const double up = ascent.up, path = ascent.path, begin = ascent.begin;
  const Measured& low = ascent.low;
  if (!std::isfinite(low.gain)) return End::lost;
  record_.branch = {};
  note_branch(low);
  const bool may_stand_there = at_maximum(low);
  if (low.gain < 0 && !may_stand_there) return End::lost;
  if (!may_stand_there)
    ascent.length = std::clamp(up * (requested_load() - low.load) / low.gain, ascent.length,
                               tuning_.measure.max_first_step * begin);
  const auto passes = [&](const Measured& point) { return up * (point.load - requested_load()) >= 0; };
  const auto keep_where_stopped = [&](End end) {
    if (end == End::interrupted) keep(low, at);
    return end;
  };
  bool prepared = true;
  for (int i = 0, missed = 0; i < tuning_.measure.max_steps && ascent.length > tuning_.measure.min_step * begin; ++i) {
    auto [next, interrupted] = nearly_at(low.measure + path * ascent.length, low, prepared, ascent.beside());
    if (interrupted) return keep_where_stopped(End::interrupted);
    prepared = false;
    if (!next) {
      ascent.length *= tuning_.step.shortening;
      if (++missed > tuning_.measure.max_failures) break;
      continue;
    }
    note_branch(*next);
    if (passes(*next)) return keep_where_stopped(arrive_before(std::move(*next), ascent, at));
    next->gain = up * path * slope_at(route_.here, *next);
    if (!std::isfinite(next->gain)) return End::lost;
    if (may_stand_there && i == 0 && next->gain < 0) return stop_at(path, begin, low, at);
    next->short_of = left_to_summit(path, ascent.beside(), low, *next);
    if (at_maximum(*next) && !(may_stand_there && next->gain > low.gain)) {
      const Search<Measured> top = exactly(std::move(*next));
      if (top.interrupted) return keep_where_stopped(End::interrupted);
      return passes(*top.found) ? keep_where_stopped(arrive_at(*top.found, at, Newton::Policy::descend))
                                : stop_at(path, begin, *top.found, at);
    }
    prepared = next->gain >= 0;
    ascent.take(std::move(*next), tuning_.measure);
    if (prepared) record_.reached = route_.whole(fraction_of(low.load));
  }
  if (low.measure == begin) return End::lost;
  const Search<Measured> last = exactly(low);
  keep(last.found ? *last.found : low, at);  // the path along the load continues there
  return last.interrupted ? End::interrupted : End::lost;
}

/// Finds the equilibrium under the requested load, before a point that has passed it. It starts where a parabola of the
/// load reaches that load: Newton's method under loads takes many iterations from a point as far away as a step along
/// the measure.
MeasureContinuation::End MeasureContinuation::arrive_before(Measured next, const Ascent& ascent, Iterate& at) {
  const Measured& low = ascent.low;
  const double went = ascent.path * (next.measure - low.measure), rose = ascent.up * (next.load - low.load);
  const double requested = ascent.up * (requested_load() - low.load), bends = (rose - low.gain * went) / (went * went);
  const double fraction = 2 * requested / (low.gain + std::sqrt(low.gain * low.gain + 4 * bends * requested)) / went;
  if (fraction < tuning_.measure.whole_step) {
    const bool from_low = fraction < 0.5;
    const Measured &from = from_low ? low : next, &beside = from_low ? next : low;
    auto [nearer, interrupted] = nearly_at(low.measure + fraction * (next.measure - low.measure), from, false, &beside);
    if (interrupted) return End::interrupted;
    if (nearer) {
      note_branch(*nearer);
      next = std::move(*nearer);
    }
  }
  return arrive_at(next, at, Newton::Policy::descend);
}

/// policy: follow where it may be unstable under its load
MeasureContinuation::End MeasureContinuation::arrive_at(const Measured& near, Iterate& at, Newton::Policy policy) {
  Iterate trial = near.at;
  for (Index a = 0; a < system_.actuators(); ++a)
    if (system_.measures().given_load(a)) trial.multipliers[a] = system_.measures().given(a, route_.to.actuation[a]);
  const auto outcome = corrector_.correct(route_.to, policy, trial);
  if (outcome == Newton::Outcome::interrupted) return End::interrupted;
  const bool found = outcome == Newton::Outcome::converged ||
                     (policy == Newton::Policy::follow && outcome == Newton::Outcome::unstable);
  if (!found || (corrector_.newton().inverted() && !corrector_.last.inverted)) return End::lost;
  corrector_.take(at, std::move(trial));
  corrector_.last = corrector_.judged();
  ++record_.continuation_steps;
  route_.here = route_.to;
  record_.reached = 1;
  return End::arrived;
}

MeasureContinuation::End MeasureContinuation::stop_at(double path, double begin, const Measured& limit_point,
                                                      Iterate& at) {
  report_limit_point(limit_point);
  at_limit_point_ = true;
  if (options_.beyond > 0 || options_.stable) {
    const End end = go_beyond(path, limit_point, at);
    if (end != End::lost) return end;
  }
  if (limit_point.measure == begin) return End::limit_point;
  const double before = tuning_.measure.before_maximum * std::abs(limit_point.measure - begin);
  if (limit_point.short_of > 0.1 * before) {
    keep(limit_point, at);
    return End::limit_point;
  }
  const Temporarily twice(work_.saddle.precision(),
                          linear::MixedLdlt::Precision::twice);  // so short a step is near the rounding error
  const auto [kept, interrupted] = at_measure(limit_point.measure - path * before, limit_point, false, nullptr);
  if (interrupted) {
    keep(limit_point, at);
    return End::interrupted;
  }
  if (!kept) return End::lost;
  keep(*kept, at);
  return End::limit_point;
}

/// Takes an equilibrium at a measure as one under its load.
void MeasureContinuation::keep(const Measured& kept, Iterate& at) {
  at = kept.at;
  corrector_.last = kept.last;
  ++record_.continuation_steps;
  route_.here.actuation[load_] = kept.load;
  route_.here.load_factor = kept.load_factor;
  route_.done = fraction_of(kept.load);
  record_.reached = route_.whole(route_.done);
}

/// Solves for an intermediate equilibrium with the final tolerance; returns it unchanged where that fails.
Search<MeasureContinuation::Measured> MeasureContinuation::exactly(Measured found) {
  Search<Measured> exact = at_measure(found.measure, found, false, nullptr);
  if (exact.found) {
    exact.found->gain = found.gain;
    exact.found->short_of = found.short_of;
  } else if (!exact.interrupted) {
    exact.found = std::move(found);
  }
  return exact;
}

/// Returns the fraction of the path from the first to the requested load, at least 0: past a maximum the load may be
/// below the first.
double MeasureContinuation::fraction_of(double load) const {
  return std::clamp((load - first_load()) / (requested_load() - first_load()), 0.0, 1.0);
}

void MeasureContinuation::report_limit_point(const Measured& limit_point) {
  const Actuator& actuator = system_.model().actuators[load_];
  const bool cable = actuator.is<CableDrive>();
  remark_ = std::string(cable ? "the tension of cable '" : "the pressure of chamber '") + actuator.name + "' has its " +
            (requested_load() > first_load() ? "maximum" : "minimum") + " there, " + load_text(limit_point.load) +
            " at " + measure_text(limit_point.measure);
  if (options_.beyond > 0) return;
  remark_ += std::string("; command its ") + (cable ? "length (control: length)" : "volume (control: volume)") +
             " to go on beyond it";
}

}  // namespace softkin::physical
