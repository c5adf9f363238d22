#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/statics/physical/arc_length.hpp>
#include <utility>

namespace softkin::physical {

namespace {

/// The first step over the tangent to where a step of the share failed.
constexpr double first_share = 0.5;
/// What a step is to miss the curve by, over its length, and what it may; bounds of the next step over the last one.
constexpr double wanted_miss = 0.1, most_miss = 1, most_grown = 2, most_shrinking = 0.1, least_shrinking = 0.4;
/// Newton's step in the middle of a step, over its length; the accuracy of a point there; and by what the slopes of the
/// share at both ends may differ from those of a parabola, over their sum: on another branch it is more.
constexpr double most_off_balance = 0.05, middle_accuracy = 1e-3, most_off_parabola = 0.3;
/// Each correction but the second is so much shorter than the one before.
constexpr double least_gain = 0.5;
/// Of a step, in a row, and of all.
constexpr int most_corrections = 8, most_failed_steps = 3, most_iterations = 60;
/// Over the first step: where the curve has a corner steps become ever shorter.
constexpr double shortest_step = 0.02;
/// Of the way, on which it is looked what a change of the share upsets.
constexpr double factor_difference = 1e-3;
/// The shape that is kept stands so far before the turn, over the way to the point beyond it: at it the stiffness is
/// singular.
constexpr double before_turn = 0.02;
/// Of steps beyond the turn, where the curve may bend sharply; and how far the share may fall there.
constexpr int most_iterations_beyond = 300, most_failed_beyond = 8;
constexpr double shortest_step_beyond = 1e-4;
constexpr double farthest_back = -1;

}  // namespace

/// How far it is from a point to where the share is largest before another one, by a cubic; and how large it is there.
double ArcLength::largest_between(const Point& low, const Beyond& high) {
  const double length = high.away, rise = (high.share - low.share) / length;
  const double a = (low.slope + high.slope - 2 * rise) / (length * length),
               b = (3 * rise - 2 * low.slope - high.slope) / length, c = low.slope;
  const double top =
      std::min(length, c / (std::sqrt(std::max(0.0, b * b - 3 * a * c)) - b));  // the root where it falls
  largest_ = low.share + top * (c + top * (b + top * a));
  return top;
}

ArcLength::ArcLength(Settler& settler, StepTracer& tracer, const Equilibria::Options& options, const Route& route)
    : Follower(settler, tracer, options), route_(route) {}

/// Where the curve goes on from a point whose stiffness is factorised, on the side on which it came.
///
/// balance  of the point
/// before   the tangent of the last point; null: the share grows
bool ArcLength::set_rates(const Balance& balance, const Eigen::VectorXd* before, Point& point) {
  const Demand here = demand(point.share), there = demand(point.share + factor_difference);
  if (system_.placement().changes(here, there))
    system_.assemble(point.at, here, balance, System::Stiffness::exact, work_, team_);
  Balance upset;
  system_.upset(point.at, here, there, settler_.active, work_, upset, team_);
  work_.saddle.step(upset, point.ahead, point.multipliers, team_);
  const double length = point.ahead.norm() / factor_difference;
  if (!(length > 0) || !std::isfinite(length) || !point.multipliers.allFinite()) return false;
  const double way = before != nullptr && point.ahead.dot(*before) < 0 ? -1 : 1;
  point.slope = way / length;
  point.ahead *= point.slope / factor_difference;
  point.multipliers *= point.slope / factor_difference;
  return true;
}

/// The point where the curve is entered; false where it is not stable.
bool ArcLength::begin(const Iterate& at, Point& point) {
  point = {.at = at, .share = route_.done};
  const Demand here = demand(point.share);
  Balance balance;
  system_.evaluate(point.at, here, settler_.active, work_, balance, team_);
  ++report_.factorisations;
  ++report_.factorisations_in_double;
  point.negative = system_.factorise(point.at, here, settler_.active, balance, {}, work_, team_);
  return point.negative == 0 && balance.force.allFinite() && set_rates(balance, nullptr, point);
}

/// Newton's method across the tangent, from a step along it.
bool ArcLength::correct(const Point& from, double whole, double tolerance, Point& point) {
  double before = 0;
  missed_ = std::numeric_limits<double>::infinity();
  why_ = "its iterations were not enough";
  for (int i = 0; i < most_corrections; ++i) {
    if (!settler_.newton().goes_on()) {
      interrupted_ = true;
      return false;
    }
    const Demand here = demand(point.share);
    Balance balance;
    system_.evaluate(point.at, here, settler_.active, work_, balance, team_);
    if (balance.forbidden || !balance.force.allFinite() || (balance.inverted && !settler_.last.inverted)) {
      why_ = "an element is inverted";
      return false;
    }
    ++report_.factorisations;
    ++report_.factorisations_in_double;
    point.negative =
        system_.factorise(point.at, here, settler_.active, balance, {System::Stiffness::exact, 0, true}, work_, team_);
    Eigen::VectorXd step, change;
    work_.saddle.first_step(balance, step, change);
    if (!set_rates(balance, &from.ahead, point)) return false;
    // along the curve by what keeps it in the plane
    const double along = -from.ahead.dot(step) / from.ahead.dot(point.ahead);
    step += along * point.ahead;
    change += along * point.multipliers;
    const double move = system_.freedoms().size_of(step, point.at.positions).largest;
    if (i == 0) missed_ = move / whole;
    // what is stiff comes first, and moves little
    if (!(move < (i < 2 ? most_miss * whole : least_gain * before)) || !change.allFinite()) return false;
    before = move;
    point.share += along * point.slope;
    const Demand there = demand(point.share);
    system_.advance(step, 1, work_, point.at.positions, team_, &there);
    point.at.multipliers += change;
    settler_.give_loads(there, point.at);
    ++report_.iterations;
    report_.step_mm = move;
    report_.gradient_norm = balance.force.norm();
    report_.energy = balance.energy;
    if (options_.keep_history)
      report_.history.push_back({.energy = balance.energy, .step_mm = move, .gradient_norm = report_.gradient_norm});
    if (move < tolerance) return true;
  }
  return false;
}

/// Do cables that are held pull, and are those that are slack no longer than they are?
bool ArcLength::holds(const Point& point) const {
  Iterate trial = point.at;
  const std::vector<bool> before = settler_.active;
  const bool changed = settler_.change_active(demand(point.share), trial);
  settler_.active = before;
  return !changed;
}

std::optional<ArcLength::Point> ArcLength::go(const Point& from, double length) {
  constexpr double most_bend = 0.5;  // over the step
  Point next{.at = from.at, .share = from.share + length * from.slope};
  Eigen::VectorXd step = length * from.ahead;
  if (from.bend.size() > 0 && 0.5 * length * from.bend.norm() < most_bend) {
    step += 0.5 * length * length * from.bend;
    next.share += 0.5 * length * length * from.slope_change;
  }
  const Demand there = demand(next.share);
  tracer_.begin(from.share, next.share, std::abs(next.share - from.share), "arc length");
  system_.advance(step, 1, work_, next.at.positions, team_, &there);
  next.at.multipliers += length * from.multipliers;
  settler_.give_loads(there, next.at);
  const Points predicted = next.at.positions;
  const double whole = system_.freedoms().size_of(length * from.ahead, from.at.positions).largest;
  bool found = correct(from, whole, options_.tolerance_mm, next);
  const double missed = missed_;
  if (found && !is_curve_between(from, next, length)) {
    found = false;
    why_ = "between its ends is no curve of equilibria";
  }
  missed_ = missed;
  tracer_.end(found, found ? "" : why_, system_.largest_move(from.at.positions, predicted),
              system_.largest_move(predicted, next.at.positions));
  if (!found) return std::nullopt;
  next.bend = (next.ahead - from.ahead) / length;
  next.slope_change = (next.slope - from.slope) / length;
  next.went = length;
  if (system_.tendons().any()) system_.tendons().slide(next.at.positions, next.at.eyelets);
  return next;
}

std::optional<Eigen::VectorXd> ArcLength::step_from(Iterate& shape, const Demand& there, Balance& balance) {
  system_.placement().hold(there, shape.positions);
  settler_.give_loads(there, shape);
  system_.evaluate(shape, there, settler_.active, work_, balance, team_);
  if (balance.forbidden || !balance.force.allFinite()) return std::nullopt;
  Eigen::VectorXd step, change;
  work_.saddle.step(balance, step, change, team_);
  return step;
}

/// Is the middle of the cubic through two points, with their tangents, nearly on the curve? A corrector that converges
/// may have come to another branch. By Newton's step of the factorisation at hand, near the far end; where that is
/// long, as it is where something thin is stretched, by the point of the curve there.
bool ArcLength::is_curve_between(const Point& low, const Point& high, double length) {
  const double rise = (high.share - low.share) / length;
  if (std::abs(low.slope + high.slope - 2 * rise) > most_off_parabola * (std::abs(low.slope) + std::abs(high.slope)))
    return false;
  Point middle{.at = low.at, .share = 0.5 * (low.share + high.share) + length * (low.slope - high.slope) / 8};
  middle.at.positions = 0.5 * (low.at.positions + high.at.positions);
  system_.freedoms().move(low.ahead - high.ahead, length / 8, middle.at.positions);
  middle.at.multipliers =
      0.5 * (low.at.multipliers + high.at.multipliers) + length * (low.multipliers - high.multipliers) / 8;
  Balance balance;
  std::optional<Eigen::VectorXd> step = step_from(middle.at, demand(middle.share), balance);
  if (!step) return false;
  Point across{.at = low.at, .share = low.share, .ahead = (low.ahead + high.ahead).normalized()};
  *step -= across.ahead.dot(*step) / across.ahead.dot(high.ahead) * high.ahead;
  const double whole = system_.largest_move(low.at.positions, high.at.positions), most = most_off_balance * whole;
  if (system_.freedoms().size_of(*step, middle.at.positions).largest <= most) return true;
  const Points begun = middle.at.positions;
  return correct(across, 0.5 * whole, middle_accuracy * whole, middle) &&
         system_.largest_move(begun, middle.at.positions) <= most;
}

/// The point at the end of a step, which is made shorter where it leads nowhere; none: nor do those.
std::optional<ArcLength::Point> ArcLength::next(const Point& from, Pace& pace) {
  while (report_.iterations < pace.most_iterations && pace.length > pace.shortest) {
    std::optional<Point> found = go(from, pace.length);
    pace.missed = found ? 0 : pace.missed + 1;
    if (interrupted_ || pace.missed > pace.most_missed) break;
    pace.length *= std::clamp(std::sqrt(wanted_miss / missed_), most_shrinking, found ? most_grown : least_shrinking);
    if (found) return found;
  }
  return std::nullopt;
}

ArcLength::End ArcLength::follow(Iterate& at) {
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  Point low;
  if (!begin(at, low)) return End::lost;
  const double first = low.share;
  const double length = first_share * (route_.failed - low.share) / low.slope;
  Pace steps{length, shortest_step * length, report_.iterations + most_iterations, most_failed_steps};
  End end = End::lost;
  std::optional<Beyond> high;
  std::optional<Point> far;  // beyond the turn
  bool last = false;         // does the step lead to just before the turn
  while (end == End::lost) {
    const double asked = steps.length;
    std::optional<Point> found = next(low, steps);
    if (!found) break;
    // one that is unstable although the share grows has not turned, but passed where the curve forks
    const bool turned = found->slope < 0;
    if (!holds(*found) || turned != (found->negative > 0)) break;
    if (turned) {
      high = Beyond{found->went, found->share, found->slope};
      far = std::move(found);
    } else {
      if (found->share > route_.failed || found->share >= 1)
        end = End::passed;
      else if (last && found->went == asked)
        end = End::turned;
      if (high) high->away -= found->went;
      if (found->share < 1) low = std::move(*found);
    }
    if (high) {
      const double top = largest_between(low, *high);
      steps.length = std::max(top - before_turn * high->away, 0.5 * top);
      last = true;
      if (steps.length <= steps.shortest && low.share > first) end = End::turned;  // nearer than any step
    }
  }
  if (low.share > first && !keep(low, at)) end = End::lost;
  if (interrupted_) return End::interrupted;
  return end == End::turned && route_.beyond ? go_beyond(std::move(*far), at) : end;
}

/// On from beyond the turn to a stable equilibrium that bears more than is borne at the turn, or all that is asked.
ArcLength::End ArcLength::go_beyond(Point last, Iterate& at) {
  Pace steps{last.went, shortest_step_beyond * last.went, report_.iterations + most_iterations_beyond,
             most_failed_beyond};
  while (std::optional<Point> found = next(last, steps)) {
    if (!holds(*found) || found->share < farthest_back) break;
    if (found->slope > 0 && found->negative == 0 && found->share > route_.done) {
      found->share = std::min(found->share, 1.0);
      const Jump jump{route_.done, jump_to(last, *found, at)};
      if (!keep(*found, at)) break;
      jump_ = jump;
      return End::passed;
    }
    last = std::move(*found);
  }
  return interrupted_ ? End::interrupted : End::turned;
}

/// How far it is to the equilibrium under the loads of the turn, which lies before the first point found that bears
/// more: that point itself depends on the steps.
double ArcLength::jump_to(const Point& before, const Point& found, const Iterate& at) {
  const double far = system_.largest_move(at.positions, found.at.positions);
  if (!(before.share < route_.done && route_.done < found.share && before.negative == 0)) return far;
  const double part = (route_.done - before.share) / (found.share - before.share);
  const Demand there = demand(route_.done);
  Iterate trial = found.at;
  trial.positions = before.at.positions + part * (found.at.positions - before.at.positions);
  trial.multipliers = before.at.multipliers + part * (found.at.multipliers - before.at.multipliers);
  system_.placement().hold(there, trial.positions);
  if (settler_.settle(there, Newton::Policy::follow, trial) != Newton::Outcome::converged) return far;
  const double near = system_.largest_move(at.positions, trial.positions);
  return near > 0.5 * far ? near : far;
}

/// The equilibrium of a share is Newton's, from that of the curve.
bool ArcLength::keep(const Point& found, Iterate& at) {
  Iterate trial = found.at;
  const auto outcome = settler_.settle(demand(found.share), Newton::Policy::follow, trial);
  interrupted_ = outcome == Newton::Outcome::interrupted;
  if (outcome != Newton::Outcome::converged || (settler_.newton().inverted() && !settler_.last.inverted)) return false;
  settler_.take(at, std::move(trial));
  settler_.last = settler_.judged();
  route_.done = found.share;
  return true;
}

}  // namespace softkin::physical
