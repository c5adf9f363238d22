#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "random/draw.hpp"
#include "support/exact_crossing.hpp"

namespace softkin::testing {
namespace {

using random_robots::Draw;
using Corner3 = std::array<Index, 3>;
using Whole = std::array<std::int64_t, 3>;

constexpr double inf = std::numeric_limits<double>::infinity();

std::size_t count(std::initializer_list<Vec3> points, const std::vector<Corner3>& triangles,
                  const std::vector<int>& group = {}) {
  Points positions(points.size(), 3);
  Eigen::Index row = 0;
  for (const Vec3& p : points) positions.row(row++) = p;
  return crossings(positions, triangles, group).size();
}

/// Of a triangle in the plane z = 0 with corners (0, 0), (8, 0), (0, 8), and another one.
bool meets_flat(const Vec3& a, const Vec3& b, const Vec3& c) {
  return count({{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, a, b, c}, {{0, 1, 2}, {3, 4, 5}}) > 0;
}

double above(double x) {
  return std::nextafter(x, inf);
}
double below(double x) {
  return std::nextafter(x, -inf);
}

// A method that is independent of the code under test: whole numbers, and planes that separate.

Whole operator-(const Whole& a, const Whole& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
std::int64_t dot(const Whole& a, const Whole& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Whole cross(const Whole& a, const Whole& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
bool is_zero(const Whole& a) {
  return dot(a, a) == 0;
}

/// Is the origin in the convex hull of points? If not, a plane through it has them all on one side, and one such plane
/// is normal to a point or an edge of theirs, to two, or contains such a normal and one.
bool hull_holds_origin(const std::vector<Whole>& points, const std::vector<Whole>& along) {
  const auto separates = [&](const Whole& normal) {
    const auto side = [&](const Whole& p) { return dot(p, normal) > 0; };
    const auto other = [&](const Whole& p) { return dot(p, normal) < 0; };
    return std::all_of(points.begin(), points.end(), side) || std::all_of(points.begin(), points.end(), other);
  };
  for (std::size_t i = 0; i < along.size(); ++i) {
    if (separates(along[i])) return false;
    for (std::size_t j = 0; j < i; ++j) {
      const Whole normal = cross(along[i], along[j]);
      if (is_zero(normal)) continue;
      if (separates(normal) || separates(cross(normal, along[i])) || separates(cross(normal, along[j]))) return false;
    }
  }
  return true;
}

using WholeTriangle = std::array<Whole, 3>;

bool has_area(const WholeTriangle& t) {
  return !is_zero(cross(t[1] - t[0], t[2] - t[0]));
}

bool meet_anywhere(const WholeTriangle& a, const WholeTriangle& b) {
  std::vector<Whole> points, all(a.begin(), a.end()), along;
  all.insert(all.end(), b.begin(), b.end());
  for (const Whole& p : a)
    for (const Whole& q : b) points.push_back(p - q);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) along.push_back(all[i] - all[j]);
  return hull_holds_origin(points, along);
}

/// Corner 0 is common: do the cones of both from there have a ray in common? Without area each is of one ray or two.
bool meet_beyond_corner(const WholeTriangle& a, const WholeTriangle& b) {
  const auto cones = [](const WholeTriangle& t, std::int64_t sign) -> std::vector<std::vector<Whole>> {
    std::vector<std::vector<Whole>> found;
    std::vector<Whole> rays;
    for (std::size_t i = 1; i < 3; ++i) {
      const Whole ray{sign * (t[i][0] - t[0][0]), sign * (t[i][1] - t[0][1]), sign * (t[i][2] - t[0][2])};
      if (!is_zero(ray)) rays.push_back(ray);
    }
    if (has_area(t)) return {rays};
    for (const Whole& ray : rays) found.push_back({ray});
    return found;
  };
  for (const std::vector<Whole>& one : cones(a, 1))
    for (const std::vector<Whole>& other : cones(b, -1)) {
      std::vector<Whole> points = one, along;
      points.insert(points.end(), other.begin(), other.end());
      along = points;
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) along.push_back(points[i] - points[j]);
      if (hull_holds_origin(points, along)) return true;
    }
  return false;
}

/// Corners 0 and 1 are common.
bool fold_over(const WholeTriangle& a, const WholeTriangle& b) {
  const Whole m = cross(a[1] - a[0], a[2] - a[0]), n = cross(b[1] - b[0], b[2] - b[0]);
  return is_zero(cross(m, n)) && dot(m, n) > 0;
}

struct Tally {
  std::size_t cross = 0, apart = 0, flat = 0;
};

/// Leaves what meets what as it is, but makes all so long and slim that rounded signs are often wrong.
Whole sheared(const Whole& p) {
  const std::int64_t much = 1 << 22, x = p[0] + much * p[1];
  return {x, p[1], p[2] + much * x};
}

/// Compares both methods on random pairs with `shared` common corners. Every other pair is sheared, others are so small
/// that products of three coordinates, or of two, almost vanish.
Tally compare_random_pairs(std::size_t shared, int range, int pairs, std::uint64_t seed) {
  Draw draw(seed);
  Tally tally;
  for (int pair = 0; pair < pairs; ++pair) {
    WholeTriangle a, b;
    for (WholeTriangle* t : {&a, &b})
      for (Whole& corner : *t)
        for (std::int64_t& value : corner) value = draw.whole(-range, range);
    if (draw.chance(0.2))  // in one plane
      for (std::size_t i = 0; i < 3; ++i) a[i][2] = b[i][2] = a[i][0] - 2 * a[i][1], b[i][2] = b[i][0] - 2 * b[i][1];
    for (std::size_t i = 0; i < shared; ++i) b[i] = a[i];
    const bool expected = shared == 0 ? meet_anywhere(a, b) : shared == 1 ? meet_beyond_corner(a, b) : fold_over(a, b);
    const Index turn = draw.below(3);
    Corner3 first{0, 1, 2}, second{3, 4, 5};
    for (std::size_t i = 0; i < shared; ++i) second[i] = first[i];
    Points positions(6, 3);
    for (int i = 0; i < 6; ++i) {
      const Whole corner = i < 3 ? a[i] : b[i - 3], at = pair % 2 == 0 ? corner : sheared(corner);
      const double scale = pair % 4 == 0 ? 0x1p-359 : pair % 4 == 2 ? 0x1p-538 : 1;
      for (int k = 0; k < 3; ++k) positions(i, k) = scale * static_cast<double>(at[k]);
    }
    std::rotate(first.begin(), first.begin() + turn, first.end());
    std::rotate(second.begin(), second.begin() + draw.below(3), second.end());
    const bool found = !crossings(positions, {first, second}).empty();
    EXPECT_EQ(found, expected) << "common: " << shared << "\n" << positions;
    if (found != expected) break;
    ++(found ? tally.cross : tally.apart);
    tally.flat += has_area(a) && has_area(b) ? 0 : 1;
  }
  return tally;
}

}  // namespace

TEST(ExactCrossing, OfCasesByHand) {
  EXPECT_TRUE(meets_flat({1, 1, -1}, {2, 1, 1}, {1, 2, 1}));     // through
  EXPECT_TRUE(meets_flat({1, 1, 0}, {2, 1, 1}, {1, 2, 1}));      // a corner on the face
  EXPECT_TRUE(meets_flat({4, 4, 0}, {5, 5, 1}, {6, 5, 1}));      // on an edge
  EXPECT_TRUE(meets_flat({8, 0, 0}, {9, 0, 1}, {9, 1, 1}));      // on a corner
  EXPECT_TRUE(meets_flat({4, -1, -1}, {4, 1, 1}, {9, -9, -1}));  // edge on edge
  EXPECT_TRUE(meets_flat({1, 1, 0}, {2, 1, 0}, {1, 2, 3}));      // an edge on the face
  EXPECT_TRUE(meets_flat({-9, -9, 0}, {20, 0, 0}, {0, 20, 0}));  // around it, in its plane
  EXPECT_TRUE(meets_flat({1, 1, 0}, {2, 1, 0}, {1, 2, 0}));      // within it
  EXPECT_TRUE(meets_flat({4, -4, 0}, {4, 9, 0}, {5, -4, 0}));    // across it
  EXPECT_TRUE(meets_flat({0, 0, 0}, {8, 0, 0}, {0, 8, 0}));      // in its place
  EXPECT_FALSE(meets_flat({5, 5, 0}, {9, 5, 0}, {5, 9, 0}));     // beside it, in its plane
  EXPECT_FALSE(meets_flat({5, 5, -1}, {9, 5, 1}, {5, 9, 1}));    // through its plane
  EXPECT_FALSE(meets_flat({0, 0, 1}, {8, 0, 1}, {0, 8, 1}));     // above it
}

/// One step of the last digit, also where coordinates are far from round.
TEST(ExactCrossing, OfNearMisses) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_FALSE(meets_flat({1, 1, tiny}, {2, 1, 1}, {1, 2, 1}));
  EXPECT_TRUE(meets_flat({1, 1, -tiny}, {2, 1, 1}, {1, 2, 1}));
  EXPECT_FALSE(meets_flat({4, above(4), 0}, {5, 5, 1}, {6, 5, 1}));
  EXPECT_TRUE(meets_flat({4, below(4), 0}, {5, 5, 1}, {6, 5, 1}));
  EXPECT_FALSE(meets_flat({above(8), 0, 0}, {9, 0, 0}, {9, 1, 0}));
  EXPECT_TRUE(meets_flat({below(8), 0, 0}, {9, 0, 0}, {9, 1, 0}));
  // in a tilted plane: coordinates of 24 bits, whose weighted mean is exact
  const Vec3 a(0.1f, 0.2f, 0.7f), b(0.9f, 0.3f, 0.15f), c(0.35f, 0.8f, 0.05f), inside = a / 2 + b / 4 + c / 4;
  const auto at = [&](double z) {
    return count({a, b, c, {inside.x(), inside.y(), z}, {9, 9, 80}, {9, 8, 90}}, {{0, 1, 2}, {3, 4, 5}});
  };
  EXPECT_EQ(at(inside.z()), 1u);
  EXPECT_EQ(at(above(inside.z())), 0u);
  EXPECT_EQ(at(below(inside.z())), 1u);
}

TEST(ExactCrossing, OfPairsWithCommonVertices) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  // one: apart but for the vertex; through; the far edge through; one edge along the other
  EXPECT_EQ(count({a, b, c, {-1, 0, 1}, {0, -1, 1}}, {{0, 1, 2}, {0, 3, 4}}), 0u);
  EXPECT_EQ(count({a, b, c, {1, 1, 1}, {1, 1, -1}}, {{0, 1, 2}, {0, 3, 4}}), 1u);
  EXPECT_EQ(count({a, b, c, {9, 9, 1}, {9, 9, -1}}, {{0, 1, 2}, {0, 3, 4}}), 1u);
  EXPECT_EQ(count({a, b, c, {9, 0, 0}, {9, 0, 1}}, {{0, 1, 2}, {0, 3, 4}}), 1u);
  EXPECT_EQ(count({a, b, c, {9, -1e-300, 0}, {9, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}), 0u);
  // two: a hinge, open, flat, and folded over
  EXPECT_EQ(count({a, b, c, {0, 4, 1e-300}}, {{0, 1, 2}, {1, 0, 3}}), 0u);
  EXPECT_EQ(count({a, b, c, {1, -4, 0}}, {{0, 1, 2}, {1, 0, 3}}), 0u);
  EXPECT_EQ(count({a, b, c, {1, 1, 0}}, {{0, 1, 2}, {1, 0, 3}}), 1u);
  // three
  EXPECT_EQ(count({a, b, c}, {{0, 1, 2}, {2, 1, 0}}), 1u);
}

TEST(ExactCrossing, OfSegmentsAndPoints) {
  EXPECT_TRUE(meets_flat({1, 1, -1}, {1, 1, 1}, {1, 1, 0}));
  EXPECT_TRUE(meets_flat({1, 1, 0}, {1, 1, 0}, {1, 1, 0}));
  EXPECT_FALSE(meets_flat({1, 1, 1}, {1, 1, 3}, {1, 1, 2}));
  EXPECT_FALSE(meets_flat({5, 5, 0}, {5, 5, 0}, {5, 5, 0}));
  EXPECT_EQ(count({{0, 0, 0}, {2, 2, 2}, {1, 1, 1}, {0, 2, 1}, {2, 0, 1}}, {{0, 1, 2}, {3, 4, 4}}), 1u);
  EXPECT_EQ(count({{0, 0, 0}, {2, 2, 2}, {1, 1, 1}, {3, 3, 3}, {5, 5, 5}}, {{0, 1, 2}, {3, 4, 4}}), 0u);
}

TEST(ExactCrossing, LeavesOutGroupsAndRefusesNonsense) {
  const std::vector<Corner3> triangles{{0, 1, 2}, {3, 4, 5}};
  const auto grouped = [&](const std::vector<int>& group) {
    return count({{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {1, 1, -1}, {2, 1, 1}, {1, 2, 1}}, triangles, group);
  };
  EXPECT_EQ(grouped({0, 0}), 0u);
  EXPECT_EQ(grouped({0, 1}), 1u);
  EXPECT_EQ(grouped({-1, -1}), 1u);
  EXPECT_THROW((void)grouped({0}), std::invalid_argument);
  EXPECT_THROW((void)count({{0, 0, 0}}, {{0, 1, 2}}), std::invalid_argument);
  EXPECT_THROW((void)count({{0, 0, 0}, {1, 0, inf}, {0, 1, 0}}, {{0, 1, 2}}), std::invalid_argument);
  EXPECT_EQ(count({}, {}), 0u);
}

/// Few places, so that most pairs touch or are degenerate, and more.
TEST(ExactCrossing, IsThatOfWholeNumbers) {
  std::uint64_t seed = 0;
  for (std::size_t shared = 0; shared < 3; ++shared)
    for (const int range : {1, 2, 4, 20}) {
      const Tally tally = compare_random_pairs(shared, range, 3000, ++seed);
      ASSERT_FALSE(HasFailure());
      EXPECT_GT(tally.cross, 20u) << shared << " " << range;
      EXPECT_GT(tally.apart, 150u) << shared << " " << range;
      EXPECT_TRUE(range > 2 || tally.flat > 20);
    }
}

namespace {

struct Sheet {
  Points positions;
  std::vector<Corner3> triangles;
};

/// 2 cells^2 triangles over the square from 0 to 1, through `place`.
template <class Place>
Sheet sheet(int cells, const Place& place) {
  Sheet made{Points((cells + 1) * (cells + 1), 3), {}};
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const Index v = j * (cells + 1) + i;
      made.positions.row(v) = place(static_cast<double>(i) / cells, static_cast<double>(j) / cells);
      if (i == cells || j == cells) continue;
      made.triangles.push_back({v, v + 1, v + cells + 1});
      made.triangles.push_back({v + 1, v + cells + 2, v + cells + 1});
    }
  return made;
}

double seconds_of(const Sheet& made, std::size_t& found) {
  const auto begin = std::chrono::steady_clock::now();
  found = crossings(made.positions, made.triangles).size();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

/// Where a sheet of 9,800 triangles passes through itself: against every pair of triangles on its own.
TEST(ExactCrossing, OfManyTrianglesIsThatOfEachPair) {
  const auto rolled = [](double u, double v) {
    return Vec3((1 + 0.1 * v) * std::cos(9 * u), (1 + 0.1 * u - 0.2 * v) * std::sin(9 * u), v);
  };
  std::size_t found = 0;
  const double seconds = seconds_of(sheet(70, rolled), found);
  EXPECT_GT(found, 50u);
  RecordProperty("seconds", std::to_string(seconds));
  const Sheet small = sheet(12, rolled);
  std::set<std::pair<std::size_t, std::size_t>> pairs, expected;
  for (const Crossing& c : crossings(small.positions, small.triangles)) pairs.emplace(c.a, c.b);
  for (std::size_t a = 0; a < small.triangles.size(); ++a)
    for (std::size_t b = a + 1; b < small.triangles.size(); ++b)
      if (!crossings(small.positions, {small.triangles[a], small.triangles[b]}).empty()) expected.emplace(a, b);
  EXPECT_GT(expected.size(), 5u);
  EXPECT_EQ(pairs, expected);
}

/// A tilted plane, where every pair of neighbours needs the sums without rounding.
TEST(ExactCrossing, OfAPlaneIsNone) {
  const auto plane = [](double u, double v) { return Vec3(u, v, 0.25 * u + 0.5 * v); };
  std::size_t found = 1;
  RecordProperty("seconds", std::to_string(seconds_of(sheet(16, plane), found)));
  EXPECT_EQ(found, 0u);
  Sheet folded = sheet(16, plane);
  folded.positions.row(0) = plane(2.0 / 16, 2.0 / 16);  // its corner, onto the next cell but one
  (void)seconds_of(folded, found);
  EXPECT_GT(found, 2u);
}

}  // namespace softkin::testing
