#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

Actuation random_actuation(const Model& model, std::mt19937& engine) {
  Actuation actuation(model.actuators.size());
  for (Index a = 0; a < actuation.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    actuation[a] = std::uniform_real_distribution<double>(actuator.low, actuator.high)(engine);
  }
  return actuation;
}

std::vector<Goal> at_point(const Vec3& target, Index marker = 0) {
  return {{PositionGoal{marker, target}}};
}

void expect_inside(const Model& model, const InverseResult& result) {
  std::vector<Actuation> all{result.equilibrium.actuation, result.equilibrium.state.actuation};
  for (const InverseTrial& record : result.history) all.push_back(record.actuation);
  for (const Actuation& actuation : all)
    for (std::size_t a = 0; a < model.actuators.size(); ++a) {
      EXPECT_GE(actuation[a], model.actuators[a].low);
      EXPECT_LE(actuation[a], model.actuators[a].high);
    }
  EXPECT_EQ(result.equilibria, static_cast<int>(result.history.size()));
}

/// The shape of the answer is the one that forward kinematics finds from rest.
void expect_equilibrium(const Statics& statics, const InverseResult& result) {
  const Equilibrium found = solve_converged(statics, result.equilibrium.actuation);
  EXPECT_LT(distance(found.state.positions, result.equilibrium.state.positions), 1e-4);
}

RobotSpec chambers(int count, double high = 1.6) {
  RobotSpec spec = chambers_beam(count);
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 1;
    actuator.high = high;
  }
  return spec;
}

RobotSpec two_cables() {
  RobotSpec spec = cable_beam();
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 0.7;
    actuator.high = 1.1;
  }
  return spec;
}

/// Three actuators of different kinds, one of them commanded by its load.
RobotSpec loaded_robot() {
  RobotSpec spec = chambers(2);
  spec.actuators[1] = by_load(spec.actuators[1], 0, 100);
  spec.actuators.push_back(cable("side", {{0, 10, 19}, {24, 10, 19}, {48, 10, 19}}, 0.8, 1));
  return spec;
}

void expect_reached(RobotSpec spec, int targets, unsigned seed) {
  const Model model = compile(spec);
  const Statics statics(model);
  std::mt19937 engine(seed);
  for (int i = 0; i < targets; ++i) {
    const Equilibrium made = solve_converged(statics, random_actuation(model, engine));
    const InverseResult result = solve_inverse(statics, at_point(marker_at(model, made)), statics.rest());
    ASSERT_EQ(result.status, InverseStatus::reached) << result.remark << ", error " << result.errors_mm.transpose();
    EXPECT_LE((marker_at(model, result.equilibrium) - marker_at(model, made)).norm(), 1e-3);
    EXPECT_NEAR((marker_at(model, result.equilibrium) - marker_at(model, made)).norm(), result.errors_mm[0], 1e-9);
    EXPECT_EQ(result.remark, "");
    EXPECT_TRUE(result.sensitivity.regular);
    expect_inside(model, result);
    expect_equilibrium(statics, result);
  }
}

TEST(Inverse, ReachesPointsOfChambers) {
  expect_reached(chambers(3), 4, 1);
}

TEST(Inverse, ReachesPointsOfCables) {
  expect_reached(two_cables(), 4, 2);
}

TEST(Inverse, ReachesPointsOfMixedControls) {
  expect_reached(loaded_robot(), 4, 3);
}

TEST(Inverse, ReachesPointsOfTargetShapes) {
  RobotSpec spec = mixed_robot(true);
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = std::max(actuator.low, 0.8);
    actuator.high = std::min(actuator.high, 1.4);
  }
  expect_reached(spec, 3, 4);
}

/// One equilibrium per cell corner; the least error.
double min_on_grid(const Model& model, const Statics& statics, const std::vector<Goal>& goals, int cells) {
  double least = HUGE_VAL;
  State state = statics.rest();
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      Actuation actuation(2);
      const int places[] = {i, i % 2 == 0 ? j : cells - j};  // neighbours from each other
      for (Index a = 0; a < 2; ++a) {
        const Actuator& actuator = model.actuators[a];
        actuation[a] = actuator.low + (actuator.high - actuator.low) * places[a] / cells;
      }
      const Equilibrium found = statics.solve(actuation, state);
      EXPECT_EQ(found.report.status, Status::converged);
      state = found.state;
      const Eigen::VectorXd errors = goal_errors(model, goals, state.positions);
      double sum = 0;
      for (std::size_t k = 0; k < goals.size(); ++k) sum += goals[k].weight * errors[k] * errors[k];
      least = std::min(least, std::sqrt(sum));
    }
  return least;
}

double weighted_error(const std::vector<Goal>& goals, const InverseResult& result) {
  double sum = 0;
  for (std::size_t k = 0; k < goals.size(); ++k) sum += goals[k].weight * std::pow(result.errors_mm[k], 2);
  return std::sqrt(sum);
}

void expect_nearest(const RobotSpec& spec, const std::vector<Goal>& goals, int cells, double resolution_mm) {
  const Model model = compile(spec);
  const Statics statics(model);
  const InverseResult result = solve_inverse(statics, goals, statics.rest());
  EXPECT_EQ(result.status, InverseStatus::unreachable) << result.remark;
  EXPECT_NE(result.remark, "");
  const double least = min_on_grid(model, statics, goals, cells), found = weighted_error(goals, result);
  EXPECT_GT(least, 0.1);
  EXPECT_LE(found, least + 1e-6);
  EXPECT_GE(found, least - resolution_mm);
  EXPECT_LT(result.slope, 1e-3);
  expect_inside(model, result);
}

TEST(Inverse, NearestPointOfTwoChambersIsThatOfTheGrid) {
  expect_nearest(chambers(2), at_point({50, 10, 0}), 12, 0.02);   // beyond what both can bend: ends of ranges
  expect_nearest(chambers(2), at_point({47, 12, 14}), 12, 0.02);  // beside the surface that the tip moves on
}

TEST(Inverse, NearestPointOfTwoCablesIsThatOfTheGrid) {
  expect_nearest(two_cables(), at_point({50, 5, 30}), 20, 0.3);  // off the line of the tip; one cable slack
}

TEST(Inverse, WeightsDecideBetweenGoals) {
  RobotSpec spec = chambers(2);
  spec.markers.push_back({"middle", {Vec3(24, 10, 20), {}}});
  for (const double weight : {0.05, 1.0, 20.0})
    expect_nearest(spec, {{PositionGoal{0, {48, 10, 4}}, weight}, {PositionGoal{1, {24, 10, 26}}}}, 12, 0.05);
}

TEST(Inverse, TellsWhichRangesBind) {
  const Model model = compile(chambers(2));
  const Statics statics(model);
  const InverseResult far = solve_inverse(statics, at_point({200, 10, 100}), statics.rest());
  EXPECT_EQ(far.status, InverseStatus::unreachable);
  for (Index a = 0; a < 2; ++a) {
    const auto& actuator = model.actuators[a];
    const double value = far.equilibrium.actuation[a];
    const int active = far.active[a];
    EXPECT_EQ(active, value == actuator.high ? 1 : value == actuator.low ? -1 : 0);
  }
  EXPECT_NE(far.active, (std::vector<int>{0, 0}));
}

/// Two cables and one coordinate: along the curve of actuations that meet it, the nearest to the start.
TEST(Inverse, OfManyAnswersTheNearest) {
  const Model model = compile(chambers(2));
  const Statics statics(model);
  const Equilibrium first = solve_converged(statics, values({1.3, 1.1}));
  const double target = marker_at(model, solve_converged(statics, values({1.3, 1.4}))).z();
  const std::vector<Goal> goals{{PositionGoal{0, {0, 0, target}, {false, false, true}}}};
  for (const Actuation& preferred : {Actuation(), values({1.5, 1.5})}) {
    InverseOptions options;
    options.preferred = preferred;
    const InverseResult result = solve_inverse(statics, goals, first.state, options);
    ASSERT_EQ(result.status, InverseStatus::reached) << result.remark;
    const Actuation& near = preferred.size() > 0 ? preferred : first.actuation;
    double least = HUGE_VAL;
    State state = first.state;
    for (double one = 1.2; one <= 1.5; one += 0.01) {  // the other by bisection; z rises with both
      double low = 1, high = 1.6, z = 0;
      for (int halving = 0; halving < 15; ++halving) {
        const double two = 0.5 * (low + high);
        const Equilibrium found = statics.solve(values({one, two}), state);
        z = marker_at(model, found).z();
        state = found.state;
        (z < target ? low : high) = two;
      }
      if (std::abs(z - target) < 1e-3) least = std::min(least, (values({one, low}) - near).norm());
    }
    EXPECT_LE((result.equilibrium.actuation - near).norm(), least + 1e-3);
    EXPECT_GE((result.equilibrium.actuation - near).norm(), least - 1e-3);
  }
}

TEST(Inverse, PullsASlackCableAndLeavesTheOtherSlack) {
  const Model model = compile(two_cables());
  const Statics statics(model);
  const Equilibrium made = solve_converged(statics, values({0.85, 1.1}));
  const Equilibrium slack = solve_converged(statics, values({1.1, 1.08}));
  const InverseResult result = solve_inverse(statics, at_point(marker_at(model, made)), slack.state);
  ASSERT_EQ(result.status, InverseStatus::reached) << result.remark;
  EXPECT_NEAR(result.equilibrium.actuation[0], 0.85, 1e-4);
  EXPECT_DOUBLE_EQ(result.equilibrium.actuation[1], 1.08);  // as it was at the start
  EXPECT_EQ(result.equilibrium.state.multipliers[1], 0);
  EXPECT_TRUE(result.sensitivity.positions[1].isZero(0));
  expect_equilibrium(statics, result);
}

TEST(Inverse, PlanesAndDirections) {
  RobotSpec spec = chambers(3);
  spec.markers.push_back({"side", {Vec3(48, 0, 10), {}}});
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium made = solve_converged(statics, values({1.1, 1.3, 1.45}));
  const Vec3 tip = marker_at(model, made), side = marker_at(model, made, 1), normal(1, 2, -0.5);
  const std::vector<Goal> goals{{PlaneGoal{0, tip + normal.cross(Vec3(0, 0, 9)), normal}, 2},
                                {DirectionGoal{0, 1, 3 * (side - tip), 20}}};
  const InverseResult result = solve_inverse(statics, goals, statics.rest());
  ASSERT_EQ(result.status, InverseStatus::reached) << result.remark;
  const Vec3 found_tip = marker_at(model, result.equilibrium), found_side = marker_at(model, result.equilibrium, 1);
  EXPECT_LT(std::abs((found_tip - tip).dot(normal.normalized())), 1e-3);
  EXPECT_LT((found_side - found_tip).normalized().cross((side - tip).normalized()).norm(), 1e-3 / 20 * 1.01);
  EXPECT_GT((found_side - found_tip).dot(side - tip), 0);
  EXPECT_EQ(result.errors_mm.size(), 2);
}

TEST(Inverse, FixedActuatorsStay) {
  const Model model = compile(chambers(3));
  const Statics statics(model);
  const Equilibrium made = solve_converged(statics, values({1.2, 1.3, 1.4}));
  const Equilibrium start = solve_converged(statics, values({1.0, 1.1, 1.4}));
  InverseOptions options;
  options.free = {true, true, false};
  const InverseResult result = solve_inverse(statics, at_point(marker_at(model, made)), start.state, options);
  ASSERT_EQ(result.status, InverseStatus::reached) << result.remark;
  EXPECT_EQ(result.equilibrium.actuation[2], 1.4);
  EXPECT_LT((result.equilibrium.actuation - made.actuation).norm(), 1e-3);
  for (const InverseTrial& record : result.history) EXPECT_EQ(record.actuation[2], 1.4);
  options.free = {false, false, false};
  const InverseResult still = solve_inverse(statics, at_point(marker_at(model, made)), start.state, options);
  EXPECT_EQ(still.status, InverseStatus::unreachable);
  EXPECT_EQ(still.equilibrium.actuation, start.actuation);
}

TEST(Inverse, AWarmTargetCostsOneEquilibriumOrTwo) {
  const Model model = compile(chambers(3));
  const Statics statics(model);
  const auto on_path = [](int i) -> Actuation { return values({1.2, 1.3, 1.4}) + 0.005 * i * values({1, -1, 0.5}); };
  InverseResult last;
  last.equilibrium = solve_converged(statics, on_path(0));
  InverseOptions options;
  int equilibria = 0;
  for (int i = 1; i <= 10; ++i) {
    const Vec3 target = marker_at(model, solve_converged(statics, on_path(i)));
    InverseResult next = solve_inverse(statics, at_point(target), last.equilibrium.state, options);
    ASSERT_EQ(next.status, InverseStatus::reached);
    const InverseResult computed = [&] {
      InverseOptions fresh = options;
      fresh.start_sensitivity = nullptr;
      return solve_inverse(statics, at_point(target), last.equilibrium.state, fresh);
    }();
    EXPECT_LT((computed.equilibrium.actuation - next.equilibrium.actuation).norm(), 1e-4);
    EXPECT_EQ(computed.equilibria, next.equilibria);
    equilibria += next.equilibria;
    last = std::move(next);
    options.start_sensitivity = &last.sensitivity;
  }
  EXPECT_LE(equilibria, 20);
  // and where it is already, none
  EXPECT_EQ(solve_inverse(statics, at_point(marker_at(model, last.equilibrium)), last.equilibrium).equilibria, 0);
}

TEST(Inverse, SensitivityIsThatOfTheAnswer) {
  const Model model = compile(loaded_robot());
  const Statics statics(model);
  const Equilibrium made = solve_converged(statics, values({1.3, 20, 0.95}));
  const InverseResult result = solve_inverse(statics, at_point(marker_at(model, made)), statics.rest());
  ASSERT_EQ(result.status, InverseStatus::reached);
  const Eigen::MatrixXd found = jacobian(model, result.equilibrium.state.positions, result.sensitivity, {0});
  for (Index a = 0; a < 3; ++a) {
    const double reach = a == 1 ? 0.01 : 1e-4;
    Actuation high = result.equilibrium.actuation, low = high;
    high[a] += reach;
    low[a] -= reach;
    const Vec3 change = (marker_at(model, statics.solve(high, result.equilibrium.state, tight())) -
                         marker_at(model, statics.solve(low, result.equilibrium.state, tight()))) /
                        (2 * reach);
    EXPECT_LT((found.col(a) - change).norm(), 1e-3 * change.norm()) << a;
  }
}

/// A pressure beyond which there is no equilibrium lies inside the range.
TEST(Inverse, StopsWhereEquilibriaEnd) {
  RobotSpec spec = bending_finger();
  spec.actuators[0] = by_load(spec.actuators[0], -1e4, 1e4);
  const Model model = compile(spec);
  const Statics statics(model);
  InverseOptions options;
  options.other_starts = 0;
  const InverseResult result = solve_inverse(statics, at_point({-500, 6, -500}), statics.rest(), options);
  expect_inside(model, result);
  EXPECT_TRUE(result.status == InverseStatus::unreachable || result.status == InverseStatus::not_converged);
  EXPECT_NE(result.remark, "");
  EXPECT_TRUE(result.equilibrium.state.positions.allFinite());
  bool limit = false;
  for (const InverseTrial& record : result.history) limit = limit || record.status != Status::converged;
  EXPECT_TRUE(limit);
  // what it returns is an equilibrium all the same: that of its volume, which exists beyond the greatest pressure too
  const Model by_volume = compile(bending_finger());
  const Statics volumes(by_volume);
  const double ratio = achieved_ratio(model, model.actuators[0], result.equilibrium.state.positions);
  const Equilibrium again = solve_converged(volumes, values({ratio}));
  EXPECT_LT(distance(again.state.positions, result.equilibrium.state.positions), 1e-2);
  EXPECT_NEAR(again.state.multipliers[0], result.equilibrium.actuation[0], 1e-3 * result.equilibrium.actuation[0]);
}

TEST(Inverse, CanBeInterrupted) {
  const Model model = compile(chambers(2));
  const Statics statics(model);
  int calls = 0;
  const InverseResult result =
      solve_inverse(statics, at_point({40, 10, 0}), statics.rest(), {}, [&](const Progress& p) {
        EXPECT_GE(p.iteration, 0);
        return ++calls < 6;
      });
  EXPECT_EQ(result.status, InverseStatus::interrupted);
  EXPECT_EQ(calls, 6);
  EXPECT_TRUE(result.equilibrium.state.positions.allFinite());
  expect_inside(model, result);
}

TEST(Inverse, EndsWithItsAllowance) {
  const Model model = compile(chambers(2));
  const Statics statics(model);
  InverseOptions options;
  options.max_equilibria = 2;
  const Vec3 target = marker_at(model, solve_converged(statics, values({1.5, 1.2})));
  const InverseResult result = solve_inverse(statics, at_point(target), statics.rest(), options);
  EXPECT_EQ(result.status, InverseStatus::not_converged);
  EXPECT_EQ(result.equilibria, 2);
  EXPECT_NE(result.remark.find("2 equilibria"), std::string::npos) << result.remark;
}

TEST(Inverse, RefusesBadOptions) {
  const Model model = compile(chambers(2));
  const Statics statics(model);
  const auto refused = [&](const State& start, const InverseOptions& options) {
    EXPECT_THROW((void)solve_inverse(statics, at_point({48, 10, 5}), start, options), InvalidInput);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](const auto& change) {
    InverseOptions options;
    change(options);
    return options;
  };
  refused(statics.rest(), with([&](auto& o) { o.tolerance_mm = 0; }));
  refused(statics.rest(), with([&](auto& o) { o.tolerance_mm = nan; }));
  refused(statics.rest(), with([&](auto& o) { o.max_equilibria = 0; }));
  refused(statics.rest(), with([&](auto& o) { o.max_iterations = 0; }));
  refused(statics.rest(), with([&](auto& o) { o.other_starts = -1; }));
  refused(statics.rest(), with([&](auto& o) { o.preferred_tolerance = 0; }));
  refused(statics.rest(), with([&](auto& o) { o.preferred = values({1}); }));
  refused(statics.rest(), with([&](auto& o) { o.preferred = values({1, 3}); }));
  refused(statics.rest(), with([&](auto& o) { o.free = {true}; }));
  const Sensitivity none;
  refused(statics.rest(), with([&](auto& o) { o.start_sensitivity = &none; }));
  State start = statics.rest();
  start.actuation = values({1, 0.5});
  refused(start, {});
  start = statics.rest();
  start.positions(0, 0) = nan;
  refused(start, {});
  EXPECT_THROW((void)solve_inverse(statics, at_point({nan, 0, 0}), statics.rest()), InvalidInput);
  EXPECT_THROW((void)solve_inverse(statics, {}, statics.rest()), InvalidInput);
}

}  // namespace
}  // namespace softkin
