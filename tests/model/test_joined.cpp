#include <Eigen/Geometry>
#include <map>
#include <softkin/model/compile/regions.hpp>
#include <softkin/model/joined.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

namespace softkin {

namespace {

using namespace testing;

/// 20 x 10 x 10 mm with a chamber, and a part of every kind. Its frame is turned when it is placed.
RobotSpec whole_block() {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.name = "block.yaml";
  spec.mesh_options.origin = {"block.yaml", 2};
  add_vertex_region(spec.mesh, "corner", {0});
  spec.regions = {{"ball", Sphere{{30, 30, 30}, 11}, line(4)},
                  {"list", VertexList{{5, 6}}, line(5)},
                  {"first", ElementList{{0, 1}}, line(6)}};
  spec.materials.push_back(spec.materials[0]);
  spec.materials[1].region = "ball";
  spec.fixed.push_back({shaped(Box{{-1, -1, -1}, {0, 1, 31}}, 7), {true, true, true}, Vec3(0, 0, 1)});
  spec.fixed[0].displacement = Vec3(0, 0, 1);
  spec.rigid.push_back({shaped(Halfspace{{29, 0, 0}, {1, 0, 0}}, 8), "rigid_1"});
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 1, 2);
  ActuatorSpec tendon = actuator("tendon", CableSpec{}, 0.5, 1);
  tendon.as<CableSpec>()->points = {at(0, 15, 29), mean("corner"), at(25, 15, 29)};
  spec.actuators = {air, tendon};
  spec.loads.forces.push_back({"push", at(30, 0, 0), Vec3(0, 0, 1)});
  spec.markers = {{"tip", mean("x_high")}, {"spot", at(20, 10, 5)}, {"middle", mean("all")}};
  return spec;
}

Placement upside(const Vec3& to) {
  Placement place;
  place.rotation = Vec3(1, -1, -1).asDiagonal();
  place.translation = to;
  return place;
}

PlacedRobot placed(const std::string& name, RobotSpec spec, const Placement& place, std::size_t number) {
  return {name, std::move(spec), place, {"pair.yaml", number}};
}

RobotSpec pair(const RobotSpec& left, const RobotSpec& right, const CommonSpec& common = {"pair.yaml", {}, {}, {}}) {
  return joined({placed("left", left, {}, 3), placed("right", right, upside({0, 100, 0}), 4)}, common);
}

std::string refusal_of_pair(const RobotSpec& left, const RobotSpec& right,
                            const CommonSpec& common = {"pair.yaml", {}, {}, {}}) {
  try {
    (void)pair(left, right, common);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

template <class Parts>
std::vector<std::string> names_of(const Parts& parts) {
  std::vector<std::string> names;
  for (const auto& part : parts) names.push_back(part.name);
  return names;
}

}  // namespace

TEST(Joined, NamesBeginWithTheRobots) {
  const RobotSpec spec = pair(whole_block(), whole_block());
  const Model model = compile(spec);
  EXPECT_EQ(model.name, "pair.yaml");
  EXPECT_EQ(names_of(spec.regions), (std::vector<std::string>{"left.ball", "left.list", "left.first", "left",
                                                              "right.ball", "right.list", "right.first", "right"}));
  EXPECT_EQ(spec.mesh.regions[0].name, "left.body");
  EXPECT_EQ(names_of(model.actuators),
            (std::vector<std::string>{"left.air", "left.tendon", "right.air", "right.tendon"}));
  EXPECT_EQ(names_of(model.markers), (std::vector<std::string>{"left.tip", "left.spot", "left.middle", "right.tip",
                                                               "right.spot", "right.middle"}));
  EXPECT_EQ(names_of(spec.loads.forces), (std::vector<std::string>{"left.push", "right.push"}));
  EXPECT_EQ(names_of(model.rigid), (std::vector<std::string>{"left.rigid_1", "right.rigid_1"}));
  EXPECT_EQ(names_of(model.held.supports),
            (std::vector<std::string>{"left.x_low", "left.fixed_2", "right.x_low", "right.fixed_2"}));
  std::vector<std::string> materials;
  for (const Material& material : model.elements.materials) materials.push_back(material.region);
  EXPECT_EQ(materials, (std::vector<std::string>{"left", "left.ball", "right", "right.ball"}));
}

/// Every region, the shapes too, holds of each robot what it holds of the one alone.
TEST(Joined, RegionsAreThoseOfTheRobotAlone) {
  for (const bool quadratic : {false, true}) {
    RobotSpec alone = whole_block();
    alone.mesh_options.quadratic = quadratic;
    const RobotSpec spec = pair(alone, alone);
    const Mesh mesh = quadratic ? elevated(alone.mesh) : alone.mesh;
    const RegionTable one(alone, mesh), both(spec);
    const Index vertices = mesh.vertices.rows();
    const Index elements = mesh.tetrahedra.size();
    ASSERT_EQ(spec.mesh.vertices.rows(), 2 * vertices);
    const auto expect_same = [&](const Region& expected, const Region& found, Index robot) {
      SCOPED_TRACE(found.name);
      EXPECT_EQ(found.dimension, expected.dimension);
      ASSERT_EQ(found.vertices.size(), expected.vertices.size());
      for (std::size_t i = 0; i < found.vertices.size(); ++i)
        EXPECT_EQ(found.vertices[i], expected.vertices[i] + robot * vertices);
      ASSERT_EQ(found.tetrahedra.size(), expected.tetrahedra.size());
      for (std::size_t i = 0; i < found.tetrahedra.size(); ++i)
        EXPECT_EQ(found.tetrahedra[i], expected.tetrahedra[i] + robot * elements);
    };
    for (const Index robot : {0, 1}) {
      const std::string name = robot == 0 ? "left" : "right";
      expect_same(one.find("all", {}), both.find(name, {}), robot);
      for (const char* region : {"body", "x_low", "z_high", "chamber", "corner", "ball", "list", "first"})
        expect_same(one.find(region, {}), both.find(name + "." + region, {}), robot);
      const std::size_t f = 2 * robot + 1;
      expect_same(one.resolve(alone.fixed[1].where), both.resolve(spec.fixed[f].where), robot);
      EXPECT_EQ(label(spec.fixed[f].where), "the box of robot '" + name + "'");
      EXPECT_EQ(spec.fixed[f].where.origin.line, 7u);
    }
  }
}

TEST(Joined, TurnedSupportsHaveTheirAxesInTheCommonFrame) {
  RobotSpec turning = whole_block();
  turning.fixed.pop_back();
  turning.fixed[0].rotation = RotationSpec{{0, 0, 1}, 20, Vec3(1, 2, 3)};
  const RobotSpec spec = pair(turning, turning);
  EXPECT_EQ(spec.fixed[0].rotation->axis, Vec3(0, 0, 1));
  EXPECT_EQ(*spec.fixed[0].rotation->about, Vec3(1, 2, 3));
  EXPECT_EQ(spec.fixed[1].rotation->axis, Vec3(0, 0, -1));
  EXPECT_EQ(*spec.fixed[1].rotation->about, Vec3(1, 98, -3));
  EXPECT_EQ(spec.fixed[1].rotation->degrees, 20);
  const Model model = compile(spec);
  EXPECT_EQ(model.actuators.back().name, "right.x_low_turn");
  EXPECT_EQ(model.held.turns[1].axis, Vec3(0, 0, -1));
}

TEST(Joined, PointsVectorsAndSurfacesAreTurned) {
  RobotSpec right = whole_block();
  right.actuators[0].as<PneumaticSpec>()->region.reset();
  right.actuators[0].as<PneumaticSpec>()->surface = box_surface({10, 10, 10}, {10, 10, 10});
  right.voids.push_back(named("chamber"));
  const RobotSpec spec = pair(whole_block(), right);
  EXPECT_EQ(std::get<Vec3>(spec.markers[1].at.point), Vec3(20, 10, 5));
  EXPECT_EQ(std::get<Vec3>(spec.markers[4].at.point), Vec3(20, 90, -5));
  EXPECT_EQ(spec.loads.forces[0].force, Vec3(0, 0, 1));
  EXPECT_EQ(spec.loads.forces[1].force, Vec3(0, 0, -1));
  EXPECT_EQ(std::get<Vec3>(spec.loads.forces[1].at.point), Vec3(30, 100, 0));
  EXPECT_EQ(spec.fixed[2].displacement, Vec3(0, 0, -1));
  EXPECT_EQ(std::get<Vec3>(spec.actuators[3].as<CableSpec>()->points[2].point), Vec3(25, 85, -29));
  EXPECT_EQ(std::get<std::string>(spec.actuators[3].as<CableSpec>()->points[1].point), "right.corner");
  const Points& surface = spec.actuators[2].as<PneumaticSpec>()->surface->vertices;
  EXPECT_EQ(Vec3(surface.colwise().minCoeff()), Vec3(10, 80, -20));
  EXPECT_EQ(Vec3(surface.colwise().maxCoeff()), Vec3(20, 90, -10));
  EXPECT_NEAR(compile(spec).actuators[2].rest_measure, 1000, 1e-9);
}

/// A robot's points beyond its surface, where another robot's elements are.
TEST(Joined, PointsLieInTheirOwnBody) {
  RobotSpec block = physical_robot(block_mesh({3, 3, 3}, {30, 30, 30}));
  block.markers = {{"after", at(30.4, 14, 16)}, {"before", at(-0.4, 14, 16)}};
  block.loads.forces.push_back({"push", at(30.4, 14, 16), Vec3(0, 0, 1)});
  block.actuators = {actuator("tendon", CableSpec{}, 0.5, 1)};
  block.actuators[0].as<CableSpec>()->points = {at(-0.4, 14, 16), at(12, 14, 16), at(30.4, 14, 16)};
  Placement beside;
  beside.translation = Vec3(30, 0, 0);
  const Model one = compile(block);
  const Model both =
      compile(joined({placed("left", block, {}, 3), placed("right", block, beside, 4)}, {"pair.yaml", {}, {}, {}}));
  const Index vertices = one.rest.rows();
  const auto expect_own = [&](const EmbeddedPoint& point, const EmbeddedPoint& alone, Index robot) {
    std::map<Index, double> weights;
    for (std::size_t i = 0; i < point.vertices.size(); ++i) weights[point.vertices[i]] += point.weights[i];
    for (std::size_t i = 0; i < alone.vertices.size(); ++i)
      weights[alone.vertices[i] + robot * vertices] -= alone.weights[i];
    for (const auto& [vertex, weight] : weights) EXPECT_NEAR(weight, 0, 1e-9) << vertex << " of robot " << robot;
  };
  const auto points = [](const Model& model, Index actuator) {
    return model.actuators[actuator].as<CableDrive>()->points;
  };
  for (const Index robot : {0, 1}) {
    for (std::size_t m = 0; m < 2; ++m)
      expect_own(both.markers[static_cast<std::size_t>(2 * robot) + m].point, one.markers[m].point, robot);
    for (std::size_t p = 0; p < 3; ++p) expect_own(points(both, robot)[p], points(one, 0)[p], robot);
    EXPECT_LT((both.loads.dead.middleRows(robot * vertices, vertices) - one.loads.dead).norm(), 1e-9);
  }
}

TEST(Joined, WhatIsSaidOfTheWholeComesLast) {
  RobotSpec spec = pair(whole_block(), whole_block()), common;
  common.regions = {{"upper", Halfspace{{0, 0, 0}, {0, 0, 1}}, line(20)}};
  common.fixed = {{shaped(VertexList{{0}}, 21), {true, true, true}, Vec3(0, 0, 1)}, {named("left.x_low", 22)}};
  common.fixed[1].displacement = Vec3(0, 0, 1);
  common.markers = {{"between", mean("all")}};
  add_common(spec, common);
  const Model model = compile(spec);
  EXPECT_EQ(names_of(model.held.supports), (std::vector<std::string>{"left.x_low", "left.fixed_2", "right.x_low",
                                                                     "right.fixed_2", "fixed_1", "fixed_2"}));
  EXPECT_EQ(model.markers.back().name, "between");
  EXPECT_LT((model.markers.back().point.at(model.rest) - Vec3(15, 50, 0)).norm(), 1e-9);
  EXPECT_EQ(RegionTable(spec).find("upper", {}).tetrahedra.size(), whole_block().mesh.tetrahedra.size());
  spec.loads.forces.push_back({"left.push", mean("right"), Vec3(1, 0, 0)});
  EXPECT_EQ(refusal(spec), "robot.yaml:6: there are two forces 'left.push'");
}

TEST(Joined, AxesOfSupportsAreTurned) {
  const auto turned = [](const std::array<bool, 3>& axes, double angle, const Vec3& axis) {
    RobotSpec spec = whole_block();
    spec.fixed = {{named("x_low", 9), axes}};
    return pair(spec, spec).fixed.size() == 2
               ? joined({placed("r", spec,
                                {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), Vec3::Zero()}, 3)},
                        {"pair.yaml", {}, {}, {}})
                     .fixed[0]
                     .axes
               : std::array<bool, 3>{};
  };
  constexpr double quarter = EIGEN_PI / 2;
  EXPECT_EQ(turned({true, false, false}, quarter, {0, 0, 1}), (std::array<bool, 3>{false, true, false}));
  EXPECT_EQ(turned({true, false, true}, quarter, {0, 1, 0}), (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(turned({true, false, false}, 4 * quarter / 3, {1, 1, 1}), (std::array<bool, 3>{false, true, false}));
  EXPECT_EQ(turned({true, true, false}, 0.3, {0, 0, 1}), (std::array<bool, 3>{true, true, false}));
  EXPECT_EQ(turned({false, false, true}, 0.3, {0, 0, 1}), (std::array<bool, 3>{false, false, true}));
  try {
    (void)turned({true, false, false}, 0.3, {0, 0, 1});
    ADD_FAILURE() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()),
              "pair.yaml:3: robot 'r': robot.yaml:9: region 'x_low' is fixed along some axes, which the turn of the "
              "robot takes to none of the scene's: fix it along x, y and z, or turn the robot by quarter turns about "
              "its axes");
  }
}

TEST(Joined, Gravity) {
  const Vec3 down(0, 0, -9.81);
  RobotSpec plain = whole_block(), heavy = whole_block(), lifted = whole_block();
  heavy.loads.gravity = down;
  heavy.loads.gravity_origin = {"block.yaml", 5};
  lifted.loads.gravity = -down;
  lifted.loads.gravity_origin = {"other.yaml", 6};
  const CommonSpec common{"pair.yaml", {}, down, {"pair.yaml", 9}};
  EXPECT_EQ(pair(plain, plain).loads.gravity, Vec3(0, 0, 0));
  EXPECT_EQ(pair(heavy, lifted).loads.gravity, down);  // the right one stands upside down
  EXPECT_EQ(pair(plain, plain, common).loads.gravity, down);
  EXPECT_EQ(pair(heavy, plain, common).loads.gravity, down);
  EXPECT_EQ(pair(heavy, lifted, common).loads.gravity, down);
  const std::string cure = ": leave 'gravity' out of the robots' scenes and give it in this one";
  EXPECT_EQ(refusal_of_pair(heavy, heavy),
            "pair.yaml:4: robot 'right': as it stands, its gravity is (0, 0, 9.81) m/s^2 (block.yaml:5), but that of "
            "robot 'left' is (0, 0, -9.81) m/s^2 (block.yaml:5)" +
                cure);
  EXPECT_EQ(refusal_of_pair(heavy, plain),
            "pair.yaml:4: robot 'right': as it stands, its gravity is (0, 0, 0) m/s^2, but that of robot 'left' is "
            "(0, 0, -9.81) m/s^2 (block.yaml:5)" +
                cure);
  EXPECT_EQ(refusal_of_pair(plain, heavy, common),
            "pair.yaml:4: robot 'right': as it stands, its gravity is (0, 0, 9.81) m/s^2 (block.yaml:5), but that of "
            "the whole is (0, 0, -9.81) m/s^2 (pair.yaml:9)" +
                cure);
}

TEST(Joined, WhatDiffersIsRefused) {
  const RobotSpec good = whole_block();
  RobotSpec target = good, quadratic = good, touching = good, empty = good;
  target.name = "target.yaml";
  target.formulation = Formulation::target_shape;
  EXPECT_EQ(refusal_of_pair(good, target),
            "pair.yaml:4: robot 'right' (target.yaml) is of the formulation 'target-shape', robot 'left' (block.yaml) "
            "of 'physical': give 'formulation' in this scene");
  EXPECT_EQ(pair(good, target, {"pair.yaml", Formulation::physical, {}, {}}).formulation, Formulation::physical);
  RobotSpec other = good;
  other.name = "other.yaml";
  other.weights = ElementWeights::mesh_independent;
  EXPECT_EQ(refusal_of_pair(good, other),
            "pair.yaml:4: robot 'right' (other.yaml) has weights 'mesh-independent', robot 'left' (block.yaml) "
            "'printed': give 'weights' in this scene");
  EXPECT_EQ(pair(other, other).weights, ElementWeights::mesh_independent);
  EXPECT_EQ(pair(good, other, {"pair.yaml", {}, {}, {}, ElementWeights::printed}).weights, ElementWeights::printed);
  quadratic.mesh_options.quadratic = true;
  EXPECT_EQ(refusal_of_pair(quadratic, good),
            "pair.yaml:4: robot 'right' (block.yaml) is of order 1, robot 'left' (block.yaml) of order 2: give both "
            "one order, such as 'order: 2' of 'mesh'");
  touching.contact = ContactSpec();
  touching.contact->origin = line(12);
  EXPECT_EQ(
      refusal_of_pair(good, touching),
      "pair.yaml:4: robot 'right': robot.yaml:12: a robot among several has no 'contact', 'obstacles' or 'bodies' of "
      "its own: give them in pair.yaml, which joins the robots");
  empty.regions[0].selector = Sphere{{100, 0, 0}, 1};
  EXPECT_EQ(refusal_of_pair(empty, good),
            "pair.yaml:3: robot 'left': robot.yaml:4: region 'ball' holds no vertex and no element");
  RobotSpec far = good;
  far.mesh.vertices(0, 0) = 1e308;
  Placement place;
  place.translation = Vec3(1.7e308, 0, 0);
  EXPECT_THROW((void)joined({placed("far", far, place, 3)}, {"pair.yaml", {}, {}, {}}), InvalidInput);
}

/// What is refused when the whole is compiled names the robot.
TEST(Joined, CompilingNamesTheRobot) {
  const RobotSpec good = whole_block();
  const auto of_right = [&](const auto& change) {
    RobotSpec right = good;
    change(right);
    return refusal(pair(good, right));
  };
  const auto elements = good.mesh.tetrahedra.size();
  EXPECT_EQ(of_right([](RobotSpec& r) { r.mesh.tetrahedra[1][3] = r.mesh.tetrahedra[1][0]; }),
            "pair.yaml: 1 tetrahedron has no volume; the first is tetrahedron " + std::to_string(elements + 1) +
                " (from 0, of robot 'right')");
  EXPECT_EQ(of_right([](RobotSpec& r) { r.actuators[0].as<PneumaticSpec>()->region = "chambre"; }),
            "robot.yaml:9: there is no region 'right.chambre'; did you mean 'right.chamber'?");
  EXPECT_EQ(of_right([](RobotSpec& r) { r.fixed[1].displacement = Vec3(0, 0, 2); }).substr(0, 58),
            "robot.yaml:7: the box of robot 'right' holds vertex 64 (fr");
  EXPECT_NE(of_right([](RobotSpec& r) {
              r.actuators[0].as<PneumaticSpec>()->region.reset();
            }).find("since the body of robot 'right' encloses no empty space"),
            std::string::npos);
  const auto doubled = [](RobotSpec& r) { r.mesh.tetrahedra.push_back(r.mesh.tetrahedra[0]); };
  EXPECT_EQ(of_right(doubled).substr(0, 50), "block.yaml:2: the mesh of robot 'right' has errors");
  RobotSpec accepted = good;
  doubled(accepted);
  accepted.mesh_options.accept_errors = true;
  EXPECT_EQ(refusal(pair(accepted, good)), "");
  RobotSpec other = good;
  doubled(other);
  EXPECT_NE(refusal(pair(accepted, other)), "");
}

/// Nodes of edges that target shapes leave out are in no region of theirs.
TEST(Joined, OfOrderTwoAsTargetShapes) {
  RobotSpec alone = whole_block();
  alone.mesh_options.quadratic = true;
  alone.materials[0].shape_ratio = alone.materials[1].shape_ratio = 1;
  alone.markers.push_back({"end", mean("end")});
  alone.regions.push_back({"end", Halfspace{{29, 0, 0}, {1, 0, 0}}, line(3)});
  RobotSpec spec = pair(alone, alone);
  spec.formulation = alone.formulation = Formulation::target_shape;
  const Model model = compile(spec), one = compile(alone);
  EXPECT_EQ(model.markers[7].point.vertices.size(), one.markers[3].point.vertices.size());
  EXPECT_EQ(model.elements.tetrahedra.size(), 2 * one.elements.tetrahedra.size());
}

}  // namespace softkin
