#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/buckling.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>
#include <softkin/statics/physical/pull_in.hpp>
#include <utility>

// The end of a load path: at its equilibrium, at a limit, or where another path segment continues it.

namespace softkin::physical {

bool Continuation::change_loads(const LoadState& from, const LoadState& to) const {
  if (from.fading != to.fading || (system_.any_dead_load() && from.load_factor != to.load_factor)) return true;
  for (Index a = 0; a < system_.actuators(); ++a)
    if (from.actuation[a] != to.actuation[a] && (system_.loads(a) || system_.measures().given_load(a))) return true;
  return false;
}

/// Does the load factor change anything?
bool Continuation::changes_with_load_factor() const {
  return system_.any_dead_load() || system_.prestretched() || holds_elsewhere();
}

/// Do supports move vertices away from their places at rest?
bool Continuation::holds_elsewhere() const {
  return system_.model().held.at != system_.model().rest || !system_.model().held.turns.empty();
}

/// Returns the only actuator whose load changes, if nothing else changes but weights and forces; -1: none.
Index Continuation::only_load(const LoadState& from, const LoadState& to) const {
  if (from.fading != to.fading) return -1;
  if (from.load_factor != to.load_factor && (system_.prestretched() || holds_elsewhere())) return -1;
  Index found = -1;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (from.actuation[a] == to.actuation[a]) continue;
    if (found >= 0 || system_.measures().constrains(a) || !system_.measures().measures(a)) return -1;
    found = a;
  }
  return found;
}

/// Does the only changing load change its measure so much, to first order, that continuation along the measure is
/// better?
bool Continuation::leads_too_far(const LoadState& here, const LoadState& there, const Iterate& at) {
  const double fraction = tuning_.step.measure_probe, most = tuning_.step.max_measure_change;
  const Index a = path_.load;
  if (a < 0 || system_.contact()) return false;
  Iterate near = at;
  (void)predict(system_, here, between(here, there, fraction), corrector_.active, work_, team_, near);
  const double before = system_.measures().value(a, at.positions);
  const double change = (system_.measures().value(a, near.positions) - before) / fraction;
  return !(change < most * before && change > -0.5 * most * before);
}

/// Follows the curve of equilibria by arc length, also past turning points, after steps along the load failed; each
/// time without an advance it waits for twice as many failures. lost: it was not tried, or it failed.
ArcLength::End Continuation::follow_curve(Iterate& at) {
  if (++path_.misses < path_.next_look || path_.turned || corrector_.last.modes > 0 || path_.releases ||
      system_.kinked())
    return ArcLength::End::lost;
  ArcLength curve(corrector_, tracer_, options_,
                  {path_.from, path_.to, path_.done,
                   path_.failed.load_factor > path_.done ? path_.failed.load_factor : 1, options_.stable});
  const ArcLength::End end = curve.follow(at);
  path_.factorised = false;
  const double gone = curve.done() - path_.done;
  path_.next_look = gone > 0 ? path_.misses + 1 : 2 * path_.misses;
  if (gone > 0) pass(between(path_.from, path_.to, curve.done()), curve.done());
  path_.turned = end == ArcLength::End::turned;
  path_.carries_full_load = path_.turned && curve.largest() >= 1;
  if (const auto& jump = curve.jump()) record_.note_snap(jump->move_mm, whole(jump->load_factor));
  if (end == ArcLength::End::passed) path_.advance = std::max(path_.advance, gone);
  return end;
}

/// Describes why the path ends at its last equilibrium.
std::string Continuation::beyond_here() const {
  if (work_.left_field)
    return "beyond this point what is magnetic comes to where the field is not known: "
           "outside its grid, on a wire or on the dipole";
  return std::string("beyond this point no equilibrium follows") +
         (path_.turned ? ": the curve of equilibria turns back there" : "") +
         (!path_.turned     ? ""
          : options_.stable ? ", and no stable shape was found that carries more"
                            : "; --stable (in Python stable=True) follows it to the next stable shape that carries "
                              "more, where there is one") +
         instead_of_loads();
}

/// Advises what to command instead of the changing loads, which may have reached a maximum; "" where no load changes.
std::string Continuation::instead_of_loads() const {
  bool pressures = false, tensions = false, fillings = false;
  for (Index a = 0; a < system_.actuators(); ++a) {
    const Actuator& actuator = system_.model().actuators[a];
    fillings = fillings || (filling_of(actuator) && path_.from.actuation[a] != path_.to.actuation[a]);
    if (actuator.control != Control::load || !system_.measures().measures(a) ||
        path_.from.actuation[a] == path_.to.actuation[a])
      continue;
    tensions = tensions || actuator.is<CableDrive>();
    pressures = pressures || actuator.is<ChamberDrive>();
  }
  if (fillings) return "; where what fills a chamber has its maximum, command its volume (control: volume) to go on";
  if (!pressures && !tensions) return "";
  return std::string("; where a ") + (pressures ? "pressure" : "tension") + " has its maximum, command " +
         (pressures ? "volumes (control: volume)" : "") + (pressures && tensions ? " and " : "") +
         (tensions ? "lengths (control: length)" : "") + " to go on beyond it";
}

void Continuation::report_balance() {
  report_.physical.residual_N = corrector_.last.forces.residual;
  report_.physical.pull_N = corrector_.last.forces.pull;
}

/// at: the last equilibrium
Status Continuation::limit(double done, const std::string& why, const Iterate& at) {
  report_balance();
  record_.reached = whole(done);
  report_.remark = why + pull_in_text(system_.model(), path_.from, between(path_.from, path_.to, done), at.positions);
  if (system_.has_wrinkling()) report_.remark += "; sheets that nothing keeps taut have no shape of their own";
  const double slipping = slipping_fraction(system_, at, work_, team_);
  if (slipping >= tuning_.termination.min_slipping)
    report_.remark += "; there " + number(100 * slipping, 3) + " % of the friction contacts slip, or nearly";
  return Status::limit;
}

/// Does a step that does not converge end after a few factorisations? If only ratios change, a long step may converge
/// after many.
bool Continuation::ends_early(bool short_step) const {
  return !path_.thorough && (path_.loads_change || short_step) && !system_.contact() && !system_.has_wrinkling();
}

/// Does the path lead from the current state to the equilibrium of a longer step without a jump? Where contact begins
/// in several places, the path bends as often within a step, which looks like a jump from its start.
bool Continuation::leads_beyond(const Iterate& at) {
  if (!path_.beyond || !system_.contact() || system_.friction() || corrector_.active != path_.beyond->active)
    return false;
  const LoadState& there = path_.beyond->load_state;
  Iterate predicted = at;
  if (!path_.factorised && corrector_.prepare(path_.here, at) < 0) return false;
  const ClearPrediction clear = predict_clear(system_, path_.here, there, corrector_.active, work_, team_, predicted);
  step_.predicted = clear.predicted;
  path_.factorised = false;
  return clear.move_mm && !jumped(path_.here, there, at, path_.beyond->at);
}

void Continuation::take_beyond(Iterate& at) {
  Beyond beyond = std::move(*path_.beyond);
  path_.beyond.reset();
  corrector_.take(at, std::move(beyond.at));
  corrector_.active = std::move(beyond.active);
  corrector_.last = beyond.last;
  pass(beyond.load_state, beyond.done);
  path_.factorised = corrector_.prepare(path_.here, at) >= 0;
}

std::optional<Status> Continuation::out_of_patience(const Iterate& at) {
  const int most = is_non_smooth() ? tuning_.termination.contact_patience : tuning_.termination.patience;
  const double least = is_non_smooth() ? tuning_.termination.contact_min_progress : tuning_.termination.min_progress;
  if (path_.done - path_.marked >= least ||
      (!is_non_smooth() && path_.done > tuning_.termination.progress_factor * path_.marked)) {
    path_.marked = path_.done;
    path_.marked_iterations = record_.iterations;
  } else if (path_.done < 1 && !options_.stable && record_.iterations - path_.marked_iterations >= most) {
    return limit(path_.done,
                 "the path advances in ever smaller steps: " + std::to_string(most) + " iterations brought less than " +
                     number(100 * least, 2) + " % of it",
                 at);
  }
  return std::nullopt;
}

/// Checks and reports the last shape.
Status Continuation::arrive(const LoadState& load_state, Iterate& at) {
  if (options_.stable && !buckle(corrector_, load_state, at)) return Status::interrupted;
  if (corrector_.last.modes > 0) report_stability(load_state, at);
  report_balance();
  if (record_.friction_change > work_.options.contact.friction_tolerance) {
    report_.remark = "friction and the normal forces that limit it do not agree: it changed by " +
                     number(100 * record_.friction_change, 2) + " % when they were found anew";
    return Status::not_converged;
  }
  if (corrector_.last.balanced) {
    if (record_.snapped_mm > 0) work_.predictor_history.clear();
    work_.predictor_history.add(load_state, corrector_.active, at, tuning_.prediction);
    return Status::converged;
  }
  report_.remark = "the steps have become small, but " + number(corrector_.last.forces.residual, 2) +
                   " N are out of balance, where elements pull with at most " + number(corrector_.last.forces.pull, 2) +
                   " N at a vertex";
  return Status::not_converged;
}

/// Reports the number of unstable modes of the last shape.
void Continuation::report_stability(const LoadState& load_state, const Iterate& at) {
  const int modes = std::max(0, corrector_.prepare(load_state, at));
  report_.physical.unstable_modes = modes;
  if (modes > 0)
    report_.remark = "this equilibrium is unstable in " + std::to_string(modes) + (modes == 1 ? " mode" : " modes") +
                     ": the robot would buckle or snap away from it";
}

/// If loads change together with weights, prestretch or supports, applies the latter first, at constant loads. Only the
/// loads remain then, and measure-controlled continuation can follow a single one of them.
bool Continuation::loads_at_last(const Iterate& at) {
  if (path_.load >= 0 || together_ || path_.here.load_factor == path_.to.load_factor || !changes_with_load_factor())
    return false;
  LoadState rest = path_.to;
  rest.actuation = path_.here.actuation;
  if (!change_loads(rest, path_.to)) return false;
  together_ = Together{path_, at, corrector_.active, corrector_.last};
  const LoadState to = path_.to;
  path_.before = path_.done;
  set_out(path_.here, rest);
  path_.then = to;
  return true;
}

/// Returns to the state before weights and loads were separated, if the path with weights alone failed: the loads may
/// carry the weights.
void Continuation::go_together(Iterate& at) {
  Together& before = *together_;
  path_ = std::move(before.path);
  at = std::move(before.at);
  corrector_.active = std::move(before.active);
  corrector_.last = before.last;
  corrector_.good_shape = at.positions;
  path_.advance *= tuning_.step.shortening;
  path_.factorised = false;
  path_.marked_iterations = record_.iterations;
  report_.remark.clear();
}

}  // namespace softkin::physical
