#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <softkin/contact/surface.hpp>
#include <softkin/core/error.hpp>

#include "contact/sphere.hpp"

namespace softkin::contact {

namespace {

using namespace testing;

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

std::vector<Index> list(const Lists& lists, std::size_t i) {
  return {lists.items.begin() + lists.begin[i], lists.items.begin() + lists.begin[i + 1]};
}

}  // namespace

/// Two triangles of a square of 2 mm, and one apart; vertex 0 and 5 belong to none.
TEST(Surface, HoldsEdgesVerticesAndTheirAreas) {
  Points rest(9, 3);
  rest << 9, 9, 9, 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 9, 9, 9, 0, 0, 1, 3, 0, 1, 0, 1, 1;
  const Surface s = make_surface({{1, 2, 3}, {1, 3, 4}, {8, 6, 7}}, rest);
  EXPECT_EQ(s.vertices, (std::vector<Index>{1, 2, 3, 4, 6, 7, 8}));
  EXPECT_EQ(s.edges, (std::vector<Ends>{{1, 2}, {1, 3}, {1, 4}, {2, 3}, {3, 4}, {6, 7}, {6, 8}, {7, 8}}));
  EXPECT_EQ(s.triangle_edges, (std::vector<std::array<Index, 3>>{{0, 3, 1}, {1, 4, 2}, {6, 5, 7}}));
  EXPECT_EQ(s.triangle_area, (std::vector<double>{2, 2, 1.5}));
  EXPECT_EQ(list(s.edge_triangles, 1), (std::vector<Index>{0, 1}));
  EXPECT_EQ(list(s.edge_triangles, 4), (std::vector<Index>{1}));
  EXPECT_EQ(list(s.vertex_triangles, 0), (std::vector<Index>{0, 1}));
  EXPECT_EQ(list(s.vertex_triangles, 6), (std::vector<Index>{2}));
  EXPECT_DOUBLE_EQ(s.edge_area[1], 4.0 / 3);
  EXPECT_DOUBLE_EQ(s.edge_area[0], 2.0 / 3);
  EXPECT_DOUBLE_EQ(s.vertex_area[2], 4.0 / 3);
  EXPECT_DOUBLE_EQ(s.vertex_area[5], 0.5);
}

TEST(Surface, OfASphereIsClosed) {
  const Sphere sphere = make_sphere(4, 2);
  const Surface s = make_surface(sphere.triangles, sphere.points);
  EXPECT_EQ(s.vertices.size() + s.triangles.size(), s.edges.size() + 2);  // Euler
  for (std::size_t e = 0; e < s.edges.size(); ++e) EXPECT_EQ(list(s.edge_triangles, e).size(), 2u);
  const double area = sum(s.triangle_area);
  EXPECT_NEAR(area, 16 * M_PI, 0.2);
  EXPECT_NEAR(sum(s.edge_area), area, 1e-10);
  EXPECT_NEAR(sum(s.vertex_area), area, 1e-10);
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Ends edge = s.edges[s.triangle_edges[t][k]];
      const Corners& corners = s.triangles[t];
      EXPECT_EQ((std::set<Index>{edge[0], edge[1]}), (std::set<Index>{corners[k], corners[(k + 1) % 3]}));
    }
}

TEST(Surface, AnEdgeMayBelongToThreeTriangles) {
  Points rest(5, 3);
  rest << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1;
  const Surface s = make_surface({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, rest);
  EXPECT_EQ(s.edges.size(), 7u);
  EXPECT_EQ(list(s.edge_triangles, 0), (std::vector<Index>{0, 1, 2}));
  EXPECT_DOUBLE_EQ(s.edge_area[0], 0.5);
}

TEST(Surface, FacesOfSixNodesCoverTheFaceWithItsOrientation) {
  Points rest(6, 3);
  rest << 0, 0, 0, 4, 0, 0, 0, 2, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0;
  const std::vector<Corners> triangles = split_faces({{0, 1, 2, 3, 4, 5}});
  ASSERT_EQ(triangles.size(), 4u);
  for (const Corners& t : triangles) {
    const Vec3 a = rest.row(t[0]), b = rest.row(t[1]), c = rest.row(t[2]);
    EXPECT_EQ((b - a).cross(c - a), Vec3(0, 0, 2));
  }
  const Surface s = make_surface(triangles, rest);
  EXPECT_EQ(s.edges.size(), 9u);
  EXPECT_DOUBLE_EQ(sum(s.vertex_area), 4);
}

TEST(Surface, RefusesTrianglesThatAreNone) {
  const Points rest = Points::Zero(3, 3);
  EXPECT_THROW((void)make_surface({{0, 1, 3}}, rest), InvalidInput);
  EXPECT_THROW((void)make_surface({{0, -1, 2}}, rest), InvalidInput);
  EXPECT_THROW((void)make_surface({{0, 1, 1}}, rest), InvalidInput);
  const Surface none = make_surface({}, rest);
  EXPECT_TRUE(none.edges.empty() && none.vertices.empty());
}

}  // namespace softkin::contact
