#include <gtest/gtest.h>

#include <random>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/map_robot.hpp>
#include <softkin/kinematics/maps/measure_gradient.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/sensitivity_samples.hpp"

namespace softkin {
namespace {

using namespace testing;
using maps::measure_gradient;

/// Two chambers by pressure, a cable by tension; markers that share vertices, one of them on a stem.
RobotSpec robot_of_many_outputs() {
  RobotSpec spec = chambers_beam(2);
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator = by_load(actuator, 0, 60);
  }
  spec.actuators.push_back(by_load(cable("pull", {{0, 18, 18}, {20, 18, 18}, {48, 18, 18}}), 0, 1.5));
  spec.markers.push_back({"near", {Vec3(47, 11, 9), {}}});
  spec.markers.push_back({"nearer", {Vec3(46.5, 11, 9.5), {}}});
  spec.markers.push_back({"flag", {std::string("x_high"), {}}, Vec3(5, 0, 12)});
  return spec;
}

/// A coarse shape, so that what is taken of it would be seen.
MapOptions coarse() {
  MapOptions options;
  options.accuracy_mm = 0.01;
  options.shape_accuracy_mm = 1;
  options.checks = 10;
  return options;
}

Actuation actuation_at(const MapData& data, const Eigen::VectorXd& commands) {
  Actuation actuation = data.actuation;
  for (Index i = 0; i < commands.size(); ++i) actuation[data.inputs[i].actuator] = commands[i];
  return actuation;
}

class MapAnswers : public ::testing::Test {
 protected:
  MapAnswers() : model_(compile(robot_of_many_outputs())), map_(build_map(model_, coarse())->data) {}

  /// A stem has the same length in every shape, but in the map's outputs of its foot and its end up to their errors.
  [[nodiscard]] double allowed(const Marker& marker, Index output) const {
    const bool is_at_stem = marker.name == "tip" || marker.name == "flag";
    return is_at_stem ? map_.data().check.largest[output] : 1e-10;
  }

  const Model model_;
  const KinematicMap map_;
  const Statics mapped_ = statics_by(model_, &map_, false);
};

TEST_F(MapAnswers, HaveTheOutputsOfTheMap) {
  const MapData& data = map_.data();
  const maps::RowMatrix commands = maps::random_commands(data, 20, 5);
  double shape_off = 0;
  for (Index i = 0; i < commands.rows(); ++i) {
    Eigen::VectorXd values(map_.outputs());
    const auto place = map_.evaluate(commands.row(i).data(), values.data());
    ASSERT_TRUE(place);
    const Equilibrium found = mapped_.solve(actuation_at(data, commands.row(i)), mapped_.rest());
    ASSERT_EQ(found.report.status, Status::converged);
    Index q = 0;
    for (const Marker& marker : model_.markers)
      for (int axis = 0; axis < 3; ++axis, ++q)
        EXPECT_NEAR(marker.at(found.state.positions)[axis], values[q], allowed(marker, q)) << data.outputs[q].name;
    for (std::size_t a = 0; a < model_.actuators.size(); ++a, ++q) {
      ASSERT_EQ(data.outputs[q].name, model_.actuators[a].name + "_ratio");
      EXPECT_NEAR(achieved_ratio(model_, model_.actuators[a], found.state.positions), values[q], 1e-11);
      const double of_shape = achieved_ratio(model_, model_.actuators[a], map_.shape(commands.row(i).data(), *place));
      shape_off = std::max(shape_off, std::abs(of_shape - values[q]));
    }
  }
  EXPECT_GT(shape_off, 1e-5) << "the shape is so good that this tests nothing";
}

TEST_F(MapAnswers, AreWithinTheMapsAccuracyOfTheSolver) {
  const MapData& data = map_.data();
  const Statics solver(model_);
  const maps::RowMatrix commands = maps::random_commands(data, 4, 6);
  for (Index i = 0; i < commands.rows(); ++i) {
    const Actuation actuation = actuation_at(data, commands.row(i));
    const Equilibrium exact = solve_converged(solver, actuation), found = mapped_.solve(actuation, mapped_.rest());
    for (const Marker& marker : model_.markers)
      EXPECT_LT((marker.at(found.state.positions) - marker.at(exact.state.positions)).norm(), 0.02) << marker.name;
    for (const Actuator& actuator : model_.actuators)
      EXPECT_NEAR(achieved_ratio(model_, actuator, found.state.positions),
                  achieved_ratio(model_, actuator, exact.state.positions), 2e-4)
          << actuator.name;
  }
}

TEST_F(MapAnswers, HaveTheSlopesOfTheMap) {
  const Eigen::VectorXd commands = Eigen::Vector3d(20, 35, 0.6);
  Eigen::VectorXd values(map_.outputs());
  maps::RowMatrix slopes(map_.inputs(), map_.outputs());
  ASSERT_TRUE(map_.evaluate(commands.data(), values.data(), slopes.data()));
  const Equilibrium found = mapped_.solve(actuation_at(map_.data(), commands), mapped_.rest());
  const Sensitivity sensitivity = mapped_.sensitivity(found.state);
  // where a stem turns, the unmoved shape stands for the moved one
  const Points shape = map_.shape(commands.data(), *map_.evaluate(commands.data(), values.data()));
  for (Index i = 0; i < map_.inputs(); ++i)
    for (std::size_t m = 0; m < model_.markers.size(); ++m) {
      const Vec3 slope = model_.markers[m].velocity(shape, sensitivity.positions[map_.data().inputs[i].actuator]);
      const bool is_at_stem = model_.markers[m].name == "tip" || model_.markers[m].name == "flag";
      EXPECT_LT((slope - slopes.row(i).segment<3>(3 * static_cast<Index>(m)).transpose()).norm(),
                is_at_stem ? 1e-4 : 1e-9);
    }
}

/// Of chambers by their elements, boundaries of order 1 and 2 and surfaces, of cables and layers.
TEST(MeasureGradient, AgreesWithDifferences) {
  RobotSpec quadratic = chambers_beam(2);
  quadratic.mesh_options.quadratic = true;
  for (const RobotSpec& spec :
       {robot_of_many_outputs(), quadratic, robot_with_bags({"bag"}), cable_beam(), dea_strip()}) {
    const Model model = compile(spec);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> any(-1, 1);
    Points positions = model.rest, moves = model.rest;
    for (Index k = 0; k < positions.size(); ++k) {
      positions.data()[k] += 0.3 * any(random);
      moves.data()[k] = any(random);
    }
    for (const Actuator& actuator : model.actuators) {
      const double step = 1e-5, slope = measure_gradient(model, actuator, positions).cwiseProduct(moves).sum();
      const double rest = actuator.rest_measure / achieved_ratio(model, actuator, model.rest);
      const double difference = (achieved_ratio(model, actuator, positions + step * moves) -
                                 achieved_ratio(model, actuator, positions - step * moves)) *
                                rest / (2 * step);
      EXPECT_NEAR(slope, difference, 1e-6 * std::max(1.0, std::abs(slope))) << actuator.name;
    }
  }
}

}  // namespace
}  // namespace softkin
