#include <Eigen/Dense>
#include <softkin/model/growth.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/mixed_samples.hpp"
#include "statics/sensitivity_samples.hpp"

/// Growth, swelling and thermal expansion: bodies that are free to follow have no stress, bilayers bend as they should.

namespace softkin {

namespace {

using namespace testing;

ActuatorSpec growth(const std::string& region, double low, double high, std::optional<Vec3> along = {}) {
  GrowthPart part{region};
  if (along) part.direction = DirectionSpec{.uniform = *along};
  return actuator("growth", GrowthSpec{{part}}, low, high, true);
}

/// A block that is held at three corners, so that its shape can change freely.
RobotSpec swelling_block(Mesh mesh, const Vec3& size) {
  RobotSpec spec = physical_robot(std::move(mesh));
  const auto corner = [&](double x, double y) {
    VertexList list;
    for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
      if ((vertex_at(spec.mesh.vertices, v) - Vec3(x, y, 0)).norm() < 1e-9) list.vertices.push_back(v);
    return RegionRef{Selector(list), {}};
  };
  spec.fixed = {{corner(0, 0), {true, true, true}},
                {corner(size.x(), 0), {false, true, true}},
                {corner(0, size.y()), {false, false, true}}};
  return spec;
}

/// Lengths between vertices over those of the rest shape stretched by G; and no stress.
void expect_unstressed(const RobotSpec& spec, double command, const Mat3& grown, const std::string& what) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({command}), tight(1e-12));
  const Points expected = model.rest * grown.transpose();
  EXPECT_GT(distance(expected, model.rest), 0.05) << what;
  double worst = 0;
  for (Index v = 1; v < model.rest.rows(); ++v)
    worst = std::max(worst, std::abs((found.state.positions.row(v) - found.state.positions.row(0)).norm() -
                                     (expected.row(v) - expected.row(0)).norm()));
  EXPECT_LT(worst, 1e-9) << what;
  double stress = 0;
  for (const double each : statics.measured(found.state).stress.von_mises) stress = std::max(stress, each);
  EXPECT_LT(stress, 1e-9) << what;  // of a modulus of 1 MPa
}

Mat3 along(const Vec3& direction, double stretch, double across) {
  const Vec3 d = direction.normalized();
  return across * Mat3::Identity() + (stretch - across) * d * d.transpose();
}

/// A strip that is held at one end, of two layers; `lower` is the lower one's fraction of the thickness.
struct Strip {
  double length = 40, thickness = 1, width = 0.5, lower = 0.4;
  double lower_modulus = 4, upper_modulus = 1, nu = 0;
  bool quadratic = true, mixed = false;
  Vec3 direction{1, 0, 0};  // 0: all
};

RobotSpec bilayer(const Strip& strip) {
  Mesh mesh = block_mesh({40, 1, 5}, {strip.length, strip.width, strip.thickness});
  const double split = strip.lower * strip.thickness;
  add_volume_region(mesh, "lower", [&](const Vec3& p) { return p.z() < split; });
  add_volume_region(mesh, "upper", [&](const Vec3& p) { return p.z() > split; });
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.mesh_options.quadratic = strip.quadratic;
  spec.materials[0].elastic = elastic(Law::neo_hookean, strip.upper_modulus, strip.nu);
  spec.materials.push_back(spec.materials[0]);
  spec.materials[1].region = "lower";
  spec.materials[1].elastic = elastic(Law::neo_hookean, strip.lower_modulus, strip.nu);
  for (MaterialSpec& material : spec.materials) material.mixed = strip.mixed;
  spec.actuators = {growth("lower", 0.5, 2)};
  if (!strip.direction.isZero(0)) spec.actuators = {growth("lower", 0.5, 2, strip.direction)};
  return spec;
}

/// Of the middle of the strip's underside, upwards [1/mm].
double curvature(const Strip& strip, const Model& model, const Points& positions) {
  Vec3 at[3];
  for (int i = 0; i < 3; ++i)
    for (Index v = 0; v < model.rest.rows(); ++v)
      if ((vertex_at(model.rest, v) - Vec3((i + 1) * strip.length / 4, 0, 0)).norm() < 1e-9)
        at[i] = vertex_at(positions, v);
  const Vec3 a = at[1] - at[0], b = at[2] - at[1];
  return 2 * (a.x() * b.z() - a.z() * b.x()) / (a.norm() * b.norm() * (a + b).norm());
}

/// source  Timoshenko, J. Opt. Soc. Am. 11(3), 1925, Eq. (4): of the lower layer grown by a strain
double timoshenko(const Strip& strip, double strain) {
  const double m = strip.lower / (1 - strip.lower), n = strip.lower_modulus / strip.upper_modulus;
  return 6 * strain * (1 + m) * (1 + m) /
         (strip.thickness * (3 * (1 + m) * (1 + m) + (1 + m * n) * (m * m + 1 / (m * n))));
}

}  // namespace

TEST(Growth, FreeBodiesSwellWithoutStress) {
  const Vec3 size(12, 8, 6);
  const std::pair<Mesh, bool> meshes[] = {{block_mesh({3, 2, 2}, size), false},
                                          {block_mesh({3, 2, 2}, size), true},
                                          {block_mesh({3, 2, 2}, size, Split::prisms), false}};
  const Vec3 oblique(1, -2, 0.5);
  for (const auto& [mesh, quadratic] : meshes)
    for (const Law law : {Law::neo_hookean, Law::corotational, Law::gent})
      for (const double stretch : {1.3, 0.8}) {
        RobotSpec spec = swelling_block(mesh, size);
        spec.mesh_options.quadratic = quadratic;
        spec.materials[0].elastic = elastic(law, 1, 0.4);
        const std::string what = std::to_string(quadratic) + " " + std::to_string(stretch);
        spec.actuators = {growth("all", 0.5, 2)};
        expect_unstressed(spec, stretch, stretch * Mat3::Identity(), what);
        spec.actuators = {growth("all", 0.5, 2, oblique)};
        expect_unstressed(spec, stretch, along(oblique, stretch, 1), what + " along");
      }
}

TEST(Growth, MixedAndViscousBodiesSwellWithoutStress) {
  const Vec3 size(12, 8, 6), oblique(1, -2, 0.5);
  RobotSpec spec = swelling_block(block_mesh({3, 2, 2}, size), size);
  spec.actuators = {growth("all", 0.5, 2, oblique)};
  spec.actuators[0].as<GrowthSpec>()->parts[0].keeps_volume = true;
  for (const bool quadratic : {false, true})
    expect_unstressed(mixed(spec, 0.5, quadratic), 1.3, along(oblique, 1.3, 1 / std::sqrt(1.3)), "mixed");
  spec.materials[0].viscosity = {{2, 5}};
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options = tight(1e-12);
  options.elapsed_s = 0;  // at once
  const Equilibrium found = solve_converged(statics, values({1.3}), options);
  EXPECT_GT(distance(found.state.positions, model.rest), 0.5);
  for (const double each : statics.measured(found.state).stress.von_mises) EXPECT_LT(each, 1e-9);
}

TEST(Growth, BilayersCurlAsTimoshenkoSays) {
  constexpr double strain = 0.002;
  for (const Strip& strip :
       {Strip{}, Strip{.lower = 0.6, .lower_modulus = 1}, Strip{.nu = 0.4, .direction = Vec3::Zero()},
        Strip{.lower_modulus = 1, .nu = 0.5, .mixed = true, .direction = Vec3::Zero()}}) {
    const Model model = compile(bilayer(strip));
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, values({1 + strain}));
    const double expected = timoshenko(strip, strain);
    EXPECT_NEAR(curvature(strip, model, found.state.positions), expected, 0.01 * expected) << strip.nu << strip.mixed;
  }
}

/// By a stretch and by a temperature, whose table bends; of one element order and the other, plain and mixed.
TEST(Growth, DerivativesOfShapes) {
  for (const bool quadratic : {false, true})
    for (const bool mixed : {false, true}) {
      Strip strip{.length = 20, .nu = mixed ? 0.5 : 0.3, .quadratic = quadratic, .mixed = mixed};
      RobotSpec spec = bilayer(strip);
      spec.actuators[0].high = 1.3;
      ActuatorSpec warm = growth("upper", 0, 100);
      warm.name = "warm";
      warm.control = Control::load;
      warm.rest = 20;
      warm.as<GrowthSpec>()->parts[0].temperature =
          TemperatureSpec{20, {}, {{0, 10}, {20, 10.1}, {50, 10.6}, {100, 10.2}}};
      spec.actuators.push_back(warm);
      const Model model = compile(spec);
      const Statics statics(model);
      const Equilibrium found = solve_converged(statics, values({1.05, 34}), tight(1e-11));
      EXPECT_GT(distance(found.state.positions, model.rest), 0.1);
      const Sensitivity exact = statics.sensitivity(found.state);
      ASSERT_TRUE(exact.regular);
      for (const Index a : {0, 1}) {
        const Difference expected = central(statics, found.state, a, a == 0 ? 1e-3 : 0.5);
        EXPECT_LT(off_by(exact.positions[a], expected.positions), 1e-6) << a << quadratic << mixed;
      }
    }
}

/// The growth is that of the reference without a command and from a start without commands.
TEST(Growth, RestsAtItsReference) {
  RobotSpec spec = bilayer({.length = 10});
  spec.actuators[0].low = 1.05;
  const Model model = compile(spec);
  EXPECT_EQ(model.rest_actuation()[0], 1.05);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  EXPECT_GT(distance(found.state.positions, model.rest), 0.1);
  EXPECT_EQ(found.state.multipliers[0], 0);
}

}  // namespace softkin
