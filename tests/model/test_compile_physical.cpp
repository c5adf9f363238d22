#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

std::set<Index> vertices_of(const std::vector<CavityFace>& faces) {
  std::set<Index> vertices;
  for (const CavityFace& face : faces) vertices.insert(face.corners.begin(), face.corners.end());
  return vertices;
}

TEST(Physical, AChamberIsACavityWithoutElements) {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.actuators.push_back(chamber("chamber"));
  const Model model = compile(spec);
  EXPECT_EQ(model.formulation, Formulation::physical);
  EXPECT_EQ(model.elements.tetrahedra.size(), 26u * 6);
  const auto& air = *model.actuators[0].as<ChamberDrive>();
  EXPECT_TRUE(air.tetrahedra.empty());
  EXPECT_EQ(air.cavity.size(), 12u);
  EXPECT_NEAR(model.actuators[0].rest_measure, 1000, 1e-9);
  for (const Index v : vertices_of(air.cavity)) {
    EXPECT_DOUBLE_EQ((model.rest.row(v).transpose() - Vec3(15, 15, 15)).cwiseAbs().maxCoeff(), 5);
    EXPECT_TRUE(model.elements.used[v]);
  }
  for (const ElementRole& role : model.elements.tetrahedron_roles) {
    EXPECT_EQ(role.material, 0);
    EXPECT_EQ(role.actuator, -1);
  }
  EXPECT_TRUE(model.notes.empty());
  // volume grows where the cavity's vertices move out
  Points grown = model.rest;
  for (const Index v : vertices_of(air.cavity)) grown.row(v) += 0.1 * (grown.row(v) - Eigen::RowVector3d::Constant(15));
  EXPECT_NEAR(enclosed_volume(grown, air.cavity), 1331, 1e-9);
}

TEST(Physical, ReversedElementsOfAChamberAreTurned) {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.actuators.push_back(chamber("chamber"));
  for (const Index i : spec.mesh.regions.back().tetrahedra)
    if (i % 2 == 0) std::swap(spec.mesh.tetrahedra[i][2], spec.mesh.tetrahedra[i][3]);
  const Model model = compile(spec);
  EXPECT_EQ(model.actuators[0].as<ChamberDrive>()->cavity.size(), 12u);
  EXPECT_NEAR(model.actuators[0].rest_measure, 1000, 1e-9);
  EXPECT_TRUE(has_note(model, "3 elements were reordered"));
}

/// 60 x 60 x 60 mm, fixed at x = 0, where a chamber of 20 x 40 x 40 mm opens.
RobotSpec against_a_plate() {
  RobotSpec spec = physical_robot(block_mesh({3, 6, 6}, {60, 60, 60}));
  add_volume_region(spec.mesh, "mouth",
                    [](const Vec3& p) { return p[0] < 20 && p[1] > 10 && p[1] < 50 && p[2] > 10 && p[2] < 50; });
  spec.actuators.push_back(chamber("mouth"));
  return spec;
}

TEST(Physical, AHeldPlateClosesAChamber) {
  const Model model = compile(against_a_plate());
  EXPECT_EQ(model.actuators[0].as<ChamberDrive>()->cavity.size(), 2 * (2 * 16u + 4 * 4));
  EXPECT_NEAR(model.actuators[0].rest_measure, 32000, 1e-8);
  EXPECT_TRUE(has_note(model, "9 vertices on the boundary of the chamber of actuator 'air' belong to no element"));
  EXPECT_EQ(model.notes.size(), 1u);
  RobotSpec half = against_a_plate();  // x = 0 a plane of symmetry
  half.fixed = {{named("x_low"), {true, false, false}}, {named("x_high"), {true, true, true}}};
  EXPECT_EQ(compile(half).actuators[0].as<ChamberDrive>()->cavity.size(),
            model.actuators[0].as<ChamberDrive>()->cavity.size());
}

TEST(Physical, AnOpenChamberIsRefused) {
  const std::string opening = "robot.yaml:9: actuator 'air' has a chamber that is open: 32 faces around (0, 30, 30) mm";
  expect_refused(against_a_plate(),
                 {{"free",
                   [](RobotSpec& s) {
                     s.fixed = {{named("x_high"), {true, true, true}}};
                   },
                   opening},
                  {"free along its normal",
                   [](RobotSpec& s) {
                     s.fixed = {{named("x_low"), {false, true, true}}, {named("x_high"), {true, true, true}}};
                   },
                   opening},
                  {"displaced",
                   [](RobotSpec& s) {
                     s.fixed[0].displacement = {1, 0, 0};
                   },
                   opening},
                  {"at a void",
                   [](RobotSpec& s) {
                     s.voids = {shaped(Box{{20, 20, 20}, {60, 40, 40}})};
                   },
                   "is open: 8 faces around (20, 30, 30) mm is not the body's"}});
  RobotSpec end = physical_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  add_volume_region(end.mesh, "end", [](const Vec3& p) { return p[0] > 20; });
  end.actuators.push_back(chamber("end"));
  EXPECT_NE(refusal(end).find("has a chamber that is open: 10 faces around"), std::string::npos) << refusal(end);
}

TEST(Physical, VerticesInsideAChamberAreNoLooseVertices) {
  RobotSpec spec = physical_robot(block_mesh({4, 4, 4}, {40, 40, 40}));
  add_volume_region(spec.mesh, "chamber",
                    [](const Vec3& p) { return (p - Vec3(20, 20, 20)).cwiseAbs().maxCoeff() < 10; });
  spec.actuators.push_back(chamber("chamber"));
  const Model model = compile(spec);
  EXPECT_TRUE(model.notes.empty());
  EXPECT_NEAR(model.actuators[0].rest_measure, 8000, 1e-9);
  EXPECT_EQ(model.actuators[0].as<ChamberDrive>()->cavity.size(), 6u * 8);
}

TEST(Physical, ACableHasNoGaps) {
  RobotSpec spec = physical_robot(block_mesh({3, 1, 2}, {30, 10, 20}));
  spec.actuators.push_back(cable({at(0, 5, 15), at(10, 5, 15), at(30, 5, 15)}, 0.01, 1));
  spec.actuators[0].as<CableSpec>()->apexes = {at(15, 5, 2)};
  const Model model = compile(spec);
  EXPECT_TRUE(model.actuators[0].as<CableDrive>()->gaps.empty());
  EXPECT_EQ(model.actuators[0].as<CableDrive>()->points.size(), 3u);
  EXPECT_NEAR(model.actuators[0].rest_measure, 30, 1e-12);
}

TEST(Physical, ACableHoldsNoPart) {
  RobotSpec spec = physical_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  spec.voids.push_back(shaped(Box{{10, 0, 0}, {20, 10, 10}}));
  spec.actuators.push_back(cable({at(2, 5, 9), at(10, 5, 9), at(20, 5, 9), at(28, 5, 9)}));
  EXPECT_NE(refusal(spec).find("a part of 8 vertices around (25, 5, 5) mm can move"), std::string::npos);
  spec.rigid.push_back({shaped(Box{{10, 0, 0}, {20, 10, 10}}), "link"});
  EXPECT_EQ(refusal(spec), "");
}

TEST(Physical, ADeaHasAMaterialAndAnActuator) {
  Mesh mesh = block_mesh({4, 2, 1}, {8, 4, 1}, Split::prisms);
  add_volume_region(mesh, "membrane", [](const Vec3& p) { return p[0] < 4; });
  RobotSpec spec = physical_robot(mesh);
  spec.materials[0].region = "all";
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "membrane"}, 0.7, 1.4);
  skin.rest = 1.2;
  spec.actuators.push_back(skin);
  const Model model = compile(spec);
  EXPECT_EQ(model.actuators[0].as<DeaDrive>()->prisms.size(), 8u);
  EXPECT_NEAR(model.actuators[0].rest_measure, 16, 1e-12);
  int actuated = 0;
  for (const ElementRole& role : model.elements.prism_roles) {
    EXPECT_EQ(role.material, 0);
    actuated += role.actuator == 0;
  }
  EXPECT_EQ(actuated, 8);
  // its prisms are elements of the body: they need a material
  spec.regions.push_back({"rest", Box{{4, 0, 0}, {8, 4, 1}}, line(2)});
  spec.materials[0].region = "rest";
  EXPECT_NE(refusal(spec).find("8 elements of region 'body' have no material"), std::string::npos);
}

TEST(Physical, AMembranesMaterialIsNotNeededInTargetShape) {
  Mesh mesh = block_mesh({4, 2, 1}, {8, 4, 1}, Split::prisms);
  add_volume_region(mesh, "membrane", [](const Vec3& p) { return p[0] < 4; });
  RobotSpec spec = physical_robot(mesh);
  spec.materials[0].region = "body";
  spec.materials[0].shape_ratio = 1;
  MaterialSpec silicone = spec.materials[0];
  silicone.region = "membrane";
  silicone.shape_ratio.reset();
  spec.materials.push_back(silicone);
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "membrane"}, 0.7, 1.4);
  spec.actuators.push_back(skin);
  EXPECT_EQ(compile(spec).elements.materials.size(), 2u);
  spec.formulation = Formulation::target_shape;
  const Model model = compile(spec);
  EXPECT_EQ(model.elements.materials.size(), 1u);
  EXPECT_EQ(model.elements.prism_roles[0].actuator, 0);
  EXPECT_EQ(model.elements.prism_roles[0].material, -1);
}

TEST(Physical, LoadControlRestsAtZero) {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.actuators = {chamber("chamber"), cable({at(0, 5, 5), at(30, 5, 5)})};
  for (ActuatorSpec& a : spec.actuators) {
    a.control = Control::load;
    a.rest = 0;
  }
  spec.actuators[0].low = -20;
  spec.actuators[1].low = 2;
  spec.actuators[1].high = 9;
  const Model model = compile(spec);
  EXPECT_EQ(model.actuators[0].control, Control::load);
  EXPECT_EQ(model.rest_actuation(), Eigen::Vector2d(0, 2));
  ASSERT_EQ(model.notes.size(), 1u);
  EXPECT_EQ(model.notes[0],
            "The range [2, 9] of actuator 'tendon' excludes its load at rest 0: where none is requested, 2 is taken.");
}

TEST(Physical, ActuatorRefusals) {
  RobotSpec good = physical_robot(hollow_mesh());
  add_volume_region(good.mesh, "half",
                    [](const Vec3& p) { return (p - Vec3(15, 15, 15)).cwiseAbs().maxCoeff() < 5 && p[0] > p[1]; });
  good.actuators = {chamber("chamber"), cable({at(0, 5, 5), at(30, 5, 5)})};
  good.actuators[1].control = Control::load;
  good.actuators[1].rest = 0;
  const auto change = [](std::size_t i, const std::function<void(ActuatorSpec&)>& f) {
    return [=](RobotSpec& spec) { f(spec.actuators[i]); };
  };
  expect_refused(
      good,
      {
          {"shared",
           [](RobotSpec& s) {
             s.actuators.push_back(s.actuators[0]);
             s.actuators[2].name = "water";
             s.actuators[2].as<PneumaticSpec>()->region = "half";
           },
           "actuator 'water' and actuator 'air' both hold tetrahedron"},
          {"void", [](RobotSpec& s) { s.voids.push_back(named("chamber")); }, "which is void: it cannot be both"},
          {"far",
           [](RobotSpec& s) {
             // all around the chamber is void
             s.mesh = block_mesh({5, 5, 5}, {50, 50, 50});
             add_volume_region(s.mesh, "chamber",
                               [](const Vec3& p) { return (p - Vec3(25, 25, 25)).cwiseAbs().maxCoeff() < 5; });
             add_volume_region(s.mesh, "around", [](const Vec3& p) {
               const double r = (p - Vec3(25, 25, 25)).cwiseAbs().maxCoeff();
               return r > 5 && r < 15;
             });
             s.voids = {named("around")};
           },
           "actuator 'air' has a chamber that does not touch the body"},
          {"all", change(0, [](ActuatorSpec& a) { a.as<PneumaticSpec>()->region = "body"; }),
           "void or belongs to a chamber"},
          {"ratio 0", change(0, [](ActuatorSpec& a) { a.low = 0; }), "needs a range with 0 < low <= high"},
          {"tension", change(1, [](ActuatorSpec& a) { a.low = -1; }), "range of its tension with 0 <= low <= high"},
          {"tension nan", change(1, [](ActuatorSpec& a) { a.high = std::nan(""); }), "not [0.9, nan]"},
          {"pressure",
           change(0,
                  [](ActuatorSpec& a) {
                    a.control = Control::load;
                    a.rest = 0;
                    a.high = -1;
                  }),
           "range of its pressure with low <= high, not [0.5, -1]"},
          {"pressure inf",
           change(0,
                  [](ActuatorSpec& a) {
                    a.control = Control::load;
                    a.rest = 0;
                    a.low = -INFINITY;
                  }),
           "range of its pressure with low <= high"},
          {"rest", change(1, [](ActuatorSpec& a) { a.rest = 1; }), "cannot have a load at rest other than 0, not 1"},
          {"open",
           change(0,
                  [](ActuatorSpec& a) {
                    a.as<PneumaticSpec>()->region.reset();
                    a.as<PneumaticSpec>()->surface = box_surface({9, 9, 9}, {12, 12, 12});
                    a.as<PneumaticSpec>()->surface->triangles.pop_back();
                  }),
           "needs a closed surface: the surface is not closed"},
      });
}

namespace {

RobotSpec charged_shell() {
  RobotSpec shell = physical_robot(block_mesh({2, 2, 1}, {2, 2, 1}, Split::prisms));
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "body"}, 0, 4);
  skin.control = Control::load;
  skin.rest = 0;
  shell.actuators.push_back(skin);
  shell.materials[0].permittivity = 3;
  shell.materials[0].origin = line(3);
  return shell;
}

PrismValues fractions_of(const std::vector<Index>& prisms) {
  PrismValues fractions;
  for (const Index prism : prisms) {
    fractions.prisms.push_back(prism);
    fractions.values.push_back(0.1 * prism);
    fractions.origins.push_back({.file = "share.csv", .line = static_cast<std::size_t>(prism) + 2});
  }
  return fractions;
}

}  // namespace

TEST(Physical, ALayerUnderVoltage) {
  RobotSpec spec = charged_shell();
  const Model model = compile(spec);
  EXPECT_EQ(model.actuators[0].control, Control::load);
  EXPECT_EQ(model.elements.materials[0].permittivity, 3);
  EXPECT_EQ(model.actuators[0].as<DeaDrive>()->fractions, std::vector<double>(8, 1));
  EXPECT_EQ(model.rest_actuation()[0], 0);
  spec.actuators[0].as<DeaSpec>()->fractions = fractions_of({3, 1, 0, 2, 7, 6, 5, 4});
  const Model shared = compile(spec);
  const auto& dea = *shared.actuators[0].as<DeaDrive>();
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_EQ(dea.fractions[i], 0.1 * dea.prisms[i]);  // all of the mesh, in its order
  EXPECT_NE(fingerprint_of(model), fingerprint_of(shared));
  spec.materials[0].permittivity = 4;
  EXPECT_NE(fingerprint_of(shared), fingerprint_of(compile(spec)));
}

TEST(Physical, RefusalsOfVoltages) {
  const auto fractions = [](std::vector<Index> prisms) {
    return [=](RobotSpec& s) { s.actuators[0].as<DeaSpec>()->fractions = fractions_of(prisms); };
  };
  expect_refused(
      charged_shell(),
      {{"no permittivity", [](RobotSpec& s) { s.materials[0].permittivity.reset(); },
        "robot.yaml:3: the material of region 'all' needs 'permittivity', over that of the vacuum: actuator 'skin'"},
       {"negative", [](RobotSpec& s) { s.actuators[0].low = -1; }, "range of its voltage with 0 <= low <= high"},
       {"prestretch", [](RobotSpec& s) { s.actuators[0].as<DeaSpec>()->prestretch = 0; },
        "needs a prestretch above 0, not 0"},
       {"rest", [](RobotSpec& s) { s.actuators[0].rest = 1; }, "cannot have a load at rest other than 0"},
       {"ratio",
        [](RobotSpec& s) {
          s.actuators[0].control = Control::ratio;
          s.actuators[0].low = s.actuators[0].rest = 1;
          s.actuators[0].as<DeaSpec>()->fractions = fractions_of({0});
        },
        "takes no fractions of a voltage"},
       {"target", [](RobotSpec& s) { s.formulation = Formulation::target_shape; },
        "is controlled by its load: that needs the physical formulation"},
       {"some", fractions({0, 1, 2, 3, 4, 5, 6}), "has no fraction of the voltage for prism 7 (from 0)"},
       {"twice", fractions({0, 1, 1}), "share.csv:3: prism 1 (from 0) is there twice"},
       {"beyond", fractions({8}), "share.csv:10: prism 8 (from 0) is none of the mesh's"},
       {"sign",
        [](RobotSpec& s) {
          s.actuators[0].as<DeaSpec>()->fractions = fractions_of({2});
          s.actuators[0].as<DeaSpec>()->fractions->values[0] = -0.5;
        },
        "share.csv:4: prism 2 (from 0) has a fraction of the voltage of -0.5: 0 or more"}});
}

TEST(Physical, TargetShapesKnowNoForces) {
  RobotSpec spec = block_robot(hollow_mesh());
  spec.loads.gravity = {0, 0, -9.81};
  spec.loads.forces = {{"push", at(30, 15, 15), {1, 0, 0}}};
  const Model model = compile(spec);
  EXPECT_EQ(model.loads.dead.rows(), 0);
  EXPECT_EQ(model.notes.size(), 2u);
  EXPECT_TRUE(has_note(model, "Gravity is left out"));
  EXPECT_TRUE(has_note(model, "1 force is left out"));
  spec.actuators = {chamber("chamber")};
  spec.actuators[0].control = Control::load;
  EXPECT_NE(refusal(spec).find("robot.yaml:9: actuator 'air' is controlled by its load: that needs the physical"),
            std::string::npos);
}

}  // namespace
