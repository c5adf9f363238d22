#include "statics/physical_samples.hpp"

/// Layers of dielectric elastomer: F = F_e F_a, F_a = diag(sqrt(ratio), sqrt(ratio), 1 / ratio).

namespace softkin {

namespace {

using namespace testing;

/// A plate of prisms of which a region is the layer, held by three vertices so that it may grow freely.
RobotSpec layered_plate(const std::array<int, 3>& cells, const Vec3& size, double layer_above) {
  Mesh mesh = block_mesh(cells, size, Split::prisms);
  add_volume_region(mesh, "layer", [&](const Vec3& p) { return p.z() > layer_above; });
  RobotSpec spec = physical_robot(std::move(mesh));
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "layer"}, 0.3, 3, true);
  spec.actuators = {skin};
  return spec;
}

}  // namespace

TEST(PhysicalDea, AFreeLayerTakesItsStretchWithoutStress) {
  for (const Law law : {Law::neo_hookean, Law::st_venant_kirchhoff, Law::yeoh, Law::gent}) {
    const std::array<int, 3> cells{5, 4, 1};
    RobotSpec spec = layered_plate(cells, {20, 12, 1}, -1);
    spec.materials[0].elastic = elastic(law, 1, 0.45);
    const Index along_x = grid_vertex(cells, 5, 0, 0), along_y = grid_vertex(cells, 0, 4, 0);
    spec.fixed = {{{VertexList{{0}}, {}}, {true, true, true}},
                  {{VertexList{{along_x}}, {}}, {false, true, true}},
                  {{VertexList{{along_y}}, {}}, {false, false, true}}};
    const Model model = compile(spec);
    const Statics statics(model);
    for (const double ratio : {0.6, 1.0, 1.5, 2.5}) {
      const Equilibrium found = solve_converged(statics, values({ratio}));
      const Vec3 stretch(std::sqrt(ratio), std::sqrt(ratio), 1 / ratio);
      EXPECT_LT(distance(found.state.positions, model.rest * stretch.asDiagonal()), 1e-7) << ratio;
      EXPECT_NEAR(found.report.energy, 0, 1e-10);
      EXPECT_EQ(found.state.multipliers[0], 0);
    }
  }
}

/// A layer that grows bends its carrier away from itself. Curvature of a beam of two layers of one modulus and
/// equal heights h, one of which wants a strain e more than the other: 3 e / (4 h) (Timoshenko 1925); a plate that is
/// clamped at one end curls across too, by less than that.
TEST(PhysicalDea, ABilayerBendsAway) {
  const double length = 40, height = 1;
  RobotSpec spec = layered_plate({80, 2, 4}, {length, 2, 2 * height}, height);
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0);
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  const Model model = compile(spec);
  const Statics statics(model);
  for (const double strain : {0.01, -0.01}) {
    const Equilibrium found = solve_converged(statics, values({(1 + strain) * (1 + strain)}));
    const double drop = height - marker_at(model, found)[2];
    EXPECT_GT(drop * strain, 0);
    EXPECT_NEAR(drop, 3 * strain / (4 * height) * length * length / 2, 0.1 * std::abs(drop));
  }
  const Equilibrium far = solve_converged(statics, values({1.1}));
  EXPECT_LT(marker_at(model, far)[2], -10);
}

/// The predictor's derivative in the ratio counts: from rest in few steps.
TEST(PhysicalDea, ComesFromRestToTheEndsOfItsRange) {
  RobotSpec spec = layered_plate({10, 4, 2}, {20, 8, 1}, 0.5);
  const Model model = compile(spec);
  const Statics statics(model);
  for (const double ratio : {0.3, 3.0}) {
    const Equilibrium found = statics.solve(values({ratio}), statics.rest());
    EXPECT_EQ(found.report.status, Status::converged) << ratio << ": " << found.report.remark;
    EXPECT_LT(found.report.iterations, 200);
  }
}

}  // namespace softkin
