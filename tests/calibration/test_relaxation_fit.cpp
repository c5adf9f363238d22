#include <gtest/gtest.h>

#include <cmath>
#include <softkin/calibration/nonnegative.hpp>
#include <softkin/calibration/relaxation_fit.hpp>
#include <softkin/core/error.hpp>

#include "calibration/relaxation_samples.hpp"

namespace softkin {
namespace {

using namespace softkin::testing;
using calibration::BranchCount;
using calibration::fit_relaxation;
using calibration::RelaxationFit;

/// Checks that a number has a deviation, and is within 3.5 deviations of the one that the data were made with.
void expect_found(const std::string& name, const calibration::Estimate& found, double made, double max_fraction) {
  ASSERT_TRUE(found.deviation) << name;
  EXPECT_NEAR(found.value, made, 3.5 * *found.deviation) << name;
  EXPECT_LT(*found.deviation, max_fraction * made) << name;
}

void expect_branches(const RelaxationFit& fit, const std::vector<ViscousBranch>& made, double max_fraction) {
  ASSERT_EQ(fit.best().branches.size(), made.size());
  for (std::size_t b = 0; b < made.size(); ++b) {
    expect_found("modulus " + std::to_string(b), fit.best().branches[b].modulus_MPa, made[b].modulus_MPa, max_fraction);
    expect_found("time " + std::to_string(b), fit.best().branches[b].time_s, made[b].time_s, max_fraction);
  }
}

TEST(RelaxationFit, CyclesOfVhbAtThreeRatesGiveItsBranchesAndItsLimit) {
  std::vector<RelaxationRun> runs;
  for (const double rate : {0.01, 0.05, 0.5})
    runs.push_back(made_run(cycled(5, rate, 2, 80), gent_stress, vhb_branches, 0.005, 7));
  const RelaxationFit fit = fit_relaxation(runs, {Law::gent});
  EXPECT_EQ(fit.by, BranchCount::information);
  expect_branches(fit, vhb_branches, 0.2);
  expect_found("shear modulus", fit.best().constants[0], vhb_modulus, 0.05);
  expect_found("jm", fit.best().constants[1], vhb_limit, 0.05);
  EXPECT_NEAR(fit.best().rms_stress_MPa.value(), 0.005 * 0.4, 0.005 * 0.4);
}

TEST(RelaxationFit, RelaxationOfTwoBranches) {
  const std::vector<ViscousBranch> made{{0.05, 0.8}, {0.03, 40}};
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const RelaxationFit fit =
        fit_relaxation({made_run(held_at(1.5, 0.05, 1000, 90), rubber_stress, made, 0.005, seed)}, {Law::neo_hookean});
    expect_branches(fit, made, 0.2);
    expect_found("c10", fit.best().constants[0], 0.05, 0.05);
    EXPECT_LE(fit.shortest_s, 0.06);
    EXPECT_NEAR(fit.longest_s, 1000, 1e-9);
  }
}

TEST(RelaxationFit, OneBranchGivesOneAndNoneGivesNone) {
  for (const double noise : {0.0, 0.003, 0.03})
    for (const unsigned seed : {1u, 2u, 3u}) {
      const auto one = fit_relaxation({made_run(held_at(1.3, 0.1, 500, 60), rubber_stress, {{0.05, 5}}, noise, seed)},
                                      {Law::neo_hookean});
      EXPECT_EQ(one.chosen, 1u) << noise << " " << seed;
      const auto none =
          fit_relaxation({made_run(cycled(2, 0.1, 2, 100), rubber_stress, {}, noise, seed)}, {Law::neo_hookean});
      EXPECT_EQ(none.chosen, 0u) << noise << " " << seed;
      EXPECT_NEAR(none.best().constants[0].value, 0.05, 0.05 * noise + 1e-9);
    }
}

TEST(RelaxationFit, ExactDataGiveExactBranches) {
  const RelaxationFit fit = fit_relaxation({made_run(cycled(3, 0.1, 2, 100), gent_stress, vhb_branches, 0, 1),
                                            made_run(cycled(3, 2, 2, 100), gent_stress, vhb_branches, 0, 1)},
                                           {Law::gent});
  ASSERT_EQ(fit.chosen, 3u);
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_NEAR(fit.best().branches[b].modulus_MPa.value, vhb_branches[b].modulus_MPa,
                1e-3 * vhb_branches[b].modulus_MPa);
    EXPECT_NEAR(fit.best().branches[b].time_s.value, vhb_branches[b].time_s, 1e-3 * vhb_branches[b].time_s);
  }
}

TEST(RelaxationFit, CreepOfTwoBranches) {
  const std::vector<ViscousBranch> made{{0.05, 0.8}, {0.03, 40}};
  const RelaxationFit fit =
      fit_relaxation({made_run(held_at(0.1, 0.05, 1000, 60, true), rubber_stress, made, 0.003, 2)}, {Law::neo_hookean});
  expect_branches(fit, made, 0.3);
  expect_found("c10", fit.best().constants[0], 0.05, 0.05);
  EXPECT_FALSE(fit.best().rms_stress_MPa);
  EXPECT_GT(fit.best().rms_stretch.value(), 0);
}

TEST(RelaxationFit, CreepAndRelaxationTogether) {
  const std::vector<ViscousBranch> made{{0.05, 0.8}, {0.03, 40}};
  const RelaxationFit fit = fit_relaxation({made_run(held_at(0.1, 0.05, 1000, 40, true), rubber_stress, made, 0.003, 2),
                                            made_run(held_at(1.5, 0.05, 1000, 40), rubber_stress, made, 0.01, 3)},
                                           {Law::neo_hookean});
  expect_branches(fit, made, 0.3);
}

TEST(RelaxationFit, HeldConstantsStay) {
  const std::vector<ViscousBranch> made{{0.03, 6}};
  const std::vector<RelaxationRun> runs{made_run(cycled(2, 0.05, 2, 60), gent_stress, made, 0.003, 2)};
  const RelaxationFit fit = fit_relaxation(runs, {Law::gent, {{"jm", vhb_limit}, {"shear_modulus", vhb_modulus}}});
  expect_branches(fit, made, 0.05);
  EXPECT_EQ(fit.best().constants[1].value, vhb_limit);
  EXPECT_FALSE(fit.best().constants[0].deviation);
  EXPECT_THROW((void)fit_relaxation(runs, {Law::gent, {{"c10", 1}}}), InvalidInput);
  EXPECT_THROW((void)fit_relaxation(runs, {Law::gent, {{"jm", 1}}}), InvalidInput);
  EXPECT_THROW((void)fit_relaxation(runs, {Law::corotational}), InvalidInput);
}

TEST(RelaxationFit, RepeatedRunsSayWhatIsNoise) {
  // specimens differ by 3 %: the branches need not fit more closely than that
  const std::vector<ViscousBranch> made{{0.05, 0.8}, {0.002, 40}};
  std::vector<RelaxationRun> runs;
  for (const unsigned seed : {1u, 2u, 3u}) {
    runs.push_back(made_run(held_at(1.5, 0.05, 1000, 60), rubber_stress, made, 0.001, seed));
    for (double& stress : runs.back().stress_MPa) stress *= 1 + 0.03 * (seed - 2.0);
  }
  const RelaxationFit fit = fit_relaxation(runs, {Law::neo_hookean});
  EXPECT_EQ(fit.by, BranchCount::repeats);
  EXPECT_EQ(fit.chosen, 1u);
  EXPECT_GT(fit.repeat_MPa.value(), 0);
  EXPECT_EQ(fit_relaxation({runs[1]}, {Law::neo_hookean}).chosen, 2u);
}

TEST(RelaxationFit, TheNumberOfBranchesCanBeAskedFor) {
  const std::vector<RelaxationRun> runs{made_run(held_at(1.3, 0.1, 500, 60), rubber_stress, {{0.05, 5}}, 0.003, 1)};
  calibration::RelaxationOptions options;
  options.branches = 2;
  const RelaxationFit two = fit_relaxation(runs, options);
  EXPECT_EQ(two.best().branches.size(), 2u);
  EXPECT_EQ(two.by, BranchCount::requested);
  options.branches = 200;
  EXPECT_THROW((void)fit_relaxation(runs, options), InvalidInput);
}

TEST(RelaxationFit, OtherLaws) {
  const std::vector<ViscousBranch> made{{0.05, 0.8}};
  const auto yeoh = [](double l) {
    const double e = l * l + 2 / l - 3;
    return 2 * (l - 1 / (l * l)) * (0.1 - 2 * 0.01 * e + 3 * 0.002 * e * e);
  };
  const auto mooney = [](double l) { return 2 * (l - 1 / (l * l)) * (0.04 + 0.03 / l); };
  const auto imposed = cycled(2.5, 0.2, 2, 100);
  const RelaxationFit of_yeoh = fit_relaxation({made_run(imposed, yeoh, made, 0.002, 1)}, {Law::yeoh});
  expect_branches(of_yeoh, made, 0.1);
  expect_found("c10", of_yeoh.best().constants[0], 0.1, 0.1);
  EXPECT_NEAR(of_yeoh.best().constants[1].value, -0.01, 3.5 * of_yeoh.best().constants[1].deviation.value());
  const RelaxationFit of_mooney = fit_relaxation({made_run(imposed, mooney, made, 0.002, 1)}, {Law::mooney_rivlin});
  expect_branches(of_mooney, made, 0.1);
  expect_found("c01", of_mooney.best().constants[1], 0.03, 0.2);
}

TEST(RelaxationFit, OneStretchDoesNotTellTwoConstantsApart) {
  const std::vector<RelaxationRun> one{made_run(held_at(1.5, 0.1, 500, 60), gent_stress, {{0.05, 5}}, 0.003, 1)};
  for (const Law law : {Law::mooney_rivlin, Law::yeoh, Law::gent})
    EXPECT_THROW((void)fit_relaxation(one, {law}), InvalidInput);
  const RelaxationFit held = fit_relaxation(one, {Law::gent, {{"jm", vhb_limit}}});
  expect_branches(held, {{0.05, 5}}, 0.1);
  expect_found("shear modulus", held.best().constants[0], vhb_modulus, 0.1);
  std::vector<RelaxationRun> two = one;  // at two stretches they are apart
  two.push_back(made_run(held_at(4, 0.1, 500, 60), gent_stress, {{0.05, 5}}, 0.003, 2));
  expect_found("jm", fit_relaxation(two, {Law::gent}).best().constants[1], vhb_limit, 0.5);
}

TEST(RelaxationFit, FewRowsCarryFewBranches) {
  const RelaxationRun few{"a.csv",
                          "run 1",
                          false,
                          {0, 0.5, 1, 2, 4, 8, 16, 32, 64},
                          std::vector<double>(9, 1.1),
                          {0.04, 0.038, 0.037, 0.0355, 0.034, 0.033, 0.0325, 0.0323, 0.0322},
                          {}};
  EXPECT_EQ(fit_relaxation({few}, {}).tried.size(), 2u);  // three rows for every number
}

TEST(RelaxationFit, RefusesTestsThatTellNothing) {
  RelaxationRun run{"a.csv", "run 1", false, {0, 1, 2, 3}, {1, 1, 1, 1}, {0, 0, 0, 0}, {}};
  EXPECT_THROW((void)fit_relaxation({run}, {}), InvalidInput);
  EXPECT_THROW((void)fit_relaxation({}, {}), InvalidInput);
  // a fluid: nothing is left in the end
  const auto nothing = [](double) { return 0.0; };
  EXPECT_THROW((void)fit_relaxation({made_run(held_at(1.5, 0.1, 1000, 60), nothing, {{0.1, 5}}, 0, 1)}, {}),
               InvalidInput);
}

TEST(NonnegativeLeastSquares, IsTheBestOfAllSetsOfColumns) {
  std::mt19937 engine(2);
  std::normal_distribution<double> normal(0, 1);
  for (int round = 0; round < 300; ++round) {
    const int free = round % 3;
    Eigen::MatrixXd a(round % 2 == 0 ? 12 : 5, 6);
    Eigen::VectorXd b(a.rows());
    for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = normal(engine);
    for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = normal(engine);
    double best = b.squaredNorm();  // by brute force over all sets of columns
    for (int set = 0; set < 64; ++set) {
      std::vector<Eigen::Index> chosen;
      for (int c = 0; c < 6; ++c)
        if (c < free || (set >> c & 1) != 0) chosen.push_back(c);
      if (chosen.empty() || std::ssize(chosen) > a.rows()) continue;
      const Eigen::MatrixXd some = a(Eigen::all, chosen);
      const Eigen::VectorXd x = (some.transpose() * some).inverse() * some.transpose() * b;
      bool allowed = true;
      for (std::size_t i = 0; i < chosen.size(); ++i) allowed = allowed && (chosen[i] < free || x[i] >= 0);
      if (allowed) best = std::min(best, (some * x - b).squaredNorm());
    }
    const Eigen::VectorXd found = calibration::nonnegative_least_squares(a, b, free);
    EXPECT_NEAR((a * found - b).squaredNorm(), best, 1e-6 * (1 + best)) << round;
    for (Eigen::Index c = free; c < 6; ++c) EXPECT_GE(found[c], 0);
  }
}

}  // namespace
}  // namespace softkin
