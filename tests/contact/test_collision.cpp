#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <queue>
#include <softkin/contact/collision.hpp>

#include "contact/contact_samples.hpp"
#include "contact/sphere.hpp"

namespace softkin::contact {

namespace {

using namespace testing;

constexpr double infinite = std::numeric_limits<double>::infinity();

double safe(Kind kind, const FourPoints& from, const FourPoints& to, double keep = 0.1) {
  return kind == Kind::vertex_triangle ? safe_vertex_triangle(from, to, keep) : safe_edge_edge(from, to, keep);
}

FourPoints at_fraction(const FourPoints& from, const FourPoints& to, double t) {
  return from + t * (to - from);
}

double distance(Kind kind, const FourPoints& x) {
  return std::sqrt(separation(kind, x).squared);
}

/// Returns the fraction of the motion at the first of equal steps where the distance is below a limit; 1: none.
double first_below(Kind kind, const FourPoints& from, const FourPoints& to, double limit, int steps) {
  for (int k = 0; k < steps; ++k) {
    const double fraction = static_cast<double>(k) / steps;
    if (distance(kind, at_fraction(from, to, fraction)) < limit) return fraction;
  }
  return 1;
}

/// Numbers known to lie between two doubles; every result is widened by a step on either side.
struct Between {
  double low, high;
};

Between widened(double low, double high) {
  return {std::nextafter(low, -infinite), std::nextafter(high, infinite)};
}

Between operator+(const Between& a, const Between& b) {
  return widened(a.low + b.low, a.high + b.high);
}

Between operator-(const Between& a, const Between& b) {
  return widened(a.low - b.high, a.high - b.low);
}

Between operator*(double a, const Between& b) {
  return a >= 0 ? widened(a * b.low, a * b.high) : widened(a * b.high, a * b.low);
}

/// A range of the fraction of the motion and of the two weights; all are dyadic, which makes 1 - t exact.
struct Box {
  double low[3], width[3];
  bool operator>(const Box& other) const { return low[0] > other.low[0]; }
};

/// Returns one coordinate of the vector between the features at a fraction of the motion and two weights.
Between gap(Kind kind, const FourPoints& from, const FourPoints& to, int k, const double (&at)[3]) {
  const auto point = [&](int i) {
    return (1 - at[0]) * Between{from(k, i), from(k, i)} + at[0] * Between{to(k, i), to(k, i)};
  };
  if (kind == Kind::vertex_triangle)
    return point(0) - (point(1) + at[1] * (point(2) - point(1)) + at[2] * (point(3) - point(1)));
  return (point(0) + at[1] * (point(1) - point(0))) - (point(2) + at[2] * (point(3) - point(2)));
}

/// Checks if the box may hold a contact. Each coordinate is linear in the fraction and in either weight: its range is
/// that of its values at the eight corners.
bool may_touch(Kind kind, const FourPoints& from, const FourPoints& to, const Box& box) {
  if (kind == Kind::vertex_triangle && box.low[1] + box.low[2] > 1) return false;
  for (int k = 0; k < 3; ++k) {
    Between range{infinite, -infinite};
    for (int corner = 0; corner < 8; ++corner) {
      double at[3];
      for (int i = 0; i < 3; ++i) at[i] = box.low[i] + (corner >> i & 1) * box.width[i];
      const Between value = gap(kind, from, to, k, at);
      range = {std::min(range.low, value.low), std::max(range.high, value.high)};
    }
    if (range.low > 0 || range.high < 0) return false;
  }
  return true;
}

/// Returns a fraction before which there is no contact, 2^-resolution from one that cannot be distinguished from
/// contact; infinite: none. Rigorous, by bisection of fraction and weights in interval arithmetic.
double first_contact(Kind kind, const FourPoints& from, const FourPoints& to, int resolution) {
  const double narrow = std::ldexp(1, -resolution);
  std::priority_queue<Box, std::vector<Box>, std::greater<>> boxes;
  boxes.push({{0, 0, 0}, {1, 1, 1}});
  while (!boxes.empty()) {
    const Box box = boxes.top();
    boxes.pop();
    if (!may_touch(kind, from, to, box)) continue;
    const int widest = static_cast<int>(std::max_element(box.width, box.width + 3) - box.width);
    if (box.width[widest] <= narrow) return box.low[0];
    Box half = box;
    half.width[widest] /= 2;
    boxes.push(half);
    half.low[widest] += half.width[widest];
    boxes.push(half);
  }
  return infinite;
}

/// Half of them fly through each other.
void random_motion(Random& random, FourPoints& from, FourPoints& to) {
  from = random.points();
  to = random.points();
  const double speed = random.uniform(0, 2);
  to = from + speed * (to - from);
  if (random.whole(0, 1) == 0) to.colwise() += 5 * random.vector();
}

}  // namespace

TEST(Collision, NeverPassesTheFirstContactAndGoesMostOfTheWay) {
  Random random(11);
  for (const Kind kind : kinds) {
    int contacts = 0, long_motions = 0;
    for (int i = 0; i < 1500; ++i) {
      FourPoints from, to;
      random_motion(random, from, to);
      const double fraction = safe(kind, from, to);
      double first = first_contact(kind, from, to, 12);
      if (fraction >= first) first = first_contact(kind, from, to, 20);  // they start close
      EXPECT_LT(fraction, first) << name_of(kind) << "\n" << from << "\n" << to;
      if (first == infinite) continue;
      ++contacts;
      EXPECT_GT(fraction, 0) << name_of(kind) << "\n" << from << "\n" << to;
      // on some motions a tenth of the distance is reached long before the contact
      const bool generic = first_below(kind, from, to, 0.12 * distance(kind, from), 200) > 0.81 * first;
      EXPECT_TRUE(!generic || fraction > 0.8 * first) << name_of(kind) << "\n" << from << "\n" << to;
      long_motions += fraction > 0.8 * first;
      if (HasFailure()) return;
    }
    EXPECT_GT(contacts, 80) << name_of(kind);
    EXPECT_GT(long_motions, 0.8 * contacts) << name_of(kind);
  }
}

/// Looked at 2,000 times.
TEST(Collision, KeepsItsShareOfTheDistanceAndEndsWhereThatIsUsedUp) {
  Random random(12);
  for (const Kind kind : kinds) {
    int ended = 0, late = 0;
    for (int i = 0; i < 400; ++i) {
      FourPoints from, to;
      random_motion(random, from, to);
      const double keep = random.uniform(0.05, 0.9), fraction = safe(kind, from, to, keep);
      const double floor = keep * distance(kind, from);
      const double used_up = first_below(kind, from, to, floor, 2000);
      EXPECT_LE(fraction, used_up) << name_of(kind) << "\n" << from << "\n" << to;
      EXPECT_GE(distance(kind, at_fraction(from, to, fraction)), floor * (1 - 1e-12));
      ended += fraction < 1;
      late += fraction > 0.97 * used_up;
    }
    EXPECT_GT(ended, 100) << name_of(kind);
    EXPECT_GT(late, 390) << name_of(kind);
  }
}

TEST(Collision, RestAndCommonMotionAreSafe) {
  Random random(13);
  for (const Kind kind : kinds)
    for (int i = 0; i < 500; ++i) {
      FourPoints from = random.points();
      EXPECT_EQ(safe(kind, from, from), 1);
      EXPECT_EQ(safe(kind, from, from.colwise() + 100 * random.vector()), 1);
      // apart
      const Separation s = separation(kind, from);
      FourPoints to = from;
      for (int k = 0; k < 4; ++k) to.col(k) += s.weights[k] * s.vector;
      EXPECT_EQ(safe(kind, from, to), 1);
      // a vertex on the triangle, edges that cross: nothing is known to be safe, but rest is
      for (int k = 0; k < 4; ++k) from.col(k) -= s.weights[k] / s.weights.squaredNorm() * s.vector;
      EXPECT_EQ(safe(kind, from, from), 1);
      EXPECT_LT(safe(kind, from, to), 1e-12);
    }
}

TEST(Collision, ParallelEdgesSlideFreelyAndMeetWhereTheyMust) {
  FourPoints from, to;
  from << 0, 2, 0, 2, 0, 0, 0, 0, 0, 0, 0.01, 0.01;
  to = from;
  to.row(0).tail<2>().array() += 50;  // along itself
  EXPECT_EQ(safe_edge_edge(from, to), 1);
  to = from;
  to.row(1).tail<2>().array() += 50;  // across
  EXPECT_EQ(safe_edge_edge(from, to), 1);
  to = from;
  to.row(2).tail<2>().array() -= 0.02;  // onto the other: contact at 1/2, a tenth is left at 0.45
  EXPECT_NEAR(safe_edge_edge(from, to), 0.45, 1e-3);
  EXPECT_LE(safe_edge_edge(from, to), 0.45);
  // in one line, end to end: a gap of 1 closes at twice its length
  from << 0, 2, 3, 5, 0, 0, 0, 0, 0, 0, 0, 0;
  to = from;
  to.row(0).tail<2>().array() -= 2;
  EXPECT_NEAR(safe_edge_edge(from, to), 0.45, 1e-3);
  EXPECT_LE(safe_edge_edge(from, to), 0.45);
}

TEST(Collision, CoplanarAndDegenerateOnes) {
  FourPoints from, to;
  from << -1, 0, 2, 0, 0.5, 0, 0, 2, 0, 0, 0, 0;  // the vertex in the plane of the triangle
  to = from;
  to(0, 0) = 1;  // through its side x = 0, at 1/2
  EXPECT_NEAR(safe_vertex_triangle(from, to), 0.45, 1e-3);
  EXPECT_LE(safe_vertex_triangle(from, to), 0.45);
  to = from;
  to(1, 0) = 100;  // past it
  EXPECT_EQ(safe_vertex_triangle(from, to), 1);
  from.col(0) = Vec3(-1, -1, 0);  // exactly at a corner, in the plane and from above
  to = from;
  to.col(0) = Vec3(1, 1, 0);
  EXPECT_NEAR(safe_vertex_triangle(from, to), 0.45, 1e-3);
  EXPECT_LE(safe_vertex_triangle(from, to), 0.45);
  from.col(0) = Vec3(0, 1, 1);  // exactly towards a side
  to = from;
  to.col(0) = Vec3(0, 1, -1);
  EXPECT_NEAR(safe_vertex_triangle(from, to), 0.45, 1e-3);
  EXPECT_LE(safe_vertex_triangle(from, to), 0.45);
  for (int k = 2; k < 4; ++k) from.col(k) = to.col(k) = from.col(1);  // a triangle without area at (0, 0, 0)
  from.col(0) = Vec3(0, 0, 1);
  to.col(0) = Vec3(0, 0, -1);
  EXPECT_NEAR(safe_vertex_triangle(from, to), 0.45, 1e-3);
  EXPECT_LE(safe_vertex_triangle(from, to), 0.45);
  EXPECT_NEAR(safe_edge_edge(from, to), 0.45, 0.45);  // its first edge: from the vertex to that place, touching
}

/// An edge that turns about a far end towards another, and a vertex that slides over a triangle: many advances.
TEST(Collision, EndsOnMotionsThatAreSlowAgainstTheSpeedOfTheirPoints) {
  Random random(14);
  for (int i = 0; i < 500; ++i) {
    FourPoints from, to;
    const double height = std::pow(10, random.uniform(-6, -1)), drop = random.uniform(0, 2) * height;
    from << 0.1, -1, 1, 0, 0.1, -1, -1, 1.5, height, 0, 0, 0;
    to = from;
    to.col(0) += Vec3(0.2, 0.2, -drop);
    to.rightCols<3>().row(0).array() += random.uniform(-0.1, 0.1);
    const double contact = height / drop, fraction = safe_vertex_triangle(from, to);
    EXPECT_LT(fraction, contact);
    EXPECT_NEAR(fraction, std::min(1.0, 0.9 * contact), 0.01);
    from << -1, 1, 0, 0, 0, 0, -1, 1, 0, 0, height, height;
    to = from;
    to(2, 0) += height;  // one end moves up to twice the height, the middle to the height
    to(2, 1) += height;
    to.row(2).head<2>() += Eigen::RowVector2d(-20, 20) * height;
    const double turned = safe_edge_edge(from, to);
    EXPECT_LE(turned, first_below(Kind::edge_edge, from, to, 0.1 * height, 2000));
    EXPECT_GT(turned, first_below(Kind::edge_edge, from, to, 0.103 * height, 2000) - 1e-3);
  }
}

/// So that the least of many pairs is the same, whichever was looked at first; of motions that turn much, too.
TEST(Collision, WhereAPairStopsDoesNotDependOnWhereOthersDo) {
  Random random(16);
  for (const Kind kind : kinds)
    for (int i = 0; i < 2000; ++i) {
      FourPoints from, to;
      random_motion(random, from, to);
      const double alone = safe(kind, from, to);
      for (const double until : {random.uniform(0, 1), std::min(1.0, alone + 1e-3 * random.uniform(0, 1))})
        EXPECT_EQ((kind == Kind::vertex_triangle ? safe_vertex_triangle : safe_edge_edge)(from, to, 0.1, until),
                  std::min(alone, until))
            << name_of(kind) << " until " << until;
    }
}

/// A sphere whose poles are pushed through each other, while it is turned and shaken.
TEST(Collision, AMotionIsAsSafeAsItsLeastSafePair) {
  Random random(15);
  const Sphere sphere = make_sphere(3, 5);
  const Surface s = make_surface(sphere.triangles, sphere.points);
  BroadPhase phase(s, sphere.points);
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  Points to = sphere.points;
  for (Eigen::Index i = 0; i < to.rows(); ++i) {
    if (std::abs(to(i, 2)) > 4) to(i, 2) *= -0.2;
    to.row(i) = (turn * to.row(i).transpose() + 0.02 * random.vector()).transpose().eval();
  }
  Team one(1), two(2);
  Candidates found;
  phase.find(sphere.points, to, 0, one, found);
  const double fraction = safe_motion(s, found, sphere.points, to, 0.1, one);
  EXPECT_EQ(fraction, safe_motion(s, found, sphere.points, to, 0.1, two));
  EXPECT_GT(fraction, 0.3);
  const Points stop = sphere.points + fraction * (to - sphere.points);
  double least = 1;
  const auto look = [&](Kind kind, const Pair& pair) {
    const Nodes nodes = kind == Kind::edge_edge ? nodes_of_edge_edge(s, pair) : nodes_of_vertex_triangle(s, pair);
    FourPoints a, b, c;
    for (int k = 0; k < 4; ++k) {
      a.col(k) = sphere.points.row(nodes[k]);
      b.col(k) = to.row(nodes[k]);
      c.col(k) = stop.row(nodes[k]);
    }
    least = std::min(least, safe(kind, a, b));
    EXPECT_GE(distance(kind, c), 0.1 * distance(kind, a));
  };
  for (const Pair& pair : found.vertex_triangle) look(Kind::vertex_triangle, pair);
  for (const Pair& pair : found.edge_edge) look(Kind::edge_edge, pair);
  EXPECT_EQ(fraction, least);
  EXPECT_LT(fraction, 0.9);
  EXPECT_EQ(safe_motion(s, found, sphere.points, sphere.points, 0.1, two), 1);
}

}  // namespace softkin::contact
