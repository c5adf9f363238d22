#include <gtest/gtest.h>

#include <softkin/runs/force_pictures.hpp>

#include "small_runs.hpp"

namespace softkin::runs {
namespace {

Model touched_model() {
  return testing::block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{region: base}]\n"
      "actuators: []\n"
      "forces: [{name: push, region: tip, range: [[-1, 1], [-1, 1], [-1, 1]]},\n"
      "  {name: pull, point: [12, 6, 6], range: [[-1, 1], [-1, 1], [0, 0]]}]\n"
      "markers: [{name: tip, region: tip}]\n");
}

/// Returns an estimate of both forces with these deviations; the shape is that at rest, rotated by a quarter turn about
/// z.
Estimate made_up(const Model& model, const Vec3& force, const Eigen::VectorXd& deviations) {
  Estimate reported;
  reported.actuation = Actuation::Zero(model.actuators.size());
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Index at = a;
    reported.actuation[at] = a < 3 ? force[at] : 0;
    reported.numbers.push_back({model.actuators[a].name, "N", reported.actuation[at], deviations[at], 0, 1, 0, at});
  }
  const Index numbers = reported.numbers.size();
  reported.covariance = Eigen::MatrixXd::Zero(numbers + 2, numbers + 2);
  for (Index n = 0; n < numbers; ++n) reported.covariance(n, n) = deviations[n] * deviations[n];
  reported.state.positions = model.rest;
  for (Index v = 0; v < model.rest.rows(); ++v) {
    reported.state.positions(v, 0) = -model.rest(v, 1);
    reported.state.positions(v, 1) = model.rest(v, 0);
  }
  EstimatedPlace place{"push", Vec3(12, 6, 5), Vec3(-6, 12, 5)};
  place.covariance.diagonal() << 0, 4, 1;
  reported.places.push_back(place);
  return reported;
}

TEST(ForcePictures, ConeAndEllipseHoldNinetyPercent) {
  const Model model = touched_model();
  ASSERT_EQ(model.actuators.size(), 5u);
  Eigen::VectorXd deviations(5);
  deviations << 0.5, 0.2, 0.1, 0.3, 0.4;
  const std::vector<ForcePicture> pictures = ForcePictures(model).of(made_up(model, Vec3(2, 0, 0), deviations));
  ASSERT_EQ(pictures.size(), 2u);
  const ForcePicture& push = pictures[0];
  EXPECT_EQ(push.name, "push");
  EXPECT_EQ(push.force, Vec3(2, 0, 0));
  EXPECT_DOUBLE_EQ(push.deviation, 0.5);
  // of two numbers as of chi-square with two freedoms, exp(-f^2 / 2) = 10 %
  EXPECT_NEAR(std::exp(-ellipse_90 * ellipse_90 / 2), 0.1, 1e-12);
  EXPECT_NEAR(std::erf(interval_90 / std::sqrt(2.0)), 0.9, 1e-12);
  EXPECT_NEAR(std::abs(push.across[0][1]), ellipse_90 * 0.2, 1e-12);
  EXPECT_NEAR(std::abs(push.across[1][2]), ellipse_90 * 0.1, 1e-12);
  EXPECT_NEAR(push.across[0][0], 0, 1e-12);
  // the face x = 12 has turned to y = 12, and the ellipse with it
  EXPECT_EQ(push.at, Vec3(-6, 12, 5));
  ASSERT_TRUE(push.place.has_value());
  EXPECT_NEAR(std::abs((*push.place)[0][0]), ellipse_90 * 2, 1e-9);
  EXPECT_NEAR(std::abs((*push.place)[1][2]), ellipse_90 * 1, 1e-9);
  EXPECT_NEAR((*push.place)[0][1], 0, 1e-9);
  // of 0 N every direction is across; a point is where it is
  const ForcePicture& pull = pictures[1];
  EXPECT_FALSE(pull.place.has_value());
  EXPECT_NEAR((pull.at - Vec3(-6, 12, 6)).norm(), 0, 1e-9);
  EXPECT_NEAR(std::abs(pull.across[0][1]), ellipse_90 * 0.4, 1e-12);
  EXPECT_NEAR(std::abs(pull.across[1][0]), ellipse_90 * 0.3, 1e-12);
}

/// The force is known along z: a single number is estimated across it.
TEST(ForcePictures, OneNumberAcrossHasAnInterval) {
  const Model model = touched_model();
  Eigen::VectorXd deviations(5);
  deviations << 0.5, 0.2, 0, 0, 0;
  const std::vector<ForcePicture> pictures = ForcePictures(model).of(made_up(model, Vec3(2, 0, 0), deviations));
  EXPECT_NEAR(pictures[0].across[0].norm(), interval_90 * 0.2, 1e-12);
  EXPECT_EQ(pictures[0].across[1], Vec3(0, 0, 0));
  EXPECT_EQ(pictures[1].across[0], Vec3(0, 0, 0));
}

}  // namespace
}  // namespace softkin::runs
