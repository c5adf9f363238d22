#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/statics/self_overlap.hpp>

#include "statics/robots.hpp"

namespace softkin {
namespace {

using namespace testing;

constexpr double pi = std::numbers::pi;

/// A bar of 100 x 12 x 12 mm, rolled up by a number of laps around an axis along y. It advances along the axis by 8 mm
/// and away from it by 3 mm per lap, so that laps overlap by a layer of 4 mm.
constexpr double bar_length = 100, bar_width = 12, along = 8, away = 3;

Points rolled(const Points& rest, double laps) {
  Points shape = rest;
  for (Index i = 0; i < rest.rows(); ++i) {
    const double lap = laps * rest(i, 0) / bar_length, angle = 2 * pi * lap;
    const double radius = 10 + rest(i, 2) + away * lap;
    shape.row(i) << radius * std::sin(angle), rest(i, 1) + along * lap, 30 + radius * std::cos(angle);
  }
  return shape;
}

Model bar(Split split = Split::six, bool quadratic = false) {
  RobotSpec spec = block_robot(block_mesh({40, 3, 3}, {bar_length, bar_width, bar_width}, split));
  if (quadratic) {
    spec = block_robot(elevated(block_mesh({20, 2, 2}, {bar_length, bar_width, bar_width}, split)));
    ElasticSpec elastic;
    elastic.youngs_modulus = 1;
    elastic.poisson_ratio = 0.3;
    spec.formulation = Formulation::physical;
    spec.materials[0].elastic = elastic;
  }
  return compile(spec);
}

/// Boundary vertices in tetrahedra that they are no corners of: by the signs of the four volumes that a point makes
/// with the faces, of all elements.
std::vector<Vec3> inside_by_hand(const Model& model, const Points& positions) {
  std::set<Index> surface;
  for (const Triangle& face : boundary_of(model.elements.tetrahedra, {}).triangles)
    surface.insert(face.begin(), face.end());
  std::vector<Vec3> inside;
  for (const Index vertex : surface) {
    const auto covers = [&](const Tetrahedron& t) {
      for (std::size_t i = 0; i < 4; ++i) {
        Tetrahedron with = t;
        with[i] = vertex;
        if (t[i] == vertex || !(signed_volume(positions, with) > 0)) return false;
      }
      return true;
    };
    if (std::any_of(model.elements.tetrahedra.begin(), model.elements.tetrahedra.end(), covers))
      inside.push_back(vertex_at(positions, vertex));
  }
  return inside;
}

TEST(SelfOverlap, IsNoneAtRestAndWhereNothingMeets) {
  for (const Split split : {Split::six, Split::five, Split::prisms}) {
    const Model model = bar(split);
    const OverlapSearch search(model);
    EXPECT_EQ(search.in(model.rest).points, 0u);
    EXPECT_EQ(search.in(rolled(model.rest, 0.9)).points, 0u);
  }
}

TEST(SelfOverlap, HasThePointsThatAllElementsHold) {
  const Model model = bar();
  const Points shape = rolled(model.rest, 1.3);
  const SelfOverlap found = OverlapSearch(model).in(shape);
  const std::vector<Vec3> expected = inside_by_hand(model, shape);
  ASSERT_GT(expected.size(), 20u);
  EXPECT_EQ(found.points, expected.size());
  const auto same = [&](const Vec3& point) { return (point - found.where).norm() < 1e-9; };
  EXPECT_TRUE(std::any_of(expected.begin(), expected.end(), same));
}

/// The layer in which two laps overlap is 4 mm thick, and is inclined by the axial advance per lap. No point is deeper,
/// and those on its sides in the middle of the radial width are as deep.
TEST(SelfOverlap, IsAsDeepAsTheLapsLieInEachOther) {
  for (const auto& [model, name] : {std::pair(bar(), "tetrahedra"), std::pair(bar(Split::prisms), "prisms"),
                                    std::pair(bar(Split::six, true), "order 2")}) {
    SCOPED_TRACE(name);
    const SelfOverlap found = OverlapSearch(model).in(rolled(model.rest, 1.3));
    const double lean = std::atan(along / (2 * pi * 16));
    EXPECT_GT(found.points, 20u);
    EXPECT_NEAR(found.deepest_mm, (bar_width - along) * std::cos(lean), 0.05);
  }
}

/// An element that is turned inside out lies in its neighbours, which is no overlap; a second overlap is still found.
TEST(SelfOverlap, CountsNothingAroundInvertedElements) {
  const Model model = bar();
  const OverlapSearch search(model);
  Points shape = model.rest;
  const Index corner = grid_vertex({40, 3, 3}, 20, 3, 3);
  shape.row(corner) += Eigen::RowVector3d(0.3, -9, -7);  // through the bar
  std::size_t inverted = 0;
  for (const Tetrahedron& t : model.elements.tetrahedra) inverted += signed_volume(shape, t) <= 0 ? 1 : 0;
  ASSERT_GT(inverted, 0u);
  ASSERT_GT(inside_by_hand(model, shape).size(), 0u);
  EXPECT_EQ(search.in(shape).points, 0u);

  Points both = rolled(model.rest, 1.3);
  const std::size_t points = search.in(both).points;
  both.row(corner) = rolled(shape, 1.3).row(corner);
  EXPECT_EQ(search.in(both).points, points);
}

/// The middle of a chamber's floor at z = 4 and of its roof at z = 8 change places by 1 mm; nearest to the floor is the
/// roof's slope, which falls by 2.5 mm on 4 mm.
TEST(SelfOverlap, SeesTheWallsOfAChamberButNotItsAir) {
  Mesh mesh = block_mesh({10, 5, 3}, {50, 20, 12});
  add_volume_region(mesh, "chamber", [](const Vec3& p) {
    return p.x() > 5 && p.x() < 45 && p.y() > 4 && p.y() < 16 && p.z() > 4 && p.z() < 8;
  });
  RobotSpec spec = block_robot(std::move(mesh));
  spec.actuators = {actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 2, true)};
  const Model model = compile(spec);
  const OverlapSearch search(model);
  Points shape = model.rest;
  EXPECT_EQ(search.in(shape).points, 0u);
  for (Index i = 0; i < shape.rows(); ++i) {
    const Vec3 p = vertex_at(model.rest, i);
    if (p.x() < 12 || p.x() > 38 || p.y() < 7 || p.y() > 13) continue;
    if (p.z() > 3 && p.z() < 5) shape(i, 2) += 2.5;
    if (p.z() > 7 && p.z() < 9) shape(i, 2) -= 2.5;
  }
  const SelfOverlap found = search.in(shape);
  EXPECT_EQ(found.points, 20u);  // 5 by 2 of the floor and of the roof
  EXPECT_NEAR(found.deepest_mm, 4 / std::hypot(4, 2.5), 1e-9);
}

TEST(SelfOverlap, OfAShapeThatIsNotFiniteIsNone) {
  const Model model = bar();
  Points shape = rolled(model.rest, 1.3);
  shape(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(OverlapSearch(model).in(shape).points, 0u);
}

}  // namespace
}  // namespace softkin
