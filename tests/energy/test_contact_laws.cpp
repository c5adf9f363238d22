#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <softkin/energy/contact_laws.hpp>

namespace softkin::energy {

namespace {

using LengthLawOf = std::function<LengthLaw(double)>;

/// Slope and curvature against central differences of value and slope.
void expect_differences(const LengthLawOf& law, double x, double step) {
  const LengthLaw at = law(x), low = law(x - step), high = law(x + step);
  EXPECT_NEAR(at.slope, (high.value - low.value) / (2 * step), 1e-6 * std::max(1.0, std::abs(at.slope))) << x;
  EXPECT_NEAR(at.curvature, (high.slope - low.slope) / (2 * step), 1e-6 * std::max(1.0, std::abs(at.curvature))) << x;
}

}  // namespace

TEST(ContactLaws, DerivativesOfTheBarrier) {
  constexpr double reach = 0.3;
  const LengthLawOf law = [](double gap) { return barrier(gap, reach); };
  for (const double fraction : {1e-3, 0.01, 0.1, 0.5, 0.9, 0.999, 1.2})
    expect_differences(law, fraction * reach, 1e-5 * fraction);
}

/// The values of the formula, at a tenth and at half of the reach.
TEST(ContactLaws, TheBarrierIsThatOfItsEquation) {
  for (const double z : {0.1, 0.5}) {
    EXPECT_NEAR(barrier(2 * z, 2).value, -2 * (z - 1) * (z - 1) * std::log(z), 1e-14);
    EXPECT_NEAR(barrier(2 * z, 2).slope, -2 * (z - 1) * std::log(z) - (z - 1) * (z - 1) / z, 1e-14);
  }
}

TEST(ContactLaws, TheBarrierRepelsTheMoreTheNearer) {
  double last = 0;
  for (double gap = 1; gap > 1e-12; gap *= 0.7) {
    const LengthLaw law = barrier(gap, 1);
    EXPECT_LE(law.slope, last);
    EXPECT_GE(law.curvature, 0);
    last = law.slope;
  }
  EXPECT_LT(last, -1e11);
}

TEST(ContactLaws, TheBarrierEndsSmoothly) {
  for (const double gap : {1.0, 1.5, HUGE_VAL}) {
    const LengthLaw law = barrier(gap, 1);
    EXPECT_EQ(law.value, 0);
    EXPECT_EQ(law.slope, 0);
    EXPECT_EQ(law.curvature, 0);
  }
  const LengthLaw inside = barrier(1 - 1e-6, 1);
  EXPECT_GT(inside.value, 0);
  EXPECT_LT(inside.value, 1e-17);
  EXPECT_NEAR(inside.curvature, 6e-6, 1e-10);  // -2 ln z - 4 (z - 1) / z + ... = 6 (1 - z) to first order
}

TEST(ContactLaws, DerivativesOfFriction) {
  constexpr double creep = 1e-2;
  const LengthLawOf law = [](double slip) { return friction(slip, creep); };
  for (const double fraction : {1e-3, 0.1, 0.5, 0.99, 1.1, 7.0}) expect_differences(law, fraction * creep, 1e-7);
}

TEST(ContactLaws, FrictionIsCoulombsBeyondItsCreep) {
  EXPECT_EQ(friction(0, 1).slope, 0);
  EXPECT_EQ(friction(1, 1).slope, 1);
  EXPECT_EQ(friction(5, 1).slope, 1);
  EXPECT_NEAR(friction(5, 1).value - friction(3, 1).value, 2, 1e-15);
  EXPECT_NEAR(friction(1 - 1e-12, 1).value, friction(1, 1).value, 1e-11);
}

}  // namespace softkin::energy
