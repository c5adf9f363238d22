#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/hull.hpp>

namespace softkin {
namespace {

Mat3 turned() {
  return (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())).toRotationMatrix();
}

/// Volume inside triangles, each with its normal outwards.
double enclosed(const Hull& hull) {
  double volume = 0;
  for (const Triangle& t : hull.triangles)
    volume += hull.vertices.row(t[0]).dot(hull.vertices.row(t[1]).cross(hull.vertices.row(t[2]))) / 6;
  return volume;
}

/// Is every edge of the surface passed once in each sense?
bool is_closed(const Hull& hull) {
  std::map<std::pair<Index, Index>, int> edges;
  for (const Triangle& t : hull.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || edges.count({edge.second, edge.first}) == 0) return false;
  return true;
}

/// Random points in a box of 4 x 2 x depth, its corners among them.
Points box(double depth) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> inside(0, 1);
  Points points(208, 3);
  for (Index i = 0; i < 200; ++i) points.row(i) << inside(generator), inside(generator), inside(generator);
  for (Index i = 0; i < 8; ++i) points.row(200 + i) << (i & 1), (i >> 1 & 1), (i >> 2 & 1);
  points.array().rowwise() *= Eigen::Array3d(4, 2, depth).transpose();
  return (points * turned()).rowwise() + Eigen::RowVector3d(100, -50, 20);
}

TEST(Hull, OfABoxIsTheBox) {
  const Hull hull = convex_hull(box(3));
  EXPECT_EQ(hull.shape, HullShape::solid);
  EXPECT_EQ(hull.vertices.rows(), 8);
  EXPECT_EQ(hull.triangles.size(), 12u);
  EXPECT_NEAR(hull.volume, 24, 1e-9);
  EXPECT_NEAR(hull.area, 2 * (8 + 12 + 6), 1e-9);
  EXPECT_NEAR(enclosed(hull), hull.volume, 1e-8);
  EXPECT_TRUE(is_closed(hull));
}

TEST(Hull, OfPointsOnASphereIsNearlyTheBall) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  Points points(4000, 3);
  for (Index i = 0; i < points.rows(); ++i)
    points.row(i) = Vec3(normal(generator), normal(generator), normal(generator)).normalized() * 2;
  const Hull hull = convex_hull(points);
  const double ball = 4.0 / 3 * std::numbers::pi * 8;
  EXPECT_LT(hull.volume, ball);
  EXPECT_GT(hull.volume, 0.99 * ball);
  EXPECT_EQ(hull.vertices.rows(), 4000);
  EXPECT_TRUE(is_closed(hull));
}

TEST(Hull, OfPointsInAPlaneIsAnArea) {
  const Hull hull = convex_hull(box(0));
  EXPECT_EQ(hull.shape, HullShape::flat);
  EXPECT_EQ(hull.volume, 0);
  EXPECT_NEAR(hull.area, 8, 1e-9);
  EXPECT_EQ(hull.vertices.rows(), 4);
  EXPECT_EQ(hull.triangles.size(), 2u);
}

TEST(Hull, OfPointsOnALineIsItsEnds) {
  Points points(5, 3);
  for (Index i = 0; i < 5; ++i) points.row(i) = Eigen::RowVector3d(1, 2, 3) + (i - 2.0) * Eigen::RowVector3d(3, 0, 4);
  const Hull hull = convex_hull(points);
  EXPECT_EQ(hull.shape, HullShape::line);
  EXPECT_NEAR(hull.extents[0], 20, 1e-9);
  EXPECT_NEAR((hull.vertices.row(1) - hull.vertices.row(0)).norm(), 20, 1e-9);
  EXPECT_TRUE(hull.triangles.empty());
  EXPECT_EQ(convex_hull(points.topRows(1)).shape, HullShape::point);
  EXPECT_EQ(convex_hull(points.row(2).replicate(4, 1)).shape, HullShape::point);
}

TEST(Hull, RefusesNoPointsAndNumbersThatAreNotFinite) {
  EXPECT_THROW((void)convex_hull(Points(0, 3)), InvalidInput);
  Points points = box(3);
  points(7, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)convex_hull(points), InvalidInput);
}

}  // namespace
}  // namespace softkin
