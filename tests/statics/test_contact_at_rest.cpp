#include <gtest/gtest.h>
#include <softkin/statics/physical/contact_at_rest.hpp>

#include "model/physical_robots.hpp"
#include "model/quadratic_mesh.hpp"

namespace softkin::physical {
namespace {

using namespace softkin::testing;

/// Cells of 10 mm between z = 0 and 10 in the rows of a drawing, the first one farthest along y; blanks are empty.
Mesh drawn(const std::vector<std::string>& rows, double width = 10) {
  const std::array<int, 3> cells{static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), 1};
  Mesh mesh = layered_mesh(cells, {width * cells[0], 10.0 * cells[1], 10}, Split::six, Split::six);
  std::erase_if(mesh.tetrahedra, [&](const Tetrahedron& t) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : t) middle += vertex_at(mesh.vertices, v) / 4;
    const auto row = static_cast<std::size_t>(cells[1] - 1 - static_cast<int>(middle.y() / 10));
    return rows[row][middle.x() / width] == ' ';
  });
  return mesh;
}

/// Held where y is least.
RobotSpec robot_of(Mesh mesh) {
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.fixed = {{{Halfspace{{0, 1, 0}, {0, -1, 0}}, {}}}};
  ContactSpec contact;
  contact.distance_mm = 0.5;
  contact.origin = {.file = "robot.yaml", .line = 4};
  spec.contact = contact;
  return spec;
}

RobotSpec robot_and(const std::string& name, ObstacleShape shape) {
  RobotSpec spec = robot_of(drawn({"##", "##"}));  // from the origin to (20, 20, 10)
  spec.contact->obstacles.push_back({name, std::move(shape), std::nullopt, {.file = "robot.yaml", .line = 6}});
  return spec;
}

std::string refusal_at_rest(const RobotSpec& spec) {
  const Model model = compile(spec);
  try {
    check_contact_at_rest(model);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// Two arms of 10 mm over a common base, with a gap of that width between their upper two thirds.
Mesh fork(double gap) {
  Mesh mesh = drawn({"# #", "# #", "# #", "###"});
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices(v, 0) > 15 && mesh.vertices(v, 1) > 15) mesh.vertices(v, 0) += gap - 10;
  return mesh;
}

TEST(ContactAtRest, NothingWithoutContact) {
  RobotSpec spec = robot_of(fork(1e-3));
  spec.contact.reset();
  EXPECT_EQ(refusal_at_rest(spec), "");
}

TEST(ContactAtRest, AFloorBelow) {
  const auto floor = [](double height) { return robot_and("floor", Halfspace{{7, 3, height}, {0, 0, 2}}); };
  EXPECT_EQ(refusal_at_rest(floor(-1e-3)), "");
  EXPECT_EQ(refusal_at_rest(floor(0)),
            "robot.yaml:6: the robot touches obstacle 'floor' at rest, at (0, 0, 0) mm: move it by more than 0 mm "
            "against its normal, so that a gap is left");
  EXPECT_EQ(refusal_at_rest(floor(0.25)),
            "robot.yaml:6: the robot lies 0.25 mm deep in obstacle 'floor' at rest, at (0, 0, 0) mm: move it by more "
            "than 0.25 mm against its normal, so that a gap is left");
  EXPECT_NE(refusal_at_rest(floor(50)), "");  // all of the robot
}

TEST(ContactAtRest, AnObstacleBeside) {
  EXPECT_EQ(refusal_at_rest(robot_and("ball", Sphere{{26, 10, 5}, 5})), "");
  EXPECT_EQ(refusal_at_rest(robot_and("block", Box{{20.001, 0, 0}, {30, 20, 10}})), "");
}

TEST(ContactAtRest, AnObstacleThatTouches) {
  EXPECT_EQ(refusal_at_rest(robot_and("block", Box{{20, 4, 3}, {30, 6, 7}})),
            "robot.yaml:6: the robot and obstacle 'block' touch or cross at rest, at (20, 6, 6) mm: move the obstacle "
            "away, so that a gap is left");
  EXPECT_NE(refusal_at_rest(robot_and("block", Box{{20 + 1e-8, 4, 3}, {30, 6, 7}})), "");
  EXPECT_EQ(refusal_at_rest(robot_and("block", Box{{20 + 1e-7, 4, 3}, {30, 6, 7}})), "");
  // corner at corner
  EXPECT_NE(refusal_at_rest(robot_and("block", Box{{20, 20, 10}, {30, 30, 20}})), "");
  // edge across edge
  EXPECT_NE(refusal_at_rest(robot_and("block", Box{{20, 5, 10}, {30, 7, 20}})), "");
}

TEST(ContactAtRest, AnObstacleThatCrosses) {
  const std::string message = refusal_at_rest(robot_and("block", Box{{19.5, 4, 3}, {30, 6, 7}}));
  EXPECT_EQ(message.substr(0, message.find(" at (")),
            "robot.yaml:6: the robot and obstacle 'block' touch or cross at rest,");
  EXPECT_NE(message.find("mm: move the obstacle away by about 0.5 mm or more, so that a gap is left"),
            std::string::npos)
      << message;
  // no vertex of either in the other, no edge of the robot through it: edges of the rod pierce faces
  EXPECT_NE(refusal_at_rest(robot_and("rod", Box{{-5, 4, 3}, {25, 6, 7}})), "");
  EXPECT_NE(refusal_at_rest(robot_and("rod", Cylinder{{13, 12, -5}, {13, 12, 15}, 1})), "");
}

TEST(ContactAtRest, AnObstacleInside) {
  EXPECT_EQ(refusal_at_rest(robot_and("core", Box{{4, 4, 4}, {6, 6, 6}})),
            "robot.yaml:6: obstacle 'core' lies inside the robot's body at rest, at (4, 4, 4) mm: move it out, so that "
            "a gap is left");
}

TEST(ContactAtRest, ARobotInside) {
  const std::string inside =
      "robot.yaml:6: the robot lies inside obstacle 'shell' at rest, at (0, 0, 0) mm: move the obstacle away, so that "
      "a gap is left";
  EXPECT_EQ(refusal_at_rest(robot_and("shell", Box{{-40, -40, -40}, {40, 40, 40}})), inside);
  // in the hollow of a closed surface, and in a surface with a rim, there is room
  TriangleSurface hollow = box_surface({-50, -50, -50}, {100, 100, 100});
  const TriangleSurface cave = box_surface({-40, -40, -40}, {80, 80, 80});
  const Index first = hollow.vertices.rows();
  hollow.vertices.conservativeResize(first + cave.vertices.rows(), 3);
  hollow.vertices.bottomRows(cave.vertices.rows()) = cave.vertices;
  for (const auto& [a, b, c] : cave.triangles) hollow.triangles.push_back({a + first, c + first, b + first});
  EXPECT_EQ(refusal_at_rest(robot_and("shell", hollow)), "");
  TriangleSurface open = cave;
  EXPECT_EQ(refusal_at_rest(robot_and("shell", open)), inside);
  open.triangles.pop_back();
  EXPECT_EQ(refusal_at_rest(robot_and("shell", open)), "");
}

TEST(ContactAtRest, AnObstacleInAChamber) {
  RobotSpec spec = robot_of(drawn({"###", "# #", "###"}));
  spec.contact->obstacles.push_back({"pin", Box{{13, 13, 2}, {17, 17, 8}}, std::nullopt, {}});
  EXPECT_EQ(refusal_at_rest(spec), "");
}

TEST(ContactAtRest, ArmsThatTouchOrCross) {
  RobotSpec spec = robot_of(fork(0));
  const std::string message = refusal_at_rest(spec);
  EXPECT_EQ(message.substr(0, message.find(" at (")), "robot.yaml:4: the robot touches or crosses itself at rest,");
  EXPECT_NE(message.find(" mm: leave a gap there or join the surfaces in the mesh, or set 'self: false'"),
            std::string::npos)
      << message;
  spec.contact->self = false;
  EXPECT_EQ(refusal_at_rest(spec), "");

  // two meshes in each other
  Mesh one = drawn({"#"}), two = drawn({"#"});
  const Index first = one.vertices.rows();
  two.vertices.rowwise() += Eigen::RowVector3d(9, 0.5, 0.25);
  one.vertices.conservativeResize(2 * first, 3);
  one.vertices.bottomRows(first) = two.vertices;
  Region left{"left", 3, {}, {}, {}, {}, {}};
  for (std::size_t t = 0; t < two.tetrahedra.size(); ++t) {
    left.tetrahedra.push_back(t);
    Tetrahedron moved = two.tetrahedra[t];
    for (Index& v : moved) v += first;
    one.tetrahedra.push_back(moved);
  }
  one.regions.push_back(left);
  RobotSpec crossed = robot_of(one);
  EXPECT_NE(refusal_at_rest(crossed).find("the robot touches or crosses itself"), std::string::npos);
  crossed.contact->pairs = {{"left", "robot", 0.5, {.file = "robot.yaml", .line = 5}}};
  EXPECT_NE(refusal_at_rest(crossed).find("touch or cross at rest"), std::string::npos) << refusal_at_rest(crossed);
}

TEST(ContactAtRest, ArmsThatAreTooClose) {
  EXPECT_EQ(refusal_at_rest(robot_of(fork(1.001))), "");
  EXPECT_EQ(refusal_at_rest(robot_of(fork(0.8))).substr(0, 55),
            "robot.yaml:4: contact distance 0.5 mm is too large: at ");
  const std::string message = refusal_at_rest(robot_of(fork(0.8)));
  EXPECT_NE(message.find(" mm the robot's surfaces are only 0.8 mm apart; choose at most 0.364 mm"), std::string::npos)
      << message;
  RobotSpec chosen = robot_of(fork(0.8));
  chosen.contact->distance_mm = 0.364;
  EXPECT_EQ(refusal_at_rest(chosen), "");
  chosen.contact->distance_mm = 0.5;
  chosen.contact->self = false;
  EXPECT_EQ(refusal_at_rest(chosen), "");
}

TEST(ContactAtRest, ThinWallsAreNoGap) {
  Mesh plate = drawn({"####", "####"});
  plate.vertices.col(2) *= 0.04;  // 0.4 mm thick
  EXPECT_EQ(refusal_at_rest(robot_of(plate)), "");
}

TEST(ContactAtRest, NeighboursAroundACornerAreNoGap) {
  // a right angle and one of 45 degrees, meshed about as finely as the distance
  std::vector<std::string> rows(9, "######      ");
  rows.insert(rows.end(), 3, "############");
  Mesh corner = drawn(rows);
  corner.vertices *= 0.01;
  RobotSpec spec = robot_of(corner);
  spec.fixed = {{{Halfspace{{0, 0.01, 0}, {0, -1, 0}}, {}}}};
  spec.contact->distance_mm = 0.08;
  EXPECT_EQ(refusal_at_rest(spec), "");
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
    spec.mesh.vertices(v, 0) += std::max(0.0, spec.mesh.vertices(v, 1) - 0.3);
  EXPECT_EQ(refusal_at_rest(spec), "");
}

TEST(ContactAtRest, OfOrderTwo) {
  RobotSpec spec = robot_of(fork(1.2));
  spec.mesh_options.quadratic = true;
  EXPECT_EQ(refusal_at_rest(spec), "");
  spec.contact->distance_mm = 0.7;
  EXPECT_NE(refusal_at_rest(spec).find("only 1.2 mm apart"), std::string::npos);
}

}  // namespace
}  // namespace softkin::physical
