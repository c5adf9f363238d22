#include <Eigen/Geometry>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/body.hpp>

#include "model/physical_robots.hpp"
#include "statics/difference.hpp"
#include "statics/robots.hpp"

namespace softkin {

namespace {

using namespace testing;
using namespace linear;

MaterialSpec material(const std::string& region, Law law) {
  MaterialSpec spec;
  spec.region = region;
  spec.shape_ratio.reset();
  ElasticSpec elastic;
  elastic.law = law;
  elastic.poisson_ratio = 0.35;
  if (forbids_inversion(law)) {
    elastic.c10 = 0.3;
    if (law == Law::mooney_rivlin) elastic.c01 = 0.1;
    if (law == Law::yeoh) elastic.c20 = 0.05;
  } else {
    elastic.youngs_modulus = 2;
  }
  spec.elastic = elastic;
  return spec;
}

/// Tetrahedra of four laws and prisms of two, some of them a layer that is actuated.
RobotSpec mixed_laws() {
  const RobotSpec mixed = mixed_robot(true);
  RobotSpec spec = physical_robot(mixed.mesh);
  spec.actuators = mixed.actuators;
  for (const char* side : {"y_low", "y_high"}) spec.fixed.push_back({{std::string(side), {}}, {false, true, false}});
  spec.regions.push_back({"left", Box{{0, 0, 0}, {20, 20, 30}}, {}});
  spec.regions.push_back({"right", Box{{40, 0, 8}, {60, 20, 30}}, {}});
  spec.regions.push_back({"top", Box{{0, 0, 16}, {60, 20, 30}}, {}});
  spec.materials = {material("all", Law::neo_hookean), material("left", Law::st_venant_kirchhoff),
                    material("right", Law::mooney_rivlin), material("top", Law::corotational)};
  return spec;
}

RobotSpec quadratic_laws() {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 2}, {30, 20, 20}));
  spec.mesh_options.quadratic = true;
  spec.regions.push_back({"left", Box{{0, 0, 0}, {10, 20, 20}}, {}});
  spec.materials = {material("all", Law::neo_hookean), material("left", Law::yeoh)};
  return spec;
}

void expect_consistent(const Model& model, const Eigen::VectorXd& actuation) {
  Team alone(1);
  physical::Body system(model);
  Cliques cliques;
  system.add_cliques(cliques);
  const Index n = model.rest.rows();
  const BlockPattern pattern(n, cliques);
  physical::Body::Scratch scratch = system.make_scratch();
  const auto gradient_at = [&](const Points& p) {
    Points gradient;
    EXPECT_FALSE(system.force({actuation}, p, scratch, gradient, alone).forbidden);
    return gradient;
  };
  Points unused;
  const auto energy_at = [&](const Points& p) { return system.force({actuation}, p, scratch, unused, alone).energy; };

  const Points positions = 1.05 * model.rest + noise(n, 0.4, 3);
  const Points gradient = gradient_at(positions);
  EXPECT_GT(gradient.norm(), 1);
  EXPECT_LT((gradient - difference(energy_at, positions, 1e-4)).norm(), 1e-7 * gradient.norm());

  LargeVector<double> slots(9 * static_cast<std::size_t>(cliques.slots.back()), 5.0), blocks;
  system.stiffness({actuation}, positions, false, scratch, slots, alone);
  pattern.gather(slots, blocks, alone);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Points direction = noise(n, 1, seed);
    Points product;
    pattern.multiply(blocks, direction, product, alone);
    const Points change = change_along(gradient_at, positions, direction, 1e-5);
    EXPECT_LT((product - change).norm(), 1e-7 * product.norm());
  }
}

}  // namespace

TEST(Body, GradientAndStiffnessAgreeWithDifferences) {
  expect_consistent(compile(mixed_laws()), (Actuation(3) << 1, 1, 1).finished());
  expect_consistent(compile(mixed_laws()), (Actuation(3) << 1.3, 1, 1).finished());
  expect_consistent(compile(quadratic_laws()), {});
}

/// One scratch serves one actuation after another.
TEST(Body, LayersFollowTheActuation) {
  Team alone(1);
  const Model model = compile(mixed_laws());
  const physical::Body system(model);
  physical::Body::Scratch used = system.make_scratch(), fresh = system.make_scratch();
  Points a, b;
  (void)system.force({(Actuation(3) << 1.4, 1, 1).finished()}, model.rest, used, a, alone);
  EXPECT_GT(a.norm(), 1e-3);
  for (const double ratio : {0.8, 1.0}) {
    const Actuation actuation = (Actuation(3) << ratio, 1, 1).finished();
    const double energy = system.force({actuation}, model.rest, used, a, alone).energy;
    EXPECT_EQ(energy, system.force({actuation}, model.rest, fresh, b, alone).energy);
    EXPECT_EQ(a, b);
  }
  EXPECT_LT(a.norm(), 1e-12);  // at rest, ratio 1
}

/// Moved and turned, the body has the same energy, and its forces turn with it; at rest there are none.
TEST(Body, InvariantUnderRigidMotion) {
  Team alone(1), pair(2);
  for (const Model& model : {compile(mixed_laws()), compile(quadratic_laws())}) {
    const physical::Body system(model);
    physical::Body::Scratch scratch = system.make_scratch();
    const Actuation actuation = Actuation::Ones(model.actuators.size());
    Points gradient, turned;
    EXPECT_NEAR(system.force({actuation}, model.rest, scratch, gradient, alone).energy, 0, 1e-12);
    EXPECT_LT(gradient.norm(), 1e-11);
    const Points positions = model.rest + noise(model.rest.rows(), 0.3, 4);
    const Mat3 turn = Eigen::AngleAxisd(2, Vec3(1, -2, 3).normalized()).toRotationMatrix();
    const double energy = system.force({actuation}, positions, scratch, gradient, alone).energy;
    const Points moved = (positions * turn.transpose()).rowwise() + Eigen::RowVector3d(10, 20, -30);
    EXPECT_NEAR(system.force({actuation}, moved, scratch, turned, alone).energy, energy, 1e-11 * energy);
    EXPECT_LT((turned - gradient * turn.transpose()).norm(), 1e-11 * gradient.norm());
    Points shared;
    EXPECT_EQ(system.force({actuation}, positions, scratch, shared, pair).energy, energy);
    EXPECT_EQ(shared, gradient);
  }
}

/// The projected stiffness has no negative direction; the exact one of a strongly compressed body has.
TEST(Body, ProjectedStiffnessIsPositive) {
  Team alone(1);
  const Model model = compile(mixed_laws());
  physical::Body system(model);
  Cliques cliques;
  system.add_cliques(cliques);
  const Index n = model.rest.rows();
  const BlockPattern pattern(n, cliques);
  physical::Body::Scratch scratch = system.make_scratch();
  const Points positions = model.rest * Eigen::Vector3d(0.5, 0.9, 0.9).asDiagonal() + noise(n, 0.3, 5);
  LargeVector<double> slots(9 * static_cast<std::size_t>(cliques.slots.back()), 0.0), blocks;
  const auto lowest = [&](bool projected) {
    system.stiffness({Actuation::Ones(3)}, positions, projected, scratch, slots, alone);
    pattern.gather(slots, blocks, alone);
    double least = 0;
    for (unsigned seed = 1; seed <= 300; ++seed) {
      const Points direction = noise(n, 1, seed).array() * (noise(n, 1, seed + 999).array().abs() > 2.2).cast<double>();
      Points product;
      pattern.multiply(blocks, direction, product, alone);
      least = std::min(least, product.cwiseProduct(direction).sum() / std::max(direction.squaredNorm(), 1e-9));
    }
    return least;
  };
  EXPECT_LT(lowest(false), -1e-3);
  EXPECT_GT(lowest(true), -1e-10);
}

TEST(Body, TellsForbiddenInversion) {
  Team alone(1);
  const Model model = compile(quadratic_laws());
  const physical::Body system(model);
  physical::Body::Scratch scratch = system.make_scratch();
  Points gradient;
  EXPECT_TRUE(
      system.force({}, model.rest * Eigen::Vector3d(1, 1, -1).asDiagonal(), scratch, gradient, alone).forbidden);
  EXPECT_FALSE(system.force({}, model.rest, scratch, gradient, alone).forbidden);
}

/// x^T L x is the integral of |grad x|^2: of a linear field, its squared slope times the volume.
TEST(Body, LaplacianOfALinearField) {
  for (const Model& model : {compile(mixed_laws()), compile(quadratic_laws())}) {
    const Eigen::SparseMatrix<double> lower = physical::Body(model).laplacian();
    const Eigen::SparseMatrix<double> matrix = lower.selfadjointView<Eigen::Lower>();
    double volume = 0;
    for (const double v : model.elements.tetrahedron_volumes) volume += v;
    for (const double v : model.elements.prism_volumes) volume += v;
    Eigen::VectorXd field = model.rest * Vec3(0.3, -1, 2);
    for (Index v = 0; v < field.size(); ++v)
      if (!model.elements.used[v]) field[v] = 0;
    EXPECT_NEAR(field.dot(matrix * field), Vec3(0.3, -1, 2).squaredNorm() * volume, 1e-9 * volume);
  }
}

}  // namespace softkin
