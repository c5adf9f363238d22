#include <Eigen/Dense>
#include <numbers>
#include <softkin/model/layer.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/physical_equations.hpp"
#include "statics/sensitivity_samples.hpp"

/// Sheets on the body: composite beams, plates that a body of nearly nothing carries, wrinkles.

namespace softkin {

namespace {

using namespace testing;

LayerSpec sheet(const std::string& region, double thickness_mm, double modulus, double nu) {
  LayerSpec layer;
  layer.name = region;
  layer.where = RegionRef{region, {}};
  layer.thickness_mm = thickness_mm;
  layer.e1 = layer.e2 = modulus;
  layer.g12 = modulus / (2 * (1 + nu));
  layer.nu12 = nu;
  return layer;
}

void lay(RobotSpec& spec, const LayerSpec& layer) {
  spec.layers.push_back(std::make_shared<const LayerSpec>(layer));
}

/// A strip clamped at one end with a small force across the other: its deflection there [mm].
double deflection(RobotSpec spec, double force_N) {
  spec.loads.forces = {{"push", {std::string("x_high"), {}}, {0, 0, force_N}}};
  spec.markers = {{"tip", {std::string("x_high"), {}}}};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  return model.markers[0].point.at(found.state.positions).z() - model.markers[0].point.at(model.rest).z();
}

struct Shaped {
  double energy = 0, pull_N = 0;
};

/// Of the layers alone, the last term.
Shaped energy_of_layers(PhysicalEquations& at, const Points& positions) {
  const physical::Term& layers = *at.system.terms().back();
  Points gradient = Points::Zero(positions.rows(), 3);
  physical::Term::Sum sum{gradient};
  physical::Iterate there = at.at;
  there.positions = positions;
  const auto scratch = layers.new_scratch();
  layers.evaluate(there, at.load_state, *scratch, sum, at.team);
  return {sum.energy, gradient.norm()};
}

/// A square plate on a body of nearly nothing, under its weight: how far its middle sinks [mm].
struct WeighedPlate {
  static constexpr double side = 40, thickness = 0.5, modulus = 100, nu = 0.3, density = 100;
  int cells = 24;
  bool clamped = false;

  [[nodiscard]] double load() const { return density * 1e-9 * 9.81 * thickness; }  // [N/mm^2]
  [[nodiscard]] double rigidity() const { return modulus * std::pow(thickness, 3) / (12 * (1 - nu * nu)); }

  [[nodiscard]] double sinks() const {
    const double cell = side / cells, out = clamped ? cell : 0;
    const double all = side + 2 * out;
    RobotSpec spec = physical_robot(
        block_mesh({cells + (clamped ? 2 : 0), cells + (clamped ? 2 : 0), 1}, {all, all, 2 * cell}, Split::five));
    spec.mesh_options.quadratic = true;
    spec.materials[0].elastic = elastic(Law::neo_hookean, 1e-9, 0);
    spec.loads.gravity = {0, 0, -9.81};
    LayerSpec layer = sheet("z_high", thickness, modulus, nu);
    layer.bending = true;
    layer.density = density;
    lay(spec, layer);
    VertexList edge, held;
    for (Index v = 0; v < spec.mesh.vertices.rows(); ++v) {
      const Vec3 p = vertex_at(spec.mesh.vertices, v);
      const double in = std::min({p.x(), p.y(), all - p.x(), all - p.y()});
      if (in < out + 1e-9) (p.z() > 2 * cell - 1e-9 ? edge : held).vertices.push_back(v);
    }
    spec.fixed = {{{Selector(edge), {}}, {clamped, clamped, true}}, {{Selector(held), {}}, {true, true, false}}};
    spec.markers = {{"middle", {Vec3(all / 2, all / 2, 2 * cell), {}}}};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, model.rest_actuation());
    return 2 * cell - model.markers[0].point.at(found.state.positions).z();
  }
};

}  // namespace

TEST(Layers, StiffenAStripAsACompositeBeam) {
  constexpr double length = 60, width = 4, height = 3, modulus = 1, force = 1e-4, held = 3;
  constexpr double thickness = 0.05, stiff = 60, bends_itself = 40;
  for (const bool bending : {false, true}) {
    RobotSpec spec = physical_robot(block_mesh({20, 2, 1}, {length, width, height}));
    spec.mesh_options.quadratic = true;
    spec.materials[0].elastic = elastic(Law::neo_hookean, modulus, 0);
    spec.fixed = {{{Selector(Box{{-1, -1, -1}, {held, 9, 9}}), {}}, {true, true, true}}};
    const double plain = deflection(spec, force);
    EXPECT_NEAR(plain, force * std::pow(length - held, 3) / (3 * modulus * width * std::pow(height, 3) / 12),
                0.01 * plain);
    LayerSpec layer = sheet("z_high", thickness, stiff, 0);
    if (bending) {  // thick in itself: as much as the strip
      layer.thickness_mm = height;
      layer.e1 = layer.e2 = bends_itself;
      layer.g12 = bends_itself / 2;
      layer.bending = true;
    }
    lay(spec, layer);
    const double sheet_EA = layer.e1 * layer.thickness_mm, body_EA = modulus * height;
    const double axis = (body_EA * height / 2 + sheet_EA * height) / (body_EA + sheet_EA);
    const double rigidity =
        width * (body_EA * (height * height / 12 + std::pow(axis - height / 2, 2)) +
                 sheet_EA * std::pow(height - axis, 2) + (bending ? layer.e1 * std::pow(height, 3) / 12 : 0));
    const double expected = force * std::pow(length - held, 3) / (3 * rigidity);
    EXPECT_NEAR(deflection(spec, force), expected, 0.01 * expected) << bending;
  }
}

TEST(Layers, PlatesSinkAsKirchhoffSays) {
  WeighedPlate plate;
  const double scale = plate.load() * std::pow(WeighedPlate::side, 4) / plate.rigidity();
  EXPECT_NEAR(plate.sinks() / scale, 0.0040624, 0.01 * 0.0040624);  // Timoshenko: supported all around
  plate.clamped = true;
  EXPECT_NEAR(plate.sinks() / scale, 0.0012653, 0.01 * 0.0012653);  // the same, clamped
}

TEST(Layers, StoreWhatAQuadraticSurfaceHas) {
  RobotSpec spec = physical_robot(block_mesh({5, 5, 1}, {10, 10, 2}));
  const Points apart = noise(spec.mesh.vertices.rows(), 0.3, 3);
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)  // irregular, but flat and with its border
    for (int axis = 0; axis < 2; ++axis)
      if (const double p = spec.mesh.vertices(v, axis); p > 0 && p < 10) spec.mesh.vertices(v, axis) += apart(v, axis);
  spec.mesh_options.quadratic = true;
  LayerSpec layer = sheet("z_high", 0.3, 5, 0);
  layer.e2 = 2;
  layer.nu12 = 0.3;
  layer.g12 = 0.8;
  layer.direction = Vec3(1, 0, 0);
  layer.bending = true;
  lay(spec, layer);
  PhysicalEquations at(compile(spec));
  const Vec3 curvature = 1e-6 * Vec3(1.2, -0.7, 2 * 0.9);  // 11, 22, 2 12
  Points bent = at.model.rest;
  for (Index v = 0; v < bent.rows(); ++v) {
    const double x = bent(v, 0), y = bent(v, 1);
    bent(v, 2) += curvature[0] * x * x / 2 + curvature[1] * y * y / 2 + curvature[2] * x * y / 2 + 1e-5 * x;
  }
  const double per_area =
      std::pow(0.3, 3) / 24 * curvature.dot(at.model.reinforcement.layers[0]->law.stiffness * curvature);
  EXPECT_NEAR(energy_of_layers(at, bent).energy, 100 * per_area, 1e-4 * 100 * per_area);
}

TEST(Layers, AnswerAsTheirDirectionSays) {
  constexpr double e1 = 50, e2 = 5, g12 = 2, nu12 = 0.3, thickness = 0.1, pull = 1e-5;
  for (const double degrees : {0.0, 25.0, 60.0, 90.0}) {
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    RobotSpec spec = physical_robot(block_mesh({2, 2, 1}, {10, 10, 2}));
    LayerSpec layer = sheet("z_low", thickness, e1, 0);
    layer.e2 = e2;
    layer.g12 = g12;
    layer.nu12 = nu12;
    layer.direction = Vec3(c, s, 7);  // laid onto the face
    lay(spec, layer);
    // pulled along x, in its own directions
    const double e11 = pull * (c * c / e1 - nu12 / e1 * s * s), e22 = pull * (s * s / e2 - nu12 / e1 * c * c);
    const double e12 = -pull * c * s / (2 * g12);
    Eigen::Matrix2d strain, turn;
    strain << e11, e12, e12, e22;
    turn << c, -s, s, c;
    Mat3 stretch = Mat3::Identity();
    stretch.topLeftCorner<2, 2>() += turn * strain * turn.transpose();
    PhysicalEquations at(compile(spec));
    const Shaped shaped = energy_of_layers(at, at.model.rest * stretch.transpose());
    const double soft = std::pow(c, 4) / e1 + std::pow(s, 4) / e2 + c * c * s * s * (1 / g12 - 2 * nu12 / e1);
    EXPECT_NEAR(shaped.energy, 100 * thickness * pull * pull * soft / 2, 1e-4 * shaped.energy) << degrees;
  }
}

TEST(Layers, WrinkleWhereTheyWouldBePressed) {
  constexpr double modulus = 10, nu = 0.3, thickness = 0.1, longer = 0.05, narrower = 0.08, side = 10;
  for (const bool tension_only : {false, true}) {
    RobotSpec spec = physical_robot(block_mesh({2, 2, 1}, {side, side, 2}));
    spec.materials[0].elastic = elastic(Law::neo_hookean, 1e-7, 0);
    LayerSpec layer = sheet("z_low", thickness, modulus, nu);
    layer.tension_only = tension_only;
    lay(spec, layer);
    spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                  {{std::string("x_high"), {}}, {true, false, false}, {longer * side, 0, 0}, "pulled"},
                  {{std::string("y_low"), {}}, {false, true, false}},
                  {{std::string("y_high"), {}}, {false, true, false}, {0, -narrower * side, 0}},
                  {{std::string("z_low"), {}}, {false, false, true}}};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, model.rest_actuation());
    const ElementDeformation measured = statics.measured(found.state);
    const double force = reactions(model, found.state.positions, measured)[1].force.x();
    const double e11 = longer + longer * longer / 2, e22 = -narrower + narrower * narrower / 2;
    const double stress = tension_only ? modulus * e11 : modulus / (1 - nu * nu) * (e11 + nu * e22);
    EXPECT_NEAR(force, (1 + longer) * stress * thickness * side, 2e-5 * force) << tension_only;
    ASSERT_EQ(measured.layers.size(), 1u);
    EXPECT_EQ(measured.layers[0].wrinkled, tension_only ? 1 : 0);
    EXPECT_NEAR(measured.layers[0].strain, longer, 1e-9);
    EXPECT_NEAR(measured.layers[0].largest_N_mm, force / (side * (1 - narrower)), 1e-5 * force);
  }
}

TEST(Layers, OfASurfaceThatElementsCarryAreThoseOfTheirFaces) {
  RobotSpec spec = physical_robot(block_mesh({4, 2, 2}, {20, 10, 8}));
  spec.loads.forces = {{"push", {std::string("x_high"), {}}, {0, 0.05, 0.1}}};
  LayerSpec layer = sheet("z_high", 0.1, 20, 0.3);
  RobotSpec carried = spec;
  lay(spec, layer);
  TriangleSurface surface;
  surface.vertices = spec.mesh.vertices;
  for (const Triangle& t : boundary_of(spec.mesh.tetrahedra, spec.mesh.prisms).triangles)
    if (std::all_of(t.begin(), t.end(), [&](Index v) { return spec.mesh.vertices(v, 2) > 8 - 1e-9; }))
      surface.triangles.push_back(t);
  layer.where = surface;
  lay(carried, layer);
  const Model by_faces = compile(spec), by_surface = compile(carried);
  const Equilibrium one = solve_converged(Statics(by_faces), by_faces.rest_actuation());
  const Equilibrium other = solve_converged(Statics(by_surface), by_surface.rest_actuation());
  EXPECT_LT(distance(one.state.positions, other.state.positions), 1e-8);
  EXPECT_GT(distance(one.state.positions, by_faces.rest), 0.2);
}

TEST(Layers, StoreNothingOfATurn) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 1}, {12, 8, 2}));
  spec.mesh_options.quadratic = true;
  LayerSpec layer = sheet("z_high", 0.2, 5, 0.3);
  layer.bending = true;
  lay(spec, layer);
  PhysicalEquations at(compile(spec));
  const Mat3 turn = Eigen::AngleAxisd(2.5, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Shaped still = energy_of_layers(at, at.model.rest * turn.transpose());
  EXPECT_LT(still.energy, 1e-20);
  EXPECT_LT(still.pull_N, 1e-10);
  const Points shaken = at.model.rest + noise(at.model.rest.rows(), 0.3, 3);
  const double energy = energy_of_layers(at, shaken).energy;
  EXPECT_GT(energy, 0.1);
  EXPECT_NEAR(energy_of_layers(at, shaken * turn.transpose()).energy, energy, 1e-10 * energy);
}

}  // namespace softkin
