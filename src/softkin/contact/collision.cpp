#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <softkin/contact/apart.hpp>
#include <softkin/contact/collision.hpp>

namespace softkin::contact {

namespace {

template <std::size_t N>
double largest_speed(const FourPoints& motion, const std::array<PointPair, N>& pairs) {
  double largest = 0;
  for (const auto& [i, j] : pairs) largest = std::max(largest, (motion.col(i) - motion.col(j)).squaredNorm());
  return std::sqrt(largest);
}

/// How long all points of one feature stay more than `apart` from those of the other along a direction, whatever that
/// direction is; below 0 where they are not.
template <std::size_t N>
double time_apart(const FourPoints& x, const FourPoints& motion, const std::array<PointPair, N>& pairs,
                  const Vec3& direction, double apart) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [i, j] : pairs) {
    const double gap = direction.dot(x.col(i) - x.col(j)) - apart;
    const double approach = -direction.dot(motion.col(i) - motion.col(j));
    if (gap < 0) return -1;
    if (approach > 0) least = std::min(least, gap / approach);
  }
  return least;
}

/// Returns how long the triangle's plane and the vertex, or the parallel planes through two edges, stay more than
/// `apart` from each other, up to `horizon`: they may turn during the motion, which time_apart counts as an approach. 0
/// where they are closer at once.
///
/// equation  (u x v) . w > apart |u x v| with u, v, w linear in time: left a cubic, right bounded by its polynomials
double time_of_planes(const FourPoints& x, const FourPoints& motion, const Separation& between, const PointPair& pair,
                      double apart, double horizon) {
  const auto along = [](const FourPoints& of, const FreeWeight& weight) -> Vec3 {
    return of.col(weight.plus) - of.col(weight.minus);
  };
  const Vec3 &u = between.moves[0].along, &v = between.moves[1].along, w = x.col(pair[0]) - x.col(pair[1]);
  const Vec3 du = along(motion, between.moves[0]), dv = along(motion, between.moves[1]);
  const Vec3 dw = motion.col(pair[0]) - motion.col(pair[1]);
  const Vec3 n = u.cross(v), dn = u.cross(dv) + du.cross(v), ddn = du.cross(dv);
  const double sign = n.dot(w) < 0 ? -1 : 1;
  const double rounding = 64 * std::numeric_limits<double>::epsilon() * (u.norm() + horizon * du.norm()) *
                          (v.norm() + horizon * dv.norm()) * (w.norm() + horizon * dw.norm());
  const double f0 = sign * n.dot(w) - apart * n.norm() - rounding;
  const double f1 = sign * (dn.dot(w) + n.dot(dw)) - apart * dn.norm();
  const double f2 = sign * (ddn.dot(w) + dn.dot(dw)) - apart * ddn.norm(), f3 = sign * ddn.dot(dw);
  if (!(f0 > 0)) return 0;
  double longest = 0;
  for (int tries = 0; tries < 8; ++tries) {
    // f >= f0 + slope t for t up to the horizon; the shorter that is, the steeper the slope need not be
    const double slope = f1 + std::min(0.0, horizon * std::min(f2, f2 + horizon * f3));
    longest = std::max(longest, slope < 0 ? std::min(horizon, -f0 / slope) : horizon);
    if (2 * longest >= horizon) break;
    horizon = 2 * longest;
  }
  return longest;
}

template <std::size_t N>
double safe_fraction(const FourPoints& from, const FourPoints& to, double keep, double until,
                     const std::array<PointPair, N>& pairs, Separation (*separation)(const FourPoints&)) {
  constexpr int max_advances = 100;
  constexpr int patience = 2;             // advances after which it is worth more to look longer
  constexpr double small_advance = 3e-4;  // of the safe fraction: the remainder is not worth a distance computation
  const FourPoints motion = to - from;
  const double speed = largest_speed(motion, pairs);
  if (speed == 0) return until;
  // of all that is rounded here, and of positions that are rounded once more
  const double rounding =
      32 * std::numeric_limits<double>::epsilon() * (from.cwiseAbs().maxCoeff() + to.cwiseAbs().maxCoeff());
  double fraction = 0, floor = 0;
  for (int advance = 0; advance < max_advances; ++advance) {
    const FourPoints x = from + fraction * motion;
    const Separation between = separation(x);
    const double distance = std::sqrt(between.squared);
    if (advance == 0) floor = keep * distance + rounding;
    if (!(distance > floor)) break;
    double step = std::max((distance - floor) / speed, time_apart(x, motion, pairs, between.vector / distance, floor));
    if (advance >= patience && between.free == 2)
      step = std::max(step, time_of_planes(x, motion, between, pairs[0], floor, 1 - fraction));
    if (!(fraction + step < until)) return until;
    fraction += step;
    if (step < small_advance * fraction) break;
  }
  return fraction;
}

}  // namespace

double safe_vertex_triangle(const FourPoints& from, const FourPoints& to, double keep, double until) {
  return safe_fraction(from, to, keep, until, of_triangle, vertex_triangle);
}

double safe_edge_edge(const FourPoints& from, const FourPoints& to, double keep, double until) {
  return safe_fraction(from, to, keep, until, of_edges, edge_edge);
}

namespace {

/// The least value of all candidates, from a value that none exceeds; value(nodes, is of edges, the least so far)
template <class Value>
double min_of(const Surface& surface, const Candidates& candidates, double most, Team& team, const Value& value) {
  std::atomic<double> least{most};
  const auto lower = [&](double found) {
    double before = least.load(std::memory_order_relaxed);
    while (found < before && !least.compare_exchange_weak(before, found, std::memory_order_relaxed)) {
    }
  };
  const auto look = [&](const std::vector<Pair>& pairs, auto nodes_of, bool edges) {
    team.pieces(pairs.size(), [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        lower(value(nodes_of(surface, pairs[i]), edges, least.load(std::memory_order_relaxed)));
    });
  };
  look(candidates.vertex_triangle, nodes_of_vertex_triangle, false);
  look(candidates.edge_edge, nodes_of_edge_edge, true);
  return least.load();
}

}  // namespace

double safe_motion(const Surface& surface, const Candidates& candidates, const Points& from, const Points& to,
                   double keep, Team& team) {
  // a pair that is safe beyond what others are stops there: the least does not depend on who was first
  return min_of(surface, candidates, 1, team, [&](const Nodes& nodes, bool edges, double least) {
    return (edges ? safe_edge_edge : safe_vertex_triangle)(points_of(from, nodes), points_of(to, nodes), keep, least);
  });
}

double min_squared_distance(const Surface& surface, const Candidates& candidates, const Points& positions, Team& team) {
  return min_of(surface, candidates, HUGE_VAL, team, [&](const Nodes& nodes, bool edges, double) {
    const FourPoints x = points_of(positions, nodes);
    return edges ? edge_edge(x).squared : vertex_triangle(x).squared;
  });
}

}  // namespace softkin::contact
