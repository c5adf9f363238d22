#include <Eigen/Geometry>

#include "statics/physical_samples.hpp"

/// Contacts and their forces.

namespace softkin {

namespace {

using namespace testing;

FixedSpec held(RegionRef where, std::array<bool, 3> axes, const Vec3& displacement = Vec3::Zero()) {
  return {std::move(where), axes, displacement};
}

RegionRef face(const std::string& name) {
  return {name, {}};
}

ContactSpec touching(double distance, std::vector<ObstacleSpec> obstacles = {}) {
  ContactSpec contact;
  contact.distance_mm = distance;
  contact.obstacles = std::move(obstacles);
  return contact;
}

ObstacleSpec obstacle(const std::string& name, ObstacleShape shape) {
  return {name, std::move(shape), std::nullopt, {}};
}

/// A block over the origin, on which its upper face presses; free to grow along x and y.
RobotSpec pressed_block(const std::array<int, 3>& cells, const Vec3& size, double down, ObstacleShape below) {
  RobotSpec spec = physical_robot(block_mesh(cells, size));
  spec.fixed = {held(face("z_high"), {false, false, true}, {0, 0, -down}), held(face("x_low"), {true, false, false}),
                held(face("y_low"), {false, true, false})};
  spec.contact = touching(0.02, {obstacle("below", std::move(below))});
  return spec;
}

struct Touched {
  Model model;
  Equilibrium found;
  ElementDeformation deformation;
  ContactForces contacts;
  std::vector<Reaction> supports;
};

Touched touched(const RobotSpec& spec) {
  Touched out{compile(spec), {}, {}, {}, {}};
  const Statics statics(out.model);
  out.found = solve_converged(statics, out.model.rest_actuation());
  out.deformation = statics.measured(out.found.state);
  EXPECT_TRUE(out.deformation.contacts.has_value());
  out.contacts = out.deformation.contacts.value_or(ContactForces{});
  out.supports = reactions(out.model, out.found.state.positions, out.deformation);
  EXPECT_EQ(out.contacts.pressure_kPa.size(), static_cast<std::size_t>(out.model.rest.rows()));
  return out;
}

const std::string& name_of_part(const Touched& shape, Index part) {
  return shape.model.contact.parts[part].name;
}

}  // namespace

TEST(ContactForces, ABlockOnAFloorPressesWithItsLoadOverItsArea) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = pressed_block({3, 3, 2}, {12, 12, 8}, 0.5, Halfspace{{3, -4, -0.05}, {0, 0, 2}});
    spec.mesh_options.quadratic = quadratic;
    const Touched shape = touched(spec);
    ASSERT_EQ(shape.contacts.pairs.size(), 1u);
    const PairForces& floor = shape.contacts.pairs[0];
    EXPECT_EQ(name_of_part(shape, floor.a), "robot");
    EXPECT_EQ(name_of_part(shape, floor.b), "below");
    const double load = -shape.supports[0].force.z();
    EXPECT_GT(load, 5);
    EXPECT_LT((floor.force - load * Vec3::UnitZ()).norm(), 1e-9 * load);
    EXPECT_NEAR(floor.normal_N, load, 1e-9 * load);
    EXPECT_LT(floor.moment.norm(), 1e-9 * load);

    const auto robot = shape.found.state.positions.topRows(shape.model.robot_vertices());
    const double across = robot.col(0).maxCoeff() * robot.col(1).maxCoeff();
    EXPECT_GT(across, 144);
    EXPECT_NEAR(floor.area_mm2, across, 1e-3 * across);
    EXPECT_NEAR(floor.gap_mm, robot.col(2).minCoeff() + 0.05, 1e-12);
    EXPECT_NEAR(floor.center.x(), robot.col(0).maxCoeff() / 2, 0.01);
    EXPECT_NEAR(floor.center.y(), robot.col(1).maxCoeff() / 2, 0.01);
    EXPECT_NEAR(floor.center.z(), robot.col(2).minCoeff(), 1e-3);
    const double pressure = 1e3 * load / across;
    EXPECT_NEAR(floor.pressure_kPa, pressure, 0.02 * pressure);
    for (Index v = 0; v < shape.model.rest.rows(); ++v) {  // rim, corners and nodes in the middle of edges alike
      const bool below = v < robot.rows() && shape.model.rest(v, 2) == 0;
      EXPECT_NEAR(shape.contacts.pressure_kPa[v], below ? pressure : 0, 0.02 * pressure)
          << shape.model.rest.row(v) << (quadratic ? " order 2" : "");
    }
  }
}

TEST(ContactForces, AreInBalanceWithSupportsAndWeight) {
  RobotSpec spec = physical_robot(block_mesh({6, 2, 2}, {60, 10, 10}));
  spec.materials[0].elastic->youngs_modulus = 0.5;
  spec.materials[0].density = 1100;
  spec.loads.gravity = {1, 2, -30};
  spec.contact =
      touching(0.3, {obstacle("ball", Sphere{{45, 5, -11}, 9}), obstacle("wall", Halfspace{{0, 10.5, 0}, {0, -1, 0}})});
  const Touched shape = touched(spec);
  ASSERT_GE(shape.contacts.pairs.size(), 1u);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double size = 0;
  for (Index v = 0; v < shape.model.rest.rows(); ++v) {
    const Vec3 load = shape.model.loads.dead.row(v), place = shape.found.state.positions.row(v);
    force += load;
    moment += place.cross(load);
    size += load.norm();
  }
  for (const Reaction& support : shape.supports) {
    force += support.force;
    moment += support.moment + support.center.cross(support.force);
  }
  for (const PairForces& pair : shape.contacts.pairs) {
    EXPECT_GT(pair.normal_N, 1e-3);
    force += pair.force;
    moment += pair.moment + pair.center.cross(pair.force);
  }
  EXPECT_LT(force.norm(), 1e-9 * size);
  EXPECT_LT(moment.norm(), 1e-9 * size * shape.model.diagonal_mm);
  // pressures of vertices times their tributary areas add up to the forces: no peak, nothing lost
  double greatest = 0, sum = 0;
  for (const PairForces& pair : shape.contacts.pairs) {
    sum += pair.normal_N;
    greatest = std::max(greatest, pair.pressure_kPa);
    EXPECT_GE(1e-3 * pair.pressure_kPa * pair.area_mm2, pair.normal_N * 0.99);
  }
  EXPECT_LE(greatest, 1e3 * sum / 2);  // the least vertex has more than 2 mm^2 below
}

/// A post under the middle of one of two triangles: nothing of the robot but guards feels it.
TEST(ContactForces, WhatPushesBetweenVerticesIsSpreadOverTheirArea) {
  const Touched shape = touched(pressed_block({1, 1, 1}, {12, 12, 12}, 0.3, Box{{3, 7, -2}, {3.6, 7.5, -0.05}}));
  ASSERT_EQ(shape.contacts.pairs.size(), 1u);
  const PairForces& post = shape.contacts.pairs[0];
  const double load = -shape.supports[0].force.z();
  EXPECT_GT(load, 0.05);
  EXPECT_NEAR(post.force.z(), load, 1e-9 * load);
  EXPECT_NEAR(post.center.x(), 3.3, 0.35);
  EXPECT_NEAR(post.center.y(), 7.25, 0.3);
  // both triangles of the face below give each corner a third
  double borne = 0;
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(12, 0), std::pair(0, 12), std::pair(12, 12)}) {
    const double area = x == y ? 48 : 24;
    for (Index v = 0; v < shape.model.robot_vertices(); ++v)
      if (shape.model.rest.row(v).transpose() == Vec3(x, y, 0)) borne += 1e-3 * shape.contacts.pressure_kPa[v] * area;
  }
  EXPECT_NEAR(borne, load, 0.03 * load);
}

namespace {

/// A block that is pushed down on another one, which stands 3 mm aside.
RobotSpec two_blocks() {
  Mesh mesh = layered_mesh({2, 2, 5}, {20, 20, 20}, Split::six, Split::six);
  std::erase_if(mesh.tetrahedra, [&](const Tetrahedron& t) {
    double low = 20, high = 0;
    for (const Index v : t) low = std::min(low, mesh.vertices(v, 2)), high = std::max(high, mesh.vertices(v, 2));
    return low == 8 && high == 12;
  });
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices(v, 2) > 10) mesh.vertices.row(v) += Vec3(3, 0, -3.5).transpose();
  add_volume_region(mesh, "upper", [](const Vec3& p) { return p.z() > 8.4; });
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.fixed = {held({Halfspace{{0, 0, 1}, {0, 0, -1}}, {}}, {true, true, true}),
                held({Halfspace{{0, 0, 16}, {0, 0, 1}}, {}}, {true, true, true}, {0, 0, -1})};
  spec.contact = touching(0.05);
  return spec;
}

}  // namespace

TEST(ContactForces, OfRegionsAreEqualAndOppositeToWhatHoldsThem) {
  RobotSpec spec = two_blocks();
  spec.contact->pairs = {{"robot", "upper", 0, {}}};
  const Touched shape = touched(spec);
  ASSERT_EQ(shape.contacts.pairs.size(), 1u);
  const PairForces& pair = shape.contacts.pairs[0];
  EXPECT_EQ(name_of_part(shape, pair.a), "robot");
  EXPECT_EQ(name_of_part(shape, pair.b), "upper");
  const Vec3 bottom = shape.supports[0].force;
  EXPECT_GT(bottom.z(), 1);
  EXPECT_LT((pair.force + bottom).norm(), 1e-9 * bottom.norm());  // b pushes down on a
  EXPECT_LT((pair.force - shape.supports[1].force).norm(), 1e-9 * bottom.norm());
  EXPECT_GT(pair.center.x(), 3);
  EXPECT_LT(pair.center.x(), 20);
  EXPECT_GT(pair.area_mm2, 200);
  EXPECT_LT(pair.area_mm2, 420);
}

TEST(ContactForces, OfAPartWithItselfCountOnce) {
  const Touched shape = touched(two_blocks());
  ASSERT_EQ(shape.contacts.pairs.size(), 1u);
  const PairForces& pair = shape.contacts.pairs[0];
  EXPECT_EQ(pair.a, pair.b);
  EXPECT_EQ(pair.force, Vec3::Zero().eval());
  EXPECT_EQ(pair.moment, Vec3::Zero().eval());
  const double load = shape.supports[0].force.norm();
  EXPECT_NEAR(pair.normal_N, load, 0.01 * load);  // some of it acts at an angle at the rim
  EXPECT_GT(pair.area_mm2, 200);
  EXPECT_LT(pair.area_mm2, 420);
  // both sides carry it
  double low = 0, high = 0;
  for (Index v = 0; v < shape.model.rest.rows(); ++v)
    (shape.model.rest(v, 2) < 8.2 ? low : high) += shape.contacts.pressure_kPa[v];
  EXPECT_GT(low, 0);
  EXPECT_NEAR(low / high, 1, 0.5);
}

TEST(ContactForces, NothingWhereNothingTouches) {
  const RobotSpec apart = pressed_block({2, 2, 2}, {12, 12, 12}, 0.5, Halfspace{{0, 0, -2}, {0, 0, 1}});
  const Touched shape = touched(apart);
  EXPECT_TRUE(shape.contacts.pairs.empty());
  for (const double pressure : shape.contacts.pressure_kPa) EXPECT_EQ(pressure, 0);
  RobotSpec without = apart;
  without.contact.reset();
  const Model model = compile(without);
  const Statics statics(model);
  EXPECT_FALSE(statics.measured(solve_converged(statics, model.rest_actuation()).state).contacts.has_value());
}

}  // namespace softkin
