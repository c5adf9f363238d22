#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <set>
#include <softkin/model/joined.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"
#include "model/quadratic_mesh.hpp"

namespace softkin {
namespace {

using namespace testing;

ObstacleSpec obstacle(const std::string& name, ObstacleShape shape, std::optional<double> friction = std::nullopt) {
  return {name, std::move(shape), friction, line(8)};
}

/// A beam of 40 x 20 x 10 mm with a floor and a ball.
RobotSpec robot() {
  RobotSpec spec = physical_robot(block_mesh({4, 2, 1}, {40, 20, 10}));
  spec.regions.push_back({"end", Box{{30, 0, 0}, {40, 20, 10}}, line(3)});
  ContactSpec contact;
  contact.distance_mm = 0.1;
  contact.friction = 0.4;
  contact.origin = line(7);
  contact.obstacles.push_back(obstacle("floor", Halfspace{{0, 0, -5}, {0, 0, 2}}, 0.3));
  contact.obstacles.push_back(obstacle("ball", Sphere{{60, 10, 5}, 8}));
  spec.contact = contact;
  return spec;
}

double area_of(const Points& vertices, const Triangle& t) {
  const Vec3 a = vertex_at(vertices, t[0]);
  return (vertex_at(vertices, t[1]) - a).cross(vertex_at(vertices, t[2]) - a).norm() / 2;
}

std::vector<Triangle> triangles_of(const ContactModel& contact, Index part) {
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < contact.triangles.size(); ++t)
    if (contact.part_of[t] == part) triangles.push_back(contact.triangles[t]);
  return triangles;
}

TEST(ContactModel, NoneWithoutKeys) {
  const Model model = compile(physical_robot(block_mesh({2, 1, 1}, {20, 10, 10})));
  EXPECT_FALSE(model.contact.any());
  EXPECT_TRUE(model.contact.parts.empty());
  EXPECT_EQ(model.robot_vertices(), model.rest.rows());
}

TEST(ContactModel, Defaults) {
  RobotSpec spec = robot();
  spec.contact = ContactSpec{};
  const Model model = compile(spec);
  EXPECT_DOUBLE_EQ(model.contact.distance_mm, 5e-4 * std::sqrt(40 * 40 + 20 * 20 + 10 * 10));
  EXPECT_DOUBLE_EQ(model.contact.modulus_MPa, 1);
  ASSERT_EQ(model.contact.parts.size(), 1u);
  EXPECT_EQ(model.contact.parts[0].name, "robot");
  EXPECT_TRUE(model.contact.pair(0, 0).touch);
  EXPECT_EQ(model.contact.pair(0, 0).friction, 0);
  EXPECT_EQ(model.robot_vertices(), model.rest.rows());
}

TEST(ContactModel, PartsAndTheirFriction) {
  RobotSpec spec = robot();
  spec.contact->pairs = {{"end", "ball", 0.8, line(7)}, {"robot", "end", 0.2, line(7)}};
  const ContactModel contact = compile(spec).contact;
  ASSERT_EQ(contact.parts.size(), 4u);
  EXPECT_EQ(contact.parts[1].name, "end");
  EXPECT_EQ(contact.parts[1].rank, ContactRank::robot);
  EXPECT_EQ(contact.parts[2].name, "floor");
  EXPECT_EQ(contact.parts[2].rank, ContactRank::obstacle);
  EXPECT_EQ(contact.parts[2].origin.line, 8u);
  EXPECT_TRUE(contact.parts[2].halfspace);
  EXPECT_FALSE(contact.parts[3].halfspace);
  const double friction[4][4] = {{0.4, 0.2, 0.3, 0.4}, {0.2, 0.4, 0.3, 0.8}, {0.3, 0.3, 0, 0}, {0.4, 0.8, 0, 0}};
  for (Index a = 0; a < 4; ++a)
    for (Index b = 0; b < 4; ++b) {
      EXPECT_EQ(contact.pair(a, b).touch, a < 2 || b < 2) << a << b;
      if (a < 2 || b < 2) {
        EXPECT_EQ(contact.pair(a, b).friction, friction[a][b]) << a << b;
      }
    }
  spec.contact->pairs = {{"end", "ball", 0.8, line(7)}};
  spec.contact->self = false;
  const ContactModel alone = compile(spec).contact;
  EXPECT_FALSE(alone.pair(0, 1).touch);
  EXPECT_FALSE(alone.pair(1, 1).touch);
  EXPECT_TRUE(alone.pair(2, 1).touch);
}

/// Two beams, each with a floor below it; the contact of both is set on the whole.
RobotSpec two_beams() {
  RobotSpec one = robot();
  one.contact.reset();
  Placement beside;
  beside.translation = Vec3(0, 100, 0);
  RobotSpec both = joined({{"left", one, {}, {}}, {"right", one, beside, {}}}, {"pair.yaml", {}, {}, {}});
  both.contact = robot().contact;
  return both;
}

TEST(ContactModel, RobotsAreParts) {
  RobotSpec spec = two_beams();
  spec.contact->pairs = {
      {"right.end", "ball", 0.8, line(7)}, {"robot", "floor", 0.1, line(7)}, {"left", "right", 0.2, line(7)}};
  const Model model = compile(spec);
  const ContactModel& contact = model.contact;
  std::vector<std::string> labels;
  for (Index part = 0; part < std::ssize(contact.parts); ++part) labels.push_back(contact.label(part));
  EXPECT_EQ(labels, (std::vector<std::string>{"robot 'left'", "robot 'right'", "region 'right.end'", "obstacle 'floor'",
                                              "obstacle 'ball'"}));
  EXPECT_EQ(contact.label_of_solid(2), "robot 'right'");
  EXPECT_EQ(contact.label_of_solid(4), "obstacle 'ball'");
  const double whole = 2 * (40 * 20 + 40 * 10 + 20 * 10), end = 2 * 10 * 10 + 2 * 10 * 20 + 20 * 10;
  const double areas[] = {whole, whole - end, end};
  for (Index part = 0; part < 3; ++part) {
    EXPECT_EQ(contact.parts[part].robot, part == 0 ? 0 : 1);
    double area = 0;
    for (const Triangle& t : triangles_of(contact, part)) {
      area += area_of(model.rest, t);
      for (const Index v : t) EXPECT_EQ(model.rest(v, 1) >= 100, part > 0);
    }
    EXPECT_NEAR(area, areas[part], 1e-9) << part;
  }
  const double friction[5][5] = {{0.4, 0.2, 0.4, 0.1, 0.4}, {0.2, 0.4, 0.4, 0.1, 0.4}, {0.4, 0.4, 0.4, 0.3, 0.8}};
  for (Index a = 0; a < 3; ++a)
    for (Index b = 0; b < 5; ++b) EXPECT_EQ(contact.pair(a, b).friction, friction[a][b]) << a << b;
}

TEST(ContactModel, RobotsTouchEachOtherWhateverTheyDoToThemselves) {
  RobotSpec spec = two_beams();
  spec.contact->self = false;
  spec.contact->pairs = {{"right.end", "left", 0.8, line(7)}};
  const ContactModel contact = compile(spec).contact;
  for (Index a = 0; a < 3; ++a)
    for (Index b = 0; b < 3; ++b) EXPECT_EQ(contact.pair(a, b).touch, (a == 0) != (b == 0)) << a << b;
  spec.contact->pairs = {{"robot", "robot", 0.8, line(7)}};
  EXPECT_EQ(compile(spec).contact.pair(0, 1).friction, 0.8);
  spec.contact->pairs = {{"right.end", "right", 0.8, line(7)}};
  EXPECT_EQ(refusal(spec),
            "robot.yaml:7: the pair of 'right.end' and 'right' never touches: both are of the robot, and 'self' is "
            "false");
  spec.contact->self = true;
  spec.regions.push_back({"upper", Halfspace{{0, 0, 6}, {0, 0, 1}}, line(3)});
  spec.contact->pairs = {{"upper", "ball", 0.8, line(7)}};
  EXPECT_EQ(refusal(spec),
            "robot.yaml:7: region 'upper' is of robot 'left' and of robot 'right': contacts are of one of them; name "
            "a region of each");
}

TEST(ContactModel, FacesOfARegion) {
  RobotSpec spec = robot();
  spec.contact->pairs = {{"end", "ball", 0.8, line(7)}, {"robot", "z_low", 0.2, line(7)}};
  const Model model = compile(spec);
  double end = 0, low = 0, rest = 0;
  for (const Triangle& t : triangles_of(model.contact, 1)) end += area_of(model.rest, t);
  for (const Triangle& t : triangles_of(model.contact, 2)) low += area_of(model.rest, t);
  for (const Triangle& t : triangles_of(model.contact, 0)) rest += area_of(model.rest, t);
  // the last quarter of the beam goes to the region that is named first
  EXPECT_NEAR(end, 2 * 10 * 10 + 2 * 10 * 20 + 20 * 10, 1e-9);
  EXPECT_NEAR(low, 30 * 20, 1e-9);
  EXPECT_NEAR(end + low + rest, 2 * (40 * 20 + 40 * 10 + 20 * 10), 1e-9);
}

TEST(ContactModel, ObstaclesVerticesFollowTheRobots) {
  const Model model = compile(robot());
  const Model bare = compile(physical_robot(block_mesh({4, 2, 1}, {40, 20, 10})));
  const std::size_t rows = model.rest.rows();
  EXPECT_EQ(model.robot_vertices(), 45 - 15);
  EXPECT_EQ(model.rest.topRows(30), bare.rest);
  EXPECT_EQ(model.held.at.rows(), model.rest.rows());
  EXPECT_EQ(model.loads.dead.rows(), model.rest.rows());
  EXPECT_EQ(model.held.fixed.size(), rows);
  EXPECT_EQ(model.held.support_of.size(), rows);
  EXPECT_EQ(model.elements.used.size(), rows);
  EXPECT_EQ(model.contact.area.size(), rows);
  for (std::size_t v = 30; v < rows; ++v) {
    ASSERT_FALSE(model.elements.used[v]);
    ASSERT_EQ(model.held.fixed[v], (std::array{true, true, true}));
    ASSERT_EQ(model.held.support_of[v], (std::array<Index, 3>{-1, -1, -1}));
    ASSERT_EQ(model.held.at.row(v), model.rest.row(v));
    ASSERT_TRUE(model.loads.dead.row(v).isZero(0));
  }
  EXPECT_EQ(model.diagonal_mm, bare.diagonal_mm);
  const Vec3 floor = model.rest.middleRows(30, 3).colwise().mean();
  EXPECT_TRUE(floor.isApprox(Vec3(20, 10, -5), 1e-9));
  for (const Triangle& t : triangles_of(model.contact, 2))
    for (const Index v : t) ASSERT_NEAR((vertex_at(model.rest, v) - Vec3(60, 10, 5)).norm(), 8, 1e-9);
}

TEST(ContactModel, AShapeOfARegionHoldsNoObstacle) {
  RobotSpec spec = robot();
  spec.markers.push_back({"far", mean("right")});
  spec.regions.push_back({"right", Halfspace{{35, 0, 0}, {1, 0, 0}}, line(4)});  // the ball, too
  const Model model = compile(spec);
  spec.contact.reset();
  EXPECT_EQ(model.markers[0].point.vertices, compile(spec).markers[0].point.vertices);
}

TEST(ContactModel, AreasAreThoseOfAUniformPressure) {
  for (const Split split : {Split::six, Split::prisms}) {
    RobotSpec spec = physical_robot(block_mesh({4, 2, 1}, {40, 20, 10}, split));
    spec.contact = ContactSpec{};
    spec.contact->obstacles.push_back(obstacle("box", Box{{0, 0, 20}, {1, 1, 21}}));
    const Model model = compile(spec);
    const double total = 2 * (40 * 20 + 40 * 10 + 20 * 10);
    double robot_area = 0;
    for (Index v = 0; v < 30; ++v) robot_area += model.contact.area[v];
    EXPECT_NEAR(robot_area, total, 1e-9);
    for (Index v = 30; v < 38; ++v) EXPECT_NEAR(model.contact.area[v], 0.01 * total / 30, 1e-12);
  }
}

TEST(ContactModel, FacesOfOrderTwoAreFourTriangles) {
  RobotSpec spec = physical_robot(quadratic_block({1, 1, 1}, {10, 10, 10}));
  spec.contact = ContactSpec{};
  const Model model = compile(spec);
  const ContactModel& contact = model.contact;
  ASSERT_EQ(contact.triangles.size(), 48u);
  double volume = 0;
  for (const auto& [a, b, c] : contact.triangles)
    volume += vertex_at(model.rest, a).dot(vertex_at(model.rest, b).cross(vertex_at(model.rest, c))) / 6;
  EXPECT_NEAR(volume, 1000, 1e-9);  // normals outwards
  std::vector<double> area(model.rest.rows());
  for (const Triangle& t : contact.triangles)
    for (const Index v : t) area[v] += 12.5 / 3;
  for (std::size_t v = 0; v < area.size(); ++v) EXPECT_NEAR(contact.area[v], area[v], 1e-9);
}

TEST(ContactModel, EdgesOfFacesOfOrderTwoAreThereOnceWithTheirNodes) {
  RobotSpec spec = physical_robot(quadratic_block({1, 1, 1}, {10, 10, 10}));
  spec.contact = ContactSpec{};
  const Model model = compile(spec);
  const std::vector<EdgeWithNode>& edges = model.contact.edges;
  EXPECT_EQ(edges.size(), 18u);  // of the block, and diagonals of its sides
  std::set<Index> nodes;
  for (const auto& [a, b, node] : edges) {
    EXPECT_LT(a, b);
    EXPECT_TRUE(nodes.insert(node).second);
    EXPECT_LT((vertex_at(model.rest, node) - (vertex_at(model.rest, a) + vertex_at(model.rest, b)) / 2).norm(), 1e-9);
  }
  spec = physical_robot(block_mesh({1, 1, 1}, {10, 10, 10}));
  spec.contact = ContactSpec{};
  EXPECT_TRUE(compile(spec).contact.edges.empty());
}

TEST(ContactModel, WallsOfChambersTakePart) {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.actuators.push_back(chamber("chamber"));
  spec.contact = ContactSpec{};
  const Model model = compile(spec);
  double area = 0;
  for (const Triangle& t : model.contact.triangles) area += area_of(model.rest, t);
  EXPECT_NEAR(area, 6 * 900 + 6 * 100, 1e-9);
}

TEST(ContactModel, TheSoftestMaterialInUseCounts) {
  RobotSpec spec = robot();
  MaterialSpec soft = spec.materials[0], unused = soft;
  soft.region = "end";
  soft.elastic->youngs_modulus = 0.25;
  unused.elastic->youngs_modulus = 0.1;
  spec.materials.insert(spec.materials.begin(), unused);  // of all, then overridden
  spec.materials.push_back(soft);
  EXPECT_DOUBLE_EQ(compile(spec).contact.modulus_MPa, 0.25);
}

TEST(ContactModel, NotesFacetsThatAreCoarse) {
  EXPECT_FALSE(has_note(compile(robot()), "facets"));
  RobotSpec spec = robot();
  spec.contact->distance_mm = 1e-3;
  EXPECT_TRUE(has_note(compile(spec), "facets of obstacle 'ball' lie up to 0.00")) << compile(spec).notes[0];
  EXPECT_TRUE(has_note(compile(spec), "mm inside its sphere."));
}

TEST(ContactModel, TheFingerprintKnowsIt) {
  const auto changed = [](const std::function<void(ContactSpec&)>& change) {
    RobotSpec spec = robot();
    change(*spec.contact);
    return fingerprint_of(compile(spec));
  };
  const std::string first = fingerprint_of(compile(robot()));
  EXPECT_EQ(changed([](ContactSpec&) {}), first);
  EXPECT_NE(changed([](ContactSpec& c) { c.distance_mm = 0.2; }), first);
  EXPECT_NE(changed([](ContactSpec& c) { c.friction = 0.5; }), first);
  EXPECT_NE(changed([](ContactSpec& c) { c.self = false; }), first);
  EXPECT_NE(changed([](ContactSpec& c) { c.obstacles[0].friction = 0.5; }), first);
  EXPECT_NE(changed([](ContactSpec& c) { c.obstacles[1].shape = Sphere{{61, 10, 5}, 8}; }), first);
  EXPECT_NE(changed([](ContactSpec& c) { c.obstacles.clear(); }), first);
}

TEST(ContactModel, Refusals) {
  const auto contact_change = [](const std::function<void(ContactSpec&)>& change) {
    return [change](RobotSpec& spec) { change(*spec.contact); };
  };
  const auto shape = [&](ObstacleShape made) {
    return contact_change([made](ContactSpec& c) { c.obstacles[1].shape = made; });
  };
  const auto pair = [&](const std::string& a, const std::string& b, double friction = 1) {
    return contact_change([=](ContactSpec& c) { c.pairs = {{a, b, friction, line(9)}}; });
  };
  const TriangleSurface flat{(Points(3, 3) << 0, 0, 0, 1, 1, 1, 2, 2, 2).finished(), {{0, 1, 2}}};
  const TriangleSurface astray{(Points(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished(), {{0, 1, 2}, {0, 1, 3}}};
  expect_refused(
      robot(),
      {{"target shapes", [](RobotSpec& s) { s.formulation = Formulation::target_shape; },
        "robot.yaml:7: contact and obstacles belong to the physical formulation, and this robot is of target shapes: "
        "give elastic constants and 'formulation: physical', or leave them out"},
       {"distance 0", contact_change([](ContactSpec& c) { c.distance_mm = 0; }),
        "robot.yaml:7: contact distance must be above 0 mm, not 0"},
       {"a large distance", contact_change([](ContactSpec& c) { c.distance_mm = 2.3; }),
        "robot.yaml:7: contact distance 2.3 mm is too large: it must be below a twentieth of the robot's diagonal, "
        "2.29129 mm"},
       {"friction", contact_change([](ContactSpec& c) { c.friction = -0.1; }),
        "robot.yaml:7: contact: friction must be 0 or more, not -0.1"},
       {"friction of an obstacle", contact_change([](ContactSpec& c) { c.obstacles[0].friction = NAN; }),
        "robot.yaml:8: obstacle 'floor': friction must be 0 or more, not nan"},
       {"friction of a pair", pair("ball", "robot", -1),
        "robot.yaml:9: the pair of 'ball' and 'robot': friction must be 0 or more, not -1"},
       {"an unknown name", pair("bal", "robot"),
        "robot.yaml:9: there is no obstacle, body or region 'bal'; did you mean 'ball'?"},
       {"all", pair("ball", "all"),
        "robot.yaml:9: there is no obstacle, body or region 'all'; the whole robot is 'robot'"},
       {"two obstacles in a pair", pair("floor", "ball"),
        "robot.yaml:9: the pair of 'floor' and 'ball' never touches: both are obstacles"},
       {"a pair of the robot",
        [](RobotSpec& s) {
          s.contact->self = false;
          s.contact->pairs = {{"end", "robot", 1, line(9)}};
        },
        "robot.yaml:9: the pair of 'end' and 'robot' never touches: both are of the robot, and 'self' is false"},
       {"a pair twice", contact_change([](ContactSpec& c) {
          c.pairs = {{"ball", "robot", 1, line(9)}, {"robot", "ball", 1, line(10)}};
        }),
        "robot.yaml:10: the pair of 'robot' and 'ball' is given twice"},
       {"a region inside",
        [](RobotSpec& s) {
          s.regions.push_back({"inside", VertexList{{7}}, line(4)});
          s.contact->pairs = {{"inside", "ball", 1, line(9)}};
        },
        "robot.yaml:9: region 'inside' has no face of the robot's surface"},
       {"no name", contact_change([](ContactSpec& c) { c.obstacles[1].name.clear(); }),
        "robot.yaml:8: an obstacle needs a name"},
       {"a name twice", contact_change([](ContactSpec& c) { c.obstacles[1].name = "floor"; }),
        "robot.yaml:8: there are two obstacles or bodies 'floor'"},
       {"a region's name", contact_change([](ContactSpec& c) { c.obstacles[1].name = "end"; }),
        "robot.yaml:8: obstacle 'end': a region of the robot has that name, too: give it another one"},
       {"the robot's name", contact_change([](ContactSpec& c) { c.obstacles[1].name = "robot"; }),
        "robot.yaml:8: an obstacle cannot be named 'robot', which stands for the robot"},
       {"no radius", shape(Sphere{{60, 0, 0}, 0}), "robot.yaml:8: obstacle 'ball': the sphere needs a radius above 0"},
       {"a negative radius", shape(Capsule{{60, 0, 0}, {70, 0, 0}, -1}),
        "robot.yaml:8: obstacle 'ball': the capsule needs a radius above 0"},
       {"no length", shape(Cylinder{{60, 0, 0}, {60, 0, 0}, 1}),
        "robot.yaml:8: obstacle 'ball': the cylinder starts where it ends"},
       {"no normal", shape(Halfspace{{60, 0, 0}, {0, 0, 0}}),
        "robot.yaml:8: obstacle 'ball': the halfspace needs a normal other than 0"},
       {"a box inside out", shape(Box{{60, 0, 0}, {61, -1, 1}}),
        "robot.yaml:8: obstacle 'ball': the box has a low corner above its high corner"},
       {"a flat box", shape(Box{{60, 0, 0}, {61, 0, 1}}), "robot.yaml:8: obstacle 'ball': the box has no volume"},
       {"a far ball", shape(Sphere{{1e9, 0, 0}, 1}),
        "robot.yaml:8: obstacle 'ball': it reaches farther from the origin than a million of the robot's diagonals, "
        "4.58e+07 mm: check its numbers and their unit"},
       {"a ball without end", shape(Sphere{{1e308, 0, 0}, 1e308}), "check its numbers and their unit"},
       {"a far plane", shape(Halfspace{{1e308, 0, 0}, {1, 1, 0}}), "check its numbers and their unit"},
       {"an empty surface", shape(TriangleSurface{}), "robot.yaml:8: obstacle 'ball': the surface has no triangle"},
       {"a flat triangle", shape(flat),
        "robot.yaml:8: obstacle 'ball': triangle 0 (from 0) of the surface has no area"},
       {"a missing vertex", shape(astray),
        "robot.yaml:8: obstacle 'ball': triangle 1 (from 0) of the surface names a vertex that is not there"}});
}

}  // namespace
}  // namespace softkin
