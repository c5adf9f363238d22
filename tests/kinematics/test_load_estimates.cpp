#include <gtest/gtest.h>

#include <random>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimator.hpp>

#include "kinematics/estimate_samples.hpp"

/// Wrenches on rigid parts, pressures over patches and stiffnesses of materials, estimated from synthetic readings.

namespace softkin {

namespace {

using namespace testing;

/// The finger with a rigid end that carries a tool, and a palm on which something may press.
RobotSpec finger_with_tool() {
  RobotSpec spec = touched_finger();
  spec.rigid = {{{Box{{54, -1, -1}, {61, 13, 17}}, {}}, "plate"}};
  spec.loads.forces = {{"tool",
                        {std::string("x_high"), {}},
                        {0, 0, 0},
                        std::array<Vec3, 2>{Vec3::Constant(-0.3), Vec3::Constant(0.3)},
                        {0, 0, 0},
                        std::array<Vec3, 2>{Vec3::Constant(-8), Vec3::Constant(8)}}};
  spec.regions.push_back({"palm", {Box{{20, -1, -0.1}, {45, 13, 0.1}}}, {}});
  TractionSpec press{"press", {std::string("palm"), {}}, true, {0, 0, 0}, 0};
  press.range_kPa = {-4, 4};
  spec.loads.tractions = {press};
  spec.markers.push_back({"e", {Vec3(60, 1, 15), {}}});
  return spec;
}

}  // namespace

/// A wrench of all six components, its moments in N mm, and how sure it is: 90 % intervals hold what was drawn.
TEST(WrenchEstimates, TellForceAndMoment) {
  const Model model = compile(finger_with_tool());
  const Statics statics(model);
  const std::vector<PoseColumn> columns = all_columns(model);
  Eigen::VectorXd deviations = Eigen::VectorXd::Constant(columns.size(), 0.02);
  for (std::size_t r = 0; r < columns.size(); ++r) {
    if (columns[r].kind == Reading::volume) deviations[r] = 2;
    if (columns[r].kind == Reading::force) deviations[r] = 0.002;
  }
  Estimator estimator(model, {{"tool"}}, columns, deviations);
  const estimate::Problem problem(model, {{"tool"}}, columns, exactly());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> normal;
  int held = 0, all = 0;
  for (int draw = 0; draw < 12; ++draw) {
    Eigen::VectorXd wrench(6);
    for (Index i = 0; i < 6; ++i) wrench[i] = (i < 3 ? 0.2 : 4) * unit(random);
    const Actuation commands = commands_of(model, 10 * unit(random));
    const estimate::Guess truth = problem.solve(commands, wrench, {}, nullptr, {});
    ASSERT_TRUE(truth.solved());
    Eigen::VectorXd values = truth.computed;
    for (Index r = 0; r < values.size(); ++r) values[r] += deviations[r] * normal(random);
    const Estimate& reported = estimator.update(commands, values);
    ASSERT_EQ(reported.status, Status::converged) << reported.remark;
    ASSERT_EQ(reported.numbers.size(), 6u);
    EXPECT_EQ(reported.numbers[3].name, "tool_mx");
    EXPECT_EQ(reported.numbers[3].unit, "N mm");
    EXPECT_LT(reported.misfit(), 3);
    for (std::size_t i = 0; i < 6; ++i, ++all) {
      const double off = reported.numbers[i].value - wrench[i];
      EXPECT_LT(std::abs(off), 4.5 * reported.numbers[i].deviation) << reported.numbers[i].name;
      EXPECT_LT(reported.numbers[i].deviation, i < 3 ? 0.003 : 0.3);
      held += std::abs(off) < 1.645 * reported.numbers[i].deviation ? 1 : 0;
    }
  }
  EXPECT_GE(held, 56) << "of " << all << ", 90 %; fewer by chance once in 1,000";
}

TEST(WrenchEstimates, TellThePressureOverAPatch) {
  const Model model = compile(finger_with_tool());
  const std::vector<PoseColumn> columns = marker_columns(model);
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(columns.size(), 0.02);
  Estimator estimator(model, {{"press"}}, columns, deviations);
  Actuation commands = commands_of(model, 5);
  commands[static_cast<Index>(model.actuators.size()) - 1] = 2.5;
  const Equilibrium truth = Statics(model).solve(commands, Statics(model).rest(), exactly());
  Eigen::VectorXd values(columns.size());
  for (std::size_t r = 0; r < columns.size(); ++r)
    values[r] = model.markers[columns[r].marker].at(truth.state.positions)[columns[r].axis];
  const Estimate& reported = estimator.update(commands_of(model, 5), values);
  ASSERT_EQ(reported.status, Status::converged);
  EXPECT_EQ(reported.numbers[0].unit, "kPa");
  EXPECT_NEAR(reported.numbers[0].value, 2.5, 0.3 * reported.numbers[0].deviation);
  EXPECT_LT(reported.numbers[0].deviation, 0.1);
}

TEST(WrenchEstimates, OfUnknownPlaceAreRefused) {
  const Model model = compile(finger_with_tool());
  const std::vector<PoseColumn> columns = marker_columns(model);
  try {
    Estimator(model, {{"tool", true}}, columns, Eigen::VectorXd::Ones(columns.size()));
    ADD_FAILURE() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("acts on its region as a whole: its place cannot be estimated"),
              std::string::npos)
        << error.what();
  }
}

namespace {

/// A finger of two materials, the tip's the softer one.
RobotSpec two_materials(double body, double tip) {
  RobotSpec spec = touched_finger();
  MaterialSpec soft = spec.materials[0];
  soft.region = "last";
  spec.materials.push_back(soft);
  for (std::size_t m = 0; m < 2; ++m) {
    spec.materials[m].elastic = elastic(Law::neo_hookean, m == 0 ? body : tip, 0.4);
    spec.materials[m].density = 1100;
  }
  spec.loads.gravity = {0, 0, -9.81};
  return spec;
}

EstimatedUnknown stiffness(const std::string& region, double mean, double deviation) {
  return {"materials." + region + ".stiffness", false, mean, deviation};
}

}  // namespace

/// Equilibria are those of a robot with scaled moduli; derivatives are those of their differences.
TEST(StiffnessEstimates, AreOfTheRobotThatIsSoStiff) {
  const Model model = compile(two_materials(0.4, 0.2)), other = compile(two_materials(0.4 * 1.3, 0.2 * 0.8));
  const std::vector<PoseColumn> columns = all_columns(model);
  const estimate::Problem problem(model, {stiffness("all", 1, 0.3), {"touch"}, stiffness("last", 1, 0.3)}, columns,
                                  exactly(), 1e-9);
  Eigen::VectorXd values(5);
  values << 1.3, 0.02, -0.03, 0.05, 0.8;
  const Actuation commands = commands_of(model, 8);
  const estimate::Guess at = problem.solve(commands, values, {}, nullptr, {});
  ASSERT_TRUE(at.solved());
  Actuation all = commands_of(other, 8);
  for (Index axis = 0; axis < 3; ++axis) all[1 + axis] = values[1 + axis];
  const Equilibrium expected = Statics(other).solve(all, Statics(other).rest(), exactly());
  EXPECT_LT(distance(at.equilibrium.state.positions, expected.state.positions), 1e-6);
  EXPECT_GT(distance(expected.state.positions, model.rest), 0.5);
  const Eigen::MatrixXd slopes = problem.slopes(problem.nearby(at), at);
  for (const Index c : {0, 2, 4}) {
    const double h = c == 2 ? 0.01 : 0.02;
    const auto computed = [&](double times) {
      Eigen::VectorXd moved = values;
      moved[c] += times * h;
      const estimate::Guess found = problem.solve(commands, moved, {}, &at, {});
      EXPECT_TRUE(found.solved());
      return found.computed;
    };
    const Eigen::VectorXd difference = (8 * (computed(1) - computed(-1)) - (computed(2) - computed(-2))) / (12 * h);
    expect_slopes(columns, slopes, c, difference, 2e-6);
  }
}

/// A material that becomes softer from reading to reading is followed, beside the force that pushes.
TEST(StiffnessEstimates, FollowAMaterialThatDrifts) {
  const Model model = compile(two_materials(0.4, 0.4));
  const std::vector<PoseColumn> columns = all_columns(model);
  Eigen::VectorXd deviations = Eigen::VectorXd::Constant(columns.size(), 0.02);
  for (std::size_t r = 0; r < columns.size(); ++r) {
    if (columns[r].kind == Reading::volume) deviations[r] = 2;
    if (columns[r].kind == Reading::force) deviations[r] = 0.002;
  }
  const std::vector<EstimatedUnknown> unknowns{stiffness("all", 1, 0.2), {"touch"}};
  EstimatorOptions options;
  options.fade_s = 5;
  Estimator estimator(model, unknowns, columns, deviations, options);
  const estimate::Problem problem(model, unknowns, columns, exactly());
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int time = 0; time < 8; ++time) {
    Eigen::VectorXd truth(4);
    truth << 1 - 0.04 * time, 0.05 * std::sin(time), 0.03, -0.1 * std::cos(0.5 * time);
    const Actuation commands = commands_of(model, 6 + time);
    const estimate::Guess made = problem.solve(commands, truth, {}, nullptr, {});
    ASSERT_TRUE(made.solved());
    Eigen::VectorXd values = made.computed;
    for (Index r = 0; r < values.size(); ++r) values[r] += deviations[r] * normal(random);
    const Estimate& reported = estimator.update(commands, values, 1);
    ASSERT_EQ(reported.status, Status::converged) << reported.remark;
    EXPECT_EQ(reported.numbers[0].name, "materials.all.stiffness");
    EXPECT_EQ(reported.numbers[0].unit, "");
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_LT(std::abs(reported.numbers[i].value - truth[i]), 4 * reported.numbers[i].deviation)
          << reported.numbers[i].name << " at " << time;
    EXPECT_LT(reported.numbers[0].deviation, 0.05) << "0.2 before";
  }
}

TEST(StiffnessEstimates, AreRefusedWithAReason) {
  const Model model = compile(two_materials(0.4, 0.4));
  const std::vector<PoseColumn> columns = marker_columns(model);
  const auto refused = [&](const std::vector<EstimatedUnknown>& unknowns, const std::string& why) {
    try {
      Estimator(model, unknowns, columns, Eigen::VectorXd::Ones(columns.size()));
      ADD_FAILURE() << "accepted: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  refused({{"materials.all.stiffness"}}, "such as materials.all.stiffness=1+-0.2");
  refused({stiffness("lost", 1, 0.2)}, "there is no material of region 'lost'; did you mean 'last'?");
  refused({stiffness("all", 1, 0.2), stiffness("all", 1, 0.2)}, "it is to be estimated twice");
  refused({stiffness("all", 0, 0.2)}, "its mean must be above 0");
  refused({{"materials.all.stiffness", true, 1, 0.2}}, "a stiffness has no place");
}

}  // namespace softkin
