#include <gtest/gtest.h>

#include <set>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/model.hpp>

#include "support/exact_crossing.hpp"
#include "support/points_in_body.hpp"
#include "support/random_drops.hpp"
#include "support/two_bodies.hpp"

namespace softkin::testing {
namespace {

constexpr std::uint64_t drops = 300;

bool cross_when_moved(const Drop& drop, const Vec3& move) {
  const Mesh& mesh = drop.robot.mesh;
  return !crossings(moved_from(drop.upper, mesh.vertices, move), boundary_of(mesh.tetrahedra, {}).triangles).empty();
}

}  // namespace

TEST(RandomDrops, CompileAndAreApartAtRest) {
  std::size_t quadratic = 0;
  std::set<std::size_t> sizes;
  for (std::uint64_t seed = 0; seed < drops; ++seed) {
    SCOPED_TRACE(seed);
    const Drop drop = random_drop(seed);
    const Mesh& mesh = drop.robot.mesh;
    std::size_t upper = 0;
    for (const Tetrahedron& t : mesh.tetrahedra) upper += t[0] >= drop.upper ? 1 : 0;
    for (const std::size_t elements : {upper, mesh.tetrahedra.size() - upper}) {
      EXPECT_GE(elements, 5u);
      EXPECT_LE(elements, 24u);
      sizes.insert(elements);
    }
    EXPECT_FALSE(cross_when_moved(drop, Vec3::Zero()));
    EXPECT_TRUE(covered_faces(mesh.vertices, mesh.tetrahedra).empty());
    const Model model = compile(drop.robot);
    EXPECT_EQ(model.elements.edge_nodes.empty(), !drop.robot.mesh_options.quadratic);
    quadratic += drop.robot.mesh_options.quadratic ? 1 : 0;
  }
  EXPECT_GE(sizes.size(), 6u);
  EXPECT_GT(quadratic, drops / 6);
  EXPECT_LT(quadratic, drops / 3);
}

/// They touch where the upper body falls by the gap, and not before; nearly all are pressed deeper than that.
TEST(RandomDrops, ArePressedOnEachOther) {
  std::size_t pressed = 0, sideways = 0;
  for (std::uint64_t seed = 0; seed < drops; ++seed) {
    SCOPED_TRACE(seed);
    const Drop drop = random_drop(seed);
    EXPECT_GE(drop.gap_mm, 0.02 * drop.size_mm);
    EXPECT_LE(drop.gap_mm, 0.5 * drop.size_mm);
    EXPECT_GE(-drop.displacement.z(), 0.2 * drop.size_mm);
    EXPECT_LE(-drop.displacement.z(), 0.8 * drop.size_mm);
    EXPECT_FALSE(cross_when_moved(drop, {0, 0, -0.999 * drop.gap_mm}));
    EXPECT_TRUE(cross_when_moved(drop, {0, 0, -1.001 * drop.gap_mm}));
    pressed += -drop.displacement.z() > drop.gap_mm ? 1 : 0;
    sideways += drop.displacement.head<2>().norm() > 0 ? 1 : 0;
  }
  EXPECT_GT(pressed, drops * 3 / 4);
  EXPECT_GT(sideways, drops / 3);
  EXPECT_LT(sideways, drops * 2 / 3);
}

/// Between what is held, at the end.
TEST(RandomDrops, LeaveRoomForTheBodies) {
  double least = 1;
  std::size_t held = 0, all = 0;
  for (std::uint64_t seed = 0; seed < drops; ++seed) {
    const Drop drop = random_drop(seed);
    const Model model = compile(drop.robot);
    const auto heights = [&](const Support& support) {
      std::vector<double> found;
      for (const Index v : support.vertices) found.push_back(model.held.at(v, 2));
      return found;
    };
    const std::vector<double> bottom = heights(model.held.supports[0]), top = heights(model.held.supports[1]);
    const double room = *std::min_element(top.begin(), top.end()) - *std::max_element(bottom.begin(), bottom.end());
    least = std::min(least, room / drop.size_mm);
    held += bottom.size() + top.size();
    all += model.rest.rows();
  }
  EXPECT_GT(least, 0.299);
  EXPECT_LT(held, all / 2);
}

TEST(RandomDrops, AreTheSameForTheSameSeed) {
  for (const std::uint64_t seed : {3, 4}) {
    const Drop one = random_drop(seed), other = random_drop(seed);
    EXPECT_EQ(one.robot.mesh.vertices, other.robot.mesh.vertices);
    EXPECT_EQ(one.displacement, other.displacement);
  }
  EXPECT_NE(random_drop(3).displacement, random_drop(4).displacement);
}

}  // namespace softkin::testing
