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

/// Where weights are foretold to move something farther than this share of the diagonal, and something is in the way,
/// what touches is looked for first.
constexpr double far = 0.2;
/// Shortest step of the continuation, over the way asked for; and where some of it was gone and nothing touches, over
/// the way and over that, whichever is less: what is asked for may be a thousand times what is borne.
constexpr double least_advance = 1e-4, least_of_way = 5e-4, least_of_gone = 0.005;
/// A step that moves no vertex farther than this share of the diagonal and yet fails leads nowhere.
constexpr double least_move = 8e-5;
/// The same where things touch, over the contact distance: what sticks moves by a hundredth of that.
constexpr double least_contact_move = 1e-4;
/// What is held turns by no more in one step [degrees].
constexpr double most_turn = 30;
/// Share of a step that is not worth another one at the end of a way.
constexpr double least_left = 0.1;
/// A step leads at most half the way to where one led nowhere, until that is this much nearer than it was then.
constexpr double much_nearer = 0.35;
/// In steps shorter than this an equilibrium is followed where it is unstable; and few factors tell where it ends.
constexpr double follow_below = 0.05;
/// Under a growing load an equilibrium this many times as far from the predicted shape as that is from the last one
/// lies beyond a snap, if that is more than this share of the robot's diagonal.
constexpr double most_correction = 0.5, least_snap = 0.01;
/// Where ratios and supports change alone a step jumps if this share of that distance is no bend of the way; one of
/// this share of the way that jumps is taken, and told.
constexpr double least_jump = 0.9, finest = 0.02;
/// A longer step that inverts an element is made shorter: laws that have an energy for it have a mirrored equilibrium.
constexpr double most_inverting = 0.01;
/// Of what elements pull with, that may be out of balance where a step has come to rest: more is no equilibrium.
constexpr double much_imbalance = 0.01;

}  // namespace

Continuation::Continuation(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
                           const ProgressCallback& progress, SolveReport& report)
    : system_(system),
      work_(work),
      team_(team),
      options_(options),
      report_(report),
      settler_(system, work, team, options, progress, report),
      tracer_(options.trace, report) {}

/// Moves to the end of a whole way where it is known without a tangent: foretold, foreseen or as the last ones led.
bool Continuation::lead(const Demand& here, const Demand& there, Iterate& trial) {
  return !system_.contact() && (follow_foretold(here, there, work_, trial) ||
                                follow_foreseen(system_, here, there, settler_.active, work_, team_, trial) ||
                                work_.trail.lead(here, there, settler_.active, options_.tolerance_mm, trial));
}

/// One step from limp sheets that lie flat, where no tangent leads anywhere.
Newton::Outcome Continuation::step_from_flat(const Demand& there, const Iterate& at, Iterate& trial) {
  if (settler_.runs_into_flat(there, at)) return Newton::Outcome::blocked;
  const std::optional<Swelling> swelling = swell(system_, there, settler_.active, trial, work_, team_);
  step_.unforetold = swelling.has_value();
  step_.predicted = step_.begun = trial.positions;
  step_.move_mm = system_.largest_move(at.positions, step_.predicted);
  return swelling ? settler_.settle_swollen(there, *swelling, trial)
                  : settler_.settle(there, Newton::Policy::descend, trial);
}

/// One step; trial begins at `at` and ends at the equilibrium.
Newton::Outcome Continuation::step(const Demand& here, const Demand& there, double length, const Iterate& at,
                                   Iterate& trial) {
  if (system_.limp() && system_.layers()->flat(at.positions)) return step_from_flat(there, at, trial);
  const bool whole = way_.done == 0 && length == 1;  // steps of a way are short where it is difficult
  bool led = false, cut = false;
  const auto prediction = [&] {
    led = whole && !led && lead(here, there, trial);
    step_.extrapolated = led;
    if (led) {
      system_.placement().hold(there, trial.positions);
      step_.predicted = step_.begun = trial.positions;
      step_.move_mm = system_.largest_move(at.positions, step_.predicted);
      return true;
    }
    const ClearPrediction clear = predict_clear(system_, here, there, settler_.active, work_, team_, trial);
    step_.predicted = clear.predicted;
    step_.straight = clear.straight;
    if (system_.friction()) settler_.free_way = {clear.straight, clear.predicted};
    step_.move_mm = clear.move_mm.value_or(system_.largest_move(at.positions, step_.predicted));
    cut = clear.cut && settler_.weighs(here, there) &&
          system_.largest_move(at.positions, step_.predicted) > far * system_.model().diagonal_mm;
    step_.begun = trial.positions;
    return clear.move_mm.has_value();
  };
  if (!prediction()) return whole ? fall_onto(here, there, at, trial) : Newton::Outcome::blocked;
  if (whole && !led && leads_too_far(here, there, at)) return Newton::Outcome::too_far;
  const bool follows = settler_.last.modes > 0 && !options_.stable && length <= 1.001 * follow_below;
  const auto policy = follows ? Newton::Policy::follow : led ? Newton::Policy::near : Newton::Policy::descend;
  const bool again = system_.contact() && !follows, first = again && whole && cut;
  const Iterate begun = again ? trial : Iterate{};
  const auto settle_foreseen = [&] {
    trial = begun;
    const auto foreseen = settler_.foresee_contact(there, at, false, trial);
    if (foreseen == Newton::Outcome::converged) return settler_.settle(there, policy, trial);
    return foreseen == Newton::Outcome::interrupted ? foreseen : Newton::Outcome::stuck;
  };
  auto outcome = first ? settle_foreseen() : Newton::Outcome::stuck;
  if (outcome == Newton::Outcome::stuck) {
    if (first) trial = begun;
    outcome = settler_.settle(there, policy, trial, whole && settler_.factorised_nearby(trial.positions));
  }
  if (outcome == Newton::Outcome::stuck && again && !first) outcome = settle_foreseen();
  if (outcome == Newton::Outcome::converged && !led && whole)
    work_.trail.note_tangent(here, there, system_.largest_move(step_.begun, trial.positions));
  if (outcome == Newton::Outcome::stuck && !follows && length < follow_below && settler_.prepare(here, at) >= 0) {
    trial = at;
    if (prediction()) outcome = settler_.settle(there, Newton::Policy::follow, trial);
  }
  return outcome;
}

/// Where weights would lead far through something: what is held comes to its place, and the body onto what is near.
Newton::Outcome Continuation::fall_onto(const Demand& here, const Demand& there, const Iterate& at, Iterate& trial) {
  if (!settler_.weighs(here, there) || settler_.touches(at)) return Newton::Outcome::blocked;
  trial = at;
  if (!carry_held(system_, here, there, settler_.active, work_, team_, trial)) return Newton::Outcome::blocked;
  settler_.give_loads(there, trial);
  step_.predicted = step_.begun = trial.positions;
  step_.unforetold = true;
  const auto outcome = settler_.foresee_contact(there, at, true, trial);
  if (outcome == Newton::Outcome::interrupted) return outcome;
  step_.begun = trial.positions;
  return outcome == Newton::Outcome::converged ? settler_.settle(there, Newton::Policy::descend, trial)
                                               : Newton::Outcome::stuck;  // blocked is what was not tried
}

/// Does a step leave the way? Where a way bends, the tangent at its end, followed back, misses its begin on the side on
/// which the one at its begin misses its end, and by about as much; where it jumps, on the other side.
bool Continuation::jumped(const Demand& here, const Demand& there, const Iterate& at, const Iterate& trial) {
  if (step_.unforetold) return false;
  const double correction = system_.largest_move(step_.predicted, trial.positions);
  const auto jumps = [&] {
    Iterate back = trial;
    (void)predict(system_, there, here, settler_.active, work_, team_, back);
    const Points ahead = step_.predicted - trial.positions, behind = back.positions - at.positions;
    step_.jump_mm = 0.5 * system_.largest_move(ahead, behind);
    // where the way has a corner, at which something begins to touch, both miss on the same side, by any lengths
    return !(step_.jump_mm <= least_jump * correction) && !(system_.contact() && ahead.cwiseProduct(behind).sum() > 0);
  };
  if (correction <= least_snap * system_.model().diagonal_mm) return false;
  // the factor at hand is of a shape nearby, and mostly good enough
  return jumps() && (settler_.prepare(there, trial) < 0 || jumps());
}

/// Does a step lead on from where the way turns back? Then it jumps, whatever a tangent tells there.
bool Continuation::turned_back(const Iterate& at, const Iterate& trial) {
  if (way_.turned) step_.jump_mm = system_.largest_move(at.positions, trial.positions);
  return way_.turned;
}

Status Continuation::follow(const Demand& from, const Demand& to, Iterate& at) {
  const Status end = follow_whole(from, to, at);
  sort_branch(system_, report_);
  return end;
}

Status Continuation::follow_whole(const Demand& from, const Demand& to, Iterate& at) {
  settler_.active.resize(system_.actuators());
  for (Index a = 0; a < system_.actuators(); ++a) settler_.active[a] = system_.measures().constrains(a);
  set_out(from, to);
  (void)settler_.release(to, at, false);
  settler_.good_shape = at.positions;
  (void)settler_.renew_anchors(at);
  if (!same_shape(work_.home, at.positions)) work_.trail.clear();
  way_.factorised = same_shape(work_.home, at.positions) && settler_.factor_holds_active();
  work_.home.resize(0, 3);
  if (!way_.factorised && from.actuation == to.actuation && from.share == to.share && from.fading == to.fading) {
    const auto outcome = settle_here(to, at);
    if (outcome == Newton::Outcome::interrupted) return Status::interrupted;
    if (outcome == Newton::Outcome::converged) return arrive(to, at);
  }
  while (way_.done < 1) {
    const std::optional<Status> end = go_on(at);
    if (end == Status::limit && together_ && way_.then)
      go_together(at);
    else if (end)
      return *end;
    else if (way_.done == 1 && way_.then)
      set_out(way_.here, Demand(*way_.then));
  }
  return arrive(to, at);
}

/// Newton at once, where the start is as near to the equilibrium asked for as any prediction from it.
Newton::Outcome Continuation::settle_here(const Demand& demand, Iterate& at) {
  const std::vector<bool> before = settler_.active;
  Iterate trial = at;
  auto outcome = settler_.settle(demand, Newton::Policy::descend, trial);
  if (settler_.newton().inverted() || (system_.surroundings().any_body() && !settler_.newton().balanced()))
    outcome = Newton::Outcome::stuck;
  if (outcome == Newton::Outcome::converged) {
    settler_.take(at, std::move(trial));
    settler_.last = settler_.judged();
    ++report_.continuation_steps;
    report_.reached = 1;
  } else {
    settler_.active = before;
  }
  return outcome;
}

/// Another way, from where the last one ended.
void Continuation::set_out(const Demand& from, const Demand& to) {
  way_ = {.from = from, .to = to, .here = from, .before = way_.before};
  way_.loads_change = change_loads(from, to);
  for (Index a = 0; a < system_.actuators(); ++a)
    way_.releases = way_.releases || (system_.surroundings().holds(a) && from.actuation[a] != to.actuation[a]);
  way_.load = only_load(from, to);
  way_.marked_iterations = report_.iterations;
}

/// Along what a load does.
Climb::End Continuation::climb(Climb::End (Climb::*along)(Iterate&), Index load, Iterate& at) {
  if (!settler_.newton().goes_on()) return Climb::End::interrupted;
  Climb climb(settler_, tracer_, options_, {load, way_.from, way_.to, way_.here, way_.done, way_.whole()});
  const Climb::End end = (climb.*along)(at);
  way_.here = climb.route().here;
  way_.done = climb.route().done;
  at_summit_ = at_summit_ || climb.at_summit();
  return end;
}

/// Where the next step ends. One that leaves hardly anything is as long as what is left.
double Continuation::next_share() {
  const double gap = way_.failed.share - way_.done;
  if (gap > much_nearer * way_.failed.ahead) way_.advance = std::min(way_.advance, 0.5 * gap);
  const double turn = system_.placement().largest_turn(way_.from, way_.to);
  if (way_.advance * turn > most_turn) way_.advance = most_turn / turn;
  const double ahead = way_.done + way_.advance;
  return ahead + least_left * way_.advance < 1 ? ahead : 1;
}

/// Makes ready for a step; a status where the way ends without one.
std::optional<Status> Continuation::start_step(const Demand& there, Iterate& at) {
  if (settler_.release(there, at, false)) way_.factorised = false;
  if (!way_.factorised && !settler_.newton().goes_on()) return Status::interrupted;
  const int modes = way_.factorised ? settler_.last.modes : settler_.prepare(way_.here, at);
  if (modes < 0)
    return limit(way_.done, "no step leads on from here: the stiffness is singular, or an element is inverted", at);
  way_.factorised = true;
  if (options_.beyond > 0 && modes > 0 && way_.load >= 0 && way_.done == 0) {
    const Climb::End back = climb(&Climb::back, way_.load, at);
    if (back == Climb::End::interrupted) return Status::interrupted;
    if (back == Climb::End::arrived) return arrive(way_.to, at);
    if (!settler_.newton().goes_on()) return Status::interrupted;
    way_.factorised = settler_.prepare(way_.here, at) >= 0;
  }
  return std::nullopt;
}

/// What a step of this length that ended so is worth.
Continuation::StepEnd Continuation::judge(Newton::Outcome outcome, const Demand& there, double length,
                                          const Iterate& at, const Iterate& trial) {
  StepEnd end{.why = outcome == Newton::Outcome::stuck     ? settler_.newton().why_stuck()
                     : outcome == Newton::Outcome::blocked ? "something is in the way"
                     : outcome == Newton::Outcome::too_far ? "it is far more than the load can be foretold for"
                                                           : ""};
  end.blocked = outcome == Newton::Outcome::blocked || outcome == Newton::Outcome::too_far;
  end.found = outcome != Newton::Outcome::stuck && !end.blocked;
  const auto reject = [&](const char* because) {
    end.found = false;
    end.why = because;
  };
  if (end.found && way_.loads_change &&
      snapped(step_.move_mm, system_.largest_move(step_.predicted, trial.positions)) &&
      jumped(way_.here, there, at, trial))
    reject("the equilibrium lies beyond a jump");
  end.snap = end.found && !way_.loads_change && (turned_back(at, trial) || jumped(way_.here, there, at, trial));
  end.unstable = end.found && outcome == Newton::Outcome::unstable;
  if (settler_.newton().inverted() && !settler_.last.inverted && length > most_inverting)
    reject("an element is inverted");
  // a body that nothing holds has no stiffness, and so no step
  if (end.found && system_.surroundings().any_body() && !settler_.newton().balanced())
    reject("a body is out of balance");
  const Imbalance& forces = settler_.newton().imbalance();
  if (end.found && forces.residual > much_imbalance * forces.pull + forces.rounding)
    reject("forces are out of balance");
  return end;
}

/// Has the path no corners, and can its tangents be compared? In a field a robot may turn freely; where tendons rub the
/// path depends on its steps, which are not made shorter for this.
bool Continuation::is_smooth() const {
  const auto& actuators = system_.model().actuators;
  return !system_.kinked() && !system_.tendons().any() &&
         std::none_of(actuators.begin(), actuators.end(),
                      [](const Actuator& each) { return each.as<MagneticDrive>() != nullptr; });
}

/// Is there a limit point between a step's begin and its end?
///
/// changed  do cables that were held slacken, or others pull
SegmentCheck::Verdict Continuation::check_segment(double length, bool changed, const Iterate& at,
                                                  const Iterate& trial) {
  using Verdict = SegmentCheck::Verdict;
  const bool has_tangent = step_.extrapolated || step_.straight.rows() > 0;  // none leads from flat sheets
  if (step_.unforetold || !has_tangent || !is_smooth()) return Verdict::confirmed;
  const double farthest = std::max(system_.largest_move(at.positions, trial.positions),
                                   system_.largest_move(at.positions, step_.predicted));
  if (SegmentCheck::is_short(system_, farthest)) return Verdict::confirmed;
  const int modes = settler_.newton().unstable_modes();
  SegmentEnd low{&at, way_.done, {}, settler_.last.modes};
  if (!step_.extrapolated) low.rate = (step_.straight - at.positions) / length;
  SegmentCheck check(settler_, tracer_, options_, way_.from, way_.to);
  Verdict verdict =
      check.check(std::move(low), {&trial, way_.done + length, {}, modes}, step_.predicted - at.positions, changed);
  if (check.lost_factor()) way_.factorised = false;
  if (changed && verdict == Verdict::unclear) verdict = Verdict::confirmed;  // where a cable slackens tangents turn
  return verdict;
}

/// A step that passed a limit point of a load, or of which nothing shows that it did not, is not taken.
void Continuation::check_path(double length, bool changed, const Iterate& at, const Iterate& trial, StepEnd& end) {
  if (!way_.loads_change) return;
  const SegmentCheck::Verdict verdict = check_segment(length, changed, at, trial);
  if (verdict == SegmentCheck::Verdict::confirmed) return;
  end.interrupted = verdict == SegmentCheck::Verdict::interrupted;
  end.found = false;
  end.why = verdict == SegmentCheck::Verdict::unclear ? "the tangents at its ends do not agree"
                                                      : "the equilibrium lies beyond a limit point";
}

/// Tries one step and takes it, or chooses a shorter one; a status where the way ends.
std::optional<Status> Continuation::go_on(Iterate& at) {
  const double next = next_share(), length = next - way_.done;
  const Demand there = between(way_.from, way_.to, next);
  Iterate trial = at;
  if (const std::optional<Status> end = start_step(there, at)) return end;
  const int before = report_.iterations;
  const std::vector<bool> active = settler_.active;
  work_.left_field = false;
  tracer_.begin(whole(way_.done), whole(next), length);
  step_.unforetold = step_.extrapolated = false;
  step_.straight.resize(0, 3);
  const auto outcome = [&] {
    const auto briefly = settler_.newton().briefly(ends_early(length < follow_below));
    return step(way_.here, there, length, at, trial);
  }();
  settler_.free_way = {};
  if (outcome == Newton::Outcome::interrupted) return Status::interrupted;
  StepEnd came = judge(outcome, there, length, at, trial);
  if (came.found && !came.snap) check_path(length, settler_.active != active, at, trial, came);
  if (came.interrupted) return Status::interrupted;
  const double longest = longest_step(came.snap, came.unstable);
  const double corrected_mm = came.found ? system_.largest_move(step_.begun, trial.positions) : 0;
  const auto trace = [&](bool taken, const std::string& told) {
    tracer_.end(taken, told, step_.move_mm, corrected_mm);
  };
  std::optional<Status> end;
  if (!came.found) {
    trace(false, came.why);
    way_.factorised = came.blocked;
    settler_.active = active;
    if (!came.blocked) way_.failed.note(next, way_.done);
    end = shorten(length, at);
  } else if (length > 1.001 * longest) {
    trace(false,
          came.snap ? "it jumps: shorter ones may not" : "it is unstable: a shorter one shows where it becomes so");
    if (came.snap)
      way_.beyond = Beyond{std::move(trial), there, next, settler_.active, settler_.judged(), step_.jump_mm};
    way_.factorised = false;
    settler_.active = active;
    way_.advance = std::max(longest, 0.4 * length);
  } else {
    trace(true, came.snap ? "it jumps" : came.unstable ? "unstable" : came.why);
    if (came.snap) tell_snap(step_.jump_mm, whole(way_.done), report_);
    settler_.take(at, std::move(trial));
    if (!come_to(there, next, came.unstable, at)) return Status::interrupted;
    lengthen(report_.iterations - before, came.unstable, at);
  }
  return end ? end : out_of_patience(at);
}

/// Chooses the next step after one that was taken, in so many iterations.
void Continuation::lengthen(int iterations, bool unstable, Iterate& at) {
  way_.advance *= lengthened(iterations / settler_.rounds());  // those for new normal forces are as many each
  if (unstable) way_.advance = std::min(way_.advance, follow_below);
  if (leads_beyond(at)) {
    take_beyond(at);
  } else if (way_.beyond && system_.contact()) {  // a step as long would end there again
    way_.advance = std::min(way_.advance, std::max(finest, 0.5 * (way_.beyond->done - way_.done)));
  }
}

/// The next step over one that took so many iterations. Where things touch they hardly depend on its length, as
/// something begins to touch in most steps.
double Continuation::lengthened(int iterations) const {
  if (system_.contact()) return iterations <= 15 ? 3 : iterations <= 30 ? 2 : 1;
  return iterations <= 7 ? 2 : iterations <= 12 ? 1.5 : 1;
}

/// After a step that led to no equilibrium.
std::optional<Status> Continuation::shorten(double length, Iterate& at) {
  const std::vector<bool> active = settler_.active;
  if (way_.load >= 0) {  // along what the load does
    const Climb::End end = climb(&Climb::up, std::exchange(way_.load, -1), at);
    if (end == Climb::End::interrupted) return Status::interrupted;
    if (end == Climb::End::arrived) return arrive(way_.to, at);
    if (end == Climb::End::summit) return limit(way_.done, report_.remark, at);
    settler_.active = active;
    way_.factorised = false;
    report_.reached = whole(way_.done);
  }
  if (loads_at_last(at)) return std::nullopt;
  const ArcLength::End curve = follow_curve(at);
  if (curve == ArcLength::End::interrupted) return Status::interrupted;
  if (curve == ArcLength::End::turned) {
    if (way_.loads_change && !way_.bears_all) return limit(way_.done, beyond_here(), at);
    way_.advance = way_.bears_all ? 1 - way_.done : finest;  // may jump to what is stable beyond
    way_.thorough = true;
  }
  if (curve != ArcLength::End::lost) return std::nullopt;
  way_.advance = 0.4 * length;
  if (way_.beyond && way_.advance < finest) {
    tell_snap(way_.beyond->jump_mm, whole(way_.done), report_);
    take_beyond(at);
    way_.advance = follow_below;
    return std::nullopt;
  }
  double least = least_move * system_.model().diagonal_mm;
  if (system_.contact()) least = std::min(least, least_contact_move * system_.model().contact.distance_mm);
  const bool leads_nowhere = !way_.releases && step_.move_mm < least;
  way_.thorough = false;
  if (way_.advance < shortest_advance() || leads_nowhere || way_.turned) return limit(way_.done, beyond_here(), at);
  return std::nullopt;
}

double Continuation::shortest_advance() const {
  if (jerky()) return least_advance;
  return std::max(least_advance, std::min(least_of_way, least_of_gone * way_.done));
}

void Continuation::Failed::note(double at, double done) {
  share = share > done ? std::min(share, at) : at;
  ahead = share - done;
}

/// An equilibrium on the way; false: interrupted.
bool Continuation::come_to(const Demand& there, double next, bool unstable, Iterate& at) {
  settler_.last = settler_.judged();
  if (unstable && options_.stable && next < 1) {
    if (!buckle(settler_, there, at)) return false;
    way_.factorised = false;
  } else if (unstable && next < 1 && report_.physical.unstable_from == 0 && settler_.prepare(there, at) > 0) {
    report_.physical.unstable_from = whole(next);  // in the shape itself: the last factorisation was of one close to it
  }
  if (way_.beyond && next >= way_.beyond->done) way_.beyond.reset();
  pass(there, next);
  return true;
}

void Continuation::pass(const Demand& demand, double done) {
  way_.here = demand;
  way_.done = done;
  way_.turned = false;
  report_.reached = whole(done);
  ++report_.continuation_steps;
}

bool Continuation::snapped(double predicted_mm, double correction_mm) const {
  return correction_mm > most_correction * predicted_mm && correction_mm > least_snap * system_.model().diagonal_mm;
}

/// Of a step that came to an equilibrium: a shorter one may not leave the way, or leave it where it becomes unstable.
double Continuation::longest_step(bool snap, bool unstable) const {
  return snap ? finest : unstable && options_.stable ? follow_below : 1;
}

}  // namespace softkin::physical
