#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "model/compile_testing.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

TEST(Compile, ABlockKeepsItsElementsAndVolume) {
  for (const Split split : {Split::five, Split::six, Split::prisms}) {
    const RobotSpec spec = block_robot(block_mesh({3, 2, 2}, {30, 20, 10}, split));
    const Model model = compile(spec);
    EXPECT_EQ(model.elements.tetrahedra, spec.mesh.tetrahedra);
    EXPECT_EQ(model.elements.prisms, spec.mesh.prisms);
    EXPECT_NEAR(sum(model.elements.tetrahedron_volumes) + sum(model.elements.prism_volumes), 6000, 1e-9);
    EXPECT_DOUBLE_EQ(model.diagonal_mm, std::sqrt(1400.0));
    EXPECT_EQ(model.elements.region_names, std::vector<std::string>{"body"});
    for (const ElementRole& role :
         split == Split::prisms ? model.elements.prism_roles : model.elements.tetrahedron_roles) {
      EXPECT_EQ(role.material, 0);
      EXPECT_EQ(role.actuator, -1);
      EXPECT_EQ(role.region, 0);
    }
    for (Index v = 0; v < model.rest.rows(); ++v) {
      EXPECT_TRUE(model.elements.used[v]);
      const bool held = model.rest(v, 0) == 0;
      EXPECT_EQ(model.held.fixed[v], (std::array<bool, 3>{held, held, held}));
    }
    EXPECT_TRUE(model.notes.empty());
  }
}

TEST(Compile, ReversedElementsAreTurned) {
  RobotSpec spec = block_robot(block_mesh({2, 1, 1}, {2, 1, 1}));
  const std::vector<Tetrahedron> good = spec.mesh.tetrahedra;
  for (const std::size_t i : {1u, 4u, 7u}) std::swap(spec.mesh.tetrahedra[i][2], spec.mesh.tetrahedra[i][3]);
  Model model = compile(spec);
  EXPECT_EQ(model.elements.tetrahedra, good);
  EXPECT_TRUE(has_note(model, "3 elements were reordered"));

  RobotSpec shell = block_robot(block_mesh({2, 1, 1}, {2, 1, 1}, Split::prisms));
  const std::vector<Prism> upright = shell.mesh.prisms;
  Prism& turned = shell.mesh.prisms[2];
  turned = {turned[3], turned[4], turned[5], turned[0], turned[1], turned[2]};
  model = compile(shell);
  EXPECT_EQ(model.elements.prisms, upright);
  EXPECT_TRUE(has_note(model, "1 element was reordered"));
  // also with triangles of the opposite orientation
  std::swap(shell.mesh.prisms[1][1], shell.mesh.prisms[1][2]);
  std::swap(shell.mesh.prisms[1][4], shell.mesh.prisms[1][5]);
  model = compile(shell);
  EXPECT_NEAR(sum(model.elements.prism_volumes), 2, 1e-12);
  for (const Prism& p : model.elements.prisms)
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR((model.rest.row(p[i + 3]) - model.rest.row(p[i])).norm(), 1, 1e-12) << "side edges pair";
}

TEST(Compile, VoidElementsGoAndTheirVerticesStay) {
  RobotSpec spec = block_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  spec.voids.push_back(shaped(Box{{20, 0, 0}, {30, 10, 10}}));
  const Model model = compile(spec);
  EXPECT_EQ(model.elements.tetrahedra.size(), 12u);
  EXPECT_NEAR(sum(model.elements.tetrahedron_volumes), 2000, 1e-9);
  EXPECT_DOUBLE_EQ(model.diagonal_mm, std::sqrt(400.0 + 100 + 100));
  EXPECT_EQ(model.rest.rows(), 16);
  for (Index v = 0; v < 16; ++v) {
    EXPECT_EQ(model.elements.used[v], model.rest(v, 0) < 25);
    const bool held = model.rest(v, 0) < 5 || !model.elements.used[v];
    EXPECT_EQ(model.held.fixed[v], (std::array<bool, 3>{held, held, held}));
  }
  EXPECT_TRUE(has_note(model, "4 vertices belong to no element"));
}

TEST(Compile, LaterMaterialsOverrideEarlierOnes) {
  RobotSpec spec = block_robot(block_mesh({4, 1, 1}, {40, 10, 10}));
  add_volume_region(spec.mesh, "tip", [](const Vec3& p) { return p[0] > 30; });
  spec.regions.push_back({"stiff", Box{{20, 0, 0}, {40, 10, 10}}, line(2)});
  for (const auto& [region, ratio] : {std::pair("stiff", 0.5), std::pair("tip", 0.25)}) {
    MaterialSpec material;
    material.region = region;
    material.shape_ratio = ratio;
    material.weight = 2;
    material.linear_range = 0.1;
    spec.materials.push_back(material);
  }
  const Model model = compile(spec);
  EXPECT_EQ(model.elements.region_names, (std::vector<std::string>{"body", "tip", "stiff"}));
  ASSERT_EQ(model.elements.materials.size(), 3u);
  EXPECT_EQ(model.elements.materials[2].region, "tip");
  EXPECT_EQ(model.elements.materials[1].shape_ratio, 0.5);
  EXPECT_EQ(model.elements.materials[1].weight, 2);
  EXPECT_EQ(*model.elements.materials[1].linear_range, 0.1);
  std::array<int, 3> count{};
  for (const ElementRole& role : model.elements.tetrahedron_roles) ++count[role.material];
  EXPECT_EQ(count, (std::array<int, 3>{12, 6, 6}));
}

TEST(Compile, ElementsAreNamedByTheFirstVolumeRegion) {
  RobotSpec spec = block_robot(block_mesh({4, 1, 1}, {40, 10, 10}));
  spec.mesh.regions.erase(spec.mesh.regions.begin());  // without "body"
  add_volume_region(spec.mesh, "b", [](const Vec3& p) { return p[0] > 20; });
  add_volume_region(spec.mesh, "a", [](const Vec3& p) { return p[0] > 10; });
  const Model model = compile(spec);
  EXPECT_EQ(model.elements.region_names, (std::vector<std::string>{"b", "a"}));
  std::array<int, 3> count{};
  for (const ElementRole& role : model.elements.tetrahedron_roles) ++count[role.region + 1];
  EXPECT_EQ(count, (std::array<int, 3>{6, 12, 6}));
}

TEST(Compile, MarkersByCoordinatesAndRegions) {
  RobotSpec spec = block_robot(block_mesh({3, 2, 2}, {30, 10, 10}));
  add_vertex_region(spec.mesh, "corner", {3});
  spec.markers = {{"inside", at(12, 3, 4)},
                  {"cap", mean("x_high")},
                  {"middle", mean("body")},
                  {"corner", mean("corner")},
                  {"stick", at(31, 5, 5)}};
  const Model model = compile(spec);
  ASSERT_EQ(model.markers.size(), 5u);
  const std::vector<Vec3> expected{{12, 3, 4}, {30, 5, 5}, {15, 5, 5}, {30, 0, 0}, {31, 5, 5}};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT((model.markers[i].point.at(model.rest) - expected[i]).norm(), 1e-12) << model.markers[i].name;
  EXPECT_DOUBLE_EQ(model.markers[4].point.distance_mm, 1);
  ASSERT_EQ(model.notes.size(), 1u);
  EXPECT_EQ(model.notes[0], "marker 'stick' is 1 mm outside the body and follows its nearest element.");
}

TEST(Compile, BadElementsAndMaterials) {
  RobotSpec good = block_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  add_volume_region(good.mesh, "tip", [](const Vec3& p) { return p[0] > 20; });
  const auto material = [](const std::string& region, double ratio, double weight, double range) {
    return [=](RobotSpec& spec) {
      MaterialSpec added;
      added.region = region;
      added.shape_ratio = ratio;
      added.weight = weight;
      added.linear_range = range;
      added.origin = line(4);
      spec.materials.push_back(added);
    };
  };
  const auto flatten = [](double height) {
    return [=](RobotSpec& spec) {
      const Tetrahedron& t = spec.mesh.tetrahedra[13];
      spec.mesh.vertices.row(t[3]) = (spec.mesh.vertices.row(t[0]) + spec.mesh.vertices.row(t[1])) / 2;
      spec.mesh.vertices(t[3], 1) += height;
    };
  };
  expect_refused(
      good,
      {
          {"no element",
           [](RobotSpec& s) { s.mesh.tetrahedra.clear(), s.mesh.triangles.clear(), s.mesh.regions.clear(); },
           "block: the mesh has no volume element and no triangle: mesh it in three dimensions"},
          {"no volume", [](RobotSpec& s) { s.mesh.tetrahedra.clear(), s.mesh.regions.clear(); },
           "block: the mesh has triangles and no volume element: mesh it in three dimensions"},
          {"all void", [](RobotSpec& s) { s.voids.push_back(named("body")); }, "every element of the mesh is void"},
          {"void face", [](RobotSpec& s) { s.voids.push_back(named("x_low", 8)); },
           "robot.yaml:8: region 'x_low' cannot be void: it holds no element"},
          {"flat", flatten(0), "have no volume; the first is tetrahedron"},
          {"nearly flat",
           [](RobotSpec& s) {
             s.mesh.vertices.conservativeResize(20, 3);
             s.mesh.vertices.bottomRows(4) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3, 0.3, 5e-9;
             s.mesh.tetrahedra.push_back({16, 17, 18, 19});
           },
           "1 tetrahedron has no volume; the first is tetrahedron 18 (from 0)"},
          {"repeated vertex", [](RobotSpec& s) { s.mesh.tetrahedra[7][1] = s.mesh.tetrahedra[7][0]; },
           "1 tetrahedron has no volume; the first is tetrahedron 7 (from 0)"},
          {"no material", [](RobotSpec& s) { s.materials[0].region = "tip"; },
           "12 elements of region 'body' have no material"},
          {"empty material", material("x_low", 1, 1, 1), "region 'x_low' has a material but no element of the body"},
          {"unknown", material("tipp", 1, 1, 1), "robot.yaml:4: there is no region 'tipp'; did you mean 'tip'?"},
          {"ratio", material("tip", 1.5, 1, 1), "shape_ratio must lie in [0, 1], not be 1.5"},
          {"negative ratio", material("tip", -0.1, 1, 1), "shape_ratio must lie in [0, 1]"},
          {"nan ratio", material("tip", std::nan(""), 1, 1), "shape_ratio must lie in [0, 1]"},
          {"weight", material("tip", 1, 0, 1), "weight must be above 0, not 0"},
          {"infinite weight", material("tip", 1, INFINITY, 1), "weight must be above 0, not inf"},
          {"range", material("tip", 1, 1, 0), "linear_range must be above 0"},
      });
}

TEST(Compile, PrismsThatFoldOverAreRefused) {
  const RobotSpec good = block_robot(block_mesh({2, 1, 1}, {2, 1, 1}, Split::prisms));
  expect_refused(good, {{"corner",
                         [](RobotSpec& s) {
                           const Prism& p = s.mesh.prisms[0];
                           // a top corner below its bottom one; the volume stays positive
                           s.mesh.vertices(p[4], 2) = -0.5;
                         },
                         "fold over at a corner; the first is prism 0 (from 0)"}});
}

TEST(Compile, BadMarkersAndFixedRegions) {
  RobotSpec good = block_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  good.regions.push_back({"hole", Box{{10, 10, 0}, {10, 10, 10}}, line(2)});
  good.mesh.vertices.conservativeResize(17, 3);
  good.mesh.vertices.row(16) << 100, 0, 0;
  add_vertex_region(good.mesh, "loose", {16});
  const auto marker = [](const std::string& name, const PointRef& point) {
    return [=](RobotSpec& spec) { spec.markers.push_back({name, point}); };
  };
  expect_refused(good, {
                           {"far", marker("tip", at(64, 5, 5)), "robot.yaml:5: marker 'tip' is 34 mm from the mesh"},
                           {"nan", marker("tip", at(std::nan(""), 5, 5)), "marker 'tip' is not finite"},
                           {"unknown", marker("tip", mean("capp")), "robot.yaml:6: there is no region 'capp'"},
                           {"loose", marker("tip", mean("loose")), "vertex 16 (from 0) belongs to no element"},
                           {"nameless", marker("", at(1, 1, 1)), "a marker needs a name"},
                           {"twice",
                            [](RobotSpec& s) {
                              s.markers = {{"a", at(1, 1, 1)}, {"a", at(2, 1, 1)}};
                            },
                            "there are two markers 'a'"},
                           {"fixed nowhere",
                            [](RobotSpec& s) {
                              s.fixed.push_back({named("loose", 8), {true, true, true}});
                            },
                            "robot.yaml:8: region 'loose' cannot be fixed: it holds no vertex of the body"},
                           {"no axis",
                            [](RobotSpec& s) {
                              s.fixed.push_back({named("hole"), {false, false, false}});
                            },
                            "region 'hole' is fixed along no axis"},
                           {"empty box",
                            [](RobotSpec& s) {
                              s.fixed.push_back({shaped(Box{{-2, 0, 0}, {-1, 1, 1}}), {true, true, true}});
                            },
                            "the box holds no vertex and no element"},
                       });
}

}  // namespace
