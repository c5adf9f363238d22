#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/refine_surface.hpp>
#include <softkin/model/mesh/shells.hpp>

#include "model/block_mesh.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

/// The surfaces as one.
TriangleSurface together(const std::vector<TriangleSurface>& surfaces) {
  TriangleSurface all;
  all.vertices.resize(0, 3);
  for (const TriangleSurface& surface : surfaces) {
    const Index first = all.vertices.rows();
    Points vertices(first + surface.vertices.rows(), 3);
    vertices << all.vertices, surface.vertices;
    all.vertices = vertices;
    for (const auto& [a, b, c] : surface.triangles) all.triangles.push_back({first + a, first + b, first + c});
  }
  return all;
}

TEST(Shells, AreMeasuredOneByOne) {
  const TriangleSurface surface = together({box_surface({1, 2, 3}, {2, 3, 4}), box_surface({9, 0, 0}, {1, 1, 1})});
  const std::vector<Shell> shells = shells_of(surface.vertices, surface.triangles);
  ASSERT_EQ(shells.size(), 2u);
  EXPECT_TRUE(shells[0].closed && shells[1].closed);
  EXPECT_NEAR(shells[0].volume, 24, 1e-12);
  EXPECT_LT((shells[0].center - Vec3(2, 3.5, 5)).norm(), 1e-12);
  EXPECT_NEAR(shells[1].volume, 1, 1e-12);
  TriangleSurface open = surface;
  open.triangles.pop_back();
  EXPECT_FALSE(shells_of(open.vertices, open.triangles)[1].closed);
}

TEST(Shells, TurnedOutwardsWhateverTheirTurns) {
  TriangleSurface surface = together({box_surface({1, 2, 3}, {2, 3, 4}), box_surface({9, 0, 0}, {1, 1, 1})});
  std::mt19937 random(3);
  for (Triangle& t : surface.triangles)
    if (random() % 2 == 0) std::swap(t[0], t[1]);
  EXPECT_NEAR(enclosed_volume(surface.vertices, turned_outwards(surface.vertices, surface.triangles)), 25, 1e-12);
}

TEST(Shells, RefusalsNameThePlace) {
  const auto complaint = [](const TriangleSurface& surface) -> std::string {
    try {
      (void)turned_outwards(surface.vertices, surface.triangles);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  TriangleSurface open = box_surface({0, 0, 0}, {2, 2, 2});
  std::erase_if(open.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](Index v) { return open.vertices(v, 0) == 2; });
  });
  EXPECT_EQ(complaint(open), "the surface is not closed: its rim of 4 edges has its middle at (2, 1, 1) mm");
  open.triangles.clear();
  EXPECT_EQ(complaint(open), "the surface has no triangle");
  TriangleSurface wild = box_surface({0, 0, 0}, {2, 2, 2});
  wild.triangles[0][0] = 8;
  EXPECT_EQ(complaint(wild), "the surface names a vertex that is not there");
  TriangleSurface flat = box_surface({0, 0, 0}, {2, 2, 2});
  flat.vertices.col(2) = 0.3 * flat.vertices.col(0) + 0.1 * flat.vertices.col(1);
  EXPECT_NE(complaint(flat).find("encloses no volume, at ("), std::string::npos) << complaint(flat);
  TriangleSurface fin = box_surface({0, 0, 0}, {2, 2, 2});
  fin.triangles.push_back({0, 1, 6});
  EXPECT_NE(complaint(fin).find("has an edge of 3 faces at (1, 0, 0) mm"), std::string::npos) << complaint(fin);
  // the projective plane with six vertices
  TriangleSurface one_sided{Points::Identity(6, 3), {}};
  one_sided.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                         {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
  EXPECT_NE(complaint(one_sided).find("the surface has one side only"), std::string::npos) << complaint(one_sided);
}

/// Spaces that touch at an edge and one that is open, in elements of either orientation.
TEST(EmptySpaces, AreFoundWhateverTheOrientation) {
  for (const Split split : {Split::six, Split::prisms}) {
    Mesh mesh = block_mesh({5, 5, 5}, {50, 50, 50}, split);
    const auto is_empty = [](const Vec3& p) {
      const Eigen::Vector3i cell = (p / 10).cast<int>();
      return cell == Eigen::Vector3i(1, 1, 1) || cell == Eigen::Vector3i(2, 2, 1) || cell == Eigen::Vector3i(2, 2, 2) ||
             cell == Eigen::Vector3i(4, 2, 2);
    };
    add_volume_region(mesh, "body", [&](const Vec3& p) { return !is_empty(p); });
    std::vector<Tetrahedron> tetrahedra;
    std::vector<Prism> prisms;
    for (const Index i : mesh.regions.back().tetrahedra) tetrahedra.push_back(mesh.tetrahedra[i]);
    for (const Index i : mesh.regions.back().prisms) prisms.push_back(mesh.prisms[i]);
    for (std::size_t i = 0; i < tetrahedra.size(); i += 3) std::swap(tetrahedra[i][0], tetrahedra[i][1]);
    const std::vector<EmptySpace> spaces = empty_spaces_in(mesh.vertices, tetrahedra, prisms);
    ASSERT_EQ(spaces.size(), 2u);
    EXPECT_EQ(text_of(spaces[0]), "2000 mm^3 (20 faces) around (25, 25, 20) mm");
    EXPECT_EQ(text_of(spaces[1]), "1000 mm^3 (12 faces) around (15, 15, 15) mm");
    EXPECT_NEAR(enclosed_volume(mesh.vertices, spaces[0].triangles), 2000, 1e-9);
  }
}

TEST(RefinedSurface, StaysClosedAndWhereItWas) {
  const TriangleSurface box = box_surface({0, 0, 0}, {12, 3, 1});
  const auto limit = [](const Vec3& p) { return p[0] < 6 ? 0.5 : 2.0; };
  const TriangleSurface fine = refined(box, limit, 100000);
  const std::vector<Shell> shells = shells_of(fine.vertices, fine.triangles);
  ASSERT_EQ(shells.size(), 1u);
  EXPECT_TRUE(shells[0].closed);
  EXPECT_NEAR(shells[0].volume, 36, 1e-12);
  double narrowest = 1;
  for (const Triangle& t : fine.triangles) {
    double longest = 0, area = 0;
    const Vec3 a = vertex_at(fine.vertices, t[0]), b = vertex_at(fine.vertices, t[1]),
               c = vertex_at(fine.vertices, t[2]);
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      EXPECT_LE((p - q).norm(), limit((p + q) / 2));
      longest = std::max(longest, (p - q).norm());
    }
    area = 0.5 * Vec3(b - a).cross(Vec3(c - a)).norm();
    narrowest = std::min(narrowest, 2 * area / (longest * longest));
  }
  EXPECT_GT(narrowest, 0.5 * 12 / 145);  // half of that of the box
  EXPECT_LT(fine.triangles.size(), 5000u);
  EXPECT_THROW((void)refined(box, limit, 500), InvalidInput);
}

}  // namespace
