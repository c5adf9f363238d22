#include <gtest/gtest.h>

#include <softkin/model/names.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

namespace softkin {

namespace {

using namespace testing;

RobotSpec surrounded() {
  RobotSpec spec = physical_robot(block_mesh({2, 2, 2}, {20, 20, 20}));
  spec.contact.emplace();
  spec.contact->bodies.push_back({"cube", Box{{30, 0, 0}, {40, 10, 20}}, {}, {}, 2000});
  spec.contact->obstacles.push_back({"wall", Box{{60, 0, 0}, {61, 20, 20}}, {}, {}, {true, false, true}});
  return spec;
}

}  // namespace

TEST(Surroundings, OfBodiesAndObstacles) {
  RobotSpec spec = surrounded();
  spec.loads.gravity = {0, 0, -10};
  spec.materials[0].density = 1;
  const Model model = compile(spec);
  ASSERT_EQ(model.bodies.size(), 1U);
  const FreeBody& cube = model.bodies[0];
  EXPECT_NEAR(cube.mass_kg, 2000 * 2000e-9, 1e-15);
  EXPECT_LT((cube.center.at(model.rest) - Vec3(35, 5, 10)).norm(), 1e-12);
  // its weight has no moment about its center of mass
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (const Index v : cube.vertices) {
    const Vec3 load = model.loads.dead.row(v).transpose();
    force += load;
    moment += (vertex_at(model.rest, v) - Vec3(35, 5, 10)).cross(load);
    EXPECT_FALSE(model.held.fixed[v][0]);
  }
  EXPECT_LT((force - Vec3(0, 0, -10 * cube.mass_kg)).norm(), 1e-15);
  EXPECT_LT(moment.norm(), 1e-14);
  std::vector<std::string> columns;
  for (const Actuator& actuator : model.actuators)
    if (!drives(actuator)) columns.push_back(command_column(actuator));
  EXPECT_EQ(columns,
            (std::vector<std::string>{"cube_hold", "cube_fx_N", "cube_fy_N", "cube_fz_N", "wall_x_mm", "wall_z_mm"}));
  EXPECT_EQ(model.markers.back().name, "cube");
  EXPECT_EQ(model.robot_vertices() + 16, model.rest.rows());
}

/// The centre of mass of a body that is no box, whatever its vertices are.
TEST(Surroundings, CenterOfMassOfATetrahedron) {
  RobotSpec spec = surrounded();
  TriangleSurface surface;
  surface.vertices.resize(5, 3);
  surface.vertices << 30, 0, 0, 42, 0, 0, 30, 12, 0, 30, 0, 12, 36, 6, 0;  // the last on an edge's middle
  surface.triangles = {{0, 4, 1}, {0, 2, 4}, {0, 1, 3}, {0, 3, 2}, {1, 4, 3}, {4, 2, 3}};
  spec.contact->bodies[0].shape = surface;
  const Model model = compile(spec);
  EXPECT_LT((model.bodies[0].center.at(model.rest) - Vec3(33, 3, 3)).norm(), 1e-9);
  EXPECT_NEAR(model.bodies[0].mass_kg, 2000e-9 * 288, 1e-12);
}

TEST(Surroundings, WhatIsNotRightIsRefused) {
  TriangleSurface open;
  open.vertices.resize(3, 3);
  open.vertices << 30, 0, 0, 40, 0, 0, 30, 9, 0;
  open.triangles = {{0, 1, 2}};
  const auto refused = [](const auto& change) {
    RobotSpec spec = surrounded();
    change(spec);
    return refusal(spec);
  };
  const auto expect = [&](const std::string& fragment, const auto& change) {
    EXPECT_NE(refused(change).find(fragment), std::string::npos) << refused(change);
  };
  expect("body 'cube': a half-space has no end", [](RobotSpec& s) {
    s.contact->bodies[0].shape = Halfspace{{0, 0, -9}, {0, 0, 1}};
  });
  expect("body 'cube': density must be 0 kg/m^3 or more, not -1",
         [](RobotSpec& s) { s.contact->bodies[0].density = -1; });
  expect("two obstacles or bodies 'wall'", [](RobotSpec& s) { s.contact->bodies[0].name = "wall"; });
  expect("body 'cube': the surface", [&](RobotSpec& s) { s.contact->bodies[0].shape = open; });
  expect("a body is rigid", [](RobotSpec& s) { s.contact->pairs.push_back({"cube", "cube", 0.3, {}}); });
  expect("a marker has that name", [](RobotSpec& s) { s.markers.push_back({"cube", {Vec3(1, 1, 1), {}}}); });
}

}  // namespace softkin
