#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <softkin/contact/candidates.hpp>
#include <softkin/contact/distance.hpp>

#include "contact/contact_samples.hpp"
#include "contact/sphere.hpp"

namespace softkin::contact {

namespace {

using namespace testing;

using PairSet = std::set<std::pair<Index, Index>>;
using Keeps = std::function<bool(const std::vector<Index>&, const std::vector<Index>&)>;

PairSet set_of(const std::vector<Pair>& pairs) {
  PairSet set;
  for (const Pair& pair : pairs) set.emplace(pair.first, pair.second);
  EXPECT_EQ(set.size(), pairs.size());
  return set;
}

std::vector<Index> vertices_in(const Surface& s, Index i, int of) {
  const std::size_t at = i;
  if (of == 1) return {s.vertices[at]};
  if (of == 2) return {s.edges[at].begin(), s.edges[at].end()};
  return {s.triangles[at].begin(), s.triangles[at].end()};
}

/// Along the axis along which they stay farthest apart, where every vertex of one may move as any other of it does.
double gap(const std::vector<Index>& a, const std::vector<Index>& b, const std::vector<Points>& instants) {
  const Points &from = instants.front(), &to = instants.back();
  double largest = -1e300;
  for (int k = 0; k < 3; ++k) {
    double above = 1e300, below = 1e300;  // the least gap with a above b, and below it
    for (const Index v : a)
      for (const Index w : b)
        for (const Index moves_v : a)
          for (const Index moves_w : b) {
            const double move = (to(moves_v, k) - from(moves_v, k)) - (to(moves_w, k) - from(moves_w, k));
            above = std::min(above, from(v, k) - from(w, k) + std::min(0.0, move));
            below = std::min(below, from(w, k) - from(v, k) - std::max(0.0, move));
          }
    largest = std::max({largest, above, below});
  }
  return largest;
}

/// Do the points of the one stay farther along than those of the other, along a direction?
bool apart(const Vec3& along, const std::vector<Index>& a, const std::vector<Index>& b,
           const std::vector<Points>& instants, double distance) {
  for (const Points* x : {&instants.front(), &instants.back()})
    for (const Index v : a)
      for (const Index w : b)
        if (!(along.normalized().dot(x->row(v).transpose() - x->row(w).transpose()) > distance)) return false;
  return true;
}

/// Checks for separation along the vector between the centroids and along the shortest vector at the end.
bool clearly_apart(const std::vector<Index>& a, const std::vector<Index>& b, const std::vector<Points>& instants,
                   double distance) {
  const auto middle = [](const Points& x, const std::vector<Index>& of) -> Vec3 {
    Vec3 sum = Vec3::Zero();
    for (const Index v : of) sum += x.row(v).transpose() / static_cast<double>(of.size());
    return sum;
  };
  Vec3 along = Vec3::Zero();
  for (const Points* x : {&instants.front(), &instants.back()}) along += middle(*x, a) - middle(*x, b);
  FourPoints end;
  for (std::size_t i = 0; i < 4; ++i)
    end.col(i) = instants.back().row(i < a.size() ? a[i] : b[i - a.size()]).transpose();
  const Kind kind = a.size() == 1 ? Kind::vertex_triangle : Kind::edge_edge;
  return apart(along, a, b, instants, distance) || apart(separation(kind, end).vector, a, b, instants, distance);
}

/// By all pairs: of vertices and triangles (3), of edges (2).
PairSet all_within(const Surface& s, const std::vector<Points>& instants, double reach, int of, const Keeps& keeps) {
  PairSet found;
  const std::size_t first = of == 3 ? s.vertices.size() : s.edges.size(), second = of == 3 ? s.triangles.size() : first;
  for (std::size_t i = 0; i < first; ++i)
    for (std::size_t j = of == 3 ? 0 : i + 1; j < second; ++j) {
      const auto a = vertices_in(s, i, of == 3 ? 1 : 2);
      const auto b = vertices_in(s, j, of);
      const bool meet = std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
      if (!meet && gap(a, b, instants) <= reach && keeps(a, b) && !clearly_apart(a, b, instants, reach))
        found.emplace(i, j);
    }
  return found;
}

bool keep_all(const std::vector<Index>&, const std::vector<Index>&) {
  return true;
}

void expect_same(const Surface& s, BroadPhase& phase, const std::vector<Points>& instants, double reach,
                 const Keeps& keeps = keep_all) {
  Team one(1), two(2);
  Candidates found, again;
  phase.find(instants.front(), instants.back(), reach, one, found);
  phase.find(instants.front(), instants.back(), reach, two, again);
  EXPECT_EQ(found.vertex_triangle, again.vertex_triangle);
  EXPECT_EQ(found.edge_edge, again.edge_edge);
  if (instants.size() == 1) {
    phase.find(instants.front(), reach, two, again);
    EXPECT_EQ(found.vertex_triangle, again.vertex_triangle);
    EXPECT_EQ(found.edge_edge, again.edge_edge);
  }
  EXPECT_EQ(set_of(found.vertex_triangle), all_within(s, instants, reach, 3, keeps));
  EXPECT_EQ(set_of(found.edge_edge), all_within(s, instants, reach, 2, keeps));
}

/// Triangles of nobody, next to each other every now and then.
Sphere make_soup(Random& random, int count) {
  Sphere soup{Points(3 * count, 3), {}};
  for (Index t = 0; t < count; ++t) {
    const Vec3 centre = 3 * random.vector();
    for (Index k = 0; k < 3; ++k) soup.points.row(3 * t + k) = centre + random.vector();
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return soup;
}

Points shaken(const Points& x, double size, Random& random) {
  Points out = x;
  for (Eigen::Index i = 0; i < x.rows(); ++i) out.row(i) += size * random.vector();
  return out;
}

/// A sphere pressed flat: far sides come close.
Points flattened(const Points& x) {
  Points out = x;
  out.col(2) *= 0.05;
  return out;
}

FourPoints gather(const Points& x, const Nodes& nodes) {
  FourPoints out;
  for (int i = 0; i < 4; ++i) out.col(i) = x.row(nodes[i]);
  return out;
}

}  // namespace

TEST(Candidates, OfTrianglesOfAnyNumberAreThoseOfAllPairs) {
  Random random(21);
  for (const int count : {0, 1, 2, 3, 7, 8, 9, 23, 64, 65, 130, 200}) {
    const Sphere soup = make_soup(random, count);
    const Surface s = make_surface(soup.triangles, soup.points);
    BroadPhase phase(s, soup.points);
    for (const double reach : {0.0, 0.1, 1.0, 100.0}) {
      if (count > 64 && reach > 1) continue;
      expect_same(s, phase, {soup.points}, reach);
      const Points from = shaken(soup.points, 0.3, random);
      expect_same(s, phase, {from, shaken(from, 0.2, random)}, reach);
    }
  }
}

/// More than one level of the tree above groups, which have moved far from where they were sorted.
TEST(Candidates, OfADeformedSphereAreThoseOfAllPairs) {
  Random random(22);
  const Sphere sphere = make_sphere(3, 5);
  const Surface s = make_surface(sphere.triangles, sphere.points);
  BroadPhase phase(s, sphere.points);
  expect_same(s, phase, {sphere.points}, 0.2);
  expect_same(s, phase, {flattened(sphere.points)}, 0.2);
  expect_same(s, phase, {shaken(sphere.points, 0.5, random), flattened(sphere.points)}, 0.05);
}

TEST(Candidates, HoldEveryPairThatComesWithinReach) {
  Random random(23);
  const Sphere sphere = make_sphere(3, 5);
  const Surface s = make_surface(sphere.triangles, sphere.points);
  BroadPhase phase(s, sphere.points);
  Team team(2);
  const Points from = flattened(sphere.points), to = shaken(from, 0.3, random);
  const double reach = 0.1;
  Candidates found;
  phase.find(from, to, reach, team, found);
  const PairSet vertex_triangle = set_of(found.vertex_triangle), edge_edge = set_of(found.edge_edge);
  int near = 0;
  for (const double t : {0.0, 0.3, 0.7, 1.0}) {
    const Points x = from + t * (to - from);
    const auto look = [&](const PairSet& all, Kind kind, const PairSet& candidates) {
      for (const auto& [i, j] : all) {
        const Nodes nodes =
            kind == Kind::vertex_triangle ? nodes_of_vertex_triangle(s, {i, j}) : nodes_of_edge_edge(s, {i, j});
        if (separation(kind, gather(x, nodes)).squared > reach * reach) continue;
        ++near;
        EXPECT_TRUE(candidates.contains({i, j})) << name_of(kind) << " " << i << " " << j;
      }
    };
    look(all_within(s, {x}, 1e9, 3, keep_all), Kind::vertex_triangle, vertex_triangle);
    look(all_within(s, {x}, 1e9, 2, keep_all), Kind::edge_edge, edge_edge);
  }
  EXPECT_GT(near, 500);
}

TEST(Candidates, LeaveOutNeighboursAndGroups) {
  const Sphere sphere = make_sphere(3, 5);
  const Surface s = make_surface(sphere.triangles, sphere.points);
  const Points flat = flattened(sphere.points);
  Exclusions exclusions;
  exclusions.neighbours = neighbours_of(s, flat.rows(), 2);
  for (Eigen::Index i = 0; i < flat.rows(); ++i)
    exclusions.group.push_back(flat(i, 0) > 0 ? -1 : flat(i, 1) > 0 ? 0 : 1);
  const auto steps = [&](Index a, Index b) {  // up to two, by the edges themselves
    const auto joined = [&](Index u, Index v) {
      return u == v || std::binary_search(s.edges.begin(), s.edges.end(), Ends{std::min(u, v), std::max(u, v)});
    };
    return std::any_of(s.vertices.begin(), s.vertices.end(), [&](Index v) { return joined(a, v) && joined(v, b); });
  };
  const auto keeps = [&](const std::vector<Index>& a, const std::vector<Index>& b) {
    std::set<Index> groups;
    for (const auto& side : {a, b})
      for (const Index v : side) groups.insert(exclusions.group[v]);
    if (groups.size() == 1 && *groups.begin() >= 0) return false;
    for (const Index v : a)
      for (const Index w : b)
        if (steps(v, w)) return false;
    return true;
  };
  BroadPhase phase(s, sphere.points, exclusions), all(s, sphere.points);
  expect_same(s, phase, {flat}, 0.5, keeps);
  Team team(1);
  Candidates some, every;
  phase.find(flat, 0.5, team, some);
  all.find(flat, 0.5, team, every);
  EXPECT_LT(2 * some.edge_edge.size(), every.edge_edge.size());
  EXPECT_GT(some.edge_edge.size(), 100u);
}

}  // namespace softkin::contact
