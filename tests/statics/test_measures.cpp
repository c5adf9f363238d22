#include <Eigen/Geometry>
#include <softkin/model/model.hpp>
#include <softkin/statics/supports/actuator_measures.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"
#include "model/quadratic_mesh.hpp"
#include "statics/difference.hpp"
#include "statics/robots.hpp"

namespace softkin {

namespace {

using namespace testing;
using namespace linear;

/// A block with a chamber inside, a bag in a notch of it, and cables: through points inside elements, from the mean of
/// one face to the mean of the other, and one that passes a point twice.
RobotSpec measuring_robot(bool quadratic) {
  RobotSpec spec = physical_robot(block_mesh({3, 3, 3}, {30, 30, 30}));
  add_volume_region(spec.mesh, "chamber",
                    [](const Vec3& p) { return (p - Vec3(15, 15, 15)).cwiseAbs().maxCoeff() < 5; });
  spec.mesh_options.quadratic = quadratic;
  spec.actuators.push_back(chamber("chamber"));
  ActuatorSpec bag = chamber("");
  bag.name = "bag";
  bag.as<PneumaticSpec>()->region.reset();
  spec.voids.push_back(shaped(Box{{10, 20, 0}, {20, 30, 10}}));
  bag.as<PneumaticSpec>()->surface = box_surface({12, 20, 5}, {6, 5, 5});
  spec.actuators.push_back(bag);
  const std::vector<std::vector<PointRef>> paths = {{at(1, 2, 28), at(16, 7, 24), at(29, 3, 22)},
                                                    {mean("x_low"), mean("x_high")},
                                                    {at(3, 3, 3), at(22, 4, 7), at(3, 3, 3)}};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    spec.actuators.push_back(cable(paths[i]));
    spec.actuators.back().name = "cable" + std::to_string(i);
  }
  return spec;
}

}  // namespace

TEST(Measures, AtRestTheyAreWhatGeometrySays) {
  for (const bool quadratic : {false, true}) {
    const Model model = compile(measuring_robot(quadratic));
    const supports::ActuatorMeasures measures(model);
    const double expected[] = {1000, 6 * 5 * 5,
                               (Vec3(16, 7, 24) - Vec3(1, 2, 28)).norm() + (Vec3(29, 3, 22) - Vec3(16, 7, 24)).norm(),
                               30, 2 * Vec3(19, 1, 4).norm()};
    for (Index a = 0; a < 5; ++a) {
      EXPECT_TRUE(measures.measures(a));
      EXPECT_NEAR(measures.rest(a), expected[a], 1e-10 * expected[a]);
      EXPECT_NEAR(measures.rest(a), model.actuators[a].rest_measure, 1e-10 * expected[a]);
    }
  }
}

/// Under an affine map volumes grow by its determinant; a quadratic map bends the chamber's faces, and its volume is
/// the integral of the map's determinant.
TEST(Measures, OfMappedBodies) {
  for (const bool quadratic : {false, true}) {
    const Model model = compile(measuring_robot(quadratic));
    const supports::ActuatorMeasures measures(model);
    Mat3 map;
    map << 1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.2;
    const Points moved = (model.rest * map.transpose()).rowwise() + Eigen::RowVector3d(5, -80, 300);
    EXPECT_NEAR(measures.value(0, moved), 1000 * map.determinant(), 1e-7);
    EXPECT_NEAR(measures.value(1, moved), 150 * map.determinant(), 1e-7);
    EXPECT_NEAR(measures.value(3, moved), 30 * map.col(0).norm(), 1e-10);
  }
  const Model model = compile(measuring_robot(true));
  const Bend bend{0.006, -0.005, 0.004};
  Points bent = model.rest;
  for (Index v = 0; v < bent.rows(); ++v) bent.row(v) = bend(model.rest.row(v).transpose()).transpose();
  EXPECT_NEAR(supports::ActuatorMeasures(model).value(0, bent), bend.moments({10, 10, 10}, {20, 20, 20}).first, 1e-9);
}

TEST(Measures, GradientAndSecondDerivativeAgreeWithDifferences) {
  Team alone(1);
  for (const bool quadratic : {false, true}) {
    const Model model = compile(measuring_robot(quadratic));
    supports::ActuatorMeasures measures(model);
    Cliques cliques;
    measures.add_cliques(cliques);
    const Index n = model.rest.rows();
    const BlockPattern pattern(n, cliques);
    const Points positions = model.rest + noise(n, 0.8, 1);
    LargeVector<double> slots(9 * static_cast<std::size_t>(cliques.slots.back()), 7.0), blocks;
    for (Index a = 0; a < 5; ++a) {
      Points gradient;
      const double value = measures.value(a, positions, &gradient);
      EXPECT_EQ(value, measures.value(a, positions));
      const Points slope = difference([&](const Points& p) { return measures.value(a, p); }, positions, 1e-4);
      EXPECT_GT(gradient.norm(), 0.1);
      EXPECT_LT((gradient - slope).norm(), 1e-8 * gradient.norm()) << "actuator " << a;

      Team pair(2);
      measures.second_derivatives(positions, -1.7 * Eigen::VectorXd::Unit(5, a), std::vector<Eigen::VectorXd>(5), slots,
                                  pair);
      pattern.gather(slots, blocks, alone);
      for (unsigned seed = 1; seed <= 3; ++seed) {
        const Points direction = noise(n, 1, seed);
        Points product;
        pattern.multiply(blocks, direction, product, alone);
        const Points change = change_along(
            [&](const Points& p) {
              Points g;
              (void)measures.value(a, p, &g);
              return g;
            },
            positions, direction, 1e-4);
        EXPECT_GT(product.norm(), 1e-3);
        EXPECT_LT((product + 1.7 * change).norm(), 1e-7 * product.norm()) << "actuator " << a;
      }
    }
  }
}

/// Two ends in one place: no direction to pull in, and nothing that is not finite.
TEST(Measures, ASegmentWithoutLengthPullsNowhere) {
  RobotSpec spec = physical_robot(block_mesh({2, 1, 1}, {20, 10, 10}));
  spec.actuators.push_back(cable({at(0, 5, 5), at(10, 5, 5), at(20, 5, 5)}));
  const Model model = compile(spec);
  supports::ActuatorMeasures measures(model);
  Cliques cliques;
  measures.add_cliques(cliques);
  Points flat = model.rest;
  flat.col(0).setConstant(3);
  Points gradient;
  EXPECT_NEAR(measures.value(0, flat, &gradient), 0, 1e-12);
  EXPECT_TRUE(gradient.allFinite());
  LargeVector<double> slots(9 * static_cast<std::size_t>(cliques.slots.back()), 0.0);
  Team pair(2);
  measures.second_derivatives(flat, Eigen::VectorXd::Ones(1), std::vector<Eigen::VectorXd>(1), slots, pair);
  for (const double value : slots) EXPECT_TRUE(std::isfinite(value));
}

TEST(Measures, ADeaMeasuresNothing) {
  const RobotSpec mixed = mixed_robot(true);
  RobotSpec spec = physical_robot(mixed.mesh);
  spec.actuators = mixed.actuators;
  for (const char* side : {"y_low", "y_high"}) spec.fixed.push_back({{std::string(side), {}}, {false, true, false}});
  const Model model = compile(spec);
  const supports::ActuatorMeasures measures(model);
  EXPECT_FALSE(measures.measures(0));
  EXPECT_TRUE(measures.measures(1));
  EXPECT_TRUE(measures.measures(2));
}

}  // namespace softkin
