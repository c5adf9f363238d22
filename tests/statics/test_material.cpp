#include <algorithm>
#include <array>
#include <softkin/model/mesh/mesh_joining.hpp>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/target_shape/system.hpp>

#include "statics/robots.hpp"

namespace softkin {

namespace {

constexpr double cube_edge = 10, small_strain = 1e-4;

FixedSpec face(const std::string& region, int axis, double displacement) {
  FixedSpec spec{{region, {}}};
  spec.axes = {axis == 0, axis == 1, axis == 2};
  spec.displacement = displacement * Vec3::Unit(axis);
  return spec;
}

struct Response {
  double stress = 0;       // mean along x at the displaced face [mm^2 of this energy]
  double contraction = 0;  // mean of y and z over the strain
};

/// A cube stretched along x, its sides free, or along all axes; three faces slide in symmetry planes.
Response stretch(testing::Split split, double shape_ratio, bool all_axes,
                 ElementWeights weights = ElementWeights::printed, int cells = 4) {
  RobotSpec spec =
      testing::block_robot(testing::block_mesh({cells, cells, cells}, {cube_edge, cube_edge, cube_edge}, split));
  spec.weights = weights;
  spec.materials[0].shape_ratio = shape_ratio;
  spec.fixed = {face("x_low", 0, 0), face("y_low", 1, 0), face("z_low", 2, 0),
                face("x_high", 0, small_strain * cube_edge)};
  if (all_axes) {
    spec.fixed.push_back(face("y_high", 1, small_strain * cube_edge));
    spec.fixed.push_back(face("z_high", 2, small_strain * cube_edge));
  }
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options;
  options.step_tolerance_mm = 1e-11;
  options.anderson = 10;
  const Points positions = statics.solve(Actuation(0), statics.rest(), options).state.positions;

  const target_shape::System system(model);
  target_shape::System::Scratch scratch = system.make_scratch();
  Team alone(1);
  system.local_step(Actuation(0), positions, scratch, alone);
  Response response;
  double moved = 0;
  int count = 0;
  for (Index v = 0; v < model.rest.rows(); ++v) {
    if (model.rest(v, 0) > cube_edge - 1e-9) response.stress -= 2 * scratch.residual(v, 0) / (cube_edge * cube_edge);
    for (const int axis : {1, 2})
      if (model.rest(v, axis) > cube_edge - 1e-9) {
        moved += positions(v, axis) - cube_edge;
        ++count;
      }
  }
  response.contraction = -moved / count / (small_strain * cube_edge);
  return response;
}

}  // namespace

/// E ~ 6R/(2+R), nu = (1-R)/(2+R), K independent of R hold for an isotropic element metric (sum of x x^T over the
/// centred vertices a multiple of I; shown exactly in TargetShape.RegularTetrahedronIsIsotropic). In these cells it is
/// not: the rotation that fits the vertices best leaves a little shear in a stretched element, which stiffens it and
/// gives it a Poisson's ratio of 0.035 at R = 1 already. Measured: five-tetrahedron cells E within 3.3 %, nu within
/// 0.035, K exact; six-tetrahedron cells (shear along one diagonal) E within 1.1 %, nu within 0.036, K within 15 %.
TEST(Material, BlockUnderTensionFollowsTheShapeRatio) {
  struct Case {
    testing::Split split;
    double e_tolerance, nu_tolerance, k_tolerance;
  };
  for (const Case& c : {Case{testing::Split::five, 0.04, 0.04, 1e-3}, Case{testing::Split::six, 0.02, 0.04, 0.16}}) {
    const double e_1 = stretch(c.split, 1, false).stress, k_1 = stretch(c.split, 1, true).stress;
    for (const double r : {1.0, 0.5, 0.2, 0.1}) {
      const Response tension = stretch(c.split, r, false);
      EXPECT_NEAR(tension.stress / e_1, 3 * r / (2 + r), c.e_tolerance * 3 * r / (2 + r)) << "R_omega " << r;
      EXPECT_NEAR(tension.contraction, (1 - r) / (2 + r), c.nu_tolerance) << "R_omega " << r;
      EXPECT_NEAR(stretch(c.split, r, true).stress / k_1, 1, c.k_tolerance) << "R_omega " << r;
    }
  }
}

/// Printed, a mesh of twice the cells is a quarter as stiff. Else the modulus is 6 w R / (2 + R) on both, times what
/// the shape of the cells leaves of it, as their metric is not isotropic: 0.9 of five tetrahedra, two thirds of six.
TEST(Material, MeshIndependentWeightsGiveOneModulusToEveryMesh) {
  for (const auto& [split, left] : {std::pair(testing::Split::five, 0.9), std::pair(testing::Split::six, 2.0 / 3)})
    for (const double r : {1.0, 0.3}) {
      const auto stress = [&, split = split](ElementWeights weights, int cells) {
        return stretch(split, r, false, weights, cells).stress / small_strain;
      };
      const double modulus = 6 * r / (2 + r), printed = stress(ElementWeights::printed, 4);
      EXPECT_NEAR(stress(ElementWeights::printed, 2) / printed, 4, 0.1) << "R_omega " << r;
      const double coarse = stress(ElementWeights::mesh_independent, 2);
      const double fine = stress(ElementWeights::mesh_independent, 4);
      EXPECT_NEAR(coarse / fine, 1, 0.025) << "R_omega " << r;
      EXPECT_NEAR(fine / modulus, left, 0.02) << "R_omega " << r;
    }
}

/// Two bars in a row, joined by a rigid plate: the one that is held of coarse cells, the other of fine ones. Of one
/// stiffness, each takes half of the elongation; a softer one with E_B / E_A = 3 R / (2 + R) takes 1 / (1 + E_B / E_A).
double fraction_of_second_bar(double shape_ratio, ElementWeights weights) {
  constexpr double length = 40, width = 10, elongation = 0.04;
  Mesh mesh = testing::block_mesh({8, 2, 2}, {length, width, width}, testing::Split::five);
  Mesh second = testing::block_mesh({16, 4, 4}, {length, width, width}, testing::Split::five);
  second.vertices.col(0).array() += length + 5;
  for (Region& region : second.regions) region.name += "_2";
  append(mesh, second);
  RobotSpec spec = testing::block_robot(std::move(mesh));
  spec.weights = weights;
  spec.materials = {spec.materials[0], spec.materials[0]};
  spec.materials[0].region = "body";
  spec.materials[1].region = "body_2";
  spec.materials[1].shape_ratio = shape_ratio;
  spec.fixed = {{{"x_low", {}}}, {{"x_high_2", {}}}};
  spec.fixed[1].displacement = elongation * Vec3::UnitX();
  spec.rigid = {{{Box{{length - 1e-6, -1, -1}, {length + 5 + 1e-6, width + 1, width + 1}}, {}}, "plate"}};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve(Actuation(0), statics.rest());
  EXPECT_EQ(found.report.status, Status::converged);
  const Index on_plate = model.rigid.at(0).vertices.front();
  return 1 - (found.state.positions(on_plate, 0) - model.rest(on_plate, 0)) / elongation;
}

TEST(Material, BarsInARowShareAnElongationByTheirModuliOnAnyMesh) {
  EXPECT_NEAR(fraction_of_second_bar(1, ElementWeights::mesh_independent), 0.5, 0.005);
  EXPECT_NEAR(fraction_of_second_bar(1, ElementWeights::printed), 0.8, 0.005);  // four times as soft
  const double ratio = 3 * 0.25 / 2.25;
  EXPECT_NEAR(fraction_of_second_bar(0.25, ElementWeights::mesh_independent), 1 / (1 + ratio), 0.015);
  EXPECT_NEAR(fraction_of_second_bar(0.25, ElementWeights::printed), 1 / (1 + ratio / 4), 0.015);
}

/// Of elements that are all of one size, the weights are the same but for a factor.
TEST(Material, WeightsAreTheSameWhereAllElementsAreOfOneSize) {
  const auto shape = [](ElementWeights weights) {
    RobotSpec spec = testing::block_robot(testing::block_mesh({6, 3, 3}, {20, 10, 10}, testing::Split::six));
    testing::add_volume_region(spec.mesh, "chamber", [](const Vec3& p) { return (p - Vec3(10, 5, 5)).norm() < 3; });
    ActuatorSpec air = testing::actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 4, true);
    spec.actuators = {air};
    spec.materials[0].shape_ratio = 0.4;
    spec.weights = weights;
    const Model model = compile(spec);
    const Statics statics(model);
    return statics.solve(testing::values({2}), statics.rest()).state.positions;
  };
  const Points printed = shape(ElementWeights::printed), other = shape(ElementWeights::mesh_independent);
  EXPECT_LT((printed - other).cwiseAbs().maxCoeff(), 1e-7);
}

/// Every kind of element: twice as large and deformed alike, it has 2^3 times the energy, and 2^5 times the printed
/// one.
TEST(Material, EnergyGrowsWithTheVolumeAlone) {
  const auto energy = [](ElementWeights weights, double scale) {
    RobotSpec spec = testing::mixed_robot(true, 0.5);
    spec.weights = weights;
    spec.mesh.vertices *= scale;
    for (PointRef& point : spec.actuators[2].as<CableSpec>()->points) std::get<Vec3>(point.point) *= scale;
    const Model model = compile(spec);
    const target_shape::System system(model);
    target_shape::System::Scratch scratch = system.make_scratch();
    Team alone(1);
    const Points positions = model.rest + scale * testing::noise(model.rest.rows(), 0.3, 7);
    return system.local_step(testing::values({1.2, 1.5, 0.8}), positions, scratch, alone);
  };
  EXPECT_NEAR(energy(ElementWeights::mesh_independent, 2) / energy(ElementWeights::mesh_independent, 1), 8, 1e-6);
  EXPECT_NEAR(energy(ElementWeights::printed, 2) / energy(ElementWeights::printed, 1), 32, 1e-5);
}

TEST(Material, NewtonAndAlgorithmOneAgreeForMeshIndependentWeights) {
  RobotSpec spec = testing::mixed_robot(true, 0.5);
  spec.weights = ElementWeights::mesh_independent;
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options;
  options.step_tolerance_mm = 1e-9;
  const Actuation requested = testing::values({1.1, 1.3, 0.9});
  const Equilibrium newton = statics.solve(requested, statics.rest(), options);
  options.solver = Solver::local_global;
  const Equilibrium slow = statics.solve(requested, statics.rest(), options);
  EXPECT_EQ(newton.report.status, Status::converged);
  EXPECT_EQ(slow.report.status, Status::converged);
  EXPECT_LT((newton.state.positions - slow.state.positions).cwiseAbs().maxCoeff(), 1e-6);
  const Sensitivity slopes = statics.sensitivity(newton.state);
  options.solver = Solver::newton;
  for (Index a = 0; a < 3; ++a) {
    constexpr double step = 1e-4;
    const auto at = [&](double change) {
      Actuation moved = requested;
      moved[a] += change;
      return statics.solve(moved, newton.state, options).state.positions;
    };
    const Points difference = (at(step) - at(-step)) / (2 * step);
    EXPECT_LT((difference - slopes.positions[a]).cwiseAbs().maxCoeff(), 1e-4 * difference.cwiseAbs().maxCoeff())
        << "actuator " << a;
  }
}

/// Half of the body and half of its chamber in cells of half the size: a chamber's ratio grows alike in both halves,
/// where the printed rule gives eight times the change to the elements that are eight times as large.
TEST(Material, ChangesOfAChamberAreSharedAlikeByLargeAndSmallElements) {
  const auto spread = [](ElementWeights weights) {
    Mesh mesh = testing::block_mesh({3, 3, 3}, {12, 12, 12}, testing::Split::six);
    Mesh fine = testing::block_mesh({6, 6, 6}, {12, 12, 12}, testing::Split::six);
    const auto inside = [](double low) {
      return [low](const Vec3& p) { return (p - Vec3(low + 6, 6, 6)).cwiseAbs().maxCoeff() < 2; };
    };
    testing::add_volume_region(mesh, "chamber", inside(0));
    fine.vertices.col(0).array() += 20;
    testing::add_volume_region(fine, "chamber", inside(20));
    for (Region& region : fine.regions)
      if (region.dimension == 2) region.name += "_2";
    append(mesh, fine);
    RobotSpec spec = testing::block_robot(std::move(mesh));
    spec.weights = weights;
    spec.fixed = {{{"x_low", {}}}, {{"x_low_2", {}}}};
    ActuatorSpec air = testing::actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 4, true);
    spec.actuators = {air};
    const Model model = compile(spec);
    const target_shape::System system(model);
    target_shape::System::Scratch scratch = system.make_scratch();
    Team alone(1);
    system.local_step(testing::values({1.1}), model.rest, scratch, alone);
    const auto& set = system.sets().pneumatic.at(0);
    const std::vector<energy::Pack>& ratios = scratch.ratios.at(2);  // tetrahedra, prisms, the chamber
    double least = 10, most = 0;
    for (Index e = 0; e < set.count; ++e) {
      const double change = ratios[e / energy::lanes][e % energy::lanes] - 1;
      least = std::min(least, change);
      most = std::max(most, change);
    }
    EXPECT_EQ(set.count, 6 + 48);
    return std::array{least, most};
  };
  const auto alike = spread(ElementWeights::mesh_independent);
  EXPECT_NEAR(alike[0], 0.1, 1e-12);
  EXPECT_NEAR(alike[1], 0.1, 1e-12);
  // by hand: V large elements of 8 v, 8 V small ones of v, V = 6: changes c u with c (6 * 64 + 48) v^2 = 0.1 * 96 v
  const auto printed = spread(ElementWeights::printed);
  EXPECT_NEAR(printed[0], 0.1 * 96 / 432, 1e-12);
  EXPECT_NEAR(printed[1], 8 * 0.1 * 96 / 432, 1e-12);
}

}  // namespace softkin
