#include <Eigen/Geometry>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/sensitivity_samples.hpp"

/// Loads spread over the surface: dead ones, and those that follow it.

namespace softkin {

namespace {

using namespace testing;

TractionSpec traction(const std::string& region, const Vec3& kilopascals, bool follows) {
  return {"wind", {region, {}}, follows, kilopascals, 0};
}

TractionSpec pressure(const std::string& region, double kilopascals, const std::string& name = "water") {
  return {name, {region, {}}, true, {0, 0, 0}, kilopascals};
}

/// An eighth of a block between its planes of symmetry, of nu 0: nominal stresses are E (s - 1) along each axis,
/// whatever pulls along the others.
RobotSpec free_block(const Mesh& mesh, bool quadratic) {
  RobotSpec spec = physical_robot(mesh);
  spec.materials[0].elastic = elastic(Law::corotational, 1, 0);
  spec.mesh_options.quadratic = quadratic;
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}}};
  return spec;
}

/// All kinds of surfaces: triangles, curved faces, quads.
std::vector<RobotSpec> blocks() {
  const Vec3 size(20, 10, 10);
  return {free_block(block_mesh({2, 1, 2}, size), false), free_block(block_mesh({2, 1, 1}, size), true),
          free_block(block_mesh({2, 2, 1}, size, Split::prisms), false)};
}

Vec3 support_force(const Model& model, const Statics& statics, const Equilibrium& found) {
  Vec3 sum = Vec3::Zero();
  for (const Reaction& held : reactions(model, found.state.positions, statics.measured(found.state))) sum += held.force;
  return sum;
}

RobotSpec strip(bool quadratic = true) {
  RobotSpec spec = physical_robot(block_mesh({quadratic ? 12 : 24, 1, 2}, {60, 4, 4}));
  spec.mesh_options.quadratic = quadratic;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0);
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

}  // namespace

/// Nominal stress of a bar that is pulled by a load on its area at rest.
TEST(Tractions, DeadOnesAreNominalStresses) {
  for (RobotSpec spec : blocks())
    for (const double kilopascals : {300.0, -200.0}) {
      spec.loads.tractions = {traction("x_high", {kilopascals, 0, 0}, false)};
      const Model model = compile(spec);
      const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
      EXPECT_NEAR(found.state.positions.col(0).maxCoeff(), 20 * (1 + 1e-3 * kilopascals), 1e-7);
    }
}

/// True stress of a block that is pressed from all sides, by the pressure p on the area that it has then: for stretches
/// s of E (s - 1) = -p s^2.
TEST(Tractions, PressuresAreTrueStresses) {
  for (RobotSpec spec : blocks())
    for (const double kilopascals : {400.0, -90.0}) {
      spec.loads.tractions = {pressure("x_high", kilopascals, "x"), pressure("y_high", kilopascals, "y"),
                              pressure("z_high", kilopascals, "z")};
      const Model model = compile(spec);
      const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
      const double p = 1e-3 * kilopascals, s = (std::sqrt(1 + 4 * p) - 1) / (2 * p);
      EXPECT_LT(distance(found.state.positions, s * model.rest), 1e-7) << s;
    }
}

/// The walls of a chamber as a group of faces: the same shape as under the chamber's pressure.
TEST(Tractions, APressureOnTheWallsOfAChamberIsThatOfTheChamber) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = bending_finger();
    if (quadratic) spec.mesh = block_mesh({6, 3, 3}, {60, 12, 12});
    if (quadratic)
      add_volume_region(spec.mesh, "chamber", [](const Vec3& p) {
        return p.x() > 9 && p.x() < 51 && p.y() > 4 && p.y() < 8 && p.z() > 4 && p.z() < 8;
      });
    spec.mesh_options.quadratic = quadratic;
    spec.actuators = {by_load(spec.actuators[0])};
    const Model by_chamber = compile(spec);
    const Equilibrium expected = solve_converged(Statics(by_chamber), values({80}));
    const Box around = quadratic ? Box{{9, 3.9, 3.9}, {51, 8.1, 8.1}} : Box{{4.9, 3.9, 7.9}, {55.1, 8.1, 12.1}};
    spec.actuators.clear();
    spec.voids.push_back({std::string("chamber"), {}});
    spec.loads.tractions = {{"water", {around, {}}, true, {0, 0, 0}, 80}};
    const Model by_walls = compile(spec);
    const Equilibrium found = solve_converged(Statics(by_walls), by_walls.rest_actuation());
    EXPECT_GT(distance(expected.state.positions, by_chamber.rest), 0.3);
    EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-6);
  }
}

/// Turned with all that holds it the robot keeps its shape: loads that follow turn with it, dead ones do not.
TEST(Tractions, ThoseThatFollowTurnWithTheRobot) {
  for (const bool follows : {true, false}) {
    RobotSpec spec = strip();
    spec.fixed[0].rotation = RotationSpec{{0, 1, 0}, 0, Vec3(0, 0, 0)};
    spec.loads.tractions = {traction("x_high", {0.3, 0.2, -0.4}, follows)};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium straight = solve_converged(statics, values({0})),
                      turned = solve_converged(statics, values({130}));
    EXPECT_GT(distance(straight.state.positions, model.rest), 5);
    const Mat3 rotation = Eigen::AngleAxisd(130 * std::numbers::pi / 180, Vec3(0, 1, 0)).toRotationMatrix();
    const double off = distance(straight.state.positions * rotation.transpose(), turned.state.positions);
    if (follows)
      EXPECT_LT(off, 1e-6);
    else
      EXPECT_GT(off, 5);
  }
}

/// The support carries the traction's force on the surface, whose area is that of the current shape.
TEST(Tractions, TheSupportBearsThem) {
  RobotSpec spec = strip();
  spec.loads.tractions = {traction("z_high", {0.06, 0, -0.04}, false), pressure("y_high", 0.05)};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  Vec3 expected = 1e-3 * 60 * 4 * Vec3(0.06, 0, -0.04);
  for (const LoadedFace& loaded : model.loads.tractions[0].faces) {
    TriangleNodes nodes;
    const std::vector<Index> of = nodes_of(loaded.face);
    for (int i = 0; i < 6; ++i) nodes.row(i) = found.state.positions.row(of[i]);
    for (const TrianglePoint& p : triangle_rule())
      expected -= 5e-5 * p.weight * Vec3(nodes.transpose() * p.along_u).cross(Vec3(nodes.transpose() * p.along_v));
  }
  EXPECT_LT((support_force(model, statics, found) + expected).norm(), 1e-8 * expected.norm());
}

/// A cantilever under a load across its end that stays across it, against an inextensible elastica.
TEST(Tractions, AFollowingLoadBendsACantileverAsTheElasticaSays) {
  const double length = 60, bending = 1.0 * 4 * 64 / 12;  // E b h^3 / 12 [N mm^2]
  // the elastica from the tip, in its frame: theta'' = -(P / EI) times cos of the angle to the load, Runge and Kutta
  const auto tip_angle = [&](double load) {
    const double k = load / bending;
    const int steps = 20000;
    const double h = length / steps;
    double angle = 0, slope = 0;  // theta from the tip's tangent, its derivative: no moment at the tip
    for (int i = 0; i < steps; ++i) {
      const auto curve = [&](double a) { return k * std::cos(a); };
      const double k1 = slope, l1 = curve(angle), k2 = slope + h / 2 * l1, l2 = curve(angle + h / 2 * k1),
                   k3 = slope + h / 2 * l2, l3 = curve(angle + h / 2 * k2), k4 = slope + h * l3,
                   l4 = curve(angle + h * k3);
      angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      slope += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
    }
    return angle;
  };
  RobotSpec spec = strip();
  const double load = 2 * bending / (length * length);
  spec.loads.tractions = {traction("x_high", {0, 0, 1e3 * load / 16}, true)};
  const Model model = compile(spec);
  const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
  // of the end's normal
  Vec3 high = Vec3::Zero(), low = Vec3::Zero();
  for (Index v = 0; v < model.rest.rows(); ++v)
    if (model.elements.used[v] && model.rest(v, 0) == 60) {
      if (model.rest(v, 2) == 4) high += found.state.positions.row(v).transpose();
      if (model.rest(v, 2) == 0) low += found.state.positions.row(v).transpose();
    }
  const Vec3 across = high - low;
  const double turned = std::atan2(-across.x(), across.z());
  EXPECT_NEAR(turned / tip_angle(load), 1, 0.02);
  EXPECT_GT(turned, 0.7);
}

/// The Jacobian against differences, where the load's stiffness is not symmetric.
TEST(Tractions, JacobiansAreThoseOfDifferences) {
  RobotSpec spec = cable_beam();
  spec.loads.tractions = {traction("x_high", {1, 2, 3}, true), pressure("z_high", 2)};
  expect_differences_at(spec, values({0.94, 0.96}));
  spec.actuators = {by_load(spec.actuators[0])};
  expect_differences_at(spec, values({0.3}));
}

TEST(Tractions, AreRefusedWithAReason) {
  const auto refused = [](const TractionSpec& bad, const std::string& why) {
    RobotSpec spec = strip();
    spec.loads.tractions = {bad};
    try {
      (void)compile(spec);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  refused(traction("x_high", {0, 0, 0}, true), "traction 'wind' is 0");
  refused(traction("x_high", {0, 0, std::nan("")}, false), "is not finite");
  refused(traction("nowhere", {0, 0, 1}, false), "nowhere");
  refused({"wind", {Box{{1, 1, 1}, {2, 2, 2}}, {}}, true, {0, 0, 0}, 3}, "holds");
  RobotSpec twice = strip();
  twice.loads.tractions = {pressure("x_high", 1), pressure("y_high", 1)};
  EXPECT_THROW((void)compile(twice), InvalidInput);
  RobotSpec inside = strip();
  Region middle;
  middle.name = "middle";
  middle.dimension = 2;
  const Tetrahedron& t = inside.mesh.tetrahedra[5];
  for (const auto& face : tetrahedron_faces) {
    middle.triangles.push_back(inside.mesh.triangles.size());
    inside.mesh.triangles.push_back({t[face[0]], t[face[1]], t[face[2]]});
  }
  inside.mesh.regions.push_back(middle);
  inside.loads.tractions = {pressure("middle", 1)};
  EXPECT_THROW((void)compile(inside), InvalidInput) << "faces between elements";
}

}  // namespace softkin
