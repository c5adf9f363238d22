#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/statics/physical/buckling.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/continuation.hpp>
#include <softkin/statics/physical/pull_in.hpp>
#include <utility>

// Where a way ends: at its equilibrium, at a limit, or where another one leads on.

namespace softkin::physical {

namespace {

/// Share of normal forces whose friction gives way, from which on it is told where the way ends.
constexpr double worth_telling = 0.5;
/// A way on which so many iterations bring less than this share of it leads nowhere. Where things come to touch, or a
/// body is released, the next share may take hundreds, and those after it few.
constexpr int patience = 100, patience_at_contact = 250;
constexpr double least_progress = 0.02, least_progress_at_contact = 0.01;
/// So much more than before is worth as many again: what is asked for may be a thousand times what is borne.
constexpr double much_gained = 2;

}  // namespace

bool Continuation::change_loads(const Demand& from, const Demand& to) const {
  if (from.fading != to.fading || (system_.any_dead_load() && from.share != to.share)) return true;
  for (Index a = 0; a < system_.actuators(); ++a)
    if (from.actuation[a] != to.actuation[a] && (system_.loads(a) || system_.measures().given_load(a))) return true;
  return false;
}

/// Does a demand's share change anything?
bool Continuation::anything_comes_with_share() const {
  return system_.any_dead_load() || system_.prestretched() || holds_elsewhere();
}

/// Is what is held to come to another place than where it rests?
bool Continuation::holds_elsewhere() const {
  return system_.model().held.at != system_.model().rest || !system_.model().held.turns.empty();
}

/// The one load that changes, where nothing else does but weights and forces; -1: none.
Index Continuation::only_load(const Demand& from, const Demand& to) const {
  if (from.fading != to.fading) return -1;
  if (from.share != to.share && (system_.prestretched() || holds_elsewhere())) return -1;
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
  (void)predict(system_, here, between(here, there, share), settler_.active, work_, team_, near);
  const double before = system_.measures().value(a, at.positions);
  const double change = (system_.measures().value(a, near.positions) - before) / share;
  return !(change < most * before && change > -0.5 * most * before);
}

/// Where steps led nowhere, more and more often: along the curve of equilibria itself, which goes on where the way
/// turns back. lost: not tried, or it told nothing.
ArcLength::End Continuation::follow_curve(Iterate& at) {
  if (++way_.misses < way_.next_look || way_.turned || settler_.last.modes > 0 || way_.releases || system_.kinked())
    return ArcLength::End::lost;
  ArcLength curve(
      settler_, tracer_, options_,
      {way_.from, way_.to, way_.done, way_.failed.share > way_.done ? way_.failed.share : 1, options_.stable});
  const ArcLength::End end = curve.follow(at);
  way_.factorised = false;
  const double gone = curve.done() - way_.done;
  way_.next_look = gone > 0 ? way_.misses + 1 : 2 * way_.misses;
  if (gone > 0) pass(between(way_.from, way_.to, curve.done()), curve.done());
  way_.turned = end == ArcLength::End::turned;
  way_.bears_all = way_.turned && curve.largest() >= 1;
  if (const auto& jump = curve.jump()) tell_snap(jump->move_mm, whole(jump->share), report_);
  if (end == ArcLength::End::passed) way_.advance = std::max(way_.advance, gone);
  return end;
}

/// Why a way ends where it does.
std::string Continuation::beyond_here() const {
  if (work_.left_field)
    return "beyond this point what is magnetic comes to where the field is not known: "
           "outside its grid, on a wire or on the dipole";
  return std::string("beyond this point no equilibrium follows") +
         (way_.turned ? ": the curve of equilibria turns back there" : "") +
         (!way_.turned      ? ""
          : options_.stable ? ", and no stable shape was found that bears more"
                            : "; --stable (in Python stable=True) goes on along it to the next stable shape that bears "
                              "more, where there is one") +
         instead_of_loads();
}

/// What to command instead of loads that change, which may have come to a maximum; "" where none does.
std::string Continuation::instead_of_loads() const {
  bool pressures = false, tensions = false, fillings = false;
  for (Index a = 0; a < system_.actuators(); ++a) {
    const Actuator& actuator = system_.model().actuators[a];
    fillings = fillings || (filling_of(actuator) && way_.from.actuation[a] != way_.to.actuation[a]);
    if (actuator.control != Control::load || !system_.measures().measures(a) ||
        way_.from.actuation[a] == way_.to.actuation[a])
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

void Continuation::tell_balance() {
  report_.physical.residual_N = settler_.last.forces.residual;
  report_.physical.pull_N = settler_.last.forces.pull;
}

/// at: the last equilibrium
Status Continuation::limit(double done, const std::string& why, const Iterate& at) {
  tell_balance();
  report_.reached = whole(done);
  report_.remark = why + pull_in_text(system_.model(), way_.from, between(way_.from, way_.to, done), at.positions);
  if (system_.limp()) report_.remark += "; sheets that nothing keeps taut have no shape of their own";
  const double slipping = slipping_share(system_, at, work_, team_);
  if (slipping >= worth_telling)
    report_.remark += "; there " + number(100 * slipping, 3) + " % of what rubs slips, or nearly";
  return Status::limit;
}

/// Does a step that comes no nearer end after a few factors? Where ratios alone change, many may bring a long one on.
bool Continuation::ends_early(bool short_step) const {
  return !way_.thorough && (way_.loads_change || short_step) && !system_.contact() && !system_.limp();
}

/// Does the way lead from here to where a longer step came out, without a jump? Where something begins to touch in
/// several places a step turns as often, which looks like a jump to it.
bool Continuation::leads_beyond(const Iterate& at) {
  if (!way_.beyond || !system_.contact() || system_.friction() || settler_.active != way_.beyond->active) return false;
  const Demand& there = way_.beyond->demand;
  Iterate predicted = at;
  if (!way_.factorised && settler_.prepare(way_.here, at) < 0) return false;
  const ClearPrediction clear = predict_clear(system_, way_.here, there, settler_.active, work_, team_, predicted);
  step_.predicted = clear.predicted;
  way_.factorised = false;
  return clear.move_mm && !jumped(way_.here, there, at, way_.beyond->at);
}

void Continuation::take_beyond(Iterate& at) {
  Beyond beyond = std::move(*way_.beyond);
  way_.beyond.reset();
  settler_.take(at, std::move(beyond.at));
  settler_.active = std::move(beyond.active);
  settler_.last = beyond.last;
  pass(beyond.demand, beyond.done);
  way_.factorised = settler_.prepare(way_.here, at) >= 0;
}

std::optional<Status> Continuation::out_of_patience(const Iterate& at) {
  const int most = jerky() ? patience_at_contact : patience;
  const double least = jerky() ? least_progress_at_contact : least_progress;
  if (way_.done - way_.marked >= least || (!jerky() && way_.done > much_gained * way_.marked)) {
    way_.marked = way_.done;
    way_.marked_iterations = report_.iterations;
  } else if (way_.done < 1 && !options_.stable && report_.iterations - way_.marked_iterations >= most) {
    return limit(way_.done,
                 "the way there goes on in ever smaller steps: " + std::to_string(most) +
                     " iterations brought less than " + number(100 * least, 2) + " % of it",
                 at);
  }
  return std::nullopt;
}

/// What the last shape is.
Status Continuation::arrive(const Demand& demand, Iterate& at) {
  if (options_.stable && !buckle(settler_, demand, at)) return Status::interrupted;
  if (settler_.last.modes > 0) tell_stability(demand, at);
  tell_balance();
  if (report_.physical.friction_change > Settler::frictions_agree) {
    report_.remark = "friction and the normal forces that limit it do not agree: it changed by " +
                     number(100 * report_.physical.friction_change, 2) + " % when they were found anew";
    return Status::not_converged;
  }
  if (settler_.last.balanced) {
    if (report_.physical.snapped_mm > 0) work_.trail.clear();
    work_.trail.add(demand, settler_.active, at);
    return Status::converged;
  }
  report_.remark = "the steps have become small, but " + number(settler_.last.forces.residual, 2) +
                   " N are out of balance, where elements pull with at most " + number(settler_.last.forces.pull, 2) +
                   " N at a vertex";
  return Status::not_converged;
}

/// Counts the ways in which the last shape itself is unstable.
void Continuation::tell_stability(const Demand& demand, const Iterate& at) {
  report_.physical.unstable_modes = std::max(0, settler_.prepare(demand, at));
  if (report_.physical.unstable_modes > 0)
    report_.remark = "this equilibrium is unstable in " + std::to_string(report_.physical.unstable_modes) +
                     (report_.physical.unstable_modes == 1 ? " way" : " ways") +
                     ": the robot would buckle or snap away from it";
}

/// Where loads change beside weights, prestretch and supports: these first, so that the loads alone are left, of which
/// one can be climbed.
bool Continuation::loads_at_last(const Iterate& at) {
  if (way_.load >= 0 || together_ || way_.here.share == way_.to.share || !anything_comes_with_share()) return false;
  Demand rest = way_.to;
  rest.actuation = way_.here.actuation;
  if (!change_loads(rest, way_.to)) return false;
  together_ = Together{way_, at, settler_.active, settler_.last};
  const Demand to = way_.to;
  way_.before = way_.done;
  set_out(way_.here, rest);
  way_.then = to;
  return true;
}

/// Weights alone lead nowhere: loads may carry them.
void Continuation::go_together(Iterate& at) {
  Together& before = *together_;
  way_ = std::move(before.way);
  at = std::move(before.at);
  settler_.active = std::move(before.active);
  settler_.last = before.last;
  settler_.good_shape = at.positions;
  way_.advance *= 0.4;
  way_.factorised = false;
  way_.marked_iterations = report_.iterations;
  report_.remark.clear();
}

}  // namespace softkin::physical
