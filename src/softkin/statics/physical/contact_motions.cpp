#include <algorithm>
#include <cmath>
#include <softkin/contact/collision.hpp>
#include <softkin/statics/physical/contacts.hpp>
#include <utility>

// Contact candidates along a motion, and the longest motion without collision.

namespace softkin::physical {

namespace {

/// A motion may shrink gaps to this fraction.
constexpr double kept_gap = 0.1;

/// Returns the largest displacement of a vertex [mm].
double moved(const Points& from, const Points& to) {
  return from.rows() == to.rows() ? std::sqrt((to - from).rowwise().squaredNorm().maxCoeff()) : HUGE_VAL;
}

}  // namespace

/// Returns the largest distance of a vertex between a shape and the nearest one on the searched motion [mm].
double Contacts::Scratch::Around::beside(const Points& points) const {
  if (begin.rows() != points.rows()) return HUGE_VAL;
  const Points motion = end - begin;
  const double square = motion.squaredNorm();
  const double fraction = square > 0 ? std::clamp((points - begin).cwiseProduct(motion).sum() / square, 0.0, 1.0) : 0;
  return moved(begin + fraction * motion, points);
}

void Contacts::search(const Points& from, const Points& to, Scratch& scratch, Team& team) const {
  std::swap(scratch.around, scratch.before);
  scratch.around.reach = reach_mm(scratch);
  scratch.broad.find(from, to, scratch.around.reach + margin_mm_, team, scratch.around.pairs);
  scratch.around.begin = from;
  scratch.around.end = to;
  scratch.around.least = -1;
}

void Contacts::find(const Points& positions, Scratch& scratch, Team& team) const {
  Points room;
  const Points& points = points_.of(positions, room);
  const double reach = reach_mm(scratch);
  const auto holds_those_of = [&](const Scratch::Around& around) {
    return around.reach >= reach && 2 * around.beside(points) <= margin_mm_;
  };
  if (!holds_those_of(scratch.around)) {
    if (holds_those_of(scratch.before))
      std::swap(scratch.around, scratch.before);
    else
      search(points, points, scratch, team);
  }
  scratch.close = scratch.around.pairs;
  keep_close(points, scratch.stiffness_scale, scratch.close);
  potential_->find(points, scratch.close, scratch.terms, scratch.stiffness_scale);
  if (scratch.straight) potential_->straighten(scratch.terms, scratch.pushes);
}

double Contacts::largest_turn(const Points& from, const Points& to) const {
  Points room, room_of_end;
  const Points &start = points_.of(from, room), &end = points_.of(to, room_of_end);
  double most = 0;
  for (const auto& [a, b] : surfaces_.surface.edges) {
    const auto before = start.row(b) - start.row(a), after = end.row(b) - end.row(a);
    most = std::max(most, (after - before).squaredNorm() / before.squaredNorm());
  }
  return std::sqrt(most);
}

double Contacts::longest_step(const Points& from, const Points& to, Term::Scratch& scratch, Team& team) const {
  Points room, room_of_end;
  return longest_step_of_points(points_.of(from, room), points_.of(to, room_of_end), static_cast<Scratch&>(scratch),
                                team);
}

double Contacts::longest_step_of_points(const Points& from, const Points& to, Scratch& scratch, Team& team) const {
  Scratch::Around& around = scratch.around;
  const auto safe = [&](const Points& end) {
    return contact::safe_motion(surfaces_.surface, around.pairs, from, end, kept_gap, team);
  };
  if (!(2 * std::max(around.beside(from), around.beside(to)) <= margin_mm_)) {
    // the known candidates may shorten the motion, so that less of it is searched
    const double most = safe(to);
    const Points end = most < 1 ? Points(from + most * (to - from)) : to;
    search(from, end, scratch, team);
    return most * safe(end);
  }
  const double motion = std::max(moved(around.end, from), moved(around.end, to));
  if (2 * motion <= margin_mm_) {
    if (around.least < 0)
      around.least = std::sqrt(contact::min_squared_distance(surfaces_.surface, around.pairs, around.end, team));
    if (2 * motion < (1 - kept_gap) * around.least) return 1;
  }
  return safe(to);
}

}  // namespace softkin::physical
