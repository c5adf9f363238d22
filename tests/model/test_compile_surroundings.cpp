#include <Eigen/Geometry>
#include <numbers>
#include <softkin/model/families.hpp>
#include <softkin/model/growth.hpp>
#include <softkin/model/joined.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

/// Liquids around robots and families of fibres in materials: what is wet, and what is refused.

namespace softkin {

namespace {

using namespace testing;

RobotSpec wet_robot(Mesh mesh) {
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 0, -9.81};
  spec.loads.liquid_around = LiquidAroundSpec{1000, {0, 0, 50}, line(4)};
  return spec;
}

RobotSpec fibrous(std::vector<FamilySpec> families) {
  RobotSpec spec = physical_robot(block_mesh({2, 2, 2}, {20, 8, 6}));
  spec.materials[0].origin = line(6);
  spec.materials[0].families = std::make_shared<const FamiliesSpec>(FamiliesSpec{std::move(families)});
  return spec;
}

/// Area vectors of the wet faces add up to 0 where they are closed.
Vec3 area_of(const Model& model, const std::vector<LoadedFace>& faces) {
  Vec3 sum = Vec3::Zero();
  for (const LoadedFace& loaded : faces) {
    const Triangle& t = loaded.face.corners;
    const Vec3 a = vertex_at(model.rest, t[0]);
    sum += 0.5 * loaded.fraction * (vertex_at(model.rest, t[1]) - a).cross(vertex_at(model.rest, t[2]) - a);
  }
  return sum;
}

}  // namespace

/// Chambers of elements, empty spaces with and without an actuator: all their walls are dry.
TEST(CompileLiquid, TheOutsideIsWet) {
  RobotSpec solid = wet_robot(hollow_mesh());
  EXPECT_EQ(compile(solid).loads.tractions.at(0).faces.size(), 6u * 18u);
  RobotSpec chamber = solid;
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 2);
  chamber.actuators = {air};
  RobotSpec empty = solid;
  empty.voids = {named("chamber")};
  RobotSpec space = empty;
  air.as<PneumaticSpec>()->region.reset();
  space.actuators = {air};
  for (const RobotSpec& spec : {chamber, empty, space}) {
    const Model model = compile(spec);
    ASSERT_EQ(model.loads.tractions.size(), 1u);
    EXPECT_EQ(model.loads.tractions[0].faces.size(), 6u * 18u);
    EXPECT_LT(area_of(model, model.loads.tractions[0].faces).norm(), 1e-9);
    EXPECT_LT((model.loads.tractions[0].deeper_MPa_mm - Vec3(0, 0, -9.81e-6)).norm(), 1e-18);
  }
  const Model prisms = compile(wet_robot(block_mesh({2, 2, 2}, {20, 8, 6}, Split::prisms)));
  EXPECT_LT(area_of(prisms, prisms.loads.tractions.at(0).faces).norm(), 1e-9);
}

/// A chamber that ends at the plate which holds the robot.
TEST(CompileLiquid, ChambersThatEndAtAPlateAreDry) {
  Mesh mesh = block_mesh({3, 3, 3}, {30, 30, 30});
  add_volume_region(mesh, "chamber",
                    [](const Vec3& p) { return p.x() < 20 && std::abs(p.y() - 15) < 5 && std::abs(p.z() - 15) < 5; });
  RobotSpec spec = wet_robot(mesh);
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 2);
  spec.actuators = {air};
  const Model model = compile(spec);
  EXPECT_EQ(model.loads.tractions.at(0).faces.size(), 6u * 18u - 2u);
  EXPECT_LT((area_of(model, model.loads.tractions[0].faces) - Vec3(100, 0, 0)).norm(), 1e-9);
}

TEST(CompileLiquid, Refusals) {
  expect_refused(
      wet_robot(hollow_mesh()),
      {{"no gravity", [](RobotSpec& s) { s.loads.gravity.setZero(); },
        "needs gravity: without it there is no pressure"},
       {"density", [](RobotSpec& s) { s.loads.liquid_around->density = -1; }, "needs a density above 0 kg/m^3, not -1"},
       {"surface", [](RobotSpec& s) { s.loads.liquid_around->surface.x() = std::nan(""); },
        "surface that is not finite"}});
  RobotSpec target = block_robot(block_mesh({2, 2, 2}, {20, 8, 6}));
  target.loads.liquid_around = LiquidAroundSpec{};
  const std::vector<std::string> notes = compile(target).notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("liquid around it is left out") != std::string::npos;
  }));
  try {
    (void)joined({{"a", wet_robot(hollow_mesh()), {}, {}}}, {});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("has no liquid around it of its own"), std::string::npos) << error.what();
  }
}

TEST(CompileFamilies, OfTheElementsOfTheirMaterial) {
  RobotSpec spec = fibrous({{0.2, 1, 0.1, {.uniform = {0, 3, 4}}}, {0.1, 0, 0, {.uniform = {1, 0, 0}}}});
  spec.regions = {{"left", Selector(Box{{-1, -1, -1}, {10, 9, 7}}), line(3)}};
  spec.materials.push_back(spec.materials[0]);
  spec.materials[1].region = "left";
  spec.materials[1].families.reset();
  const Model model = compile(spec);
  EXPECT_FALSE(model.elements.materials[1].families);
  const Families& families = *model.elements.materials[0].families;
  ASSERT_EQ(families.families.size(), 2u);
  EXPECT_EQ(2 * families.tetrahedra.size(), model.elements.tetrahedra.size());
  EXPECT_EQ(families.families[0].directions.size(), families.tetrahedra.size());
  EXPECT_EQ(families.families[0].directions[0], Vec3(0, 0.6, 0.8));
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()).toRotationMatrix();
  const Model placed = compile(joined({{"a", spec, {turn, {0, 0, 0}}, {}}}, {}));
  EXPECT_LT((placed.elements.materials[0].families->families[0].directions[0] - Vec3(0, -0.8, 0.6)).norm(), 1e-12);
  RobotSpec other = spec;
  other.materials[0].families = fibrous({{0.2, 1, 0.1, {.uniform = {0, 3, 5}}}, {0.1, 0, 0, {}}}).materials[0].families;
  EXPECT_NE(fingerprint_of(compile(other)), fingerprint_of(model));
}

TEST(CompileFamilies, Refusals) {
  const auto with = [](const FamilySpec& family) {
    return [family](RobotSpec& s) { s.materials[0].families = fibrous({family}).materials[0].families; };
  };
  expect_refused(
      fibrous({{0.2, 1, 0.1, {}}}),
      {{"none", [](RobotSpec& s) { s.materials[0].families = fibrous({}).materials[0].families; },
        "no family of fibres"},
       {"k1", with({0, 1, 0, {}}), "needs k1 above 0 MPa, not 0"},
       {"k2", with({1, -1, 0, {}}), "needs k2 of 0 or more, not -1"},
       {"dispersion", with({1, 1, 0.5, {}}), "needs a dispersion of 0 to 1/3, not 0.5"},
       {"direction", with({1, 1, 0, {.uniform = Vec3::Zero()}}), "the direction of its fibres needs a direction"},
       {"target shapes",
        [](RobotSpec& s) {
          s.formulation = Formulation::target_shape;
          s.materials[0].shape_ratio = 1;
        },
        "has families of fibres, which need the physical formulation"},
       {"growth",
        [](RobotSpec& s) {
          ActuatorSpec grow = actuator("grow", GrowthSpec{{{"all"}}}, 0.8, 1.5);
          s.actuators = {grow};
        },
        "has families of fibres, and an actuator lets it grow"}});
}

}  // namespace softkin
