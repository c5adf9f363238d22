#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/map_estimate.hpp>

#include "statics/physical_samples.hpp"

/// Forces that a map estimates from markers.

namespace softkin {

namespace {

using namespace testing;

/// A finger with a chamber and a force of three components at a point, and three markers.
RobotSpec weighed_finger() {
  RobotSpec spec = bending_finger();
  spec.actuators[0] = by_load(spec.actuators[0]);
  spec.actuators[0].low = 0;
  spec.actuators[0].high = 15;
  spec.loads.forces = {
      {"touch", {Vec3(50, 6, 16), {}}, {0, 0, 0}, std::array<Vec3, 2>{Vec3(-1, -1, -1), Vec3(1, 1, 1)}}};
  spec.loads.forces[0].range = std::array<Vec3, 2>{Vec3(-0.2, -0.2, -0.3), Vec3(0.2, 0.2, 0.3)};
  spec.markers = {{"a", {Vec3(25, 1, 15), {}}}, {"b", {Vec3(45, 11, 15), {}}}, {"c", {Vec3(59, 1, 2), {}}}};
  return spec;
}

struct Weighed {
  Model model = compile(weighed_finger());
  KinematicMap map{map_of(model)};
  std::vector<MapUnknown> forces{};
  static MapData map_of(const Model& model) {
    MapOptions options;
    options.accuracy_mm = 1e-3;
    options.checks = 20;
    return build_map(model, options).value().data;
  }
  Weighed() {
    for (Index i = 0; i < map.inputs(); ++i)
      if (const MapInput& input = map.data().inputs[i]; input.unit == "N") forces.push_back({i, 0, input.high});
  }
};

const Weighed& weighed() {
  static const Weighed one;
  return one;
}

}  // namespace

/// The solver's own equilibria, without noise: forces to what the map is off.
TEST(MapEstimate, TellsTheSolversForces) {
  const auto& [model, map, forces] = weighed();
  ASSERT_EQ(forces.size(), 3u);
  const Statics statics(model);
  for (const Vec3& force : {Vec3(0.1, -0.1, -0.25), Vec3(-0.05, 0.15, 0.2)}) {
    Actuation commands = model.rest_actuation();
    commands.head<4>() << 8, force;
    const Equilibrium found = statics.solve(commands, statics.rest());
    ASSERT_EQ(found.report.status, Status::converged);
    Eigen::VectorXd values = Eigen::VectorXd::Constant(map.outputs(), std::nan(""));
    for (Index m = 0; m < 3; ++m) values.segment<3>(3 * m) = model.markers[m].at(found.state.positions);
    Eigen::VectorXd begin = map.commands(commands);
    for (const MapUnknown& unknown : forces) begin[unknown.input] = 0;
    const auto reported = estimate_by_map(map, forces, begin, values, Eigen::VectorXd::Constant(map.outputs(), 1e-3));
    ASSERT_TRUE(reported && reported->converged);
    EXPECT_LE(reported->iterations, 8);
    for (Index k = 0; k < 3; ++k)
      EXPECT_NEAR(reported->commands[forces[k].input], force[k], 5 * std::sqrt(reported->covariance(k, k)));
    EXPECT_LT((reported->commands - map.commands(commands)).norm(), 0.01);
  }
}

/// The posterior's gradient is 0 and its second differences are the covariance's inverse where readings are exact.
TEST(MapEstimate, IsTheLeastCost) {
  const auto& [model, map, forces] = weighed();
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(map.inputs());
  truth << 5, 0.05, -0.1, -0.1;
  Eigen::VectorXd values(map.outputs()), outputs(map.outputs());
  ASSERT_TRUE(map.evaluate(truth.data(), values.data()));
  std::vector<MapUnknown> unknowns = forces;
  for (MapUnknown& unknown : unknowns) unknown.mean = truth[unknown.input];
  Eigen::VectorXd begin = truth;
  for (const MapUnknown& unknown : unknowns) begin[unknown.input] = 0.15;
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(map.outputs(), 0.2);
  const auto reported = estimate_by_map(map, unknowns, begin, values, deviations);
  ASSERT_TRUE(reported && reported->converged);
  EXPECT_LT((reported->commands - truth).norm(), 1e-5);
  const auto cost = [&, &map = map](const Eigen::VectorXd& at) {
    EXPECT_TRUE(map.evaluate(at.data(), outputs.data()));
    double sum = ((outputs - values).array() / 0.2).square().sum();
    for (const MapUnknown& unknown : unknowns)
      sum += std::pow((at[unknown.input] - unknown.mean) / unknown.deviation, 2);
    return sum;
  };
  const double h = 1e-3;
  const auto column = [&, &map = map](Index i, double by) {
    Eigen::VectorXd move = Eigen::VectorXd::Zero(map.inputs());
    move[unknowns[i].input] = by;
    return move;
  };
  const Eigen::Matrix3d information = reported->covariance.inverse();
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j) {
      const double second = (cost(truth + column(i, h) + column(j, h)) - cost(truth + column(i, h) - column(j, h)) -
                             cost(truth - column(i, h) + column(j, h)) + cost(truth - column(i, h) - column(j, h))) /
                            (4 * h * h);
      EXPECT_NEAR(second / 2, information(i, j), 1e-3 * information.diagonal().maxCoeff());
    }
}

/// 90 % ellipsoids hold the force about that often, the chi-square is what it is to be, and a reading that is wrong
/// shows in it.
TEST(MapEstimate, DeviationsAreHonest) {
  const auto& [model, map, forces] = weighed();
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int held = 0;
  double chi_square = 0, freedoms = 0;
  constexpr int draws = 400;
  Eigen::VectorXd values(map.outputs());
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(map.outputs(), 0.1);
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::VectorXd truth(map.inputs()), begin;
    truth[0] = 7;
    for (const MapUnknown& unknown : forces) truth[unknown.input] = 0.2 * unknown.deviation * normal(random);
    for (Index i = 0; i < map.inputs(); ++i)
      truth[i] = std::clamp(truth[i], map.data().inputs[i].low, map.data().inputs[i].high);
    ASSERT_TRUE(map.evaluate(truth.data(), values.data()));
    for (Index q = 0; q < 9; ++q) values[q] += 0.1 * normal(random);
    values.tail(map.outputs() - 9).setConstant(std::nan(""));
    begin = truth;
    std::vector<MapUnknown> known = forces;
    for (MapUnknown& unknown : known) {
      unknown.deviation *= 0.2;
      begin[unknown.input] = 0;
    }
    const auto reported = estimate_by_map(map, known, begin, values, deviations);
    ASSERT_TRUE(reported && reported->converged);
    Vec3 off;
    for (Index k = 0; k < 3; ++k) {
      const Index i = forces[k].input;
      off[k] = reported->commands[i] - truth[i];
    }
    held += off.dot(reported->covariance.inverse() * off) < 6.2514;
    chi_square += reported->chi_square;
    freedoms += reported->freedoms;
    if (draw > 0) continue;
    values[4] += 3;
    EXPECT_GT(estimate_by_map(map, known, begin, values, deviations)->misfit(), 5);
  }
  EXPECT_NEAR(held, 0.9 * draws, 0.05 * draws);
  EXPECT_NEAR(chi_square / freedoms, 1, 0.1);
}

TEST(MapEstimate, StaysInItsRangesAndRefuses) {
  const auto& [model, map, forces] = weighed();
  Eigen::VectorXd begin = Eigen::VectorXd::Zero(map.inputs()), values(map.outputs());
  begin[0] = 7;
  ASSERT_TRUE(map.evaluate(begin.data(), values.data()));
  values[8] -= 100;  // far below what the range allows
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(map.outputs(), 0.1);
  const auto reported = estimate_by_map(map, forces, begin, values, deviations);
  ASSERT_TRUE(reported);
  bool at_end = false;
  for (const MapUnknown& unknown : forces) {
    const MapInput& input = map.data().inputs[unknown.input];
    EXPECT_GE(reported->commands[unknown.input], input.low);
    EXPECT_LE(reported->commands[unknown.input], input.high);
    at_end =
        at_end || reported->commands[unknown.input] == input.low || reported->commands[unknown.input] == input.high;
  }
  EXPECT_TRUE(at_end);
  Eigen::VectorXd outside = begin;
  outside[0] = 100;
  EXPECT_FALSE(estimate_by_map(map, forces, outside, values, deviations));
  EXPECT_THROW((void)estimate_by_map(map, {{9, 0, 1}}, begin, values, deviations), InvalidInput);
  EXPECT_THROW((void)estimate_by_map(map, {{1, 0, 0}}, begin, values, deviations), InvalidInput);
  EXPECT_THROW((void)estimate_by_map(map, {{1, 0, 1}, {1, 0, 1}}, begin, values, deviations), InvalidInput);
  EXPECT_THROW((void)estimate_by_map(map, forces, begin, values, 0 * deviations), InvalidInput);
  EXPECT_THROW((void)estimate_by_map(map, forces, begin.head(1), values, deviations), InvalidInput);
}

}  // namespace softkin
