#include <algorithm>
#include <softkin/statics/physical/segment_check.hpp>
#include <utility>

namespace softkin::physical {

bool SegmentCheck::is_short(const System& system, const SegmentCheckOptions& options, double move_mm) {
  return move_mm <= options.min_move * system.model().diagonal_mm;
}

SegmentCheck::SegmentCheck(Corrector& corrector, StepTracer& tracer, const Equilibria::Options& options,
                           const LoadState& from, const LoadState& to)
    : ArcLength(corrector, tracer, options, {from, to}) {}

double SegmentCheck::size(const Points& moves) const {
  return system_.largest_move(Points::Zero(moves.rows(), 3), moves);
}

/// Is Newton's step in the middle of a segment short? The step uses the current factorisation.
///
/// aside  offset of the middle of the curve from the middle of the secant
bool SegmentCheck::is_balanced_between(const SegmentEnd& low, const SegmentEnd& high, const Points& aside) {
  const LoadState there = load_state(0.5 * (low.factor + high.factor));
  Iterate middle = *low.at;
  middle.positions = 0.5 * (low.at->positions + high.at->positions) + aside;
  middle.multipliers = 0.5 * (low.at->multipliers + high.at->multipliers);
  Balance balance;
  const std::optional<Eigen::VectorXd> step = step_from(middle, there, balance);
  evaluate(high);
  return step && !balance.inverted &&
         system_.freedoms().size_of(*step, middle.positions).largest <=
             tuning_.segment_check.max_middle_step * size(high.at->positions - low.at->positions);
}

/// Does the tangent at the begin predict the end? If the prediction was an extrapolation, the error at the end
/// suffices.
bool SegmentCheck::is_predicted(const SegmentEnd& low, const SegmentEnd& high, const Points& predicted) {
  const Points secant = high.at->positions - low.at->positions;
  if (size(predicted - secant) > tuning_.segment_check.max_error_ahead * size(secant)) return false;
  return low.rate.rows() == 0 || is_balanced_between(low, high, ((high.factor - low.factor) * low.rate - secant) / 4);
}

/// Does the tangent at the end lead back to the begin?
bool SegmentCheck::is_retraced(const SegmentEnd& low, const SegmentEnd& high) {
  const Points secant = high.at->positions - low.at->positions;
  const Points behind = (high.factor - low.factor) * high.rate - secant;
  return size(behind) <= tuning_.segment_check.max_error_at_an_end * size(secant) &&
         is_balanced_between(low, high, -behind / 4);
}

bool SegmentCheck::tangents_agree(const SegmentEnd& low, const SegmentEnd& high) const {
  const double length = high.factor - low.factor;
  const Points secant = high.at->positions - low.at->positions;
  const Points ahead = length * low.rate - secant, behind = length * high.rate - secant;
  const double whole = size(secant);
  return size(ahead) <= tuning_.segment_check.max_error_ahead * whole ||
         (size(ahead) <= tuning_.segment_check.max_error_at_an_end * whole &&
          size(behind) <= tuning_.segment_check.max_error_at_an_end * whole &&
          size(ahead + behind) <= tuning_.segment_check.max_error_together * whole);
}

bool SegmentCheck::agree(const SegmentEnd& low, const SegmentEnd& high) {
  return tangents_agree(low, high) &&
         is_balanced_between(low, high, (high.factor - low.factor) / 8 * (low.rate - high.rate));
}

SegmentCheck::Verdict SegmentCheck::check(SegmentEnd low, SegmentEnd high, const Points& predicted, bool changed) {
  if (is_predicted(low, high, predicted)) return Verdict::confirmed;
  const bool extrapolated = low.rate.rows() == 0;
  // the current factorisation is of a nearby shape, and mostly good enough
  const bool at_hand = !changed && !turns();
  if (at_hand) {
    high.rate = rate_towards(low, high);
    if (extrapolated && is_retraced(low, high)) return Verdict::confirmed;
  }
  if (!at_hand || extrapolated) {
    lost_factor_ = true;
    if (!factorise(low)) return Verdict::unclear;
    low.rate = rate_towards(high, low);
    if (!factorise(high)) return Verdict::unclear;
    high.rate = rate_towards(low, high);
    lost_factor_ = false;
  }
  return agree(low, high) ? Verdict::confirmed : check_by_middles(low, high);
}

SegmentCheck::Verdict SegmentCheck::check_by_middles(const SegmentEnd& low, const SegmentEnd& high) {
  const double energy = record_.energy, gradient_norm = record_.gradient_norm, step_mm = record_.step_mm;
  iterations_ = record_.iterations;
  const Verdict verdict = check_halves(low, high, tuning_.segment_check.max_halvings);
  record_.energy = energy;
  record_.gradient_norm = gradient_norm;
  record_.step_mm = step_mm;
  lost_factor_ = verdict != Verdict::confirmed || !factorise(high);
  return verdict;
}

/// Do supports turn on the path?
bool SegmentCheck::turns() const {
  return system_.placement().largest_turn(load_state(0), load_state(1)) > 0;
}

/// Evaluates an end of a segment, because the workspace contains the evaluation of a middle.
void SegmentCheck::evaluate(const SegmentEnd& end) {
  Balance balance;
  system_.evaluate(*end.at, load_state(end.factor), corrector_.active, work_, balance, team_);
}

bool SegmentCheck::factorise(const SegmentEnd& end) {
  return corrector_.prepare(load_state(end.factor), *end.at) >= 0;
}

/// Returns the tangent of the path at one end, with the current factorisation. A support that moves on an arc follows
/// its tangent over a small part of the segment only.
Points SegmentCheck::rate_towards(const SegmentEnd& other, const SegmentEnd& at) {
  const double change = (turns() ? tuning_.segment_check.rate_difference : 1) * (other.factor - at.factor);
  return first_order_moves(system_, load_state(at.factor), load_state(at.factor + change), corrector_.active, work_,
                           team_, *at.at) /
         change;
}

SegmentCheck::Verdict SegmentCheck::check_halves(const SegmentEnd& low, const SegmentEnd& high, int depth) {
  const bool short_segment =
      is_short(system_, tuning_.segment_check, system_.largest_move(low.at->positions, high.at->positions)) &&
      is_short(system_, tuning_.segment_check, (high.factor - low.factor) * size(low.rate));
  if (short_segment || (depth < tuning_.segment_check.max_halvings && agree(low, high))) return Verdict::confirmed;
  if (depth == 0 || record_.iterations - iterations_ > tuning_.segment_check.max_corrections) return Verdict::unclear;
  Point found;
  const Verdict verdict = find_middle(low, high, found);
  if (verdict != Verdict::confirmed) return verdict;
  if (corrected_ <= tuning_.segment_check.max_middle_step * size(high.at->positions - low.at->positions) &&
      tangents_agree(low, high))
    return Verdict::confirmed;
  const SegmentEnd middle{&found.at, found.load_factor,
                          rate(found, tuning_.segment_check.rate_difference * (high.factor - low.factor)),
                          found.negative};
  const Verdict first = check_halves(low, middle, depth - 1);
  return first == Verdict::confirmed ? check_halves(middle, high, depth - 1) : first;
}

/// Returns the derivative of the positions by the load factor, as a difference over a small change.
Points SegmentCheck::rate(const Point& point, double change) const {
  Points ahead = point.at.positions;
  system_.freedoms().move(point.ahead, change / point.slope, ahead);
  system_.placement().hold(load_state(point.load_factor + change), ahead);
  return (ahead - point.at.positions) / change;
}

/// Finds the equilibrium on the plane normal to the secant, from the middle of the cubic through both ends whose
/// tangents are no longer than the secant.
SegmentCheck::Verdict SegmentCheck::find_middle(const SegmentEnd& low, const SegmentEnd& high, Point& middle) {
  const double length = high.factor - low.factor;
  const Points secant = high.at->positions - low.at->positions;
  const double whole = size(secant);
  const auto shortened = [&](const SegmentEnd& end) { return std::min(1.0, whole / (length * size(end.rate))); };
  const double begins = shortened(low), ends = shortened(high);
  Point from{.at = *low.at, .load_factor = low.factor};
  middle = from;
  middle.load_factor = 0.5 * (low.factor + high.factor) + length * (begins - ends) / 8;
  middle.at.positions =
      0.5 * (low.at->positions + high.at->positions) + length * (begins * low.rate - ends * high.rate) / 8;
  middle.at.multipliers = 0.5 * (low.at->multipliers + high.at->multipliers);
  const LoadState there = load_state(middle.load_factor);
  system_.placement().hold(there, middle.at.positions);
  corrector_.give_loads(there, middle.at);
  from.ahead.resize(system_.freedoms().size());
  system_.freedoms().reduce(secant, middle.at.positions, from.ahead);
  if (!(from.ahead.norm() > 0)) return Verdict::unclear;
  from.ahead.normalize();
  tracer_.begin(low.factor, high.factor, length, "check");
  const Points begun = middle.at.positions;
  bool found = correct(from, 0.5 * whole, tuning_.segment_check.middle_accuracy * whole, middle);
  const auto is_passed = [&] {
    return middle.negative > std::max(low.negative, high.negative) || !(middle.slope > 0) ||
           !(low.factor < middle.load_factor && middle.load_factor < high.factor);
  };
  // at a shape that is not quite an equilibrium, compressed stiff parts may seem to buckle
  if (found && is_passed()) found = correct(from, 0.5 * whole, options_.tolerance_mm, middle);
  corrected_ = system_.largest_move(begun, middle.at.positions);
  const bool held = found && holds(middle), passed = found && is_passed();
  tracer_.end(held && !passed,
              !found   ? why_
              : !held  ? "a cable slackens or pulls in the middle"
              : passed ? "a limit point is passed"
                       : "",
              0.5 * whole, corrected_);
  if (interrupted_) return Verdict::interrupted;
  if (!held) return Verdict::unclear;
  return passed ? Verdict::passes_limit_point : Verdict::confirmed;
}

}  // namespace softkin::physical
