#include <gtest/gtest.h>

#include <mutex>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/map_robot.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

RobotSpec two_chambers_to_map() {
  RobotSpec spec = chambers_beam(2);
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 1;
    actuator.high = 1.5;
  }
  return spec;
}

/// Cables on both sides: where one is short the other is slack, or both pull.
RobotSpec two_cables_to_map() {
  RobotSpec spec = cable_beam();
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 0.85;
    actuator.high = 1.1;
  }
  return spec;
}

MapOptions quick() {
  MapOptions options;
  options.accuracy_mm = 1e-3;
  options.shape_accuracy_mm = 0.01;
  options.checks = 12;
  return options;
}

MapResult made(const Model& model, const MapOptions& options = quick()) {
  return build_map(model, options).value();
}

/// The map beside fresh solves of the robot from rest.
void expect_agreement(const Model& model, const MapResult& result, int points) {
  const KinematicMap map(result.data);
  const Statics statics(model);
  const maps::RowMatrix commands = maps::random_commands(result.data, points, 77);
  for (Index i = 0; i < points; ++i) {
    Actuation actuation = model.rest_actuation();
    for (Index j = 0; j < map.inputs(); ++j) actuation[result.data.inputs[j].actuator] = commands(i, j);
    const Equilibrium found = solve_converged(statics, actuation);
    Eigen::VectorXd values(map.outputs());
    const auto place = map.evaluate(commands.row(i).data(), values.data());
    ASSERT_TRUE(place);
    const Eigen::VectorXd expected = maps::outputs_of(model, result.data, found.state);
    for (Index q = 0; q < values.size(); ++q)
      EXPECT_NEAR(values[q], expected[q], 2 * result.data.outputs[q].accuracy) << result.data.outputs[q].name;
    EXPECT_LT(largest_move(map.shape(commands.row(i).data(), *place), found.state.positions), 0.02);
  }
}

/// Of the shape's largest strains, at points that the map was not checked at.
TEST(Map, StrainsOfTheShapeAreAsTheCheckSays) {
  const Model model = compile(two_chambers_to_map());
  const MapResult result = made(model);
  const KinematicMap map(result.data);
  const Statics statics(model);
  const maps::RowMatrix commands = maps::random_commands(result.data, 6, 78);
  double largest = 0;
  for (Index i = 0; i < commands.rows(); ++i) {
    Eigen::VectorXd values(map.outputs());
    const auto place = map.evaluate(commands.row(i).data(), values.data());
    ASSERT_TRUE(place);
    const auto greatest = [&](const Points& positions) {
      double found = -1;
      for (const auto& strain : deformation_of(model, positions).strain) found = std::max(found, strain[0]);
      return found;
    };
    const Points solved = solve_converged(statics, commands.row(i)).state.positions;
    largest = std::max(largest, std::abs(greatest(map.shape(commands.row(i).data(), *place)) - greatest(solved)));
  }
  EXPECT_GT(result.data.check.strain_largest, 0);
  EXPECT_LT(result.data.check.strain_largest, 0.01);
  EXPECT_LT(largest, 2 * result.data.check.strain_largest + 1e-9);
}

TEST(Map, ChambersAreAsTheSolverHasThem) {
  const Model model = compile(two_chambers_to_map());
  const MapResult result = made(model);
  EXPECT_TRUE(result.accurate) << result.remark;
  EXPECT_EQ(result.data.check.points, 12);
  EXPECT_LE(result.data.equilibria, 40);
  expect_agreement(model, result, 8);
}

/// A wiggle across the kink where a cable goes slack would be seen here.
TEST(Map, SlackCablesAreAsTheSolverHasThem) {
  const Model model = compile(two_cables_to_map());
  const MapResult result = made(model);
  EXPECT_TRUE(result.accurate) << result.remark;
  EXPECT_GE(result.data.pieces.size(), 3u);
  expect_agreement(model, result, 16);
}

TEST(Map, SlopesAreTheJacobian) {
  const Model model = compile(two_chambers_to_map());
  const MapResult result = made(model);
  const KinematicMap map(result.data);
  const Statics statics(model);
  const Eigen::VectorXd commands = Eigen::Vector2d(1.13, 1.37);
  Eigen::VectorXd values(map.outputs());
  maps::RowMatrix slopes(map.inputs(), map.outputs());
  ASSERT_TRUE(map.evaluate(commands.data(), values.data(), slopes.data()));
  const Eigen::MatrixXd expected = jacobian(statics, solve_converged(statics, commands), {0});
  EXPECT_LT((slopes.leftCols(3).transpose() - expected).cwiseAbs().maxCoeff(), 1e-3 * expected.norm());
}

TEST(Map, TheSameWithAnyNumberOfThreads) {
  const Model model = compile(two_chambers_to_map());
  MapOptions options = quick();
  const MapData one = made(model, options).data;
  options.threads = 3;
  const MapData three = made(model, options).data;
  ASSERT_EQ(one.pieces.size(), three.pieces.size());
  EXPECT_EQ(one.pieces[0].cells[0].outputs.coefficients(), three.pieces[0].cells[0].outputs.coefficients());
  EXPECT_EQ(one.check.largest, three.check.largest);
}

/// A desk that knows what an earlier, stopped making has found.
class Memory : public MapDesk {
 public:
  std::optional<maps::Sample> known(Index piece, Index number, const Eigen::VectorXd& commands) override {
    const auto found = samples_.find({piece, number});
    if (found == samples_.end()) return std::nullopt;
    EXPECT_EQ(found->second.commands, commands);
    ++reported;
    return found->second;
  }
  void keep(Index piece, Index number, const maps::Sample& sample) override {
    EXPECT_FALSE(samples_.contains({piece, number}));
    samples_[{piece, number}] = sample;
  }
  std::size_t reported = 0;

 private:
  std::map<std::pair<Index, Index>, maps::Sample> samples_;
};

TEST(Map, AStoppedMakingIsGoneOnWith) {
  const Model model = compile(two_chambers_to_map());
  const MapData whole = made(model).data;
  Memory memory;
  std::optional<MapResult> result;
  for (int most = 5; !result && most < 200; most += 7) {
    int seen = 0;
    result = build_map(model, quick(), &memory,
                       [&](const MapProgress& at) { return at.equilibria + at.checks < most || ++seen < 0; });
  }
  ASSERT_TRUE(result);
  EXPECT_GT(memory.reported, 20u);
  EXPECT_EQ(result->data.pieces[0].cells[0].outputs.coefficients(), whole.pieces[0].cells[0].outputs.coefficients());
  EXPECT_EQ(result->data.check.largest, whole.check.largest);
}

TEST(Map, InverseKinematicsAsWithTheSolver) {
  for (const RobotSpec& spec : {two_chambers_to_map(), two_cables_to_map()}) {
    const Model model = compile(spec);
    const MapResult result = made(model);
    const KinematicMap map(result.data);
    const MapRobot robot(model, map);
    const Statics statics(model);
    const maps::RowMatrix commands = maps::random_commands(result.data, 4, 5);
    for (Index i = 0; i < 4; ++i) {
      Eigen::VectorXd values(map.outputs());
      ASSERT_TRUE(map.evaluate(commands.row(i).data(), values.data()));
      const Vec3 target = values.head<3>() + (i == 3 ? Vec3(0, 40, 40) : Vec3::Zero());  // out of reach
      const std::vector<Goal> goals{{PositionGoal{0, target, {true, false, true}}}};
      const InverseResult by_map = solve_inverse_from(robot.statics(), goals, model.rest_actuation());
      const InverseResult solved = solve_inverse_from(statics, goals, model.rest_actuation());
      EXPECT_EQ(by_map.status, solved.status);
      EXPECT_NEAR(by_map.errors_mm[0], solved.errors_mm[0], 2e-3);
      const Equilibrium there = solve_converged(statics, by_map.equilibrium.actuation);
      EXPECT_LT((model.markers[0].point.at(there.state.positions) -
                 model.markers[0].point.at(solved.equilibrium.state.positions))
                    .norm(),
                4e-3);
    }
  }
}

TEST(Map, RefusesWhatIsOutside) {
  const Model model = compile(two_chambers_to_map());
  const KinematicMap map(made(model).data);
  Eigen::VectorXd values(map.outputs());
  for (const Eigen::Vector2d& commands :
       {Eigen::Vector2d(0.99, 1.2), Eigen::Vector2d(1.2, 1.51), Eigen::Vector2d(std::nan(""), 1.2)})
    EXPECT_FALSE(map.evaluate(commands.data(), values.data()));
}

TEST(Map, RefusesRobotsThatHaveNone) {
  RobotSpec spec = two_chambers_to_map();
  spec.markers.clear();
  EXPECT_THROW((void)made(compile(spec)), InvalidInput);
  spec = two_chambers_to_map();
  for (ActuatorSpec& actuator : spec.actuators) actuator.low = actuator.high = 1;
  EXPECT_THROW((void)made(compile(spec)), InvalidInput);
  MapOptions options = quick();
  options.accuracy_mm = 0;
  EXPECT_THROW((void)made(compile(two_chambers_to_map()), options), InvalidInput);
}

}  // namespace
}  // namespace softkin
