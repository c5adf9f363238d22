#include <gtest/gtest.h>

#include <random>
#include <softkin/statics/physical/predictor_history.hpp>
#include <softkin/statics/statics.hpp>

#include "statics/physical_samples.hpp"

namespace softkin::physical {

namespace {

using namespace testing;

constexpr double tolerance = 1e-5;  // [mm]

LoadState load_state_at(double path) {
  return {Eigen::Vector2d(1 + path, 3 - 2 * path), 1};
}

/// A path whose vertices move by polynomials.
struct Curve {
  std::vector<Points> coefficients;

  explicit Curve(int degree) {
    std::mt19937 engine(5);
    std::normal_distribution<double> normal;
    for (int i = 0; i <= degree; ++i)
      coefficients.emplace_back(Points::NullaryExpr(20, 3, [&] { return normal(engine); }));
  }
  [[nodiscard]] Iterate at(double path) const {
    Points positions = Points::Zero(20, 3);
    double power = 1;
    for (const Points& coefficient : coefficients) {
      positions += power * coefficient;
      power *= path;
    }
    return {positions, Eigen::Vector2d(positions(0, 0), positions(1, 1))};
  }
};

PredictorHistory walked(const Curve& curve, const std::vector<double>& paths) {
  PredictorHistory predictor_history;
  for (const double path : paths) predictor_history.add(load_state_at(path), {true, true}, curve.at(path), {});
  return predictor_history;
}

}  // namespace

TEST(PredictorHistory, ReproducesPolynomials) {
  const std::vector<double> even{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6}, uneven{0, 0.1, 0.15, 0.22, 0.31, 0.47, 0.53};
  for (const int degree : {1, 3, 5})
    for (const auto& paths : {even, uneven})
      for (const double next : {0.6, 0.65, 0.4, 0.55}) {
        if (next == paths.back()) continue;
        const Curve curve(degree);
        const PredictorHistory predictor_history = walked(curve, paths);
        Iterate at = curve.at(paths.back());
        ASSERT_TRUE(predictor_history.extrapolate(load_state_at(paths.back()), load_state_at(next), {true, true},
                                                  tolerance, {}, at))
            << degree << " " << next;
        EXPECT_LT((at.positions - curve.at(next).positions).norm(), 1e-10) << degree << " " << next;
        EXPECT_LT((at.multipliers - curve.at(next).multipliers).norm(), 1e-10);
      }
}

TEST(PredictorHistory, RefusesToExtrapolateACornerOrAnotherActiveSet) {
  const Curve curve(9);
  const std::vector<double> paths{0, 0.4, 0.8, 1.2, 1.6, 2};
  const PredictorHistory predictor_history = walked(curve, paths);
  Iterate at = curve.at(2);
  EXPECT_FALSE(predictor_history.extrapolate(load_state_at(2), load_state_at(2.4), {true, true}, tolerance, {}, at));
  EXPECT_EQ(at.positions, curve.at(2).positions);
  // a straight path is predicted, but not with other constraints, from another state, or to the current load state
  const Curve straight(1);
  const PredictorHistory other = walked(straight, paths);
  at = straight.at(2);
  EXPECT_FALSE(other.extrapolate(load_state_at(2), load_state_at(2.4), {true, false}, tolerance, {}, at));
  EXPECT_FALSE(other.extrapolate(load_state_at(2), load_state_at(2), {true, true}, tolerance, {}, at));
  EXPECT_FALSE(other.extrapolate(load_state_at(1.9), load_state_at(2.4), {true, true}, tolerance, {}, at));
  EXPECT_TRUE(other.extrapolate(load_state_at(2), load_state_at(2.4), {true, true}, tolerance, {}, at));
  at = straight.at(2);
  at.positions(3, 1) += 1e-9;
  EXPECT_FALSE(other.extrapolate(load_state_at(2), load_state_at(2.4), {true, true}, tolerance, {}, at));
  at = straight.at(0.4);
  EXPECT_FALSE(
      walked(straight, {0, 0.4}).extrapolate(load_state_at(0.4), load_state_at(0.8), {true, true}, tolerance, {}, at));
}

/// Along a curved path of several loads each equilibrium has the requested loads, whatever the predictions.
TEST(PredictorHistory, SetsGivenLoadsToTheRequestedOnes) {
  RobotSpec spec = chambers_beam(3);
  for (ActuatorSpec& chamber : spec.actuators) chamber = by_load(chamber);
  spec.actuators.push_back(by_load(cable("rope", {{0, 1, 10}, {24, 1, 10}, {48, 1, 10}})));
  const Model model = compile(spec);
  const Statics tracked(model);
  State at = tracked.rest();
  double farthest = 0;
  for (int step = 0; step < 60; ++step) {
    const double t = 0.1 * step;
    Actuation loads(model.actuators.size());
    for (Index a = 0; a < loads.size(); ++a) loads[a] = 20 + 15 * std::sin((1 + 0.4 * a) * t + a);
    loads[loads.size() - 1] = 0.2 + 0.1 * std::cos(1.3 * t);
    const Equilibrium found = tracked.solve(loads, at);
    ASSERT_EQ(found.report.status, Status::converged);
    EXPECT_LT((found.state.multipliers - loads).cwiseAbs().maxCoeff(), 1e-9) << step;
    at = found.state;
    if (step % 10 != 9) continue;
    const Equilibrium fresh = Statics(model).solve(loads, Statics(model).rest());
    farthest = std::max(farthest, distance(fresh.state.positions, model.rest));
    EXPECT_LT(distance(found.state.positions, fresh.state.positions), 1e-4) << step;
  }
  EXPECT_GT(farthest, 0.2);
}

/// Where tangents do better they are not given up.
TEST(PredictorHistory, PrefersTheTangentWhereItWasCloser) {
  const Curve curve(9);
  const std::vector<double> paths{0, 0.01, 0.02, 0.03};
  PredictorHistory predictor_history = walked(curve, paths);
  Iterate at = curve.at(0.03);
  ASSERT_TRUE(predictor_history.extrapolate(load_state_at(0.03), load_state_at(0.04), {true, true}, tolerance, {}, at));
  const double missed = largest_move(at.positions, curve.at(0.04).positions);
  EXPECT_GT(missed, 0);
  at = curve.at(0.03);
  predictor_history.note_tangent(load_state_at(0.02), load_state_at(0.03), missed);
  EXPECT_FALSE(
      predictor_history.extrapolate(load_state_at(0.03), load_state_at(0.04), {true, true}, tolerance, {}, at));
  predictor_history.note_tangent(load_state_at(0.02), load_state_at(0.03), 1e3 * missed);
  EXPECT_TRUE(predictor_history.extrapolate(load_state_at(0.03), load_state_at(0.04), {true, true}, tolerance, {}, at));
}

/// Steps of one length come to the same equilibria as each would alone, in two thirds of the iterations.
TEST(PredictorHistory, SavesIterationsOnPaths) {
  const Model model = compile(bending_finger());
  const Statics together(model), apart(model);
  StaticsOptions alone;
  alone.reuse_factor = false;
  State state = together.rest();
  int iterations = 0, iterations_alone = 0;
  for (int step = 1; step <= 30; ++step) {
    const Actuation command = Actuation::Constant(1, 1 + 0.02 * step);
    const Equilibrium found = together.solve(command, state), fresh = apart.solve(command, state, alone);
    ASSERT_EQ(found.report.status, Status::converged);
    ASSERT_EQ(fresh.report.status, Status::converged);
    EXPECT_LT(largest_move(found.state.positions, fresh.state.positions), 1e-6) << step;
    if (step > 10) {
      iterations += found.report.iterations;
      iterations_alone += fresh.report.iterations;
    }
    state = found.state;
  }
  EXPECT_LE(3 * iterations, 2 * iterations_alone);
}

}  // namespace softkin::physical
