#include <gtest/gtest.h>

#include <softkin/model/compile/embedding.hpp>
#include <softkin/model/compile/regions.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

#include "model/compile_testing.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

RobotSpec block() {
  return block_robot(block_mesh({4, 2, 2}, {40, 20, 20}));
}

std::string refusal_of(const RobotSpec& spec, const std::string& name) {
  try {
    (void)RegionTable(spec).find(name, line(7));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

Region chosen(const RobotSpec& spec, const Selector& selector) {
  return RegionTable(spec).resolve(shaped(selector));
}

TEST(Regions, MeshRegionsHoldTheVerticesOfTheirCells) {
  const RobotSpec spec = block();
  const RegionTable table(spec);
  EXPECT_EQ(table.find("body", {}).vertices.size(), 5u * 3 * 3);
  EXPECT_EQ(table.find("body", {}).tetrahedra.size(), 6u * 16);
  EXPECT_EQ(table.find("x_low", {}).vertices.size(), 9u);
  EXPECT_EQ(table.find("x_low", {}).triangles.size(), 8u);
  EXPECT_EQ(table.find("all", {}).tetrahedra.size(), 96u);
  for (const Index v : table.find("y_high", {}).vertices) EXPECT_DOUBLE_EQ(spec.mesh.vertices(v, 1), 20);
}

TEST(Regions, BoxTakesVerticesOnItsBoundaryAndElementsByCentroid) {
  const Region half = chosen(block(), Box{{0, 0, 0}, {20, 20, 20}});
  EXPECT_EQ(half.vertices.size(), 27u);
  EXPECT_EQ(half.tetrahedra.size(), 48u);
  EXPECT_EQ(half.dimension, 3);
  const Region face = chosen(block(), Box{{40, 0, 0}, {40, 20, 20}});
  EXPECT_EQ(face.vertices.size(), 9u);
  EXPECT_TRUE(face.tetrahedra.empty());
  EXPECT_EQ(face.dimension, 0);
  // the tolerance is 1e-9 of the diagonal of 49 mm
  EXPECT_EQ(chosen(block(), Box{{40 + 4e-8, 0, 0}, {41, 20, 20}}).vertices.size(), 9u);
  EXPECT_THROW((void)chosen(block(), Box{{40 + 6e-8, 0, 0}, {41, 20, 20}}), InvalidInput);
}

TEST(Regions, RoundShapesAndHalfspaces) {
  // six neighbours at exactly the radius, and the center
  EXPECT_EQ(chosen(block(), Sphere{{20, 10, 10}, 10}).vertices.size(), 7u);
  const Region pin = chosen(block(), Cylinder{{10, 10, 10}, {30, 10, 10}, 10});
  EXPECT_EQ(pin.vertices.size(), 3u * 5);
  const Region side = chosen(block(), Halfspace{{30, 0, 0}, {2, 0, 0}});
  EXPECT_EQ(side.vertices.size(), 18u);
  EXPECT_EQ(side.tetrahedra.size(), 24u);
}

/// As the shape of which the surface is: a box with faces through vertices, and one aslant to all of them.
TEST(Regions, InsideOfASurfaceChoosesAsItsShapeDoes) {
  for (const auto& [low, size] :
       {std::pair(Vec3(0, 0, 0), Vec3(20, 20, 20)), std::pair(Vec3(3, 2, 1), Vec3(30, 11, 12))}) {
    const TriangleSurface surface = box_surface(low, size);
    const auto inside = std::make_shared<const SurfaceTree>(surface.vertices, surface.triangles);
    const Region expected = chosen(block(), Box{low, low + size}), found = chosen(block(), InsideSurface{inside});
    EXPECT_EQ(found.vertices, expected.vertices);
    EXPECT_EQ(found.tetrahedra, expected.tetrahedra);
  }
}

TEST(Regions, ListsOfVerticesAndElements) {
  const RobotSpec spec = block();
  const Tetrahedron& first = spec.mesh.tetrahedra[5];
  const Region corners = chosen(spec, VertexList{{first[3], first[0], first[2], first[1], first[0]}});
  EXPECT_EQ(corners.vertices.size(), 4u);
  EXPECT_EQ(corners.tetrahedra, std::vector<Index>{5});
  EXPECT_EQ(corners.dimension, 0);
  const Region elements = chosen(spec, ElementList{{5}});
  EXPECT_EQ(elements.vertices, corners.vertices);
  EXPECT_EQ(elements.dimension, 3);
}

TEST(Regions, UnknownNamesAreAnsweredWithTheNearest) {
  EXPECT_EQ(refusal_of(block(), "boddy"), "robot.yaml:7: there is no region 'boddy'; did you mean 'body'?");
  RobotSpec twice = block();
  add_vertex_region(twice.mesh, "body", {1});
  EXPECT_NE(refusal_of(twice, "body").find("two regions 'body'"), std::string::npos);
  EXPECT_EQ(refusal_of(twice, "x_low"), "");
  RobotSpec hollow = block();
  add_vertex_region(hollow.mesh, "nothing", {});
  EXPECT_NE(refusal_of(hollow, "nothing").find("region 'nothing' is empty"), std::string::npos);
}

TEST(Regions, BadDescriptionsAreRefused) {
  const double nan = std::nan("");
  const auto add = [](const std::string& name, const Selector& selector) {
    return [=](RobotSpec& spec) { spec.regions.push_back({name, selector, line(3)}); };
  };
  const Box good{{0, 0, 0}, {20, 20, 20}};
  expect_refused(
      block(),
      {
          {"mesh name", add("body", good), "robot.yaml:3: there is already a region 'body'"},
          {"reserved", add("all", good), "already a region 'all'"},
          {"empty", add("far", Box{{50, 0, 0}, {60, 1, 1}}), "region 'far' holds no vertex and no element"},
          {"box", add("a", Box{{1, 0, 0}, {0, 1, 1}}), "the box has a low corner above its high corner"},
          {"box nan", add("a", Box{{nan, 0, 0}, {0, 1, 1}}), "the box has a corner that is not finite"},
          {"sphere", add("a", Sphere{{0, 0, 0}, 0}), "the sphere needs a radius above 0"},
          {"sphere nan", add("a", Sphere{{0, 0, 0}, nan}), "the sphere needs a radius above 0"},
          {"cylinder", add("a", Cylinder{{1, 1, 1}, {1, 1, 1}, 1}), "the cylinder starts where it ends"},
          {"cylinder radius", add("a", Cylinder{{1, 1, 1}, {2, 1, 1}, -1}), "the cylinder needs a radius above 0"},
          {"halfspace", add("a", Halfspace{{0, 0, 0}, {0, 0, 0}}), "the halfspace needs a normal other than 0"},
          {"vertices", add("a", VertexList{{45}}), "region 'a' names vertex 45, but the mesh has 45 (counted from 0)"},
          {"negative", add("a", VertexList{{-1}}), "region 'a' names vertex -1"},
          {"elements", add("a", ElementList{{96}}), "region 'a' names tetrahedron 96, but the mesh has 96"},
          {"no vertices", add("a", VertexList{}), "region 'a' holds no vertex and no element"},
          {"mesh all",
           [](RobotSpec& spec) { add_volume_region(spec.mesh, "all", [](const Vec3& p) { return p[0] < 20; }); },
           "the mesh has a region 'all' that is not every element"},
          {"mesh element", [](RobotSpec& spec) { spec.mesh.regions[0].tetrahedra.push_back(1000); },
           "region 'body' of the mesh names"},
          {"mesh triangle", [](RobotSpec& spec) { spec.mesh.regions[1].triangles.push_back(-2); }, "names triangle -2"},
          {"mesh vertex", [](RobotSpec& spec) { add_vertex_region(spec.mesh, "v", {99}); }, "names vertex 99"},
          {"corner", [](RobotSpec& spec) { spec.mesh.tetrahedra[3][2] = 45; }, "tetrahedron 3 names vertex 45"},
          {"coordinate", [=](RobotSpec& spec) { spec.mesh.vertices(2, 1) = nan; }, "vertex 2 (from 0) is not finite"},
      });
  RobotSpec same = block();
  add_volume_region(same.mesh, "all", [](const Vec3&) { return true; });
  EXPECT_EQ(refusal(same), "");
}

// Layers of different thickness, so that the mean over vertices is not the centroid.
Mesh uneven(Split split) {
  Mesh mesh = block_mesh({3, 4, 3}, {30, 20, 10}, split);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 0) *= mesh.vertices(v, 0) / 30;
    mesh.vertices(v, 1) *= mesh.vertices(v, 1) / 20;
  }
  return mesh;
}

TEST(Regions, MeansAreWeightedByVolumeAndArea) {
  for (const Split split : {Split::five, Split::six, Split::prisms}) {
    const RobotSpec spec = block_robot(uneven(split));
    const RegionTable table(spec);
    const auto mean = [&](const std::string& name) {
      const EmbeddedPoint point = mean_of(table.find(name, {}), spec.mesh);
      double sum = 0;
      for (const double w : point.weights) sum += w;
      EXPECT_NEAR(sum, 1, 1e-14);
      return point.at(spec.mesh.vertices);
    };
    EXPECT_LT((mean("body") - Vec3(15, 10, 5)).norm(), 1e-12);
    EXPECT_LT((mean("all") - Vec3(15, 10, 5)).norm(), 1e-12);
    EXPECT_LT((mean("x_high") - Vec3(30, 10, 5)).norm(), 1e-12);
    EXPECT_LT((mean("z_low") - Vec3(15, 10, 0)).norm(), 1e-12);
    Region points = table.find("x_high", {});
    points.dimension = 0;
    // layers at 0, 1.25, 5, 11.25, 20
    EXPECT_LT((mean_of(points, spec.mesh).at(spec.mesh.vertices) - Vec3(30, 7.5, 5)).norm(), 1e-12);
  }
}

TEST(Regions, SpanPlane) {
  Points points(4, 3);
  points << 0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2, 2.1;
  EXPECT_FALSE(span_plane(points, {0, 1}));
  EXPECT_FALSE(span_plane(points, {0, 1, 2}));
  EXPECT_FALSE(span_plane(points, {0, 0, 0}));
  EXPECT_TRUE(span_plane(points, {0, 1, 3}));
}

}  // namespace
