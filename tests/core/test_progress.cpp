#include <gtest/gtest.h>

#include <softkin/core/progress.hpp>

namespace softkin {
namespace {

TEST(TimeLeft, OfAnEvenPaceIsWhatIsLeft) {
  TimeLeft left;
  EXPECT_FALSE(left.at(0.1, 0.001));
  for (int i = 1; i <= 99; ++i) {
    const auto reported = left.at(0.5 * i, 0.01 * i);
    if (i < 2) continue;
    ASSERT_TRUE(reported) << i;
    EXPECT_NEAR(*reported, 0.5 * (100 - i), 1e-9) << i;
  }
}

/// 90 % in the first 10 s, then a hundredth a second: 10 s are left, not one.
TEST(TimeLeft, FollowsWorkThatSlowsDown) {
  TimeLeft left;
  for (int i = 1; i <= 100; ++i) (void)left.at(0.1 * i, 0.009 * i);
  for (int i = 1; i <= 60; ++i) (void)left.at(10 + 0.1 * i, 0.9 + 0.001 * i);
  EXPECT_NEAR(left.at(16.1, 0.961).value(), 3.9, 0.1);
  EXPECT_FALSE([&] {
    std::optional<double> reported;
    for (int i = 1; i <= 60; ++i) reported = left.at(16.1 + 0.1 * i, 0.961);
    return reported;
  }()) << "it stands still";
}

}  // namespace
}  // namespace softkin
