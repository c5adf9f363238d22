#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <softkin/io/file.hpp>
#include <softkin/model/families.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

#include "scene_fixtures.hpp"
#include "support/patience.hpp"

namespace softkin {
namespace {

RobotSpec parse(const std::string& text) {
  return parse_scene(text, "robots/finger.yaml", fake_files());
}

RobotSpec parse_body(const std::string& text) {
  return parse("softkin: 1\nmesh: {file: a.msh}\n" + text);
}

void expect_near(const Vec3& found, double x, double y, double z) {
  EXPECT_LT((found - Vec3(x, y, z)).norm(), 1e-12) << found.transpose();
}

Vec3 position(const PointRef& point) {
  return std::get<Vec3>(point.point);
}

std::string region(const PointRef& point) {
  return std::get<std::string>(point.point);
}

TEST(Scene, WholeSceneMeshAndMaterials) {
  const RobotSpec spec = parse(whole_scene);
  EXPECT_EQ(spec.name, "robots/finger.yaml");
  expect_near(spec.mesh.vertices.row(1).transpose(), 120, 0, 0);
  ASSERT_EQ(spec.materials.size(), 2u);
  EXPECT_EQ(spec.materials[0].region, "all");
  EXPECT_EQ(spec.materials[0].shape_ratio, 0.5);
  EXPECT_EQ(spec.materials[0].weight, 1);
  EXPECT_FALSE(spec.materials[0].linear_range);
  EXPECT_EQ(spec.materials[1].region, "rib");
  EXPECT_EQ(spec.materials[1].weight, 2);
  EXPECT_EQ(spec.materials[1].linear_range, 0.2);
  EXPECT_EQ(spec.materials[1].origin.text(), "robots/finger.yaml:16");
}

TEST(Scene, WholeSceneRegions) {
  const RobotSpec spec = parse(whole_scene);
  ASSERT_EQ(spec.regions.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(spec.regions[i].origin.line, 6 + i);
    EXPECT_EQ(spec.regions[i].origin.file, "robots/finger.yaml");
  }
  EXPECT_EQ(spec.regions[0].name, "stiff");
  expect_near(std::get<Box>(spec.regions[0].selector).high, 10, 25, 25);
  const auto& ball = std::get<Sphere>(spec.regions[1].selector);
  expect_near(ball.center, 100, 200, 300);
  EXPECT_DOUBLE_EQ(ball.radius, 4);
  const auto& rod = std::get<Cylinder>(spec.regions[2].selector);
  expect_near(rod.start, 0, 0, 0);
  expect_near(rod.end, 120, 0, 0);
  EXPECT_DOUBLE_EQ(rod.radius, 2);
  const auto& upper = std::get<Halfspace>(spec.regions[3].selector);
  expect_near(upper.point, 0, 0, 12.5);
  expect_near(upper.normal, 0, 0, 1);
  EXPECT_EQ(std::get<VertexList>(spec.regions[4].selector).vertices, (std::vector<Index>{0, 4}));
  EXPECT_EQ(std::get<ElementList>(spec.regions[5].selector).tetrahedra, std::vector<Index>{1});
  EXPECT_EQ(std::get<ElementList>(spec.regions[6].selector).tetrahedra, std::vector<Index>{1});
  EXPECT_EQ(std::get<VertexList>(spec.regions[7].selector).vertices, (std::vector<Index>{0, 4}));
}

TEST(Scene, WholeSceneSupports) {
  const RobotSpec spec = parse(whole_scene);
  ASSERT_EQ(spec.voids.size(), 1u);
  EXPECT_EQ(std::get<std::string>(spec.voids[0].region), "chamber2");
  EXPECT_EQ(spec.voids[0].origin.line, 17u);
  ASSERT_EQ(spec.fixed.size(), 3u);
  EXPECT_EQ(std::get<std::string>(spec.fixed[0].where.region), "base");
  EXPECT_EQ(spec.fixed[0].axes, (std::array<bool, 3>{true, true, true}));
  const auto& box = std::get<Box>(std::get<Selector>(spec.fixed[1].where.region));
  expect_near(box.low, -1, -1, -1);
  expect_near(box.high, 0.1, 26, 26);
  EXPECT_EQ(spec.fixed[1].where.origin.line, 20u);
  EXPECT_EQ(spec.fixed[2].axes, (std::array<bool, 3>{true, false, true}));
  ASSERT_EQ(spec.rigid.size(), 3u);
  EXPECT_EQ(spec.rigid[0].name, "tip_plate");
  EXPECT_EQ(std::get<std::string>(spec.rigid[0].where.region), "tip_plate");
  EXPECT_EQ(spec.rigid[1].name, "handle");
  EXPECT_EQ(spec.rigid[1].where.origin.line, 24u);
  EXPECT_EQ(spec.rigid[2].name, "rigid_3");
  EXPECT_DOUBLE_EQ(std::get<Sphere>(std::get<Selector>(spec.rigid[2].where.region)).radius, 1);
}

TEST(Scene, WholeSceneChambersAndSkins) {
  const RobotSpec spec = parse(whole_scene);
  ASSERT_EQ(spec.actuators.size(), 4u);
  const ActuatorSpec &air = spec.actuators[0], &skin = spec.actuators[2], &bag = spec.actuators[3];
  EXPECT_EQ(air.name, "air");
  EXPECT_TRUE(air.is<PneumaticSpec>());
  EXPECT_EQ(air.as<PneumaticSpec>()->region, "chamber");
  EXPECT_FALSE(air.as<PneumaticSpec>()->surface);
  EXPECT_EQ(air.low, 1);
  EXPECT_EQ(air.high, 3);
  EXPECT_EQ(air.rest, 1);
  EXPECT_EQ(air.weight, 5);
  EXPECT_EQ(air.distribution, Distribution::uniform);
  EXPECT_TRUE(skin.is<DeaSpec>());
  EXPECT_EQ(skin.as<DeaSpec>()->region, "membrane");
  EXPECT_EQ(skin.rest, 1.2);
  EXPECT_EQ(skin.low, 0.7);
  EXPECT_EQ(skin.distribution, Distribution::minimum_norm);
  EXPECT_FALSE(bag.as<PneumaticSpec>()->region);
  ASSERT_TRUE(bag.as<PneumaticSpec>()->surface);
  expect_near(bag.as<PneumaticSpec>()->surface->vertices.row(1).transpose(), 1000, 0, 0);
  EXPECT_EQ(bag.as<PneumaticSpec>()->surface->triangles.size(), 1u);
  EXPECT_EQ(bag.origin.text(), "robots/finger.yaml:37");
}

TEST(Scene, SurfacesAreMovedAndThenRotatedAndVoidsAreNamedByAPoint) {
  const auto chamber = [](const std::string& keys) {
    return *parse("softkin: 1\nunits: {length: cm}\nmesh: {file: a.msh}\nactuators: [{name: a, kind: pneumatic, " +
                  keys + ", range: [1, 2]}]\n")
                .actuators[0]
                .as<PneumaticSpec>();
  };
  const std::string turn = "rotate: {axis: [0, 0, 1], degrees: 90}";
  const auto corner = [&](const std::string& surface) {
    return Vec3(chamber("surface: " + surface).surface->vertices.row(1).transpose());
  };
  expect_near(corner("{file: c.stl, move: [1, 0, 0]}"), 20, 0, 0);
  expect_near(corner("{file: c.stl, move: [1, 0, 0], " + turn + "}"), 0, 20, 0);
  expect_near(corner("{file: c.stl, unit: mm, move: [1, 0, 0]}"), 11, 0, 0);
  expect_near(corner("{file: c.stl, rotate: {axis: [0, 0, 1], degrees: 180, about: [1, 1, 0]}}"), 10, 20, 0);
  const PneumaticSpec at = chamber("void_at: [1, 2, 3]");
  ASSERT_TRUE(at.void_at);
  expect_near(*at.void_at, 10, 20, 30);
  EXPECT_FALSE(at.surface || at.region || at.wall);
}

TEST(Scene, ARegionLiesInsideAClosedSurface) {
  const RobotSpec spec = parse_body(
      "regions:\n  - {name: a, inside: closed.stl}\n"
      "  - {name: b, inside: {file: closed.stl, unit: mm, move: [0, 0, 1]}}\n");
  ASSERT_EQ(spec.regions.size(), 2u);
  const auto contains = [&](int i, const Vec3& point) {
    return std::get<InsideSurface>(spec.regions[i].selector).surface->contains(point);
  };
  EXPECT_TRUE(contains(0, {0.2, 0.2, 0.2}));
  EXPECT_FALSE(contains(0, {0.4, 0.4, 0.4}));
  EXPECT_TRUE(contains(1, {0.2, 0.2, 1.2}));
  EXPECT_FALSE(contains(1, {0.2, 0.2, 0.2}));
}

TEST(Scene, CavitiesAndErrorsOfTheMesh) {
  const std::string rest = ", range: [1, 2]}]\n", head = "actuators: [{name: a, kind: pneumatic";
  const auto chamber = [&](const std::string& keys) { return parse_body(head + keys + rest).actuators[0]; };
  const ActuatorSpec inches = chamber(", surface: {file: c.stl, unit: in}");
  expect_near(inches.as<PneumaticSpec>()->surface->vertices.row(1).transpose(), 25.4, 0, 0);
  const ActuatorSpec wall = chamber(", surface: {region: cavity_wall}");
  EXPECT_EQ(wall.as<PneumaticSpec>()->wall, "cavity_wall");
  EXPECT_FALSE(wall.as<PneumaticSpec>()->surface || wall.as<PneumaticSpec>()->region);
  const ActuatorSpec none = chamber("");
  EXPECT_FALSE(none.as<PneumaticSpec>()->surface || none.as<PneumaticSpec>()->region || none.as<PneumaticSpec>()->wall);
  const RobotSpec strict = parse("softkin: 1\nmesh:\n  file: a.msh\n"),
                  lenient = parse("softkin: 1\nmesh: {file: a.msh, accept_errors: true}\n");
  EXPECT_FALSE(strict.mesh_options.accept_errors);
  EXPECT_EQ(strict.mesh_options.origin.line, 3u);
  EXPECT_TRUE(lenient.mesh_options.accept_errors);
}

TEST(Scene, WholeSceneCableAndMarkers) {
  const RobotSpec spec = parse(whole_scene);
  const ActuatorSpec& tendon = spec.actuators.at(1);
  EXPECT_TRUE(tendon.is<CableSpec>());
  EXPECT_EQ(tendon.weight, 7);
  EXPECT_DOUBLE_EQ(tendon.as<CableSpec>()->spacing, 4);
  EXPECT_EQ(tendon.origin.line, 28u);
  ASSERT_EQ(tendon.as<CableSpec>()->points.size(), 3u);
  expect_near(position(tendon.as<CableSpec>()->points[1]), 60, 12, 22);
  EXPECT_EQ(region(tendon.as<CableSpec>()->points[2]), "eyelet");
  EXPECT_EQ(tendon.as<CableSpec>()->points[2].origin.line, 30u);
  ASSERT_EQ(tendon.as<CableSpec>()->apexes.size(), 1u);
  expect_near(position(tendon.as<CableSpec>()->apexes[0]), 30, 12, 10);
  ASSERT_EQ(spec.markers.size(), 2u);
  EXPECT_EQ(spec.markers[0].name, "tip");
  expect_near(position(spec.markers[0].at), 120, 12.5, 0);
  EXPECT_EQ(spec.markers[0].at.origin.line, 39u);
  EXPECT_EQ(region(spec.markers[1].at), "tip");
}

TEST(Scene, PhysicalSceneMaterials) {
  const RobotSpec spec = parse(physical_scene);
  EXPECT_EQ(spec.formulation, Formulation::physical);
  EXPECT_TRUE(spec.mesh_options.quadratic);
  EXPECT_EQ(spec.loads.gravity, Vec3(0, 0.5, -9.81));
  ASSERT_EQ(spec.materials.size(), 5u);
  const MaterialSpec &both = spec.materials[0], &rib = spec.materials[1], &plate = spec.materials[4];
  ASSERT_TRUE(both.elastic && rib.elastic);
  EXPECT_EQ(both.elastic->law, Law::neo_hookean);
  EXPECT_EQ(both.elastic->youngs_modulus, 12);
  EXPECT_EQ(both.elastic->poisson_ratio, 0.4);
  EXPECT_FALSE(both.elastic->c10 || both.elastic->c01 || both.elastic->c20 || both.elastic->c30);
  EXPECT_FALSE(both.elastic->bulk_modulus);
  EXPECT_EQ(both.density, 1130);
  EXPECT_EQ(both.shape_ratio, 0.5);
  EXPECT_EQ(rib.elastic->law, Law::corotational);
  EXPECT_EQ(rib.elastic->poisson_ratio, -0.2);
  EXPECT_EQ(rib.density, 0);
  EXPECT_FALSE(rib.shape_ratio);
  EXPECT_FALSE(plate.elastic);
  EXPECT_EQ(plate.shape_ratio, 1);
}

TEST(Scene, PhysicalSceneRubberLaws) {
  const RobotSpec spec = parse(physical_scene);
  const ElasticSpec &skin = spec.materials.at(2).elastic.value(), &foam = spec.materials.at(3).elastic.value();
  EXPECT_EQ(skin.law, Law::mooney_rivlin);
  EXPECT_EQ(skin.c10, 0.3);
  EXPECT_EQ(skin.c01, -0.1);
  EXPECT_EQ(skin.bulk_modulus, 100);
  EXPECT_FALSE(skin.poisson_ratio || skin.youngs_modulus || skin.c20 || skin.c30);
  EXPECT_EQ(foam.law, Law::yeoh);
  EXPECT_EQ(foam.c10, 0.11);
  EXPECT_EQ(foam.c20, -0.02);
  EXPECT_EQ(foam.c30, 0);
  EXPECT_EQ(foam.poisson_ratio, 0.49);
  EXPECT_FALSE(foam.bulk_modulus || foam.youngs_modulus || foam.c01);
}

TEST(Scene, PhysicalSceneLoads) {
  const RobotSpec spec = parse(physical_scene);
  ASSERT_EQ(spec.actuators.size(), 3u);
  const ActuatorSpec &air = spec.actuators[0], &tendon = spec.actuators[1], &bag = spec.actuators[2];
  EXPECT_EQ(air.control, Control::load);
  EXPECT_EQ(air.low, -20);
  EXPECT_EQ(air.high, 80);
  EXPECT_EQ(air.rest, 0);
  EXPECT_EQ(air.weight, 3);
  EXPECT_EQ(air.distribution, Distribution::uniform);
  EXPECT_EQ(tendon.control, Control::load);
  EXPECT_EQ(tendon.low, 0);
  EXPECT_EQ(tendon.high, 25);
  EXPECT_EQ(tendon.rest, 0);
  EXPECT_EQ(tendon.as<CableSpec>()->apexes.size(), 1u);
  EXPECT_EQ(bag.control, Control::ratio);
  EXPECT_EQ(bag.rest, 1);
  ASSERT_EQ(spec.loads.forces.size(), 2u);
  EXPECT_EQ(spec.loads.forces[0].name, "load");
  EXPECT_EQ(region(spec.loads.forces[0].at), "tip");
  EXPECT_EQ(spec.loads.forces[0].at.origin.line, 21u);
  EXPECT_EQ(spec.loads.forces[0].force, Vec3(0, 0, -0.5));
  expect_near(position(spec.loads.forces[1].at), 120, 0, 10);
  EXPECT_EQ(spec.loads.forces[1].force, Vec3(1, 0, 0));
}

TEST(Scene, Tractions) {
  const RobotSpec spec = parse(
      "softkin: 1\nmesh: {file: a.msh}\ntractions:\n"
      "  - {name: wind, region: side, traction: [1, -2, 3]}\n"
      "  - {name: skin, region: side, traction: [0, 0, 4], follows: true}\n"
      "  - {name: water, box: [[0, 0, 0], [1, 2, 3]], pressure: 5}\n"
      "  - {name: palm, region: side, pressure: 2, range: [0, 9]}\n"
      "  - {name: hand, region: side, range: [-1, 9]}\n");
  ASSERT_EQ(spec.loads.tractions.size(), 5u);
  EXPECT_EQ(spec.loads.tractions[3].pressure_kPa, 2);
  EXPECT_EQ(spec.loads.tractions[3].range_kPa, (std::array<double, 2>{0, 9}));
  EXPECT_TRUE(spec.loads.tractions[4].follows);
  EXPECT_EQ(spec.loads.tractions[4].range_kPa, (std::array<double, 2>{-1, 9}));
  EXPECT_FALSE(spec.loads.tractions[2].range_kPa);
  const TractionSpec &wind = spec.loads.tractions[0], &skin = spec.loads.tractions[1], &water = spec.loads.tractions[2];
  EXPECT_EQ(wind.name, "wind");
  EXPECT_EQ(wind.kilopascals, Vec3(1, -2, 3));
  EXPECT_EQ(wind.where.origin.line, 4u);
  EXPECT_FALSE(wind.follows);
  EXPECT_TRUE(skin.follows);
  EXPECT_EQ(skin.pressure_kPa, 0);
  EXPECT_TRUE(std::holds_alternative<Box>(std::get<Selector>(water.where.region)));
  EXPECT_TRUE(water.follows);
  EXPECT_EQ(water.pressure_kPa, 5);
  EXPECT_EQ(water.kilopascals, Vec3(0, 0, 0));
}

TEST(Scene, Wrenches) {
  const RobotSpec spec = parse(
      "softkin: 1\nmesh: {file: a.msh}\nforces:\n"
      "  - {name: twist, region: tip, moment: [1, -2, 3]}\n"
      "  - {name: tool, region: tip, range: [[-1, 1], [0, 0], [0, 2]], moment_range: [[0, 0], [-5, 5], [0, 0]]}\n");
  ASSERT_EQ(spec.loads.forces.size(), 2u);
  EXPECT_EQ(spec.loads.forces[0].moment, Vec3(1, -2, 3));
  EXPECT_EQ(spec.loads.forces[0].force, Vec3(0, 0, 0));
  EXPECT_FALSE(spec.loads.forces[0].moment_range);
  ASSERT_TRUE(spec.loads.forces[1].moment_range && spec.loads.forces[1].range);
  EXPECT_EQ((*spec.loads.forces[1].moment_range)[0], Vec3(0, -5, 0));
  EXPECT_EQ((*spec.loads.forces[1].moment_range)[1], Vec3(0, 5, 0));
  EXPECT_EQ((*spec.loads.forces[1].range)[1], Vec3(1, 0, 2));
}

TEST(Scene, Fibres) {
  SceneFiles files = fake_files();
  files.route = [](const std::filesystem::path& path) {
    EXPECT_EQ(path.filename(), "way.csv");
    return Points(Points::Constant(2, 3, 7));
  };
  const RobotSpec spec = parse_scene(
      "softkin: 1\nunits: {length: cm}\nmesh: {file: a.msh}\nfibres:\n"
      "  - {name: belly, points: [[0, 0, 0], [1, 2, 3]], stiffness: 40, tension_only: true, region: skin}\n"
      "  - {name: coil, helix: {start: [0, 0, 1], axis: [0, 0, 2], radius: 0.8, pitch: 0.2, turns: 3.5, handed: left,\n"
      "      degrees: 90}, inextensible: true}\n"
      "  - {name: drawn, file: way.csv, stiffness: 5}\n",
      "s.yaml", files);
  ASSERT_EQ(spec.fibres.size(), 3u);
  const FibreSpec &belly = spec.fibres[0], &coil = spec.fibres[1], &drawn = spec.fibres[2];
  EXPECT_EQ(belly.name, "belly");
  EXPECT_EQ(belly.origin.line, 5u);
  EXPECT_EQ(belly.stiffness_N, 40);
  EXPECT_TRUE(belly.tension_only);
  EXPECT_EQ(belly.region, "skin");
  EXPECT_LT((std::get<std::vector<Vec3>>(belly.path)[1] - Vec3(10, 20, 30)).norm(), 1e-9);
  const auto& helix = std::get<Helix>(coil.path);
  EXPECT_FALSE(coil.stiffness_N);
  EXPECT_FALSE(coil.tension_only);
  EXPECT_LT((helix.start - Vec3(0, 0, 10)).norm(), 1e-9);
  EXPECT_LT((helix.first - Vec3(0, 1, 0)).norm(), 1e-9);
  EXPECT_NEAR(helix.radius, 8, 1e-9);
  EXPECT_NEAR(helix.pitch, 2, 1e-9);
  EXPECT_EQ(helix.turns, 3.5);
  EXPECT_TRUE(helix.left_handed);
  EXPECT_EQ(std::get<std::vector<Vec3>>(drawn.path).size(), 2u);
  EXPECT_EQ(std::get<std::vector<Vec3>>(drawn.path)[0], Vec3(7, 7, 7));
}

TEST(Scene, EveryLawByItsName) {
  const std::pair<const char*, Law> laws[] = {
      {"law: st-venant-kirchhoff, youngs_modulus: 1, poisson_ratio: 0.3", Law::st_venant_kirchhoff},
      {"law: corotational, youngs_modulus: 1, poisson_ratio: 0.3", Law::corotational},
      {"law: neo-hookean, youngs_modulus: 1, poisson_ratio: 0.3", Law::neo_hookean},
      {"youngs_modulus: 1, poisson_ratio: 0", Law::neo_hookean},
      {"law: mooney-rivlin, c10: 1, bulk_modulus: 9", Law::mooney_rivlin},
      {"law: yeoh, c10: 1, c30: 2, bulk_modulus: 9", Law::yeoh},
      {"law: gent, shear_modulus: 1, jm: 30, poisson_ratio: 0.4", Law::gent},
      {"law: ogden, mu1: 1, alpha1: 2, mu2: -0.1, alpha2: -3, poisson_ratio: 0.4", Law::ogden}};
  for (const auto& [keys, law] : laws) {
    const RobotSpec spec = parse_body("materials: [{" + std::string(keys) + "}]\n");
    EXPECT_EQ(spec.materials.at(0).elastic.value().law, law) << keys;
    EXPECT_EQ(spec.formulation, Formulation::physical) << keys;
  }
  EXPECT_EQ(parse_body("materials: [{law: mooney-rivlin, c10: 1, poisson_ratio: 0.4}]").materials.at(0).elastic->c01,
            0);
}

TEST(Scene, FormulationFollowsTheMaterialsUnlessItIsGiven) {
  const std::string soft = "materials: [{shape_ratio: 0.5}]\n";
  const std::string elastic = "materials: [{shape_ratio: 0.5}, {region: a, youngs_modulus: 1, poisson_ratio: 0.3}]\n";
  const auto formulation = [](const std::string& body) { return parse_body(body).formulation; };
  EXPECT_EQ(formulation(""), Formulation::target_shape);
  EXPECT_EQ(formulation(soft), Formulation::target_shape);
  EXPECT_EQ(formulation(elastic), Formulation::physical);
  EXPECT_EQ(formulation("formulation: target-shape\n" + elastic), Formulation::target_shape);
  EXPECT_EQ(formulation("formulation: physical\n" + soft), Formulation::physical);
}

TEST(Scene, Weights) {
  EXPECT_EQ(parse_body("").weights, ElementWeights::printed);
  EXPECT_EQ(parse_body("weights: printed\n").weights, ElementWeights::printed);
  EXPECT_EQ(parse_body("weights: mesh-independent\n").weights, ElementWeights::mesh_independent);
}

TEST(Scene, KeysOfThePhysicalFormulationAreAllowedInTheOther) {
  const RobotSpec spec = parse(
      "softkin: 1\nformulation: target-shape\nmesh: {file: quadratic.msh, order: 2}\ngravity: [0, 0, 1]\n"
      "materials: [{shape_ratio: 1, youngs_modulus: 1, poisson_ratio: 0.3, density: 0}]\n"
      "forces: [{name: f, region: tip, force: [1, 0, 0]}]\n");
  EXPECT_TRUE(spec.mesh_options.quadratic);
  EXPECT_EQ(spec.mesh.edge_nodes.size(), 2u);
  EXPECT_EQ(spec.loads.forces.size(), 1u);
}

TEST(Scene, CurvedEdges) {
  const auto curve = [](const std::string& text) {
    return parse("softkin: 1\nunits: {length: cm}\nmesh: {file: a.msh, order: 2, curve: " + text + "}\n")
        .mesh_options.curve;
  };
  EXPECT_FALSE(curve("false"));
  ASSERT_TRUE(curve("true"));
  EXPECT_TRUE(curve("true")->smooth);
  EXPECT_EQ(curve("true")->crease_degrees, 50);
  EXPECT_EQ(curve("{crease: 65}")->crease_degrees, 65);
  const auto several =
      curve("[{sphere: {center: [1, 2, 3], radius: 4}}, {cylinder: {start: [0, 0, 0], end: [1, 0, 0], radius: 2}}]");
  EXPECT_FALSE(several->smooth);
  ASSERT_EQ(several->surfaces.size(), 2u);
  EXPECT_EQ(std::get<Sphere>(several->surfaces[0].shape).center, Vec3(10, 20, 30));
  EXPECT_EQ(std::get<Cylinder>(several->surfaces[1].shape).radius, 20);
  EXPECT_EQ(several->surfaces[1].origin.line, 3u);
  EXPECT_TRUE(curve("[{sphere: {center: [1, 2, 3], radius: 4}}, true]")->smooth);
}

TEST(Scene, EveryUnitOfLength) {
  const std::pair<const char*, double> units[] = {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"in", 25.4}};
  for (const auto& [unit, mm] : units) {
    const RobotSpec spec =
        parse_body("units: {length: " + std::string(unit) + "}\nmarkers: [{name: p, point: [1, 0, -2]}]");
    expect_near(position(spec.markers.at(0).at), mm, 0, -2 * mm);
    EXPECT_DOUBLE_EQ(spec.mesh.vertices(1, 0), 0.12 * mm);
  }
  EXPECT_EQ(position(parse_body("markers: [{name: p, point: [1, .5, 1e2]}]").markers.at(0).at), Vec3(1, 0.5, 100));
}

TEST(Scene, Feet) {
  const RobotSpec spec = parse_body(
      "feet:\n  - {marker: heel, forward: 0.01, backward: 0.05}\n  - {marker: toe, forward: 0, backward: 1e-3}\n");
  ASSERT_EQ(spec.feet.size(), 2u);
  EXPECT_EQ(spec.feet[0].marker, "heel");
  EXPECT_EQ(spec.feet[0].forward, 0.01);
  EXPECT_EQ(spec.feet[0].backward, 0.05);
  EXPECT_EQ(spec.feet[1].marker, "toe");
  EXPECT_EQ(spec.feet[1].forward, 0);
  EXPECT_EQ(spec.feet[1].backward, 1e-3);
}

TEST(Scene, LeastSceneHasDefaults) {
  const RobotSpec spec = parse("\xEF\xBB\xBF# a comment\r\nsoftkin: 1\r\nmesh: {file: a.msh}\r\n");
  EXPECT_EQ(spec.mesh.tetrahedra.size(), 2u);
  EXPECT_FALSE(spec.mesh_options.quadratic);
  EXPECT_EQ(spec.loads.gravity, Vec3(0, 0, 0));
  EXPECT_TRUE(spec.loads.forces.empty());
  EXPECT_TRUE(spec.materials.empty() && spec.actuators.empty() && spec.fixed.empty() && spec.markers.empty());
}

TEST(Scene, FilesAreBesideTheScene) {
  std::string requested;
  SceneFiles files = fake_files();
  files.mesh = [&](const std::filesystem::path& path) {
    requested = path.string();
    return Mesh{};
  };
  (void)parse_scene("{softkin: 1, mesh: {file: sub/a.msh}}", "robots/finger.yaml", files);
  EXPECT_EQ(requested, "robots/sub/a.msh");
  (void)parse_scene("{softkin: 1, mesh: {file: /data/a.msh}}", "robots/finger.yaml", files);
  EXPECT_EQ(requested, "/data/a.msh");
}

TEST(Scene, SeveralMeshesAreOneWhereTheirTransformsPutThem) {
  const RobotSpec spec = parse(
      "softkin: 1\nunits: {length: m}\nmeshes:\n"
      "  - {file: parts.msh}\n"
      "  - {file: parts.msh, name: b, scale: 2, move: [0, 0.1, 0], rotate: {axis: [0, 0, 3], degrees: 90}}\n"
      "  - {file: parts.msh, rotate: {axis: [1, 0, 0], degrees: -90, about: [0, 0.01, 0]}}\n");
  const Mesh& mesh = spec.mesh;
  ASSERT_EQ(mesh.vertices.rows(), 15);
  EXPECT_LT((mesh.vertices.row(1) - Eigen::RowVector3d(120, 0, 0)).norm(), 1e-12);
  EXPECT_LT((mesh.vertices.row(5) - Eigen::RowVector3d(-100, 0, 0)).norm(), 1e-12);
  EXPECT_LT((mesh.vertices.row(6) - Eigen::RowVector3d(-100, 240, 0)).norm(), 1e-12);  // (240, 100, 0) turned
  EXPECT_LT((mesh.vertices.row(8) - Eigen::RowVector3d(-100, 0, 50)).norm(), 1e-12);
  EXPECT_LT((mesh.vertices.row(12) - Eigen::RowVector3d(0, 10, -15)).norm(), 1e-12);  // 15 mm beyond the axis
  ASSERT_EQ(mesh.tetrahedra.size(), 6u);
  EXPECT_EQ(mesh.tetrahedra[2], (Tetrahedron{5, 6, 7, 8}));
  EXPECT_EQ(mesh.triangles[2], (Triangle{10, 11, 12}));
  std::vector<std::string> names;
  for (const Region& region : mesh.regions) names.push_back(region.name);
  EXPECT_EQ(names, (std::vector<std::string>{"body", "base", "tip", "b.body", "b.base", "b.tip"}));
  EXPECT_EQ(mesh.regions[0].tetrahedra, (std::vector<Index>{0, 1, 4, 5}));
  EXPECT_EQ(mesh.regions[1].triangles, (std::vector<Index>{0, 2}));
  EXPECT_EQ(mesh.regions[5].vertices, (std::vector<Index>{9}));
  // the axis keeps its place, and lengths stay as they are
  EXPECT_LT((mesh.vertices.row(13) - Eigen::RowVector3d(0, 35, 10)).norm(), 1e-12);
}

TEST(Scene, AliasesShareAValue) {
  const RobotSpec spec = parse_body(
      "fixed: [{box: &feet [[0, 0, 0], [1, 1, 1]]}]\n"
      "regions: [{name: a, box: *feet}, {name: b, box: *feet}]\n");
  EXPECT_EQ(std::get<Box>(spec.regions.at(1).selector).high, Vec3(1, 1, 1));
}

/// A point in the scene's unit, an angle in degrees whatever that is.
TEST(Scene, SupportsMayTurn) {
  const RobotSpec spec = parse_body(
      "units: {length: cm}\nfixed:\n  - {region: base, displacement: [1, 0, 0],\n"
      "     rotation: {axis: [0, 2, 0], degrees: -45, about: [1, 2, 3]}}\n  - {region: tip, rotation: {axis: [1, 0, "
      "0]}}");
  const RotationSpec& base = spec.fixed.at(0).rotation.value();
  EXPECT_EQ(base.axis, Vec3(0, 2, 0));
  EXPECT_EQ(base.degrees, -45);
  expect_near(base.about.value(), 10, 20, 30);
  expect_near(spec.fixed[0].displacement, 10, 0, 0);
  const RotationSpec& tip = spec.fixed.at(1).rotation.value();
  EXPECT_EQ(tip.degrees, 0);
  EXPECT_FALSE(tip.about);
}

TEST(Scene, DistributionsHaveTheirNames) {
  const RobotSpec spec = parse_body(
      "actuators:\n  - {name: a, kind: dea, region: r, range: [1, 2], distribution: proportional}\n"
      "  - {name: b, kind: dea, region: r, range: [1, 2], distribution: least-norm}\n");
  EXPECT_EQ(spec.actuators.at(0).distribution, Distribution::proportional);
  EXPECT_EQ(spec.actuators.at(1).distribution, Distribution::minimum_norm);
}

TEST(Scene, NamesMayBeQuotedOrLookLikeNumbers) {
  const RobotSpec spec = parse_body("void: [\"air chamber\", 12, 'y']\nfixed: [{region: '# 3', axes: y}]");
  EXPECT_EQ(std::get<std::string>(spec.voids.at(0).region), "air chamber");
  EXPECT_EQ(std::get<std::string>(spec.voids.at(1).region), "12");
  EXPECT_EQ(std::get<std::string>(spec.voids.at(2).region), "y");
  EXPECT_EQ(std::get<std::string>(spec.fixed.at(0).where.region), "# 3");
  EXPECT_EQ(spec.fixed.at(0).axes, (std::array<bool, 3>{false, true, false}));
}

TEST(Scene, SidecarOfEqualCountsNeedsOf) {
  const std::string head = "softkin: 1\nmesh: {file: square.msh}\n";
  const RobotSpec spec = parse(head +
                               "regions:\n  - {name: a, sidecar: {file: vertices.txt, column: 3, of: elements}}\n"
                               "  - {name: b, sidecar: {file: vertices.txt, column: 3, of: vertices}}\n");
  EXPECT_EQ(std::get<ElementList>(spec.regions.at(0).selector).tetrahedra, std::vector<Index>{2});
  EXPECT_EQ(std::get<VertexList>(spec.regions.at(1).selector).vertices, std::vector<Index>{2});
}

/// The scenes that a document shows, by words that one of them alone has.
struct ManualScenes {
  const std::vector<std::string>& texts;
  const std::vector<RobotSpec>& parsed;

  [[nodiscard]] const RobotSpec& at(const std::string& words) const {
    const auto has_words = [&](const std::string& text) { return text.find(words) != std::string::npos; };
    EXPECT_EQ(std::count_if(texts.begin(), texts.end(), has_words), 1) << "examples with '" << words << "'";
    return parsed.at(static_cast<std::size_t>(std::find_if(texts.begin(), texts.end(), has_words) - texts.begin()));
  }
};

TEST(Scene, ExamplesOfTheManualAreScenes) {
  const std::string manual = read_file(SOFTKIN_SOURCE_DIR "/docs/scene.md"), fence = "```yaml\n";
  SceneFiles files = fake_files();
  files.scene = [](const std::filesystem::path& path) -> std::string {
    EXPECT_EQ(path.string(), "robots/finger.yaml");
    return "softkin: 1\nmesh: {file: parts.msh}\nmaterials: [{youngs_modulus: 12, poisson_ratio: 0.4}]\n";
  };
  std::vector<std::string> texts;
  std::vector<RobotSpec> parsed;
  for (std::size_t begin = manual.find(fence); begin != std::string::npos; begin = manual.find(fence, begin)) {
    begin += fence.size();
    texts.push_back(manual.substr(begin, manual.find("```", begin) - begin));
    parsed.push_back(parse_scene(texts.back(), "robots/scene.yaml", files));
  }
  EXPECT_GE(parsed.size(), 16u);
  const ManualScenes specs{texts, parsed};
  EXPECT_EQ(specs.at("kind: dea").actuators.size(), 3u);
  EXPECT_EQ(specs.at("kind: dea").markers.size(), 2u);
  EXPECT_EQ(specs.at("kind: dea").formulation, Formulation::target_shape);
  EXPECT_EQ(specs.at("law: mooney-rivlin").formulation, Formulation::physical);
  EXPECT_EQ(specs.at("law: mooney-rivlin").actuators.at(0).control, Control::load);
  EXPECT_EQ(specs.at("law: mooney-rivlin").loads.forces.size(), 1u);
  ASSERT_EQ(specs.at("name: right, scene: finger.yaml").robots.size(), 2u);
  EXPECT_EQ(specs.at("name: right, scene: finger.yaml").robots[1].name, "right");
  EXPECT_EQ(specs.at("{youngs_modulus: 1.2, poisson_ratio: 0.5}").materials.at(0).elastic.value().poisson_ratio, 0.5);
  EXPECT_FALSE(specs.at("{youngs_modulus: 1.2, poisson_ratio: 0.5}").materials[0].mixed) << "left to the material";
  EXPECT_EQ(specs.at("families:").materials.at(0).families->families.at(1).direction.degrees, -35);
  EXPECT_EQ(specs.at("rotation: {axis: [1, 0, 0], degrees: 90}").fixed.at(1).rotation.value().degrees, 90);
  EXPECT_EQ(specs.at("control: gas").actuators.at(0).as<PneumaticSpec>()->filling.value().syringe_mL, 20);
  EXPECT_EQ(specs.at("sheath: {turns_degrees: 270").actuators.at(0).as<CableSpec>()->friction, 0.15);
  EXPECT_EQ(specs.at("sheath: {turns_degrees: 270").actuators[0].as<CableSpec>()->sheath_friction, 0.05);
  EXPECT_EQ(specs.at("sheath: {turns_degrees: 270").actuators[0].as<CableSpec>()->sheath_turns_degrees, 270);
  EXPECT_TRUE(specs.at("kind: growth").actuators.at(0).is<GrowthSpec>());
  EXPECT_TRUE(specs.at("moment_range:").loads.forces.at(0).moment_range);
  EXPECT_TRUE(specs.at("moment_range:").loads.tractions.at(0).range_kPa);
  EXPECT_EQ(specs.at("name: winding").fibres.size(), 2u);
  ASSERT_EQ(specs.at("name: paper").layers.size(), 2u);
  EXPECT_TRUE(specs.at("name: paper").layers[0]->bending);
  EXPECT_TRUE(specs.at("name: film").materials.empty()) << "of film alone";
  EXPECT_EQ(specs.at("name: film").actuators.at(0).as<PneumaticSpec>()->wall, "pouch");
  EXPECT_EQ(specs.at("kind: direction").sensors.size(), 3u);
  EXPECT_EQ(specs.at("motion: [x, z]").contact.value().obstacles.size(), 2u);
}

TEST(Scene, Layers) {
  const RobotSpec spec = parse(
      "softkin: 1\nunits: {length: cm}\nmesh: {file: a.msh}\nlayers:\n"
      "  - {name: paper, region: belly, thickness: 0.01, youngs_modulus: 2000, poisson_ratio: 0.25, bending: true}\n"
      "  - {name: cloth, region: back, thickness: 0.05, tension_only: true, direction: [0, 2, 0], density: 900,\n"
      "     orthotropic: {e1: 30, e2: 2, g12: 0.6, nu12: 0.3}}\n"
      "  - {name: latex, region: back, thickness: 0.05, law: neo-hookean, youngs_modulus: 1.2}\n"
      "  - {name: silicone, region: back, thickness: 0.05, law: yeoh, c10: 0.1, c30: 0.002, tension_only: true}\n");
  ASSERT_EQ(spec.layers.size(), 4u);
  EXPECT_NEAR(spec.layers[2]->rubber.value().c10, 0.2, 1e-15);  // E / 6
  EXPECT_EQ(spec.layers[3]->rubber.value().c30, 0.002);
  EXPECT_TRUE(spec.layers[3]->tension_only);
  const LayerSpec &paper = *spec.layers[0], &cloth = *spec.layers[1];
  EXPECT_EQ(paper.name, "paper");
  EXPECT_EQ(paper.origin.line, 5u);
  EXPECT_EQ(std::get<std::string>(std::get<RegionRef>(paper.where).region), "belly");
  EXPECT_NEAR(paper.thickness_mm, 0.1, 1e-12);
  EXPECT_EQ(paper.e1, 2000);
  EXPECT_EQ(paper.e2, 2000);
  EXPECT_EQ(paper.g12, 800);
  EXPECT_EQ(paper.nu12, 0.25);
  EXPECT_TRUE(paper.bending);
  EXPECT_FALSE(paper.tension_only);
  EXPECT_FALSE(paper.direction);
  EXPECT_EQ(cloth.e1, 30);
  EXPECT_EQ(cloth.e2, 2);
  EXPECT_EQ(cloth.g12, 0.6);
  EXPECT_EQ(cloth.nu12, 0.3);
  EXPECT_EQ(cloth.direction.value(), Vec3(0, 2, 0));
  EXPECT_EQ(cloth.density, 900);
  EXPECT_TRUE(cloth.tension_only);
  EXPECT_FALSE(cloth.bending);
}

/// 0: parsed, 1: refused. Anything else escapes and fails the test.
int outcome(const std::string& text) {
  try {
    (void)parse(text);
    return 0;
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).rfind("robots/finger.yaml", 0), 0u) << error.what();
    return 1;
  }
}

TEST(SceneFuzz, FlippedBytesAreReadOrRefused) {
  std::mt19937 random(20);
  int counts[2] = {0, 0};
  for (int i = 0; i < 3000; ++i) {
    std::string text = i % 2 == 0 ? whole_scene : physical_scene;
    const int flips = 1 + static_cast<int>(random() % 3);
    for (int k = 0; k < flips; ++k) text[random() % text.size()] ^= static_cast<char>(1u << (random() % 8));
    ++counts[outcome(text)];
  }
  EXPECT_GT(counts[0], 50);
  EXPECT_GT(counts[1], 500);
}

TEST(SceneFuzz, CutsInsertionsAndBracketsAreReadOrRefused) {
  std::mt19937 random(21);
  const std::string marks = "[]{},:-?&*!|>'\"%@`#\n\t ~.\\";
  int counts[2] = {0, 0};
  for (int i = 0; i < 3000; ++i) {
    const std::string good = i % 2 == 0 ? whole_scene : physical_scene;
    std::string text = good.substr(0, i % 4 == 0 ? random() % good.size() : good.size());
    for (int k = 0; k < 3; ++k) text.insert(random() % (text.size() + 1), 1, marks[random() % marks.size()]);
    ++counts[outcome(text)];
  }
  EXPECT_GT(counts[1], 1000);
}

TEST(SceneFuzz, DeepAndManyfoldScenesEnd) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(outcome(std::string(100000, '[')), 1);
  EXPECT_EQ(outcome(std::string(100000, '{')), 1);
  std::string laughs = "a0: &a0 [x]\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = " *a" + std::to_string(i - 1);
    laughs +=
        "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before + "," + before + "," + before + "]\n";
  }
  EXPECT_EQ(outcome("softkin: 1\nmesh: {file: a.msh}\n" + laughs), 1);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), testing::patient(60));
}

}  // namespace
}  // namespace softkin
