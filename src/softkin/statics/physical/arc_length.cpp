#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/statics/physical/arc_length.hpp>
#include <utility>

namespace softkin::physical {

/// Returns the arc length from a point to the maximum of the load factor before another one, by a cubic. Stores the
/// maximum.
double ArcLength::largest_between(const Point& low, const Beyond& high) {
  const double length = high.away, rise = (high.load_factor - low.load_factor) / length;
  const double a = (low.slope + high.slope - 2 * rise) / (length * length),
               b = (3 * rise - 2 * low.slope - high.slope) / length, c = low.slope;
  const double top =
      std::min(length, c / (std::sqrt(std::max(0.0, b * b - 3 * a * c)) - b));  // the root where it falls
  largest_ = low.load_factor + top * (c + top * (b + top * a));
  return top;
}

ArcLength::ArcLength(Corrector& corrector, StepTracer& tracer, const Equilibria::Options& options, const Route& route)
    : Follower(corrector, tracer, options), route_(route) {}

/// Computes the tangent of the curve at a point whose stiffness is factorised, in the direction of travel.
///
/// balance  of the point
/// before   the tangent of the previous point; null: the load factor increases
bool ArcLength::set_rates(const Balance& balance, const Eigen::VectorXd* before, Point& point) {
  const LoadState here = load_state(point.load_factor),
                  there = load_state(point.load_factor + tuning_.arc_length.factor_difference);
  if (system_.placement().changes(here, there))
    system_.assemble(point.at, here, balance, System::Stiffness::exact, work_, team_);
  Balance residual_change;
  system_.residual_change(point.at, here, there, corrector_.active, work_, residual_change, team_);
  work_.saddle.step(residual_change, point.ahead, point.multipliers, team_);
  const double length = point.ahead.norm() / tuning_.arc_length.factor_difference;
  if (!(length > 0) || !std::isfinite(length) || !point.multipliers.allFinite()) return false;
  const double path = before != nullptr && point.ahead.dot(*before) < 0 ? -1 : 1;
  point.slope = path / length;
  point.ahead *= point.slope / tuning_.arc_length.factor_difference;
  point.multipliers *= point.slope / tuning_.arc_length.factor_difference;
  return true;
}

/// Prepares the point where the curve is entered; false if it is not stable.
bool ArcLength::begin(const Iterate& at, Point& point) {
  point = {.at = at, .load_factor = route_.done};
  const LoadState here = load_state(point.load_factor);
  Balance balance;
  system_.evaluate(point.at, here, corrector_.active, work_, balance, team_);
  record_.note_factorisation(true);
  point.negative = system_.factorise(point.at, here, corrector_.active, balance, {}, work_, team_);
  return point.negative == 0 && balance.force.allFinite() && set_rates(balance, nullptr, point);
}

/// Applies Newton's method in the plane normal to the tangent, starting from a step along it.
bool ArcLength::correct(const Point& from, double whole, double tolerance, Point& point) {
  double before = 0;
  missed_ = std::numeric_limits<double>::infinity();
  why_ = "its iterations were not enough";
  for (int i = 0; i < tuning_.arc_length.max_corrections; ++i) {
    if (!corrector_.newton().may_continue()) {
      interrupted_ = true;
      return false;
    }
    const LoadState here = load_state(point.load_factor);
    Balance balance;
    system_.evaluate(point.at, here, corrector_.active, work_, balance, team_);
    if (balance.forbidden || !balance.force.allFinite() || (balance.inverted && !corrector_.last.inverted)) {
      why_ = "an element is inverted";
      return false;
    }
    record_.note_factorisation(true);
    point.negative = system_.factorise(point.at, here, corrector_.active, balance, {System::Stiffness::exact, 0, true},
                                       work_, team_);
    Eigen::VectorXd step, change;
    work_.saddle.first_step(balance, step, change);
    if (!set_rates(balance, &from.ahead, point)) return false;
    // a move along the curve brings the step back into the plane
    const double along = -from.ahead.dot(step) / from.ahead.dot(point.ahead);
    step += along * point.ahead;
    change += along * point.multipliers;
    const double move = system_.freedoms().size_of(step, point.at.positions).largest;
    if (i == 0) missed_ = move / whole;
    // the first correction mostly relaxes stiff deformations and moves little, so the second one may be longer
    if (!(move < (i < 2 ? tuning_.arc_length.max_error * whole : tuning_.arc_length.min_contraction * before)) ||
        !change.allFinite())
      return false;
    before = move;
    point.load_factor += along * point.slope;
    const LoadState there = load_state(point.load_factor);
    system_.advance(step, 1, work_, point.at.positions, team_, &there);
    point.at.multipliers += change;
    corrector_.give_loads(there, point.at);
    const IterationRecord entry{.energy = balance.energy, .step_mm = move, .gradient_norm = balance.force.norm()};
    record_.note_iteration(entry, options_.keep_history);
    if (move < tolerance) return true;
  }
  return false;
}

/// Is every active cable under tension, and no slack cable longer than commanded?
bool ArcLength::holds(const Point& point) const {
  Iterate trial = point.at;
  const std::vector<bool> before = corrector_.active;
  const bool changed = corrector_.change_active(load_state(point.load_factor), trial);
  corrector_.active = before;
  return !changed;
}

std::optional<ArcLength::Point> ArcLength::go(const Point& from, double length) {
  Point next{.at = from.at, .load_factor = from.load_factor + length * from.slope};
  Eigen::VectorXd step = length * from.ahead;
  if (from.bend.size() > 0 && 0.5 * length * from.bend.norm() < tuning_.arc_length.max_bend) {
    step += 0.5 * length * length * from.bend;
    next.load_factor += 0.5 * length * length * from.slope_change;
  }
  const LoadState there = load_state(next.load_factor);
  tracer_.begin(from.load_factor, next.load_factor, std::abs(next.load_factor - from.load_factor), "arc length");
  system_.advance(step, 1, work_, next.at.positions, team_, &there);
  next.at.multipliers += length * from.multipliers;
  corrector_.give_loads(there, next.at);
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

std::optional<Eigen::VectorXd> ArcLength::step_from(Iterate& shape, const LoadState& there, Balance& balance) {
  system_.placement().hold(there, shape.positions);
  corrector_.give_loads(there, shape);
  system_.evaluate(shape, there, corrector_.active, work_, balance, team_);
  if (balance.forbidden || !balance.force.allFinite()) return std::nullopt;
  Eigen::VectorXd step, change;
  work_.saddle.step(balance, step, change, team_);
  return step;
}

/// Is the middle of the cubic through two points and their tangents close to the curve? If it is not, the corrector may
/// have converged to another branch. The check is Newton's step with the current factorisation, which is near the far
/// end. Where that step is long, as for a thin part under stretch, the point of the curve is computed.
bool ArcLength::is_curve_between(const Point& low, const Point& high, double length) {
  const double rise = (high.load_factor - low.load_factor) / length;
  if (std::abs(low.slope + high.slope - 2 * rise) >
      tuning_.arc_length.max_slope_error * (std::abs(low.slope) + std::abs(high.slope)))
    return false;
  Point middle{.at = low.at,
               .load_factor = 0.5 * (low.load_factor + high.load_factor) + length * (low.slope - high.slope) / 8};
  middle.at.positions = 0.5 * (low.at.positions + high.at.positions);
  system_.freedoms().move(low.ahead - high.ahead, length / 8, middle.at.positions);
  middle.at.multipliers =
      0.5 * (low.at.multipliers + high.at.multipliers) + length * (low.multipliers - high.multipliers) / 8;
  Balance balance;
  std::optional<Eigen::VectorXd> step = step_from(middle.at, load_state(middle.load_factor), balance);
  if (!step) return false;
  Point across{.at = low.at, .load_factor = low.load_factor, .ahead = (low.ahead + high.ahead).normalized()};
  *step -= across.ahead.dot(*step) / across.ahead.dot(high.ahead) * high.ahead;
  const double whole = system_.largest_move(low.at.positions, high.at.positions),
               most = tuning_.arc_length.max_middle_step * whole;
  if (system_.freedoms().size_of(*step, middle.at.positions).largest <= most) return true;
  const Points begun = middle.at.positions;
  return correct(across, 0.5 * whole, tuning_.arc_length.middle_accuracy * whole, middle) &&
         system_.largest_move(begun, middle.at.positions) <= most;
}

/// Returns the point at the end of a step, which is shortened when it fails; none if the shortened steps fail, too.
std::optional<ArcLength::Point> ArcLength::next(const Point& from, Pace& pace) {
  while (record_.iterations < pace.max_iterations && pace.length > pace.shortest) {
    std::optional<Point> found = go(from, pace.length);
    pace.missed = found ? 0 : pace.missed + 1;
    if (interrupted_ || pace.missed > pace.max_missed) break;
    pace.length *= std::clamp(std::sqrt(tuning_.arc_length.wanted_error / missed_), tuning_.arc_length.min_shortening,
                              found ? tuning_.arc_length.max_growth : tuning_.arc_length.max_shortening);
    if (found) return found;
  }
  return std::nullopt;
}

ArcLength::End ArcLength::follow(Iterate& at) {
  const Temporarily twice(work_.saddle.precision(), linear::MixedLdlt::Precision::twice);
  Point low;
  if (!begin(at, low)) return End::lost;
  const double first = low.load_factor;
  const double length = tuning_.arc_length.first_step * (route_.failed - low.load_factor) / low.slope;
  Pace steps{length, tuning_.arc_length.min_step * length, record_.iterations + tuning_.arc_length.max_iterations,
             tuning_.arc_length.max_failures};
  End end = End::lost;
  std::optional<Beyond> high;
  std::optional<Point> far;  // beyond the limit point
  bool last = false;         // whether the step ends just before the limit point
  while (end == End::lost) {
    const double requested = steps.length;
    std::optional<Point> found = next(low, steps);
    if (!found) break;
    // an unstable point with increasing load factor lies beyond a bifurcation, not beyond a limit point
    const bool turned = found->slope < 0;
    if (!holds(*found) || turned != (found->negative > 0)) break;
    if (turned) {
      high = Beyond{found->went, found->load_factor, found->slope};
      far = std::move(found);
    } else {
      if (found->load_factor > route_.failed || found->load_factor >= 1)
        end = End::passed;
      else if (last && found->went == requested)
        end = End::turned;
      if (high) high->away -= found->went;
      if (found->load_factor < 1) low = std::move(*found);
    }
    if (high) {
      const double top = largest_between(low, *high);
      steps.length = std::max(top - tuning_.arc_length.before_turn * high->away, 0.5 * top);
      last = true;
      if (steps.length <= steps.shortest && low.load_factor > first)
        end = End::turned;  // closer than the shortest step
    }
  }
  if (low.load_factor > first && !keep(low, at)) end = End::lost;
  if (interrupted_) return End::interrupted;
  return end == End::turned && route_.beyond ? go_beyond(std::move(*far), at) : end;
}

/// Continues beyond the limit point to a stable equilibrium with a larger load factor, at most the requested one.
ArcLength::End ArcLength::go_beyond(Point last, Iterate& at) {
  Pace steps{last.went, tuning_.beyond_turn.min_step * last.went,
             record_.iterations + tuning_.beyond_turn.max_iterations, tuning_.beyond_turn.max_failures};
  while (std::optional<Point> found = next(last, steps)) {
    if (!holds(*found) || found->load_factor < tuning_.beyond_turn.min_load_factor) break;
    if (found->slope > 0 && found->negative == 0 && found->load_factor > route_.done) {
      found->load_factor = std::min(found->load_factor, 1.0);
      const Jump jump{route_.done, jump_to(last, *found, at)};
      if (!keep(*found, at)) break;
      jump_ = jump;
      return End::passed;
    }
    last = std::move(*found);
  }
  return interrupted_ ? End::interrupted : End::turned;
}

/// Returns the distance to the equilibrium under the loads of the limit point. It lies before the first point found
/// with a larger load factor, which itself depends on the step sizes.
double ArcLength::jump_to(const Point& before, const Point& found, const Iterate& at) {
  const double far = system_.largest_move(at.positions, found.at.positions);
  if (!(before.load_factor < route_.done && route_.done < found.load_factor && before.negative == 0)) return far;
  const double part = (route_.done - before.load_factor) / (found.load_factor - before.load_factor);
  const LoadState there = load_state(route_.done);
  Iterate trial = found.at;
  trial.positions = before.at.positions + part * (found.at.positions - before.at.positions);
  trial.multipliers = before.at.multipliers + part * (found.at.multipliers - before.at.multipliers);
  system_.placement().hold(there, trial.positions);
  if (corrector_.correct(there, Newton::Policy::follow, trial) != Newton::Outcome::converged) return far;
  const double near = system_.largest_move(at.positions, trial.positions);
  return near > 0.5 * far ? near : far;
}

/// Accepts a point after correcting it at its fixed load factor by Newton's method.
bool ArcLength::keep(const Point& found, Iterate& at) {
  Iterate trial = found.at;
  const auto outcome = corrector_.correct(load_state(found.load_factor), Newton::Policy::follow, trial);
  interrupted_ = outcome == Newton::Outcome::interrupted;
  if (outcome != Newton::Outcome::converged || (corrector_.newton().inverted() && !corrector_.last.inverted))
    return false;
  corrector_.take(at, std::move(trial));
  corrector_.last = corrector_.judged();
  route_.done = found.load_factor;
  return true;
}

}  // namespace softkin::physical
