#include <gtest/gtest.h>

#include <cmath>

#include "model/compile_testing.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

RobotSpec hollow_cube() {
  return block_robot(hollow_mesh());
}

TEST(Pneumatic, ARegionBecomesTheChamber) {
  RobotSpec spec = hollow_cube();
  ActuatorSpec air = chamber("chamber");
  air.weight = 7;
  air.distribution = Distribution::uniform;
  spec.actuators.push_back(air);
  const Model model = compile(spec);
  ASSERT_EQ(model.actuators.size(), 1u);
  const Actuator& compiled = model.actuators[0];
  EXPECT_EQ(compiled.name, "air");
  EXPECT_EQ(compiled.as<ChamberDrive>()->tetrahedra.size(), 6u);
  EXPECT_NEAR(compiled.rest_measure, 1000, 1e-9);
  EXPECT_EQ(compiled.low, 0.5);
  EXPECT_EQ(compiled.high, 3);
  EXPECT_EQ(compiled.weight, 7);
  EXPECT_EQ(compiled.distribution, Distribution::uniform);
  EXPECT_TRUE(compiled.as<ChamberDrive>()->points.empty());
  int members = 0;
  for (std::size_t i = 0; i < model.elements.tetrahedra.size(); ++i) {
    const ElementRole& role = model.elements.tetrahedron_roles[i];
    members += role.actuator == 0;
    EXPECT_EQ(role.material, role.actuator == 0 ? -1 : 0);
  }
  EXPECT_EQ(members, 6);
  EXPECT_EQ(model.rest_actuation().size(), 1);
  EXPECT_EQ(model.rest_actuation()[0], 1);
}

TEST(Pneumatic, IndicesFollowTheDroppedVoids) {
  RobotSpec spec = hollow_cube();
  spec.voids.push_back(shaped(Box{{20, 0, 0}, {30, 30, 10}}));
  spec.actuators.push_back(chamber("chamber"));
  const Model model = compile(spec);
  EXPECT_EQ(model.elements.tetrahedra.size(), 24u * 6);
  EXPECT_NEAR(model.actuators[0].rest_measure, 1000, 1e-9);
  for (const Index i : model.actuators[0].as<ChamberDrive>()->tetrahedra) {
    Vec3 centroid = Vec3::Zero();
    for (const Index v : model.elements.tetrahedra[i]) centroid += 0.25 * model.rest.row(v).transpose();
    EXPECT_LT((centroid - Vec3(15, 15, 15)).cwiseAbs().maxCoeff(), 5);
  }
}

TEST(Pneumatic, MarkersAreNotEmbeddedInTheChamber) {
  RobotSpec spec = hollow_cube();
  spec.actuators.push_back(chamber("chamber"));
  spec.markers.push_back({"center", at(15, 15, 15)});
  const Model model = compile(spec);
  EXPECT_DOUBLE_EQ(model.markers[0].point.distance_mm, 5);
  EXPECT_TRUE(has_note(model, "marker 'center' is 5 mm outside the body"));
}

TEST(Pneumatic, ASurfaceTakesTheElementsInside) {
  for (const bool inwards : {false, true}) {
    RobotSpec spec = hollow_cube();
    ActuatorSpec air = chamber("");
    air.as<PneumaticSpec>()->region.reset();
    air.as<PneumaticSpec>()->surface = box_surface({9.5, 9.5, 9.5}, {11, 11, 11});
    if (inwards)
      for (Triangle& t : air.as<PneumaticSpec>()->surface->triangles) std::swap(t[0], t[1]);
    spec.actuators.push_back(air);
    const Model model = compile(spec);
    const Actuator& compiled = model.actuators[0];
    EXPECT_EQ(compiled.as<ChamberDrive>()->tetrahedra.size(), 6u);
    EXPECT_NEAR(compiled.rest_measure, 1000, 1e-9);
    ASSERT_EQ(compiled.as<ChamberDrive>()->points.size(), 8u);
    Points corners(8, 3);
    for (Index i = 0; i < 8; ++i) {
      corners.row(i) = compiled.as<ChamberDrive>()->points[i].at(model.rest).transpose();
      EXPECT_LT((corners.row(i) - air.as<PneumaticSpec>()->surface->vertices.row(i)).norm(), 1e-12);
    }
    EXPECT_NEAR(enclosed_volume(corners, compiled.as<ChamberDrive>()->surface), 1331, 1e-9) << "normals outwards";
  }
}

TEST(Dea, MeasuresItsMeanArea) {
  Mesh mesh = block_mesh({4, 2, 1}, {8, 4, 1}, Split::prisms);
  // the top is drawn in to half its size
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices(v, 2) > 0.5) mesh.vertices.row(v).head<2>() *= 0.5;
  add_volume_region(mesh, "membrane", [](const Vec3& p) { return p[0] < 3.0; });
  RobotSpec spec = block_robot(mesh);
  spec.fixed = {{named("z_low"), {true, true, true}}};
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "membrane"}, 0.7, 1.4);
  skin.rest = 1.2;
  spec.actuators.push_back(skin);
  const Model model = compile(spec);
  const auto count = static_cast<double>(model.actuators[0].as<DeaDrive>()->prisms.size());
  EXPECT_EQ(count, 8);
  // a triangle is 2 mm^2 at the bottom and 0.5 mm^2 at the top
  EXPECT_NEAR(model.actuators[0].rest_measure, count * 1.25, 1e-12);
  EXPECT_EQ(model.rest_actuation()[0], 1.2);
  for (const Index i : model.actuators[0].as<DeaDrive>()->prisms) EXPECT_EQ(model.elements.prism_roles[i].actuator, 0);
}

/// 30 x 10 x 20 mm with the notch 10 < x < 20, z > 10.
RobotSpec notched() {
  RobotSpec spec = block_robot(block_mesh({3, 1, 2}, {30, 10, 20}));
  spec.voids.push_back(shaped(Box{{10, 0, 10}, {20, 10, 20}}));
  return spec;
}

std::vector<PointRef> through_the_notch() {
  return {at(0, 5, 15), at(10, 5, 15), at(20, 5, 15), at(30, 5, 15)};
}

TEST(Cable, FindsItsGapAndTheApexAcrossIt) {
  RobotSpec spec = notched();
  spec.actuators.push_back(cable(through_the_notch(), 0.7, 1));
  const Model model = compile(spec);
  const Actuator& tendon = model.actuators[0];
  EXPECT_NEAR(tendon.rest_measure, 30, 1e-12);
  ASSERT_EQ(tendon.as<CableDrive>()->gaps.size(), 1u);
  EXPECT_EQ(tendon.as<CableDrive>()->gaps[0].segment, 1);
  // the body's centroid is at (15, 5, 9): straight down, onto the floor of the notch
  EXPECT_LT((tendon.as<CableDrive>()->gaps[0].apex.at(model.rest) - Vec3(15, 5, 10)).norm(), 1e-9);
  EXPECT_EQ(tendon.as<CableDrive>()->points.size(), 4u);
  EXPECT_LT((tendon.as<CableDrive>()->points[3].at(model.rest) - Vec3(30, 5, 15)).norm(), 1e-12);
}

TEST(Cable, IsOneGapPerSegmentInAContinuousBody) {
  RobotSpec spec = block_robot(block_mesh({3, 2, 2}, {30, 10, 10}));
  for (const double z : {8.0, 10.0}) {  // inside, and on the surface
    spec.actuators = {cable({at(3, 5, z), at(14, 5, z), at(27, 5, z)}, 0.1, 1)};
    const Model model = compile(spec);
    const Actuator& tendon = model.actuators[0];
    ASSERT_EQ(tendon.as<CableDrive>()->gaps.size(), 2u);
    EXPECT_LT((tendon.as<CableDrive>()->gaps[0].apex.at(model.rest) - Vec3(8.5, 5, 0)).norm(), 1e-9);
    EXPECT_LT((tendon.as<CableDrive>()->gaps[1].apex.at(model.rest) - Vec3(20.5, 5, 0)).norm(), 1e-9);
    EXPECT_NEAR(tendon.rest_measure, 24, 1e-12);
  }
}

TEST(Cable, IsGuidedInsideTheBodyAsOftenAsItsSpacingSays) {
  RobotSpec spec = notched();
  spec.actuators.push_back(cable({at(0, 5, 15), at(30, 5, 15)}, 0.7, 1));
  spec.actuators[0].as<CableSpec>()->spacing = 2.5;
  const Model model = compile(spec);
  const Actuator& tendon = model.actuators[0];
  // 13 places 2.5 mm apart, of which three lie in the notch
  ASSERT_EQ(tendon.as<CableDrive>()->points.size(), 10u);
  double before = -2.5;
  for (const EmbeddedPoint& point : tendon.as<CableDrive>()->points) {
    const Vec3 place = point.at(model.rest);
    EXPECT_LT((place - Vec3(before == 10 ? 20 : before + 2.5, 5, 15)).norm(), 1e-9);
    before = place[0];
  }
  ASSERT_EQ(tendon.as<CableDrive>()->gaps.size(), 1u) << "the notch alone";
  EXPECT_EQ(tendon.as<CableDrive>()->gaps[0].segment, 4);
  EXPECT_NEAR(tendon.rest_measure, 30, 1e-12);
}

TEST(Cable, TakesMeansOfRegionsAndGivenApexes) {
  RobotSpec spec = notched();
  add_vertex_region(spec.mesh, "eyelet", {2 + 8, 2 + 8 + 4});  // (20, 0, 10) and (20, 10, 10)
  spec.actuators.push_back(cable({mean("x_low"), at(10, 5, 15), mean("eyelet")}, 0.95, 1));
  spec.actuators[0].as<CableSpec>()->apexes = {at(15, 5, 2)};
  const Model model = compile(spec);
  const Actuator& tendon = model.actuators[0];
  EXPECT_LT((tendon.as<CableDrive>()->points[0].at(model.rest) - Vec3(0, 5, 10)).norm(), 1e-12);
  EXPECT_LT((tendon.as<CableDrive>()->points[2].at(model.rest) - Vec3(20, 5, 10)).norm(), 1e-12);
  EXPECT_NEAR(tendon.rest_measure, 2 * std::sqrt(125.0), 1e-12);
  EXPECT_LT((tendon.as<CableDrive>()->gaps[0].apex.at(model.rest) - Vec3(15, 5, 2)).norm(), 1e-12);
}

TEST(Cable, AChamberCountsAsOutside) {
  RobotSpec spec = hollow_cube();
  spec.actuators = {chamber("chamber"), cable({at(15, 15, 2), at(15, 15, 10), at(15, 15, 20), at(15, 15, 28)}, 0.9, 1)};
  spec.actuators[1].as<CableSpec>()->apexes = {at(10, 15, 15)};
  const Model model = compile(spec);
  ASSERT_EQ(model.actuators[1].as<CableDrive>()->gaps.size(), 1u);
  EXPECT_EQ(model.actuators[1].as<CableDrive>()->gaps[0].segment, 1);
}

TEST(Cable, Refusals) {
  RobotSpec good = notched();
  good.actuators.push_back(cable(through_the_notch(), 0.7, 1));
  const auto change = [](const std::function<void(ActuatorSpec&)>& f) {
    return [=](RobotSpec& spec) { f(spec.actuators[0]); };
  };
  expect_refused(
      good,
      {
          {"one point", change([](ActuatorSpec& a) { a.as<CableSpec>()->points.resize(1); }),
           "needs at least two points"},
          {"zero length", change([](ActuatorSpec& a) { a.as<CableSpec>()->points[2] = a.as<CableSpec>()->points[1]; }),
           "robot.yaml:9: actuator 'tendon' has no length between points[1] and points[2]"},
          {"reach", change([](ActuatorSpec& a) { a.low = 0.5; }),
           "begins at 0.5, but its pieces inside the body alone make 0.666667 of its length of 30 mm"},
          {"too many apexes", change([](ActuatorSpec& a) {
             a.as<CableSpec>()->apexes = {at(15, 5, 2), at(15, 5, 2)};
           }),
           "has 1 gap but 2 apexes"},
          {"apex on the line", change([](ActuatorSpec& a) { a.as<CableSpec>()->apexes = {at(25, 5, 15)}; }),
           "apexes[0] of actuator 'tendon' lies on the line of the cable"},
          {"far point", change([](ActuatorSpec& a) { a.as<CableSpec>()->points[3] = at(60, 5, 15); }),
           "points[3] of actuator 'tendon' is 30 mm from the mesh"},
          {"far apex", change([](ActuatorSpec& a) { a.as<CableSpec>()->apexes = {at(15, 5, -15)}; }),
           "apexes[0] of actuator 'tendon' is 15 mm from the mesh"},
          {"close guides", change([](ActuatorSpec& a) { a.as<CableSpec>()->spacing = 1e-4; }),
           "actuator 'tendon' would be guided at 100000 places by its spacing of 0.0001 mm: the most are 10000"},
          {"filling", change([](ActuatorSpec& a) { a.control = Control::filling; }), "to be a chamber with a filling"},
          {"curve", change([](ActuatorSpec& a) { a.curve = straight_curve(); }), "is a cable: it takes no curve"},
          {"rest", change([](ActuatorSpec& a) { a.rest = 0.9; }), "only a dea has a prestretch"},
          {"through the centroid",
           [](RobotSpec& s) {
             s.voids.clear();
             s.actuators[0].as<CableSpec>()->points = {at(0, 5, 10), at(30, 5, 10)};
           },
           "has a gap between points[0] and points[1] with no body straight across it: name its third corner in"},
          {"along the surface",
           [](RobotSpec& s) {
             s.voids.clear();
             s.actuators[0].as<CableSpec>()->points = {at(0, 5, 20.001), at(30, 5, 20.001)};
           },
           "no body straight across it"},
      });
}

TEST(Actuators, NumbersAndNames) {
  RobotSpec good = hollow_cube();
  good.actuators.push_back(chamber("chamber"));
  const auto change = [](const std::function<void(ActuatorSpec&)>& f) {
    return [=](RobotSpec& spec) { f(spec.actuators[0]); };
  };
  const double nan = std::nan("");
  expect_refused(
      good, {
                {"order", change([](ActuatorSpec& a) { a.low = 2, a.high = 1; }), "0 < low <= high, not [2, 1]"},
                {"zero", change([](ActuatorSpec& a) { a.low = 0; }), "needs a range with 0 < low <= high"},
                {"nan", change([=](ActuatorSpec& a) { a.high = nan; }), "needs a range with 0 < low <= high"},
                {"infinite", change([](ActuatorSpec& a) { a.high = INFINITY; }), "needs a range with 0 < low <= high"},
                {"weight", change([](ActuatorSpec& a) { a.weight = -1; }), "needs a weight above 0, not -1"},
                {"nameless", change([](ActuatorSpec& a) { a.name = ""; }), "an actuator needs a name"},
                {"rest", change([](ActuatorSpec& a) { a.rest = 2; }), "only a dea has a prestretch"},
                {"neither", change([](ActuatorSpec& a) { a.as<PneumaticSpec>()->region.reset(); }),
                 "needs a region or a surface"},
                {"both", change([](ActuatorSpec& a) {
                   a.as<PneumaticSpec>()->surface = box_surface({9, 9, 9}, {12, 12, 12});
                 }),
                 "needs a region or a surface, one of the two"},
                {"unknown", change([](ActuatorSpec& a) { a.as<PneumaticSpec>()->region = "chambre"; }),
                 "did you mean 'chamber'?"},
                {"face", change([](ActuatorSpec& a) { a.as<PneumaticSpec>()->region = "x_low"; }),
                 "region 'x_low' holds no tetrahedron"},
                {"void", [](RobotSpec& s) { s.voids.push_back(named("chamber")); }, "which is void: it cannot be both"},
                {"dea of tetrahedra", change([](ActuatorSpec& a) { a.drive = DeaSpec{.region = "chamber"}; }),
                 "needs prisms, but region 'chamber' has 6 tetrahedra"},
                {"twice the name", [](RobotSpec& s) { s.actuators.push_back(s.actuators[0]); }, "two actuators 'air'"},
                {"twice the element",
                 [](RobotSpec& s) {
                   s.actuators.push_back(s.actuators[0]);
                   s.actuators[1].name = "water";
                 },
                 "actuator 'water' and actuator 'air' both hold tetrahedron 78 (from 0)"},
                {"material of a chamber",
                 [](RobotSpec& s) {
                   MaterialSpec material;
                   material.region = "chamber";
                   s.materials.push_back(material);
                 },
                 "region 'chamber' has a material but no element of the body"},
            });
}

TEST(Pneumatic, Refusals) {
  RobotSpec good = hollow_cube();
  ActuatorSpec air = chamber("");
  air.as<PneumaticSpec>()->region.reset();
  air.as<PneumaticSpec>()->surface = box_surface({9.5, 9.5, 9.5}, {11, 11, 11});
  good.actuators.push_back(air);
  const auto surface = [](const TriangleSurface& replacement) {
    return [=](RobotSpec& spec) { spec.actuators[0].as<PneumaticSpec>()->surface = replacement; };
  };
  TriangleSurface open = *air.as<PneumaticSpec>()->surface, wild = *air.as<PneumaticSpec>()->surface;
  open.triangles.pop_back();
  wild.vertices(0, 0) = std::nan("");
  expect_refused(good, {
                           {"open", surface(open), "actuator 'air' needs a closed surface: the surface is not closed"},
                           {"nan", surface(wild), "a vertex that is not finite"},
                           {"small", surface(box_surface({11, 11, 11}, {0.1, 0.1, 0.1})),
                            "the target-shape formulation needs the chamber meshed, and no element lies inside"},
                           {"large", surface(box_surface({-9, 9, 9}, {40, 12, 12})), "mm from the body"},
                           {"everything", surface(box_surface({-1, -1, -1}, {32, 32, 32})), "no element of the body"},
                       });

  RobotSpec shell = block_robot(block_mesh({2, 2, 1}, {2, 2, 1}, Split::prisms));
  shell.actuators.push_back(chamber("body"));
  EXPECT_NE(refusal(shell).find("is pneumatic and needs tetrahedra, but region 'body' has 8 prisms"),
            std::string::npos);
}

TEST(Pneumatic, AnElementOfAnotherActuatorIsRefused) {
  RobotSpec spec = hollow_cube();
  spec.actuators = {chamber("chamber"), chamber("")};
  spec.actuators[1].name = "bag";
  spec.actuators[1].as<PneumaticSpec>()->region.reset();
  spec.actuators[1].as<PneumaticSpec>()->surface = box_surface({9, 9, 9}, {12, 12, 12});
  EXPECT_NE(refusal(spec).find("actuator 'bag' and actuator 'air' both hold tetrahedron 78"), std::string::npos);
}

TEST(Dea, Refusals) {
  Mesh mesh = block_mesh({4, 2, 1}, {8, 4, 1}, Split::prisms);
  add_volume_region(mesh, "membrane", [](const Vec3& p) { return p[0] < 4; });
  RobotSpec good = block_robot(mesh);
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "membrane"}, 0.7, 1.4);
  good.actuators.push_back(skin);
  const auto change = [](const std::function<void(ActuatorSpec&)>& f) {
    return [=](RobotSpec& spec) { f(spec.actuators[0]); };
  };
  expect_refused(
      good,
      {
          {"prestretch", change([](ActuatorSpec& a) { a.rest = 1.5; }),
           "has its rest ratio (prestretch) 1.5 outside its range [0.7, 1.4]"},
          {"prestretch nan", change([](ActuatorSpec& a) { a.rest = std::nan(""); }), "rest ratio"},
          {"face", change([](ActuatorSpec& a) { a.as<DeaSpec>()->region = "x_low"; }), "region 'x_low' has none"},
          {"no region", change([](ActuatorSpec& a) { a.as<DeaSpec>()->region.clear(); }), "needs a region of prisms"},
      });
}

TEST(Actuators, ARangeWithoutTheRestRatioIsClampedAndNoted) {
  RobotSpec spec = hollow_cube();
  spec.actuators.push_back(chamber("chamber"));
  spec.actuators[0].low = 1.25;
  const Model model = compile(spec);
  EXPECT_EQ(model.rest_actuation()[0], 1.25);
  EXPECT_TRUE(has_note(model, "The range [1.25, 3] of actuator 'air' excludes its rest ratio 1"));
}

TEST(Actuators, ARobotMayBeAllChamber) {
  RobotSpec spec = block_robot(block_mesh({2, 1, 1}, {2, 1, 1}));
  spec.materials.clear();
  spec.actuators.push_back(chamber("body"));
  EXPECT_EQ(compile(spec).actuators[0].as<ChamberDrive>()->tetrahedra.size(), 12u);
  spec.markers.push_back({"tip", at(2, 0, 0)});
  EXPECT_NE(refusal(spec).find("marker 'tip' needs a body to lie in"), std::string::npos);
}

}  // namespace
