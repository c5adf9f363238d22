#include <gtest/gtest.h>

#include <random>
#include <softkin/model/backlash.hpp>

/// Effective commands of motors with play.

namespace softkin {

namespace {

Model two_loads(double first, double second) {
  Model model;
  for (const double backlash : {first, second}) {
    Actuator actuator;
    actuator.control = Control::load;
    actuator.rest = 0;
    actuator.backlash = backlash;
    model.actuators.push_back(actuator);
  }
  return model;
}

Actuation pair_of(double first, double second) {
  return (Actuation(2) << first, second).finished();
}

}  // namespace

TEST(Backlash, LagsBehindWhatFalls) {
  const Model model = two_loads(0.5, 0);
  const std::vector<double> reported{0, 1, 3, 2.8, 2, 1, 1.2, 1.5, 1.6, 0, -2},
      acts{0, 1, 3, 3, 2.5, 1.5, 1.5, 1.5, 1.6, 0.5, -1.5};
  std::vector<Actuation> commands;
  for (const double each : reported) commands.push_back(pair_of(each, each));
  const std::vector<Actuation> found = acting_in_order(model, model.rest_actuation(), commands);
  ASSERT_EQ(found.size(), reported.size());
  for (std::size_t i = 0; i < reported.size(); ++i) {
    EXPECT_DOUBLE_EQ(found[i][0], acts[i]) << i;
    EXPECT_EQ(found[i][1], reported[i]) << "without backlash";
  }
  EXPECT_DOUBLE_EQ(acting_in_order(model, pair_of(4, 4), commands)[0][0], 0.5) << "a start that is known";
}

/// Play knows no rate: commands in between change nothing, as a block that two stops push to and fro knows but where it
/// is pushed to.
TEST(Backlash, KnowsNoRate) {
  const Model model = two_loads(0.7, 0);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> anywhere(0, 3);
  double block = 0, motor = 0;
  Actuation before = pair_of(0, 0);
  for (int i = 0; i < 200; ++i) {
    const double reported = anywhere(engine);
    before = acting(model, before, pair_of(reported, 0));
    constexpr int pieces = 1000;
    for (int piece = 1; piece <= pieces; ++piece) {
      const double at = motor + (reported - motor) * piece / pieces;
      if (block < at) block = at;              // the stop that winds
      if (block > at + 0.7) block = at + 0.7;  // the one that lets go
    }
    motor = reported;
    EXPECT_NEAR(before[0], block, 1e-12) << i;
  }
}

}  // namespace softkin
