#include "support/exact_crossing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "random/exact_sign.hpp"

namespace softkin::testing {

namespace {

using Triple = std::array<Index, 3>;

/// What the corners of a triangle span: a triangle, whose projection along `axis` has an area, a segment or a point.
struct Hull {
  Triple corners;
  int count = 3;
  int axis = 0;

  /// The ends of its side i of three, two or one.
  [[nodiscard]] std::array<Index, 2> side(int i) const { return {corners[i], corners[(i + 1) % count]}; }
  [[nodiscard]] int sides() const { return count == 3 ? 3 : 1; }
};

/// Answers about the points of one list by signs that are exact: rounded ones where they are certain, which is nearly
/// always, else sums without rounding.
class ExactPoints {
 public:
  explicit ExactPoints(const Points& positions) : p_(positions) {}

  /// Sign of the volume of a tetrahedron.
  [[nodiscard]] int orientation(Index a, Index b, Index c, Index d) const {
    const Vec3 from = at(a), u = at(b) - from, v = at(c) - from, w = at(d) - from;
    const double volume = u.dot(v.cross(w));
    const Vec3 x = v.cwiseAbs(), y = w.cwiseAbs();
    const double size =
        u.cwiseAbs().dot(Vec3(x[1] * y[2] + x[2] * y[1], x[2] * y[0] + x[0] * y[2], x[0] * y[1] + x[1] * y[0]));
    // rounding is below 8e-16 of it (Shewchuk 1997, orient3d), unless products vanish
    if (size > 1e-250 && std::abs(volume) > 4e-15 * size) return volume > 0 ? 1 : -1;
    for (int i = 0; i < 3; ++i)
      if (u[i] == 0 && v[i] == 0 && w[i] == 0) return 0;
    return random_robots::exact_orientation(p_, Tetrahedron{a, b, c, d});
  }

  /// Sign of the area of a triangle that is projected along an axis.
  [[nodiscard]] int turn(int axis, Index a, Index b, Index c) const {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double one = (p_(b, i) - p_(a, i)) * (p_(c, j) - p_(a, j));
    const double other = (p_(b, j) - p_(a, j)) * (p_(c, i) - p_(a, i));
    const double size = std::abs(one) + std::abs(other);
    if (size > 1e-250 && std::abs(one - other) > 4e-15 * size) return one > other ? 1 : -1;
    random_robots::ExactSum sum;
    const auto add = [&](Index x, Index y) {
      sum.add(1, p_(x, i), p_(y, j), 1);
      sum.add(-1, p_(x, j), p_(y, i), 1);
    };
    add(a, b);
    add(b, c);
    add(c, a);
    return sum.sign();
  }

  [[nodiscard]] Hull hull(const Triple& t) const {
    for (int axis = 0; axis < 3; ++axis)
      if (turn(axis, t[0], t[1], t[2]) != 0) return {t, 3, axis};
    const auto [low, high] = std::minmax_element(t.begin(), t.end(), [&](Index a, Index b) { return before(a, b); });
    return {{*low, *high, *high}, same(*low, *high) ? 1 : 2, 0};
  }

  /// Do a segment, which may be a point, and a hull have a point in common?
  [[nodiscard]] bool meets(Index s, Index t, const Hull& hull) const {
    const auto [a, b, c] = hull.corners;
    if (hull.count < 3) return segments_meet(s, t, a, hull.count == 2 ? b : a);
    const int from = orientation(a, b, c, s), to = orientation(a, b, c, t);
    if (from * to > 0) return false;
    if (from == 0 && to == 0) return meets_in_plane(s, t, hull);
    // the line through s and t has one point in the plane, which the segment reaches
    return agree(orientation(s, t, a, b), orientation(s, t, b, c), orientation(s, t, c, a));
  }

  [[nodiscard]] bool apart(const Hull& a, const Hull& b) const {
    if (a.count < 3) return false;
    const auto [i, j, k] = a.corners;
    const int first = orientation(i, j, k, b.corners[0]);
    return first != 0 && orientation(i, j, k, b.corners[1]) == first && orientation(i, j, k, b.corners[2]) == first;
  }

  [[nodiscard]] bool same(Index a, Index b) const { return at(a) == at(b); }

 private:
  const Points& p_;

  [[nodiscard]] Vec3 at(Index i) const { return p_.row(i).transpose(); }
  /// Along a line this is one of its two directions.
  [[nodiscard]] bool before(Index a, Index b) const {
    const Vec3 x = at(a), y = at(b);
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  }
  [[nodiscard]] static bool agree(int a, int b, int c) { return std::min({a, b, c}) >= 0 || std::max({a, b, c}) <= 0; }

  [[nodiscard]] bool boxes_meet(Index s, Index t, Index a, Index b) const {
    return (at(s).cwiseMin(at(t)).array() <= at(a).cwiseMax(at(b)).array()).all() &&
           (at(a).cwiseMin(at(b)).array() <= at(s).cwiseMax(at(t)).array()).all();
  }

  /// Of four points in one plane, that is not parallel to the axis: no line of one segment has the other on one side.
  [[nodiscard]] bool segments_meet(int axis, Index s, Index t, Index a, Index b) const {
    return boxes_meet(s, t, a, b) && turn(axis, a, b, s) * turn(axis, a, b, t) <= 0 &&
           turn(axis, s, t, a) * turn(axis, s, t, b) <= 0;
  }

  [[nodiscard]] bool segments_meet(Index s, Index t, Index a, Index b) const {
    if (!boxes_meet(s, t, a, b) || orientation(s, t, a, b) != 0) return false;
    for (int axis = 0; axis < 3; ++axis)
      for (const Triple& three : {Triple{s, t, a}, Triple{s, t, b}, Triple{a, b, s}, Triple{a, b, t}})
        if (turn(axis, three[0], three[1], three[2]) != 0) return segments_meet(axis, s, t, a, b);
    return true;  // on one line
  }

  [[nodiscard]] bool meets_in_plane(Index s, Index t, const Hull& hull) const {
    for (int i = 0; i < 3; ++i)
      if (const auto [a, b] = hull.side(i); segments_meet(hull.axis, s, t, a, b)) return true;
    const auto [a, b, c] = hull.corners;
    return agree(turn(hull.axis, a, b, s), turn(hull.axis, b, c, s), turn(hull.axis, c, a, s));
  }
};

bool has(const Triple& t, Index v) {
  return std::find(t.begin(), t.end(), v) != t.end();
}

std::vector<Index> common_vertices(const Triple& a, const Triple& b) {
  std::vector<Index> common;
  for (const Index v : a)
    if (has(b, v) && std::find(common.begin(), common.end(), v) == common.end()) common.push_back(v);
  return common;
}

/// One has a side that meets the other: so it is with any two that meet.
bool cross_apart(const ExactPoints& points, const Hull& a, const Hull& b) {
  if (points.apart(a, b) || points.apart(b, a)) return false;
  const auto side_meets = [&](const Hull& from, const Hull& to) {
    for (int i = 0; i < from.sides(); ++i)
      if (const auto [s, t] = from.side(i); points.meets(s, t, to)) return true;
    return false;
  };
  return side_meets(a, b) || side_meets(b, a);
}

/// A ray from the common vertex that lies in both leaves the first of them across the side that the vertex is not on.
bool cross_at_vertex(const ExactPoints& points, Index v, const Triple& a, const Triple& b, const Hull& hull_a,
                     const Hull& hull_b) {
  const auto far_meets = [&](const Triple& from, const Hull& hull, const Hull& to) {
    std::vector<Index> far;
    for (const Index other : from)
      if (!points.same(other, v)) far.push_back(other);
    if (hull.count == 3) return points.meets(far[0], far[1], to);
    return std::any_of(far.begin(), far.end(), [&](Index end) { return points.meets(end, end, to); });
  };
  return far_meets(a, hull_a, hull_b) || far_meets(b, hull_b, hull_a);
}

bool cross_at_edge(const ExactPoints& points, const std::vector<Index>& edge, const Triple& a, const Triple& b,
                   int axis) {
  const auto third = [&](const Triple& t) {
    return *std::find_if_not(t.begin(), t.end(), [&](Index v) { return v == edge[0] || v == edge[1]; });
  };
  const Index p = third(a), q = third(b);
  return points.orientation(edge[0], edge[1], p, q) == 0 &&
         points.turn(axis, edge[0], edge[1], p) == points.turn(axis, edge[0], edge[1], q);
}

bool cross(const ExactPoints& points, const Triple& a, const Triple& b, const Hull& hull_a, const Hull& hull_b) {
  const std::vector<Index> common = common_vertices(a, b);
  if (common.empty()) return cross_apart(points, hull_a, hull_b);
  if (common.size() == 1) return cross_at_vertex(points, common[0], a, b, hull_a, hull_b);
  if (hull_a.count < 3 || hull_b.count < 3) return false;
  return common.size() == 3 || cross_at_edge(points, common, a, b, hull_a.axis);
}

struct TriangleBox {
  Vec3 low, high;
};

std::vector<TriangleBox> boxes_of(const Points& positions, const std::vector<Triple>& triangles) {
  std::vector<TriangleBox> boxes;
  for (const Triple& t : triangles) {
    for (const Index v : t)
      if (v < 0 || v >= positions.rows() || !positions.row(v).allFinite())
        throw std::invalid_argument("crossings: a vertex is not there or not finite");
    const Vec3 a = positions.row(t[0]), b = positions.row(t[1]), c = positions.row(t[2]);
    boxes.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
  }
  return boxes;
}

/// Calls visit(i, j) for boxes that meet, by a sweep along the axis in which all together are longest.
template <class Visit>
void visit_meeting(const std::vector<TriangleBox>& boxes, const Visit& visit) {
  if (boxes.empty()) return;
  TriangleBox all = boxes.front();
  for (const TriangleBox& box : boxes) all = {all.low.cwiseMin(box.low), all.high.cwiseMax(box.high)};
  Eigen::Index axis = 0;
  (all.high - all.low).maxCoeff(&axis);
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return boxes[i].low[axis] < boxes[j].low[axis]; });
  for (std::size_t m = 0; m < order.size(); ++m) {
    const TriangleBox& first = boxes[order[m]];
    for (std::size_t n = m + 1; n < order.size() && boxes[order[n]].low[axis] <= first.high[axis]; ++n) {
      const TriangleBox& second = boxes[order[n]];
      if ((first.low.array() <= second.high.array()).all() && (second.low.array() <= first.high.array()).all())
        visit(std::min(order[m], order[n]), std::max(order[m], order[n]));
    }
  }
}

}  // namespace

std::vector<Crossing> crossings(const Points& positions, const std::vector<Triple>& triangles,
                                const std::vector<int>& group) {
  if (!group.empty() && group.size() != triangles.size())
    throw std::invalid_argument("crossings: one group for each triangle, or none");
  const ExactPoints points(positions);
  std::vector<std::optional<Hull>> hulls(triangles.size());
  const auto hull = [&](std::size_t i) -> const Hull& {
    if (!hulls[i]) hulls[i] = points.hull(triangles[i]);
    return *hulls[i];
  };
  std::vector<Crossing> found;
  visit_meeting(boxes_of(positions, triangles), [&](std::size_t i, std::size_t j) {
    if (!group.empty() && group[i] >= 0 && group[i] == group[j]) return;
    if (cross(points, triangles[i], triangles[j], hull(i), hull(j))) found.push_back({i, j});
  });
  std::sort(found.begin(), found.end(),
            [](const Crossing& x, const Crossing& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  return found;
}

}  // namespace softkin::testing
