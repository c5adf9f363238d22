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
Response stretch(testing::Split split, double shape_ratio, bool all_axes) {
  RobotSpec spec = testing::block_robot(testing::block_mesh({4, 4, 4}, {cube_edge, cube_edge, cube_edge}, split));
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

}  // namespace softkin
