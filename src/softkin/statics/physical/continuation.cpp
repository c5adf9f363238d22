#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>
#include <softkin/statics/physical/pull_in.hpp>
#include <softkin/statics/physical/stability.hpp>
#include <utility>

namespace softkin::physical {

namespace {

bool same_shape(const Points& a, const Points& b) {
  return a.rows() == b.rows() && a == b;
}

/// Where weights are foretold to move something farther than this share of the diagonal, and something is in the way,
/// what touches is looked for first.
constexpr double far = 0.2;
/// Shortest step of the continuation, over the way asked for.
constexpr double least_advance = 1e-4;
/// A step that moves no vertex farther than so many tolerances and yet fails leads nowhere.
constexpr double least_move = 1000;
/// The same where things touch, over the contact distance: what sticks moves by a hundredth of that.
constexpr double least_contact_move = 1e-4;
/// A way on which so many iterations bring less than this share of it leads nowhere either.
constexpr int patience = 500;
constexpr double least_progress = 0.01;
/// What is held turns by no more in one step [degrees].
constexpr double most_turn = 30;
/// A step towards a fold, over what is left to it.
constexpr double before_fold = 0.8;
/// Share of a step that is not worth another one at the end of a way.
constexpr double least_left = 0.1;
/// Steps are tried with the stiffness of a shape that is nearer than this share of the diagonal.
constexpr double nearby = 1e-3;
/// In steps shorter than this an equilibrium is followed where it is unstable.
constexpr double follow_below = 0.05;
/// Under a growing load an equilibrium this many times as far from the predicted shape as that is from the last one
/// lies beyond a snap, if that is more than this share of the robot's diagonal.
constexpr double most_correction = 0.5, least_snap = 0.01;
/// Where ratios and supports change alone a step jumps if this share of that distance is no bend of the way; one of
/// this share of the way that jumps is taken, and told.
constexpr double least_jump = 0.9, finest = 0.02;
/// A longer step that inverts an element is made shorter: laws that have an energy for it have a mirrored equilibrium.
constexpr double most_inverting = 0.01;

}  // namespace

Continuation::Continuation(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
                           const ProgressCallback& progress, SolveReport& report)
    : system_(system),
      work_(work),
      team_(team),
      newton_(system, work, team,
              {options.tolerance_mm, options.force_share, system.contact() || system.limp() ? 100 : 30,
               options.keep_history},
              progress, report),
      tolerance_mm_(options.tolerance_mm),
      max_iterations_(options.max_iterations),
      stable_(options.stable),
      beyond_(options.beyond),
      report_(report),
      tracer_(options.trace, report) {}

/// Moves to the end of a whole way where it is known without a tangent: foretold, foreseen or as the last ones led.
bool Continuation::lead(const Demand& here, const Demand& there, Iterate& trial) {
  return !system_.contact() && (follow_foretold(here, there, work_, trial) ||
                                follow_foreseen(system_, here, there, active_, work_, team_, trial) ||
                                work_.trail.lead(here, there, active_, tolerance_mm_, trial));
}

/// One step from limp sheets that lie flat, where no tangent leads anywhere.
Newton::Outcome Continuation::step_from_flat(const Demand& there, const Iterate& at, Iterate& trial) {
  if (runs_into_flat(there, at)) return Newton::Outcome::blocked;
  const std::optional<Swelling> swelling = swell(system_, there, active_, trial, work_, team_);
  unforetold_ = swelling.has_value();
  predicted_ = begun_ = trial.positions;
  move_mm_ = system_.largest_move(at.positions, predicted_);
  return swelling ? settle_swollen(there, *swelling, trial) : settle(there, Newton::Policy::descend, trial);
}

/// One step; trial begins at `at` and ends at the equilibrium.
Newton::Outcome Continuation::step(const Demand& here, const Demand& there, double length, const Iterate& at,
                                   Iterate& trial) {
  if (system_.limp() && system_.layers()->flat(at.positions)) return step_from_flat(there, at, trial);
  const bool whole = way_.done == 0 && length == 1;  // steps of a way are short where it is difficult
  bool led = false, cut = false;
  const auto prediction = [&] {
    led = whole && !led && lead(here, there, trial);
    if (led) {
      system_.placement().hold(there, trial.positions);
      predicted_ = begun_ = trial.positions;
      move_mm_ = system_.largest_move(at.positions, predicted_);
      return true;
    }
    const ClearPrediction clear = predict_clear(system_, here, there, active_, work_, team_, trial);
    predicted_ = clear.predicted;
    if (system_.friction()) free_way_ = {clear.straight, clear.predicted};
    move_mm_ = clear.move_mm.value_or(system_.largest_move(at.positions, predicted_));
    cut = clear.cut && weighs(here, there) &&
          system_.largest_move(at.positions, predicted_) > far * system_.model().diagonal_mm;
    begun_ = trial.positions;
    return clear.move_mm.has_value();
  };
  if (!prediction()) return whole ? fall_onto(here, there, at, trial) : Newton::Outcome::blocked;
  tangent_mm_ = led ? 0 : move_mm_ / length;
  if (leads_over_fold(length)) return Newton::Outcome::over_fold;
  if (whole && !led && leads_too_far(here, there, at)) return Newton::Outcome::too_far;
  const bool follows = last_.modes > 0 && !stable_ && length <= 1.001 * follow_below;
  const auto policy = follows ? Newton::Policy::follow : led ? Newton::Policy::near : Newton::Policy::descend;
  const bool again = system_.contact() && !follows, first = again && whole && cut;
  const Iterate begun = again ? trial : Iterate{};
  const auto settle_foreseen = [&] {
    trial = begun;
    const auto foreseen = foresee_contact(there, at, false, trial);
    if (foreseen == Newton::Outcome::converged) return settle(there, policy, trial);
    return foreseen == Newton::Outcome::interrupted ? foreseen : Newton::Outcome::stuck;
  };
  auto outcome = first ? settle_foreseen() : Newton::Outcome::stuck;
  if (outcome == Newton::Outcome::stuck) {
    if (first) trial = begun;
    outcome = settle(there, policy, trial, whole && factorised_nearby(trial.positions));
  }
  if (outcome == Newton::Outcome::stuck && again && !first) outcome = settle_foreseen();
  if (outcome == Newton::Outcome::converged && !led && whole)
    work_.trail.note_tangent(here, there, system_.largest_move(begun_, trial.positions));
  if (outcome == Newton::Outcome::stuck && !follows && length < follow_below && prepare(here, at) >= 0) {
    trial = at;
    if (prediction()) outcome = settle(there, Newton::Policy::follow, trial);
  }
  return outcome;
}

/// Would a step lead over a fold beyond which one led nowhere?
bool Continuation::leads_over_fold(double length) const {
  const double left = left_to_fold();
  return may_turn_back() && way_.failed - way_.done >= before_fold * left && length > left &&
         before_fold * left > least_advance;
}

/// Does a step leave the way? Where a way bends, the tangent at its end, followed back, misses its begin on the side on
/// which the one at its begin misses its end, and by about as much; where it jumps, on the other side.
bool Continuation::jumped(const Demand& here, const Demand& there, const Iterate& at, const Iterate& trial) {
  if (unforetold_) return false;
  const double correction = system_.largest_move(predicted_, trial.positions);
  const auto jumps = [&] {
    Iterate back = trial;
    (void)predict(system_, there, here, active_, work_, team_, back);
    const Points ahead = predicted_ - trial.positions, behind = back.positions - at.positions;
    jump_mm_ = 0.5 * system_.largest_move(ahead, behind);
    // where the way has a corner, at which something begins to touch, both miss on the same side, by any lengths
    return !(jump_mm_ <= least_jump * correction) && !(system_.contact() && ahead.cwiseProduct(behind).sum() > 0);
  };
  if (correction <= least_snap * system_.model().diagonal_mm) return false;
  // the factor at hand is of a shape nearby, and mostly good enough
  return jumps() && (prepare(there, trial) < 0 || jumps());
}

Status Continuation::follow(const Demand& from, const Demand& to, Iterate& at) {
  const Status end = follow_whole(from, to, at);
  sort_branch();
  return end;
}

Status Continuation::follow_whole(const Demand& from, const Demand& to, Iterate& at) {
  active_.resize(static_cast<std::size_t>(system_.actuators()));
  for (Index a = 0; a < system_.actuators(); ++a) active_[a] = system_.measures().constrains(a);
  set_out(from, to);
  (void)release(to, at, false);
  from_ = at.positions;
  (void)renew_anchors(at);
  if (!same_shape(work_.home, at.positions)) work_.trail.clear();
  way_.factorised = same_shape(work_.home, at.positions) && factor_holds_active();
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

/// Another way, from where the last one ended.
void Continuation::set_out(const Demand& from, const Demand& to) {
  way_ = {.from = from, .to = to, .here = from, .before = way_.before};
  way_.loads_change = change_loads(from, to);
  for (Index a = 0; a < system_.actuators(); ++a)
    way_.releases = way_.releases || (system_.surroundings().holds(a) && from.actuation[a] != to.actuation[a]);
  way_.load = only_load(from, to);
  way_.marked_iterations = report_.iterations;
}

/// Share of all that was asked.
double Continuation::whole(double done) const {
  return way_.then ? way_.before : way_.before + (1 - way_.before) * done;
}

/// Where the next step ends. One that leaves hardly anything is as long as what is left.
double Continuation::next_share() {
  const double turn = system_.placement().largest_turn(way_.from, way_.to);
  if (way_.advance * turn > most_turn) way_.advance = most_turn / turn;
  const double ahead = way_.done + way_.advance;
  return ahead + least_left * way_.advance < 1 ? ahead : 1;
}

/// Makes ready for a step; a status where the way ends without one.
std::optional<Status> Continuation::start_step(const Demand& there, Iterate& at) {
  if (release(there, at, false)) way_.factorised = false;
  const int modes = way_.factorised ? last_.modes : prepare(way_.here, at);
  if (modes < 0) return limit(way_.done, "the stiffness at the start is not stable", at);
  way_.factorised = true;
  if (beyond_ > 0 && modes > 0 && way_.load >= 0 && way_.done == 0) {
    const Climb back = go_back(way_.load, way_.from, way_.to, at);
    if (back == Climb::interrupted) return Status::interrupted;
    if (back == Climb::arrived) return arrive(way_.to, at);
    way_.factorised = prepare(way_.here, at) >= 0;
  }
  return std::nullopt;
}

/// What a step of this length that ended so is worth.
Continuation::StepEnd Continuation::judge(Newton::Outcome outcome, const Demand& there, double length,
                                          const Iterate& at, const Iterate& trial) {
  StepEnd end{.why = outcome == Newton::Outcome::stuck       ? newton_.why_stuck()
                     : outcome == Newton::Outcome::blocked   ? "something is in the way"
                     : outcome == Newton::Outcome::too_far   ? "it is far more than the load can be foretold for"
                     : outcome == Newton::Outcome::over_fold ? "the way is foretold to turn back before its end"
                     : outcome == Newton::Outcome::unmet     ? "what actuators command contradicts each other"
                                                             : ""};
  end.blocked = outcome == Newton::Outcome::blocked || outcome == Newton::Outcome::too_far ||
                outcome == Newton::Outcome::over_fold;
  end.found = outcome != Newton::Outcome::stuck && !end.blocked;
  end.hurried = outcome == Newton::Outcome::stuck && newton_.hurried();
  const auto reject = [&](const char* because) {
    end.found = false;
    end.why = because;
  };
  if (end.found && way_.loads_change && snapped(move_mm_, system_.largest_move(begun_, trial.positions)) &&
      jumped(way_.here, there, at, trial))
    reject("the equilibrium lies beyond a jump");
  end.snap = end.found && !way_.loads_change && jumped(way_.here, there, at, trial);
  end.unstable = end.found && outcome == Newton::Outcome::unstable;
  if (newton_.inverted() && !last_.inverted && length > most_inverting) reject("an element is inverted");
  // a body that nothing holds has no stiffness, and so no step
  if (end.found && system_.surroundings().any_body() && !newton_.balanced()) reject("a body is out of balance");
  return end;
}

/// Tries one step and takes it, or chooses a shorter one; a status where the way ends.
std::optional<Status> Continuation::go_on(Iterate& at) {
  const double next = next_share(), length = next - way_.done;
  const Demand there = between(way_.from, way_.to, next);
  Iterate trial = at;
  if (const std::optional<Status> end = start_step(there, at)) return end;
  const int before = report_.iterations;
  const std::vector<bool> active = active_;
  work_.left_field = false;
  tracer_.begin(whole(way_.done), whole(next), length);
  tangent_mm_ = 0;
  unforetold_ = false;
  const auto outcome = [&] {
    const Newton::Brief scope(newton_, !way_.thorough && may_turn_back());
    return step(way_.here, there, length, at, trial);
  }();
  free_way_ = {};
  if (outcome == Newton::Outcome::interrupted) return Status::interrupted;
  const StepEnd came = judge(outcome, there, length, at, trial);
  const double longest = longest_step(came.snap, came.unstable);
  const double corrected_mm = came.found ? system_.largest_move(begun_, trial.positions) : 0;
  const auto trace = [&](bool taken, const std::string& told) { tracer_.end(taken, told, move_mm_, corrected_mm); };
  std::optional<Status> end;
  if (!came.found) {
    trace(false, came.why);
    way_.factorised = came.blocked;
    active_ = active;
    if (!came.blocked) way_.failed = way_.failed > way_.done ? std::min(way_.failed, next) : next;
    end = shorten(length, came.hurried, at);
  } else if (length > 1.001 * longest) {
    trace(false,
          came.snap ? "it jumps: shorter ones may not" : "it is unstable: a shorter one shows where it becomes so");
    if (came.snap) way_.beyond = Beyond{std::move(trial), there, next, active_, judged(), jump_mm_};
    way_.factorised = false;
    active_ = active;
    way_.advance = std::max(longest, 0.4 * length);
  } else {
    trace(true, came.snap ? "it jumps" : came.unstable ? "unstable" : came.why);
    if (came.snap) tell_snap(jump_mm_, whole(way_.done));
    take(at, std::move(trial));
    way_.tangent_mm = tangent_mm_;
    way_.tangent_at = way_.done;
    if (!come_to(there, next, came.unstable, at)) return Status::interrupted;
    lengthen(report_.iterations - before, came.unstable, at);
  }
  return end ? end : out_of_patience(at);
}

/// Chooses the next step after one that was taken, in so many iterations.
void Continuation::lengthen(int iterations, bool unstable, Iterate& at) {
  way_.advance *= lengthened(iterations / rounds_);  // those for new normal forces are as many each
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
  return iterations <= 5 ? 2 : iterations <= 9 ? 1.4 : 0.8;
}

/// After a step that led to no equilibrium. Before a limit is told, one that hurried has every iteration.
std::optional<Status> Continuation::shorten(double length, bool hurried, Iterate& at) {
  const std::vector<bool> active = active_;
  if (way_.load >= 0) {  // along what the load does
    const Climb end = climb(std::exchange(way_.load, -1), way_.from, way_.here, way_.to, at);
    if (end == Climb::interrupted) return Status::interrupted;
    if (end == Climb::arrived) return arrive(way_.to, at);
    if (end == Climb::summit) return limit(way_.done, report_.remark, at);
    active_ = active;
    way_.factorised = false;
    report_.reached = whole(way_.done);
  }
  if (loads_at_last(at)) return std::nullopt;
  const bool folds = leads_over_fold(length);  // a shorter step comes before a limit is told
  way_.advance = folds ? std::max(0.1 * length, before_fold * left_to_fold()) : 0.4 * length;
  if (folds) return std::nullopt;
  if (way_.beyond && way_.advance < finest) {
    tell_snap(way_.beyond->jump_mm, whole(way_.done));
    take_beyond(at);
    way_.advance = follow_below;
    return std::nullopt;
  }
  double least = least_move * tolerance_mm_;
  if (system_.contact()) least = std::min(least, least_contact_move * system_.model().contact.distance_mm);
  const bool leads_nowhere = !way_.releases && move_mm_ < least;
  const bool ends = way_.advance < least_advance || leads_nowhere;
  if (ends && hurried) {
    way_.advance = length;
    way_.thorough = true;
    return std::nullopt;
  }
  way_.thorough = false;
  if (ends)
    return limit(way_.done,
                 work_.left_field ? "beyond this point what is magnetic comes to where the field is not known: outside "
                                    "its grid, on a wire or on the dipole"
                                  : "beyond this point no equilibrium follows" + instead_of_loads(),
                 at);
  return std::nullopt;
}

/// An equilibrium on the way; false: interrupted.
bool Continuation::come_to(const Demand& there, double next, bool unstable, Iterate& at) {
  last_ = judged();
  if (unstable && stable_ && next < 1) {
    if (!buckle(there, at)) return false;
    way_.factorised = false;
  } else if (unstable && next < 1 && report_.unstable_from == 0 && prepare(there, at) > 0) {
    report_.unstable_from = whole(next);  // in the shape itself: the last factorisation was of one close to it
  }
  if (way_.beyond && next >= way_.beyond->done) way_.beyond.reset();
  pass(there, next);
  return true;
}

void Continuation::pass(const Demand& demand, double done) {
  way_.here = demand;
  way_.done = done;
  report_.reached = whole(done);
  ++report_.continuation_steps;
}

std::optional<Status> Continuation::out_of_patience(const Iterate& at) {
  if (way_.done - way_.marked >= least_progress) {
    way_.marked = way_.done;
    way_.marked_iterations = report_.iterations;
  } else if (way_.done < 1 && report_.iterations - way_.marked_iterations >= patience) {
    return limit(way_.done,
                 "the way there goes on in ever smaller steps: " + std::to_string(patience) +
                     " iterations brought less than 1 % of it",
                 at);
  }
  if (way_.done == 1 || report_.iterations < max_iterations_) return std::nullopt;
  tell_balance();
  report_.remark = "the limit of iterations was reached";
  return Status::not_converged;
}

/// Does the workspace hold the stable stiffness of a shape close by?
bool Continuation::factorised_nearby(const Points& shape) const {
  return work_.exact && work_.saddle.spectrum().unstable == 0 && work_.factorised.rows() == shape.rows() &&
         system_.largest_move(work_.factorised, shape) <= nearby * system_.model().diagonal_mm;
}

Continuation::Judgement Continuation::judged() const {
  return {newton_.imbalance(), newton_.balanced(), newton_.inverted(), newton_.unstable_modes()};
}

bool Continuation::snapped(double predicted_mm, double correction_mm) const {
  return correction_mm > most_correction * predicted_mm && correction_mm > least_snap * system_.model().diagonal_mm;
}

/// Of a step that came to an equilibrium: a shorter one may not leave the way, or leave it where it becomes unstable.
double Continuation::longest_step(bool snap, bool unstable) const {
  return snap ? finest : unstable && stable_ ? follow_below : 1;
}

/// Slackens cables that may be longer than they are and carry nothing: held to their length they would push the body
/// there before they are found to be slack. contradicting: those too that carry something, against another one.
bool Continuation::release(const Demand& there, Iterate& at, bool contradicting) {
  bool changed = false;
  for (Index a = 0; a < system_.actuators(); ++a) {
    if (!active_[a] || !system_.measures().only_pulls(a) || (at.multipliers[a] > 0 && !contradicting)) continue;
    if (system_.measures().value(a, at.positions) >= system_.measures().target(a, there.actuation, 0)) continue;
    active_[a] = false;
    at.multipliers[a] = 0;
    changed = true;
  }
  return changed;
}

/// Factorises at an equilibrium, for the predictor. Returns in how many ways it is unstable; -1: it is none.
int Continuation::prepare(const Demand& here, const Iterate& at) {
  Balance balance;
  hold_friction(system_, at, work_, team_);
  system_.evaluate(at, here, active_, work_, balance, team_);
  ++report_.factorisations;
  const int modes = system_.factorise(at, here, active_, balance, {}, work_, team_);
  report_.factorisations_in_double += work_.saddle.factor().in_double();
  return balance.force.allFinite() ? modes : -1;
}

}  // namespace softkin::physical
