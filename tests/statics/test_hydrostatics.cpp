#include <Eigen/Dense>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/mixed_samples.hpp"
#include "statics/sensitivity_samples.hpp"

/// A liquid around robots: buoyancy is the weight of what is displaced, whole and in part, at rest and deformed.

namespace softkin {

namespace {

using namespace testing;

constexpr double standard_gravity = 9.81;

RobotSpec submerged(Mesh mesh, double level_mm, double density = 1000) {
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.materials[0].elastic = elastic(Law::neo_hookean, 0.02, 0.4);
  spec.materials[0].density = 1300;
  spec.loads.gravity = {0, 0, -standard_gravity};
  spec.loads.liquid_around = LiquidAroundSpec{density, {0, 0, level_mm}, {}};
  return spec;
}

/// The part of a tetrahedron that is below a level, by halving its longest edge: what a piece has wet is taken between
/// all and nothing where it is cut.
double wet_volume(const std::array<Vec3, 4>& corners, double level, int depth) {
  double low = 1e300, high = -1e300;
  for (const Vec3& corner : corners) {
    low = std::min(low, corner.z());
    high = std::max(high, corner.z());
  }
  const Vec3 a = corners[0];
  const double volume = (corners[1] - a).dot((corners[2] - a).cross(corners[3] - a)) / 6;
  if (low >= level) return 0;
  if (high <= level) return volume;
  // exact where one corner is alone on its side, by similar tetrahedra
  std::vector<int> below, above;
  for (int i = 0; i < 4; ++i) (corners[i].z() < level ? below : above).push_back(i);
  const auto cap = [&](int tip, const std::vector<int>& others) {
    double fraction = 1;
    for (const int other : others) {
      const double z = corners[tip].z();
      fraction *= (level - z) / (corners[other].z() - z);
    }
    return fraction * volume;
  };
  if (below.size() == 1) return cap(below[0], above);
  if (above.size() == 1) return volume - cap(above[0], below);
  if (depth == 0) return volume / 2;
  int from = 0, to = 1;
  double longest = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j)
      if (const double length = (corners[i] - corners[j]).norm(); length > longest) {
        longest = length;
        from = i;
        to = j;
      }
  auto one = corners, two = corners;
  one[to] = two[from] = 0.5 * (corners[from] + corners[to]);
  return wet_volume(one, level, depth - 1) + wet_volume(two, level, depth - 1);
}

/// Of an element of either order, cut into 2^depth straight ones, corners by their barycentric coordinates.
double wet_volume(const Model& model, std::size_t element, const Points& positions,
                  const std::array<Eigen::Vector4d, 4>& corners, double level, int depth) {
  if (depth == 0) {
    std::array<Vec3, 4> at;
    for (std::size_t c = 0; c < 4; ++c) {
      const Eigen::Vector4d& l = corners[c];
      at[c].setZero();
      for (Eigen::Index i = 0; i < 4; ++i)
        at[c] += l[i] * (model.elements.edge_nodes.empty() ? 1 : 2 * l[i] - 1) *
                 vertex_at(positions, model.elements.tetrahedra[element][i]);
      for (std::size_t i = 0; i < 6 && !model.elements.edge_nodes.empty(); ++i)
        at[c] += 4 * l[tetrahedron_edges[i][0]] * l[tetrahedron_edges[i][1]] *
                 vertex_at(positions, model.elements.edge_nodes[element][i]);
    }
    return wet_volume(at, level, 12);
  }
  static constexpr std::size_t edges[6][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {0, 3}, {1, 2}};
  std::size_t longest = 0;
  double most = 0;
  for (std::size_t e = 0; e < 6; ++e)
    if (const double length = (corners[edges[e][0]] - corners[edges[e][1]]).norm(); length > 1.001 * most) {
      most = length;
      longest = e;
    }
  const auto [from, to] = edges[longest];
  auto one = corners, two = corners;
  one[to] = two[from] = 0.5 * (corners[from] + corners[to]);
  return wet_volume(model, element, positions, one, level, depth - 1) +
         wet_volume(model, element, positions, two, level, depth - 1);
}

double wet_volume(const Model& model, const Points& positions, double level) {
  std::array<Eigen::Vector4d, 4> whole;
  for (Eigen::Index i = 0; i < 4; ++i) whole[i] = Eigen::Vector4d::Unit(i);
  double sum = 0;
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    sum += wet_volume(model, e, positions, whole, level, model.elements.edge_nodes.empty() ? 0 : 9);
  return sum;
}

/// Of the whole of it, exact for curved faces.
double whole_volume(const Model& model, const Points& positions) {
  std::vector<CavityFace> faces;
  for (const LoadedFace& loaded : model.loads.tractions.at(0).faces) faces.push_back(loaded.face);
  return enclosed_volume(positions, faces);
}

/// Returns the sum of the support reactions [N].
Vec3 borne(const Model& model, const Statics& statics, const Equilibrium& found) {
  Vec3 sum = Vec3::Zero();
  for (const auto& reaction : reactions(model, found.state.positions, statics.measured(found.state)))
    sum += reaction.force;
  return sum;
}

/// Returns the weight less the support reactions [N].
Vec3 buoyancy(const RobotSpec& spec, Points* shape = nullptr) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation(), tight(1e-11));
  EXPECT_GT(distance(found.state.positions, model.rest), 1);  // it bends
  if (shape) *shape = found.state.positions;
  const Vec3 weight = model.loads.dead.colwise().sum().transpose();
  return -(borne(model, statics, found) + weight);
}

}  // namespace

/// To rounding, in the shape that it has bent to.
TEST(Hydrostatics, LiftsByTheWeightOfWhatIsDisplaced) {
  const Vec3 size(60, 10, 8);
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = submerged(block_mesh({8, 2, 2}, size), 30);
    spec.mesh_options.quadratic = quadratic;
    Points shape;
    const Vec3 lift = buoyancy(spec, &shape);
    const Model model = compile(spec);
    const double displaced = whole_volume(model, shape);
    EXPECT_NEAR(displaced, wet_volume(model, shape, 30), 1e-3 * displaced);
    EXPECT_GT(std::abs(displaced - 4800), 1);                     // and is compressed
    const double expected = 1e-6 * displaced * standard_gravity;  // 1 g per mL
    EXPECT_NEAR(lift.z(), expected, 1e-7 * expected) << quadratic;
    EXPECT_LT(lift.head<2>().norm(), 1e-7 * expected);
  }
}

TEST(Hydrostatics, LiftsPrisms) {
  const Vec3 size(60, 10, 8);
  RobotSpec spec = submerged(block_mesh({8, 2, 2}, size, Split::prisms), 30);
  spec.materials[0].elastic = elastic(Law::neo_hookean, 0.02, 0);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation(), tight(1e-11));
  const Vec3 lift = -(borne(model, statics, found) + Vec3(model.loads.dead.colwise().sum().transpose()));
  // the volume within its faces, averaged over both diagonals of the quads
  std::vector<CavityFace> faces;
  const Boundary boundary = boundary_of(model.elements.tetrahedra, model.elements.prisms);
  for (const Triangle& t : boundary.triangles) faces.insert(faces.end(), 2, CavityFace{t});
  for (const Quad& q : boundary.quads)
    for (std::size_t i = 0; i < 4; ++i) faces.push_back({{q[i], q[(i + 1) % 4], q[(i + 2) % 4]}});
  const double expected = 1e-6 * standard_gravity * enclosed_volume(found.state.positions, faces) / 2;
  EXPECT_NEAR(lift.z(), expected, 1e-9 * expected);
}

TEST(Hydrostatics, LiftsWhatIsInTheLiquidInPart) {
  const Vec3 size(60, 10, 8);
  for (const bool quadratic : {false, true})
    for (const double level : {-13.7, 1.3, 5.9}) {
      RobotSpec spec = submerged(block_mesh({8, 2, 2}, size), level);
      spec.mesh_options.quadratic = quadratic;
      Points shape;
      const Vec3 lift = buoyancy(spec, &shape);
      const Model model = compile(spec);
      const double displaced = wet_volume(model, shape, level);
      EXPECT_GT(displaced, 100) << level;
      EXPECT_LT(displaced, 4700) << level;
      const double expected = 1e-6 * displaced * standard_gravity;
      EXPECT_NEAR(lift.z(), expected, (quadratic ? 1e-3 : 1e-4) * expected) << quadratic << level;
      EXPECT_LT(lift.head<2>().norm(), (quadratic ? 1e-4 : 1e-9) * expected) << quadratic << level;
    }
}

/// What keeps its volume and is as heavy as the liquid around it hangs in it without strain, however gravity acts.
TEST(Hydrostatics, WhatIsAsHeavyAsTheLiquidDoesNotSag) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = mixed(submerged(block_mesh({8, 2, 2}, {60, 10, 8}), 30, 1300), 0.5, quadratic);
    spec.loads.gravity = {0, 5, -8};
    spec.loads.liquid_around->surface = {0, -100, 60};
    const Model model = compile(spec);
    const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
    // pressures of order 1 are smoothed
    EXPECT_LT(distance(found.state.positions, model.rest), quadratic ? 1e-5 : 0.1);
    spec.loads.liquid_around.reset();
    const Model in_air = compile(spec);
    EXPECT_GT(distance(solve_converged(Statics(in_air), in_air.rest_actuation()).state.positions, in_air.rest), 1);
  }
}

/// Walls of chambers are dry, and their pressures over that of the atmosphere: at as much as the liquid has there, a
/// chamber keeps its volume.
TEST(Hydrostatics, PressesChambersIn) {
  RobotSpec spec = submerged(hollow_mesh(), 2000);
  spec = mixed(spec, 0.5, true);
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.1, 3, true);
  spec.actuators = {air};
  const Model model = compile(spec);
  EXPECT_EQ(model.loads.tractions.at(0).faces.size(), 6u * 18u);  // of the outside alone
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1}));
  const double depth_mm = 2000 - 15;
  EXPECT_NEAR(found.state.multipliers[0], 1e-3 * standard_gravity * depth_mm, 0.02 * 19.5);
}

TEST(Hydrostatics, DerivativesOfShapes) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = submerged(block_mesh({10, 2, 2}, {60, 10, 8}), 4.1);
    spec.mesh_options.quadratic = quadratic;
    const auto along = [](double z) { return std::vector<Vec3>{{0, 5, z}, {20, 5, z}, {40, 5, z}, {60, 5, z}}; };
    spec.actuators = {by_load(cable("top", along(7)))};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, values({0.02}), tight(1e-11));
    const Sensitivity exact = statics.sensitivity(found.state);
    const Difference expected = central(statics, found.state, 0, 1e-4);
    EXPECT_LT(off_by(exact.positions[0], expected.positions), quadratic ? 1e-4 : 1e-6);
  }
}

}  // namespace softkin
