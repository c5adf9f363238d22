#include <cstdio>
#include <softkin/statics/statics.hpp>

#include "statics/physical_samples.hpp"
#include "statics/reference_cases.hpp"

namespace softkin {

namespace {

using testing::actuator;
using testing::reference_material;
using testing::reference_robot;
using testing::ReferenceLaw;

/// The finger of 14,822 tetrahedra, of which CalculiX needs 139 iterations to 240 degrees of bend.
RobotSpec reference_finger() {
  RobotSpec spec = reference_robot("finger_15k", false);
  spec.materials = {reference_material("body", ReferenceLaw::lin, 12, 0.4)};
  spec.fixed.push_back({{std::string("fixed"), {}}, {true, true, true}});
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 1, 3, true);
  spec.actuators = {air};
  return spec;
}

/// How far the first step is corrected, over how far it was predicted to move.
double missed_by_prediction(const RobotSpec& spec) {
  const Model model = compile(spec);
  StaticsOptions options = testing::tight(1e-9);
  options.trace = true;
  const Equilibrium found = Statics(model).solve(model.rest_actuation(), Statics(model).rest(), options);
  EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
  EXPECT_EQ(found.report.trace.size(), 1u);
  return found.report.trace[0].corrected_mm / found.report.trace[0].predicted_mm;
}

/// The reference's rows about 240 degrees: 1.68.
constexpr double ratio_at_240_degrees = 1.68;

}  // namespace

TEST(PhysicalSteps, FromRestTo240DegreesInOneCall) {
  SKIP_WITHOUT_TABLE("finger_15k.msh");
  const Model model = compile(reference_finger());
  const Statics statics(model);
  const Equilibrium found = statics.solve(Actuation::Constant(1, ratio_at_240_degrees), statics.rest());
  EXPECT_EQ(found.report.status, Status::converged);
  std::printf("  %d factorisations, %d iterations\n", found.report.factorisations, found.report.iterations);
  EXPECT_LE(found.report.factorisations, 50);
}

/// At most 8 factorisations a step of 0.1, and at its end the residual falls ever faster: each of the last falls by
/// more than the one before, until rounding.
TEST(PhysicalSteps, StepsOfATenth) {
  SKIP_WITHOUT_TABLE("finger_15k.msh");
  const Model model = compile(reference_finger());
  const Statics statics(model);
  State state = statics.rest();
  int total = 0;
  for (double ratio = 1.1; ratio < 1.75; ratio += 0.1) {
    const Equilibrium found = statics.solve(Actuation::Constant(1, ratio), state);
    ASSERT_EQ(found.report.status, Status::converged);
    EXPECT_LE(found.report.factorisations, 8) << ratio;
    total += found.report.factorisations;
    const auto& history = found.report.history;
    ASSERT_GE(history.size(), 3u);
    EXPECT_LT(history.back().step_mm, 0.1 * history[history.size() - 2].step_mm) << ratio;
    EXPECT_LT(found.report.gradient_norm, 1e-5 * history.front().gradient_norm) << ratio;
    state = found.state;
  }
  std::printf("  %d factorisations in 7 steps\n", total);
  EXPECT_LE(total, 50);
}

/// What a support carries along of a cable changes its length, too: a robot that is only moved stays as it is.
TEST(PhysicalSteps, ACableThatIsHeldGoesWithItsRobot) {
  RobotSpec spec = testing::cable_beam();
  spec.fixed[0].displacement = {3, -2, 5};
  EXPECT_LT(missed_by_prediction(spec), 1e-3);  // to which predictions are refined
}

/// A support pulls at a cable of a given length: the error of predictions is quadratic in the step.
TEST(PhysicalSteps, ASupportPullsAtACable) {
  RobotSpec spec = testing::cable_beam();
  spec.actuators = {testing::cable("zigzag", {{0, 5, 9}, {20, 5, 1}, {40, 5, 9}, {60, 5, 1}})};
  spec.fixed.push_back({{std::string("x_high"), {}}, {true, true, true}});
  std::vector<double> missed;
  for (const double path : {0.2, 0.1}) {
    spec.fixed[1].displacement = {path, 0, 0};
    missed.push_back(missed_by_prediction(spec));
  }
  EXPECT_LT(missed[0], 0.1);
  EXPECT_NEAR(missed[0] / missed[1], 2, 0.3);
}

}  // namespace softkin
