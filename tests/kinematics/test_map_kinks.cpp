#include <gtest/gtest.h>

#include "runs/small_maps.hpp"

namespace softkin {
namespace {

using runs::testing::askew_map;
using runs::testing::ending_map;
using runs::testing::TwoCables;

/// Pieces that agree up to an error: near the kink the taut cable has a negative tension, and the slack one is too
/// long.
TEST(MapKinks, AreWhatThePiecesSayUpToTheirAccuracy) {
  const KinematicMap map(askew_map());
  int circles = 0;
  Eigen::VectorXd values(map.outputs());
  for (int k = 0; k <= 200; ++k) {
    const double air = 1, free = TwoCables::free_ratios(air)[0];
    const Eigen::Vector3d commands(air, free - 0.03 + 0.0003 * k, 1.2);  // the second is slack
    ASSERT_TRUE(map.evaluate(commands.data(), values.data())) << k;
    if (commands[1] > free && commands[1] < free + 0.02) {
      ++circles;
      EXPECT_NEAR(values[3], (free - commands[1]) / 0.02, 1e-6) << k;  // taut: the ratio has no accuracy
    }
  }
  EXPECT_GT(circles, 50);
}

TEST(MapKinks, ThatContradictEachOtherAreOutside) {
  MapData data = askew_map();
  for (MapOutput& output : data.outputs) output.accuracy = 1e-4;
  const KinematicMap map(std::move(data));
  Eigen::VectorXd values(map.outputs());
  const double free = TwoCables::free_ratios(1)[0];
  EXPECT_FALSE(map.evaluate(Eigen::Vector3d(1, free + 0.01, 1.2).eval().data(), values.data()));
  EXPECT_TRUE(map.evaluate(Eigen::Vector3d(1, free - 0.01, 1.2).eval().data(), values.data()));
  EXPECT_TRUE(map.evaluate(Eigen::Vector3d(1, free + 0.03, 1.2).eval().data(), values.data()));
}

/// As at rest, where ranges end and tensions are 0 but for an error.
TEST(MapKinks, WithoutAPieceBeyondThemEndAtTheAccuracy) {
  const KinematicMap map(ending_map());
  Eigen::VectorXd values(map.outputs());
  int inside = 0, beyond = 0;
  for (int k = 0; k <= 400; ++k) {
    const Eigen::Vector3d commands(1, 0.8 + 0.0007 * k, 0.85);
    const Eigen::VectorXd taut = TwoCables().outputs(1, commands.tail<2>(), {true, true});
    const double least = std::min(taut[3], taut[5]);
    if (std::abs(least + 8) < 1e-3) continue;
    ASSERT_EQ(map.evaluate(commands.data(), values.data()).has_value(), least > -8) << k << " " << least;
    if (least < 0) ++(least > -8 ? inside : beyond);
    if (least > -8) {
      EXPECT_LT((values - taut).cwiseAbs().maxCoeff(), 1e-6) << k;
    }
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(beyond, 20);
}

}  // namespace
}  // namespace softkin
