#include <gtest/gtest.h>

#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/inverse_response.hpp>

#include "statics/difference.hpp"
#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

/// A block whose markers are three of its corners.
Model marked_block() {
  RobotSpec spec = physical_robot(block_mesh({1, 1, 1}, {10, 10, 10}));
  spec.markers = {{"origin", {Vec3(0, 0, 0), {}}}, {"right", {Vec3(10, 0, 0), {}}}, {"high", {Vec3(0, 0, 10), {}}}};
  return compile(spec);
}

double error_of(const Model& model, const Goal& goal, const Points& positions) {
  return goal_errors(model, {goal}, positions)[0];
}

TEST(Goal, ErrorsAreDistances) {
  const Model model = marked_block();
  const Points& at = model.rest;
  EXPECT_NEAR(error_of(model, {PositionGoal{1, {10, 3, 4}}}, at), 5, 1e-12);
  EXPECT_NEAR(error_of(model, {PositionGoal{1, {10, 3, 4}, {true, false, true}}, 9}, at), 4, 1e-12);
  EXPECT_NEAR(error_of(model, {PlaneGoal{2, {7, 7, 4}, {0, 0, 5}}}, at), 6, 1e-12);
  EXPECT_NEAR(error_of(model, {PlaneGoal{1, {0, 0, 0}, {1, 1, 0}}}, at), 10 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(error_of(model, {DirectionGoal{0, 1, {2, 0, 0}}}, at), 0, 1e-12);
  EXPECT_NEAR(error_of(model, {DirectionGoal{0, 1, {0, 0, 1}, 30}}, at), 30 * std::sqrt(2), 1e-12);
  EXPECT_NEAR(error_of(model, {DirectionGoal{1, 0, {1, 0, 0}}}, at), 2, 1e-12);
}

TEST(Goal, TermsAreWeightedErrors) {
  const Model model = marked_block();
  const std::vector<Goal> goals{{PositionGoal{1, {10, 3, 4}, {false, true, true}}, 4}, {PlaneGoal{2, {0, 0, 4}}, 0.25}};
  const Eigen::VectorXd terms = inverse::goal_terms(model, goals, model.rest);
  ASSERT_EQ(terms.size(), 3);
  EXPECT_NEAR(terms[0], -6, 1e-12);
  EXPECT_NEAR(terms[1], -8, 1e-12);
  EXPECT_NEAR(terms[2], 3, 1e-12);
}

TEST(Goal, SlopesEqualDifferences) {
  const Model model = marked_block();
  const std::vector<Goal> goals{{PositionGoal{1, {1, 2, 3}}, 2},
                                {PlaneGoal{2, {1, 2, 3}, {1, -2, 0.5}}, 3},
                                {DirectionGoal{0, 2, {1, 1, 1}, 7}, 0.5}};
  const Points at = model.rest + noise(model.rest.rows(), 1, 1);
  Sensitivity along;
  for (const unsigned seed : {2u, 3u}) along.positions.push_back(noise(model.rest.rows(), 1, seed));
  const Eigen::MatrixXd slopes = inverse::goal_slopes(model, goals, at, along);
  ASSERT_EQ(slopes.rows(), 7);
  ASSERT_EQ(slopes.cols(), 2);
  constexpr double reach = 1e-5;
  for (Index a = 0; a < 2; ++a) {
    const Points& move = along.positions[a];
    const Eigen::VectorXd change =
        (inverse::goal_terms(model, goals, at + reach * move) - inverse::goal_terms(model, goals, at - reach * move)) /
        (2 * reach);
    EXPECT_LT((slopes.col(a) - change).norm(), 1e-8 * change.norm());
  }
}

TEST(Goal, MarkersThatLieOnEachOtherHaveNoDirection) {
  const Model model = marked_block();
  Points at = model.rest;
  at.setZero();
  const std::vector<Goal> goals{{DirectionGoal{0, 1, {1, 0, 0}, 3}}};
  Sensitivity along;
  along.positions.push_back(noise(at.rows(), 1, 1));
  EXPECT_NEAR(goal_errors(model, goals, at)[0], 3, 1e-12);
  EXPECT_TRUE(inverse::goal_slopes(model, goals, at, along).isZero(0));
}

TEST(Goal, RefusesWhatMeansNothing) {
  const Model model = marked_block();
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto refused = [&](const Goal& goal, const std::string& part) {
    try {
      check_goals(model, {{PositionGoal{}}, goal});
      ADD_FAILURE() << "accepted: " << part;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("goal 2: "), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused({PositionGoal{3}}, "no marker number 3");
  refused({PositionGoal{-1}}, "no marker number -1");
  refused({PositionGoal{0, {0, nan, 0}}}, "not finite");
  refused({PositionGoal{0, {0, inf, 0}}}, "not finite");
  refused({PositionGoal{0, {0, 0, 0}, {false, false, false}}}, "no coordinate");
  refused({PositionGoal{}, 0}, "weight");
  refused({PositionGoal{}, nan}, "weight");
  refused({PlaneGoal{9}}, "no marker number 9");
  refused({PlaneGoal{0, {nan, 0, 0}}}, "not finite");
  refused({PlaneGoal{0, {0, 0, 0}, {0, 0, 0}}}, "is zero");
  refused({DirectionGoal{0, 0}}, "itself");
  refused({DirectionGoal{0, 7}}, "no marker number 7");
  refused({DirectionGoal{0, 1, {0, 0, 0}}}, "is zero");
  refused({DirectionGoal{0, 1, {1, 0, 0}, -1}}, "lever");
  EXPECT_THROW(check_goals(model, {}), InvalidInput);
  EXPECT_NO_THROW(check_goals(model, {{PositionGoal{}}, {PlaneGoal{}}, {DirectionGoal{0, 1}}}));
}

}  // namespace
}  // namespace softkin
