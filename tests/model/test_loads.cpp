#include <gtest/gtest.h>

#include <cmath>
#include <softkin/model/names.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

RobotSpec heavy_block(Split split) {
  Mesh mesh = block_mesh({3, 2, 2}, {30, 20, 10}, split);
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 3, -9.81};
  return spec;
}

/// Moments of a load: sum of x_i f_i over the vertices, a component of f a column.
Mat3 moments(const Model& model) {
  return model.rest.transpose() * model.loads.dead;
}

TEST(Loads, AreAnyOfThoseThatActUncommanded) {
  const std::array<Vec3, 2> range{Vec3(-1, -1, -1), Vec3(1, 1, 1)};
  EXPECT_FALSE(LoadsSpec{}.any());
  EXPECT_FALSE((LoadsSpec{.forces = {{"commanded", {}, {0, 0, 0}, range, {0, 0, 0}, range}}}.any()));
  EXPECT_TRUE((LoadsSpec{.gravity = {0, -1, 0}}.any()));
  EXPECT_TRUE((LoadsSpec{.forces = {{"push", {}, {0, 0, 2}}}}.any()));
  EXPECT_TRUE((LoadsSpec{.forces = {{"turn", {}, {0, 0, 0}, {}, {0, 3, 0}}}}.any()));
  EXPECT_TRUE((LoadsSpec{.tractions = {{}}}.any()));
  EXPECT_TRUE((LoadsSpec{.liquid_around = LiquidAroundSpec{}}.any()));
}

TEST(DeadLoad, WeighsABlock) {
  for (const Split split : {Split::five, Split::six, Split::prisms}) {
    const RobotSpec spec = heavy_block(split);
    const Model model = compile(spec);
    ASSERT_EQ(model.loads.dead.rows(), model.rest.rows());
    const Vec3 weight = 6e-6 * 1100 * spec.loads.gravity;  // 6000 mm^3
    EXPECT_LT((model.loads.dead.colwise().sum().transpose() - weight).norm(), 1e-14);
    EXPECT_LT((moments(model) - Vec3(15, 10, 5) * weight.transpose()).norm(), 1e-12) << "acts at the centroid";
  }
}

TEST(DeadLoad, OfATaperedPrismActsAtItsCentroid) {
  // a frustum of unit height over the triangle (0, 0), (3, 0), (0, 3), its top scaled by s about (0, 0)
  RobotSpec spec = heavy_block(Split::prisms);
  const double s = 0.4;
  spec.mesh = Mesh();
  spec.mesh.vertices.resize(6, 3);
  spec.mesh.vertices << 0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 1, 3 * s, 0, 1, 0, 3 * s, 1;
  spec.mesh.prisms = {{0, 1, 2, 3, 4, 5}};
  spec.fixed = {{shaped(VertexList{{0, 1, 2}}), {true, true, true}}};
  const Model model = compile(spec);
  // scale 1 - (1 - s) z: area 9/2 scale^2, centroid at scale (1, 1)
  const auto power = [&](int n) { return (1 - std::pow(s, n + 1)) / ((n + 1) * (1 - s)); };
  const double volume = 4.5 * power(2), x = 4.5 * power(3);
  const double z = 4.5 * (power(2) - power(3)) / (1 - s);
  const Vec3 unit = 1100e-9 * spec.loads.gravity;
  EXPECT_LT((model.loads.dead.colwise().sum().transpose() - volume * unit).norm(), 1e-18);
  EXPECT_LT((moments(model) - Vec3(x, x, z) * unit.transpose()).norm(), 1e-18);
}

TEST(DeadLoad, EveryMaterialHasItsDensity) {
  RobotSpec spec = heavy_block(Split::six);
  add_volume_region(spec.mesh, "tip", [](const Vec3& p) { return p[0] > 20; });
  spec.materials.push_back(spec.materials[0]);
  spec.materials[1].region = "tip";
  spec.materials[1].density = 0;
  Model model = compile(spec);
  EXPECT_NEAR(model.loads.dead.col(2).sum(), -4e-6 * 1100 * 9.81, 1e-14);
  EXPECT_TRUE(has_note(model, "The material of region 'tip' has no density and so no weight."));
  spec.materials[1].density = 2200;
  model = compile(spec);
  EXPECT_NEAR(model.loads.dead.col(2).sum(), -8e-6 * 1100 * 9.81, 1e-14);
  EXPECT_TRUE(model.notes.empty());
}

TEST(DeadLoad, AChamberHasNoWeight) {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.actuators.push_back(chamber("chamber"));
  spec.materials[0].density = 1000;
  spec.loads.gravity = {0, 0, -10};
  EXPECT_NEAR(compile(spec).loads.dead.col(2).sum(), -0.26, 1e-14);
}

TEST(DeadLoad, ForcesActAtPointsAndOnRegions) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 2}, {30, 20, 10}));
  EXPECT_EQ(compile(spec).loads.dead, Points::Zero(compile(spec).rest.rows(), 3));
  spec.loads.forces = {{"push", at(12, 3, 4), {1, 2, 3}}, {"", mean("x_high"), {0, 0, -4}}};
  const Model model = compile(spec);
  EXPECT_LT((model.loads.dead.colwise().sum().transpose() - Vec3(1, 2, -1)).norm(), 1e-14);
  const Mat3 expected = Vec3(12, 3, 4) * Vec3(1, 2, 3).transpose() + Vec3(30, 10, 5) * Vec3(0, 0, -4).transpose();
  EXPECT_LT((moments(model) - expected).norm(), 1e-12);
}

/// A commanded force is no dead load, but for what is not commanded of it.
TEST(CommandedForce, IsOfTheAxesThatHaveARange) {
  RobotSpec spec = heavy_block(Split::six);
  spec.loads.gravity = Vec3::Zero();
  spec.loads.forces = {{"push", mean("x_high"), {1, 2, 3}, std::array<Vec3, 2>{Vec3(-2, 2, -4), Vec3(2, 2, 4)}}};
  const Model model = compile(spec);
  EXPECT_LT((model.loads.dead.colwise().sum() - Vec3(0, 2, 0).transpose()).norm(), 1e-12);
  ASSERT_EQ(model.actuators.size(), 2u);
  for (const Actuator& command : model.actuators) {
    const auto& force = std::get<ForceCommand>(command.drive);
    EXPECT_FALSE(drives(command));
    double sum = 0, area = 0;
    for (const double weight : force.place->weights) sum += weight;
    EXPECT_NEAR(sum, 1, 1e-12);
    for (const CavityFace& face : force.faces) {
      const Vec3 a = vertex_at(model.rest, face.corners[0]);
      area += (vertex_at(model.rest, face.corners[1]) - a).cross(vertex_at(model.rest, face.corners[2]) - a).norm() / 2;
      EXPECT_NEAR(a.x(), model.rest.col(0).maxCoeff(), 1e-12);
    }
    EXPECT_NEAR(area,
                (model.rest.col(1).maxCoeff() - model.rest.col(1).minCoeff()) *
                    (model.rest.col(2).maxCoeff() - model.rest.col(2).minCoeff()),
                1e-9);
  }
  EXPECT_EQ(model.actuators[0].name, "push_fx");
  EXPECT_EQ(model.actuators[1].name, "push_fz");
  EXPECT_EQ(model.actuators[1].rest, 3);
}

TEST(DeadLoad, Refusals) {
  RobotSpec good = heavy_block(Split::six);
  good.loads.forces = {{"push", at(30, 3, 4), {1, 2, 3}}};
  expect_refused(good,
                 {
                     {"density", [](RobotSpec& s) { s.materials[0].density = 0; },
                      "block: there is gravity but no material or layer has a density"},
                     {"gravity", [](RobotSpec& s) { s.loads.gravity[1] = NAN; }, "block: gravity is not finite"},
                     {"force", [](RobotSpec& s) { s.loads.forces[0].force[0] = INFINITY; },
                      "robot.yaml:5: force 'push' is not finite"},
                     {"far", [](RobotSpec& s) { s.loads.forces[0].at = at(90, 0, 0); },
                      "the point of force 'push' is 60 mm from the mesh"},
                     {"region", [](RobotSpec& s) { s.loads.forces[0].at = mean("x_hihg"); }, "did you mean 'x_high'?"},
                 });
}

TEST(CommandedForce, Refusals) {
  RobotSpec good = heavy_block(Split::six);
  good.loads.forces = {{"push", at(30, 3, 4), {1, 0, 0}, std::array<Vec3, 2>{Vec3(-2, 0, -2), Vec3(2, 0, 2)}}};
  EXPECT_EQ(compile(good).actuators.size(), 2u);
  expect_refused(good,
                 {
                     {"name", [](RobotSpec& s) { s.loads.forces[0].name = ""; }, "is commanded, and so needs a name"},
                     {"infinite", [](RobotSpec& s) { (*s.loads.forces[0].range)[1][0] = INFINITY; }, "not finite"},
                     {"order", [](RobotSpec& s) { (*s.loads.forces[0].range)[0][2] = 3; },
                      "force 'push' has the range [3, 2] N along z: the low end comes first"},
                     {"outside", [](RobotSpec& s) { s.loads.forces[0].force[0] = 5; },
                      "force 'push' is 5 N along x, outside its range [-2, 2] N"},
                     {"held", [](RobotSpec& s) { s.loads.forces[0].force[1] = 1; },
                      "force 'push' is 1 N along y, outside its range [0, 0] N"},
                 });
}

RobotSpec wrench_block() {
  RobotSpec good = heavy_block(Split::six);
  const std::array<Vec3, 2> range{Vec3(-2, 0, -2), Vec3(2, 0, 2)};
  good.rigid = {{{std::string("x_high"), {}}, "end"}};
  good.loads.forces = {{"tool", mean("x_high"), {1, 0, 0}, range, {0, 0, 1}, range}};
  good.loads.tractions = {{"water", {std::string("z_low"), {}}, true, {0, 0, 0}, 1, std::array<double, 2>{-3, 3}}};
  return good;
}

/// Forces first, then the moment of each, then pressures.
TEST(CommandedWrench, HasAMomentToo) {
  const Model model = compile(wrench_block());
  std::vector<std::string> names;
  for (const Actuator& command : model.actuators) {
    names.push_back(command_column(command));
    EXPECT_TRUE(loads_robot(command));
    EXPECT_FALSE(drives(command));
  }
  EXPECT_EQ(names, (std::vector<std::string>{"tool_fx_N", "tool_fz_N", "tool_mx_Nmm", "tool_mz_Nmm", "water_kPa"}));
  EXPECT_EQ(model.rest_actuation(), (Eigen::VectorXd(5) << 1, 0, 0, 1, 1).finished());
  ASSERT_EQ(model.loads.moments.size(), 1u);
  EXPECT_EQ(model.loads.moments[0].vertices.size(), 3u) << "in a plane";
  EXPECT_TRUE(model.loads.moments[0].moment_Nmm.isZero(0));
  EXPECT_NE(fingerprint_of(model), fingerprint_of(compile(heavy_block(Split::six))));
}

TEST(CommandedWrench, Refusals) {
  expect_refused(
      wrench_block(),
      {
          {"soft", [](RobotSpec& s) { s.rigid.clear(); },
           "the moment of force 'tool' acts on a rigid region, which 'x_high' is not: list it under 'rigid'"},
          {"elsewhere", [](RobotSpec& s) { s.loads.forces[0].at = mean("y_high"); }, "which 'y_high' is not"},
          {"point", [](RobotSpec& s) { s.loads.forces[0].at = at(30, 3, 4); },
           "the moment of force 'tool' acts on a rigid region: give 'region' in place of 'point'"},
          {"infinite", [](RobotSpec& s) { s.loads.forces[0].moment[1] = INFINITY; },
           "the moment of force 'tool' is not finite"},
          {"outside", [](RobotSpec& s) { s.loads.forces[0].moment[0] = 5; },
           "the moment of force 'tool' is 5 N mm along x, outside its range [-2, 2] N mm"},
          {"order",
           [](RobotSpec& s) {
             s.loads.tractions[0].range_kPa = {4, -4};
           },
           "traction 'water' has the range [4, -4] kPa: the low end comes first"},
          {"pressure", [](RobotSpec& s) { s.loads.tractions[0].pressure_kPa = 4; },
           "traction 'water' is 4 kPa, outside its range [-3, 3] kPa"},
          {"name", [](RobotSpec& s) { s.loads.tractions[0].name = "tool_fx"; },
           "the command 'tool_fx' of a load has the name of an actuator"},
      });
}

}  // namespace
