#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/buckling.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>
#include <utility>

namespace softkin::physical {

namespace {

bool same_shape(const Points& a, const Points& b) {
  return a.rows() == b.rows() && a == b;
}

}  // namespace

Continuation::Continuation(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
                           const ProgressCallback& progress, SolveRecord& record, SolveReport& report)
    : system_(system),
      work_(work),
      team_(team),
      options_(options),
      tuning_(work.options.path),
      record_(record),
      report_(report),
      corrector_(system, work, team, options, progress, record, report),
      tracer_(options.trace, record, report.trace) {}

/// Predicts the end of a whole path without a tangent: by the caller's initial guess, by a stored second-order
/// extrapolation or by a polynomial through the last equilibria. Returns false if none of these is available.
bool Continuation::extrapolate(const LoadState& here, const LoadState& there, Iterate& trial) {
  return !system_.contact() && (follow_initial_guess(here, there, work_, trial) ||
                                follow_extrapolated(system_, here, there, corrector_.active, work_, team_, trial) ||
                                work_.predictor_history.extrapolate(here, there, corrector_.active,
                                                                    options_.tolerance_mm, tuning_.prediction, trial));
}

/// Makes one step from flat sheets, which have no stiffness against their loads and so no tangent.
Newton::Outcome Continuation::step_from_flat(const LoadState& there, const Iterate& at, Iterate& trial) {
  if (corrector_.runs_into_flat(there, at)) return Newton::Outcome::blocked;
  const std::optional<Swelling> swelling = swell(system_, there, corrector_.active, trial, work_, team_);
  step_.unpredicted = swelling.has_value();
  step_.predicted = step_.begun = trial.positions;
  step_.move_mm = system_.largest_move(at.positions, step_.predicted);
  return swelling ? corrector_.correct_swollen(there, *swelling, trial)
                  : corrector_.correct(there, Newton::Policy::descend, trial);
}

/// Makes one step; `trial` starts as a copy of `at` and becomes the equilibrium.
Newton::Outcome Continuation::step(const LoadState& here, const LoadState& there, double length, const Iterate& at,
                                   Iterate& trial) {
  if (system_.has_wrinkling() && system_.layers()->flat(at.positions)) return step_from_flat(there, at, trial);
  const bool whole = path_.done == 0 && length == 1;  // later steps are short where the path is difficult
  bool extrapolated = false, cut = false;
  const auto prediction = [&] {
    extrapolated = whole && !extrapolated && extrapolate(here, there, trial);
    step_.extrapolated = extrapolated;
    if (extrapolated) {
      system_.placement().hold(there, trial.positions);
      step_.predicted = step_.begun = trial.positions;
      step_.move_mm = system_.largest_move(at.positions, step_.predicted);
      return true;
    }
    const ClearPrediction clear = predict_clear(system_, here, there, corrector_.active, work_, team_, trial);
    step_.predicted = clear.predicted;
    step_.straight = clear.straight;
    if (system_.friction()) corrector_.free_motion = {clear.straight, clear.predicted};
    step_.move_mm = clear.move_mm.value_or(system_.largest_move(at.positions, step_.predicted));
    cut = clear.cut && corrector_.weighs(here, there) &&
          system_.largest_move(at.positions, step_.predicted) >
              tuning_.acceptance.long_fall * system_.model().diagonal_mm;
    step_.begun = trial.positions;
    return clear.move_mm.has_value();
  };
  if (!prediction()) return whole ? fall_onto(here, there, at, trial) : Newton::Outcome::blocked;
  if (whole && !extrapolated && leads_too_far(here, there, at)) return Newton::Outcome::too_far;
  const bool follows =
      corrector_.last.modes > 0 && !options_.stable && length <= 1.001 * tuning_.acceptance.follow_below;
  const auto policy = follows ? Newton::Policy::follow : extrapolated ? Newton::Policy::near : Newton::Policy::descend;
  const bool again = system_.contact() && !follows, first = again && whole && cut;
  const Iterate begun = again ? trial : Iterate{};
  const auto correct_with_predicted_contact = [&] {
    trial = begun;
    const auto predicted_contact = corrector_.predict_contact(there, at, false, trial);
    if (predicted_contact == Newton::Outcome::converged) return corrector_.correct(there, policy, trial);
    return predicted_contact == Newton::Outcome::interrupted ? predicted_contact : Newton::Outcome::stuck;
  };
  auto outcome = first ? correct_with_predicted_contact() : Newton::Outcome::stuck;
  if (outcome == Newton::Outcome::stuck) {
    if (first) trial = begun;
    outcome = corrector_.correct(there, policy, trial, whole && corrector_.factorised_nearby(trial.positions));
  }
  if (outcome == Newton::Outcome::stuck && again && !first) outcome = correct_with_predicted_contact();
  if (outcome == Newton::Outcome::converged && !extrapolated && whole)
    work_.predictor_history.note_tangent(here, there, system_.largest_move(step_.begun, trial.positions));
  if (outcome == Newton::Outcome::stuck && !follows && length < tuning_.acceptance.follow_below &&
      corrector_.prepare(here, at) >= 0) {
    trial = at;
    if (prediction()) outcome = corrector_.correct(there, Newton::Policy::follow, trial);
  }
  return outcome;
}

/// If dead loads would carry the body far into an obstacle, the supports are moved first and the body is then dropped
/// into contact.
Newton::Outcome Continuation::fall_onto(const LoadState& here, const LoadState& there, const Iterate& at,
                                        Iterate& trial) {
  if (!corrector_.weighs(here, there) || corrector_.touches(at)) return Newton::Outcome::blocked;
  trial = at;
  if (!carry_held(system_, here, there, corrector_.active, work_, team_, trial)) return Newton::Outcome::blocked;
  corrector_.give_loads(there, trial);
  step_.predicted = step_.begun = trial.positions;
  step_.unpredicted = true;
  const auto outcome = corrector_.predict_contact(there, at, true, trial);
  if (outcome == Newton::Outcome::interrupted) return outcome;
  step_.begun = trial.positions;
  return outcome == Newton::Outcome::converged ? corrector_.correct(there, Newton::Policy::descend, trial)
                                               : Newton::Outcome::stuck;  // `blocked` would mean: not tried
}

/// Does a step leave the path? On a curved path the tangent at the end of the step, followed backwards, misses the
/// start on the side on which the tangent at the start misses the end, and by about as much. After a snap-through or
/// branch switch it misses the start on the other side.
bool Continuation::jumped(const LoadState& here, const LoadState& there, const Iterate& at, const Iterate& trial) {
  if (step_.unpredicted) return false;
  const double correction = system_.largest_move(step_.predicted, trial.positions);
  const auto jumps = [&] {
    Iterate back = trial;
    (void)predict(system_, there, here, corrector_.active, work_, team_, back);
    const Points ahead = step_.predicted - trial.positions, behind = back.positions - at.positions;
    step_.jump_mm = 0.5 * system_.largest_move(ahead, behind);
    // at a corner of the path, where contact begins, both tangents miss on the same side, by any distances
    return !(step_.jump_mm <= tuning_.acceptance.min_snap_fraction * correction) &&
           !(system_.contact() && ahead.cwiseProduct(behind).sum() > 0);
  };
  if (correction <= tuning_.acceptance.min_snap * system_.model().diagonal_mm) return false;
  // the current factorisation is of a nearby shape, which is usually accurate enough
  return jumps() && (corrector_.prepare(there, trial) < 0 || jumps());
}

/// Does the step start where the path turns back? Then it snaps through, whatever the tangent there predicts.
bool Continuation::turned_back(const Iterate& at, const Iterate& trial) {
  if (path_.turned) step_.jump_mm = system_.largest_move(at.positions, trial.positions);
  return path_.turned;
}

Status Continuation::follow(const LoadState& from, const LoadState& to, Iterate& at) {
  report_.remark.clear();
  const Status end = follow_whole(from, to, at);
  sort_branch(system_, record_.branch);
  return end;
}

Status Continuation::follow_whole(const LoadState& from, const LoadState& to, Iterate& at) {
  corrector_.active.resize(system_.actuators());
  for (Index a = 0; a < system_.actuators(); ++a) corrector_.active[a] = system_.measures().constrains(a);
  set_out(from, to);
  (void)corrector_.release(to, at, false);
  corrector_.good_shape = at.positions;
  (void)corrector_.renew_anchors(at);
  if (!same_shape(work_.solved_shape, at.positions)) work_.predictor_history.clear();
  path_.factorised = same_shape(work_.solved_shape, at.positions) && corrector_.factor_holds_active();
  work_.solved_shape.resize(0, 3);
  if (!path_.factorised && from.actuation == to.actuation && from.load_factor == to.load_factor &&
      from.fading == to.fading) {
    const auto outcome = correct_here(to, at);
    if (outcome == Newton::Outcome::interrupted) return Status::interrupted;
    if (outcome == Newton::Outcome::converged) return arrive(to, at);
  }
  while (path_.done < 1) {
    const std::optional<Status> end = go_on(at);
    if (end == Status::limit && together_ && path_.then)
      go_together(at);
    else if (end)
      return *end;
    else if (path_.done == 1 && path_.then)
      set_out(path_.here, LoadState(*path_.then));
  }
  return arrive(to, at);
}

/// Runs Newton's method without a prediction, where the start is as close to the requested equilibrium as any
/// prediction.
Newton::Outcome Continuation::correct_here(const LoadState& load_state, Iterate& at) {
  const std::vector<bool> before = corrector_.active;
  Iterate trial = at;
  auto outcome = corrector_.correct(load_state, Newton::Policy::descend, trial);
  if (corrector_.newton().inverted() || (system_.surroundings().any_body() && !corrector_.newton().balanced()))
    outcome = Newton::Outcome::stuck;
  if (outcome == Newton::Outcome::converged) {
    corrector_.take(at, std::move(trial));
    corrector_.last = corrector_.judged();
    ++record_.continuation_steps;
    record_.reached = 1;
  } else {
    corrector_.active = before;
  }
  return outcome;
}

/// Starts a new path at the end of the last one.
void Continuation::set_out(const LoadState& from, const LoadState& to) {
  path_ = {.from = from, .to = to, .here = from, .before = path_.before};
  path_.next_look = tuning_.termination.curve_failures;
  path_.loads_change = change_loads(from, to);
  for (Index a = 0; a < system_.actuators(); ++a)
    path_.releases = path_.releases || (system_.surroundings().holds(a) && from.actuation[a] != to.actuation[a]);
  path_.load = only_load(from, to);
  path_.marked_iterations = record_.iterations;
}

/// Runs a measure-controlled continuation of a load, and continues from the load state that it reaches.
MeasureContinuation::End Continuation::follow_measure(MeasureContinuation::End (MeasureContinuation::*along)(Iterate&),
                                                      Index load, Iterate& at) {
  if (!corrector_.newton().may_continue()) return MeasureContinuation::End::interrupted;
  MeasureContinuation follow_measure(corrector_, tracer_, options_,
                                     {load, path_.from, path_.to, path_.here, path_.done, path_.whole()});
  const MeasureContinuation::End end = (follow_measure.*along)(at);
  path_.here = follow_measure.route().here;
  path_.done = follow_measure.route().done;
  measure_remark_ = follow_measure.remark();
  if (end == MeasureContinuation::End::interrupted) report_.remark = measure_remark_;
  at_limit_point_ = at_limit_point_ || follow_measure.at_limit_point();
  return end;
}

/// Returns the fraction of the path at which the next step ends. A step that would leave a small remainder includes it.
double Continuation::next_fraction() {
  const double gap = path_.failed.load_factor - path_.done;
  if (gap > tuning_.step.failed_gap * path_.failed.ahead) path_.advance = std::min(path_.advance, 0.5 * gap);
  const double turn = system_.placement().largest_turn(path_.from, path_.to);
  if (path_.advance * turn > tuning_.step.max_turn) path_.advance = tuning_.step.max_turn / turn;
  const double ahead = path_.done + path_.advance;
  return ahead + tuning_.step.min_remainder * path_.advance < 1 ? ahead : 1;
}

/// Prepares a step; returns a status if the path ends without one.
std::optional<Status> Continuation::start_step(const LoadState& there, Iterate& at) {
  if (corrector_.release(there, at, false)) path_.factorised = false;
  if (!path_.factorised && !corrector_.newton().may_continue()) return Status::interrupted;
  const int modes = path_.factorised ? corrector_.last.modes : corrector_.prepare(path_.here, at);
  if (modes < 0)
    return limit(path_.done, "no step leads on from here: the stiffness is singular, or an element is inverted", at);
  path_.factorised = true;
  if (options_.beyond > 0 && modes > 0 && path_.load >= 0 && path_.done == 0) {
    const MeasureContinuation::End back = follow_measure(&MeasureContinuation::back, path_.load, at);
    if (back == MeasureContinuation::End::interrupted) return Status::interrupted;
    if (back == MeasureContinuation::End::arrived) return arrive(path_.to, at);
    if (!corrector_.newton().may_continue()) return Status::interrupted;
    path_.factorised = corrector_.prepare(path_.here, at) >= 0;
  }
  return std::nullopt;
}

/// Evaluates the result of a step of this length: whether it found an equilibrium on the path, and if not, why.
Continuation::StepEnd Continuation::judge(Newton::Outcome outcome, const LoadState& there, double length,
                                          const Iterate& at, const Iterate& trial) {
  StepEnd end{.why = outcome == Newton::Outcome::stuck     ? corrector_.newton().why_stuck()
                     : outcome == Newton::Outcome::blocked ? "something is in the way"
                     : outcome == Newton::Outcome::too_far ? "it is far more than the load can be predicted for"
                                                           : ""};
  end.blocked = outcome == Newton::Outcome::blocked || outcome == Newton::Outcome::too_far;
  end.found = outcome != Newton::Outcome::stuck && !end.blocked;
  const auto reject = [&](const char* because) {
    end.found = false;
    end.why = because;
  };
  if (end.found && path_.loads_change &&
      snapped(step_.move_mm, system_.largest_move(step_.predicted, trial.positions)) &&
      jumped(path_.here, there, at, trial))
    reject("the equilibrium lies beyond a jump");
  end.snap = end.found && !path_.loads_change && (turned_back(at, trial) || jumped(path_.here, there, at, trial));
  end.unstable = end.found && outcome == Newton::Outcome::unstable;
  if (corrector_.newton().inverted() && !corrector_.last.inverted && length > tuning_.acceptance.max_inverting)
    reject("an element is inverted");
  // a body without supports or contact has no stiffness, and so no Newton step
  if (end.found && system_.surroundings().any_body() && !corrector_.newton().balanced())
    reject("a body is out of balance");
  const Imbalance& forces = corrector_.newton().imbalance();
  if (end.found && forces.residual > tuning_.acceptance.max_residual * forces.pull + forces.rounding)
    reject("forces are out of balance");
  return end;
}

/// Has the path no corners, and can its tangents be compared? In a magnetic field a robot may rotate freely. With
/// friction of tendons the path depends on its steps, which are not shortened for this check.
bool Continuation::is_smooth() const {
  const auto& actuators = system_.model().actuators;
  return !system_.kinked() && !system_.tendons().any() &&
         std::none_of(actuators.begin(), actuators.end(),
                      [](const Actuator& each) { return each.as<MagneticDrive>() != nullptr; });
}

/// Is there a limit point between the start and the end of a step?
///
/// changed  has the set of active cables changed
SegmentCheck::Verdict Continuation::check_segment(double length, bool changed, const Iterate& at,
                                                  const Iterate& trial) {
  using Verdict = SegmentCheck::Verdict;
  const bool has_tangent = step_.extrapolated || step_.straight.rows() > 0;  // flat sheets have none
  if (step_.unpredicted || !has_tangent || !is_smooth()) return Verdict::confirmed;
  const double farthest = std::max(system_.largest_move(at.positions, trial.positions),
                                   system_.largest_move(at.positions, step_.predicted));
  if (SegmentCheck::is_short(system_, tuning_.segment_check, farthest)) return Verdict::confirmed;
  const int modes = corrector_.newton().unstable_modes();
  SegmentEnd low{&at, path_.done, {}, corrector_.last.modes};
  if (!step_.extrapolated) low.rate = (step_.straight - at.positions) / length;
  SegmentCheck check(corrector_, tracer_, options_, path_.from, path_.to);
  Verdict verdict =
      check.check(std::move(low), {&trial, path_.done + length, {}, modes}, step_.predicted - at.positions, changed);
  if (check.lost_factor()) path_.factorised = false;
  if (changed && verdict == Verdict::unclear) verdict = Verdict::confirmed;  // where a cable slackens tangents turn
  return verdict;
}

/// Rejects a step that passed a limit point of a load, or for which this cannot be excluded.
void Continuation::check_path(double length, bool changed, const Iterate& at, const Iterate& trial, StepEnd& end) {
  if (!path_.loads_change) return;
  const SegmentCheck::Verdict verdict = check_segment(length, changed, at, trial);
  if (verdict == SegmentCheck::Verdict::confirmed) return;
  end.interrupted = verdict == SegmentCheck::Verdict::interrupted;
  end.found = false;
  end.why = verdict == SegmentCheck::Verdict::unclear ? "the tangents at its ends do not agree"
                                                      : "the equilibrium lies beyond a limit point";
}

/// Tries one step and accepts it, or chooses a shorter one; returns a status if the path ends.
std::optional<Status> Continuation::go_on(Iterate& at) {
  const double next = next_fraction(), length = next - path_.done;
  const LoadState there = between(path_.from, path_.to, next);
  Iterate trial = at;
  if (const std::optional<Status> end = start_step(there, at)) return end;
  const int before = record_.iterations;
  const std::vector<bool> active = corrector_.active;
  work_.left_field = false;
  tracer_.begin(whole(path_.done), whole(next), length);
  step_.unpredicted = step_.extrapolated = false;
  step_.straight.resize(0, 3);
  const auto outcome = [&] {
    const auto limited =
        corrector_.newton().with_few_factorisations(ends_early(length < tuning_.acceptance.follow_below));
    return step(path_.here, there, length, at, trial);
  }();
  corrector_.free_motion = {};
  if (outcome == Newton::Outcome::interrupted) return Status::interrupted;
  StepEnd came = judge(outcome, there, length, at, trial);
  if (came.found && !came.snap) check_path(length, corrector_.active != active, at, trial, came);
  if (came.interrupted) return Status::interrupted;
  const double longest = longest_step(came.snap, came.unstable);
  const double corrected_mm = came.found ? system_.largest_move(step_.begun, trial.positions) : 0;
  const auto trace = [&](bool taken, const std::string& reported) {
    tracer_.end(taken, reported, step_.move_mm, corrected_mm);
  };
  std::optional<Status> end;
  if (!came.found) {
    trace(false, came.why);
    path_.factorised = came.blocked;
    corrector_.active = active;
    if (!came.blocked) path_.failed.note(next, path_.done);
    end = shorten(length, at);
  } else if (length > 1.001 * longest) {
    trace(false,
          came.snap ? "it jumps: shorter ones may not" : "it is unstable: a shorter one shows where it becomes so");
    if (came.snap)
      path_.beyond = Beyond{std::move(trial), there, next, corrector_.active, corrector_.judged(), step_.jump_mm};
    path_.factorised = false;
    corrector_.active = active;
    path_.advance = std::max(longest, tuning_.step.shortening * length);
  } else {
    trace(true, came.snap ? "it jumps" : came.unstable ? "unstable" : came.why);
    if (came.snap) record_.note_snap(step_.jump_mm, whole(path_.done));
    corrector_.take(at, std::move(trial));
    if (!come_to(there, next, came.unstable, at)) return Status::interrupted;
    lengthen(record_.iterations - before, came.unstable, at);
  }
  return end ? end : out_of_patience(at);
}

/// Chooses the length of the next step after an accepted one that took this many iterations.
void Continuation::lengthen(int iterations, bool unstable, Iterate& at) {
  path_.advance *= lengthened(iterations / corrector_.rounds());  // each update of normal forces takes as many
  if (unstable) path_.advance = std::min(path_.advance, tuning_.acceptance.follow_below);
  if (leads_beyond(at)) {
    take_beyond(at);
  } else if (path_.beyond && system_.contact()) {  // a step of that length would end there again
    path_.advance =
        std::min(path_.advance, std::max(tuning_.acceptance.snap_length, 0.5 * (path_.beyond->done - path_.done)));
  }
}

/// Returns the length of the next step over that of one which took this many iterations. With contact their number
/// hardly depends on the length, as contacts begin in most steps.
double Continuation::lengthened(int iterations) const {
  const StepSizeOptions& by = tuning_.step;
  const bool contact = system_.contact();
  if (iterations <= (contact ? by.few_contact_iterations : by.few_iterations))
    return contact ? by.few_contact_growth : by.few_growth;
  if (iterations <= (contact ? by.some_contact_iterations : by.some_iterations))
    return contact ? by.some_contact_growth : by.some_growth;
  return 1;
}

/// Chooses how to continue after a step without an equilibrium; returns a status if the path ends.
std::optional<Status> Continuation::shorten(double length, Iterate& at) {
  const std::vector<bool> active = corrector_.active;
  if (path_.load >= 0) {  // by measure-controlled continuation
    const MeasureContinuation::End end = follow_measure(&MeasureContinuation::up, std::exchange(path_.load, -1), at);
    if (end == MeasureContinuation::End::interrupted) return Status::interrupted;
    if (end == MeasureContinuation::End::arrived) return arrive(path_.to, at);
    if (end == MeasureContinuation::End::limit_point) return limit(path_.done, measure_remark_, at);
    corrector_.active = active;
    path_.factorised = false;
    record_.reached = whole(path_.done);
  }
  if (loads_at_last(at)) return std::nullopt;
  const ArcLength::End curve = follow_curve(at);
  if (curve == ArcLength::End::interrupted) return Status::interrupted;
  if (curve == ArcLength::End::turned) {
    if (path_.loads_change && !path_.carries_full_load) return limit(path_.done, beyond_here(), at);
    path_.advance = path_.carries_full_load ? 1 - path_.done
                                            : tuning_.acceptance.snap_length;  // may snap through to a stable shape
    path_.thorough = true;
  }
  if (curve != ArcLength::End::lost) return std::nullopt;
  path_.advance = tuning_.step.shortening * length;
  if (path_.beyond && path_.advance < tuning_.acceptance.snap_length) {
    record_.note_snap(path_.beyond->jump_mm, whole(path_.done));
    take_beyond(at);
    path_.advance = tuning_.acceptance.follow_below;
    return std::nullopt;
  }
  double least = tuning_.termination.min_move * system_.model().diagonal_mm;
  if (system_.contact())
    least = std::min(least, tuning_.termination.min_contact_move * system_.model().contact.distance_mm);
  const bool leads_nowhere = !path_.releases && step_.move_mm < least;
  path_.thorough = false;
  if (path_.advance < shortest_advance() || leads_nowhere || path_.turned) return limit(path_.done, beyond_here(), at);
  return std::nullopt;
}

double Continuation::shortest_advance() const {
  if (is_non_smooth()) return tuning_.step.min_length;
  return std::max(tuning_.step.min_length,
                  std::min(tuning_.step.min_smooth_length, tuning_.step.min_of_completed * path_.done));
}

void Continuation::Failed::note(double at, double done) {
  load_factor = load_factor > done ? std::min(load_factor, at) : at;
  ahead = load_factor - done;
}

/// Records an equilibrium on the path; with the option `stable` an unstable one is left by buckling. Returns false if
/// interrupted.
bool Continuation::come_to(const LoadState& there, double next, bool unstable, Iterate& at) {
  corrector_.last = corrector_.judged();
  if (unstable && options_.stable && next < 1) {
    if (!buckle(corrector_, there, at)) return false;
    path_.factorised = false;
  } else if (unstable && next < 1 && record_.unstable_from == 0 && corrector_.prepare(there, at) > 0) {
    record_.unstable_from = whole(next);  // at this shape: the last factorisation was of a nearby one
  }
  if (path_.beyond && next >= path_.beyond->done) path_.beyond.reset();
  pass(there, next);
  return true;
}

void Continuation::pass(const LoadState& load_state, double done) {
  path_.here = load_state;
  path_.done = done;
  path_.turned = false;
  record_.reached = whole(done);
  ++record_.continuation_steps;
}

bool Continuation::snapped(double predicted_mm, double correction_mm) const {
  return correction_mm > tuning_.acceptance.max_correction * predicted_mm &&
         correction_mm > tuning_.acceptance.min_snap * system_.model().diagonal_mm;
}

/// Returns the longest step that is accepted with this result: a shorter one may stay on the path, or end closer to
/// where the path becomes unstable.
double Continuation::longest_step(bool snap, bool unstable) const {
  return snap ? tuning_.acceptance.snap_length : unstable && options_.stable ? tuning_.acceptance.follow_below : 1;
}

}  // namespace softkin::physical
