#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <softkin/calibration/actuator_curves.hpp>
#include <softkin/calibration/actuator_samples.hpp>
#include <softkin/calibration/pressure_check.hpp>
#include <softkin/core/error.hpp>

namespace softkin {
namespace {

constexpr calibration::SyringeSetup setup{20000, 1500, 60000, 100};

/// The chamber's true ratio: a hysteresis between two stiffening curves that meet at rest and at 140 kPa.
double loading(double gauge) {
  const double s = gauge / 140;
  return 1 + 0.55 * (0.4 * s + 0.6 * s * s);
}

double unloading(double gauge) {
  const double s = gauge / 140;
  return loading(gauge) + 0.2 * s * (1 - s);
}

/// Delta V_sy [mm^3] by the gas law of Eq. (18), found by bisection over it: independent of Eq. (19).
double gas_law_volume(const calibration::SyringeSetup& s, double absolute, double ratio) {
  const double closed = s.atmosphere_kPa * (s.chamber_mm3 + s.syringe_mm3 + s.tube_mm3);
  double low = -1e7, high = 1e7;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    const double now = absolute * (ratio * s.chamber_mm3 + s.syringe_mm3 - middle + s.tube_mm3);
    (now > closed ? low : high) = middle;
  }
  return (low + high) / 2;
}

struct Noise {
  double pressure_kPa = 0, volume_mm3 = 0;
};

/// Up and down again, with noise of both sensors.
SyringeRun cycle(PressureScale scale, int rows, const Noise& noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  SyringeRun run{"test.csv", "run " + std::to_string(seed), scale, {}};
  for (int i = 0; i <= 2 * rows; ++i) {
    const double gauge = 140.0 * (i <= rows ? i : 2 * rows - i) / rows;
    const double ratio = i <= rows ? loading(gauge) : unloading(gauge);
    const double volume = gas_law_volume(setup, 100 + gauge, ratio);
    const double read = (scale == PressureScale::absolute ? 100 + gauge : gauge) + noise.pressure_kPa * normal(random);
    run.rows.push_back({read, volume + noise.volume_mm3 * normal(random), static_cast<std::size_t>(i + 2)});
  }
  return run;
}

std::vector<calibration::CurveSample> samples_of(const std::vector<SyringeRun>& runs) {
  std::vector<calibration::CurveSample> samples;
  for (const calibration::SyringeSample& each : calibration::chamber_ratios(setup, runs))
    samples.push_back(each.sample);
  return samples;
}

/// Returns the message of a refusal; empty: none.
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << "no '" << word << "' in: " << text;
}

TEST(Syringe, Equation19IsTheGasLawBothWays) {
  for (const double absolute : {60.0, 100.0, 131.0, 240.0})
    for (const double ratio : {0.7, 1.0, 1.3, 2.2}) {
      const double volume = gas_law_volume(setup, absolute, ratio);
      EXPECT_NEAR(calibration::chamber_ratio(setup, absolute, volume), ratio, 1e-9);
      EXPECT_NEAR(calibration::syringe_volume(setup, absolute, ratio), volume, 1e-5);
    }
  EXPECT_DOUBLE_EQ(calibration::chamber_ratio(setup, 100, 0), 1);
}

TEST(Syringe, NoisyRunsGiveTheRatioWithinHalfAPercentAndKeepTheHysteresis) {
  // sensors of 0.15 kPa and 60 mm^3 (0.1 mL graduations), five cycles, both scales
  std::vector<SyringeRun> runs;
  for (unsigned seed = 1; seed <= 5; ++seed)
    runs.push_back(cycle(seed % 2 == 0 ? PressureScale::gauge : PressureScale::absolute, 40, {0.15, 60}, seed));
  const calibration::CurveFit fit = calibration::fit_curve(samples_of(runs));
  ASSERT_TRUE(fit.unloading.has_value());
  EXPECT_EQ(fit.loading_quality.repeats, 5U);
  EXPECT_EQ(fit.unloading_quality.repeats, 5U);
  double worst = 0, scatter = 0;
  for (const SyringeRun& run : runs)
    for (int i = 0; i <= 40; ++i) {
      const auto& row = run.rows[i];
      const double absolute = run.scale == PressureScale::gauge ? row.pressure_kPa + 100 : row.pressure_kPa;
      scatter = std::max(scatter,
                         std::abs(calibration::chamber_ratio(setup, absolute, row.syringe_mm3) / loading(3.5 * i) - 1));
    }
  for (double gauge = 1; gauge <= 139; gauge += 0.5) {
    worst = std::max(worst, std::abs(fit.loading.ratio.value(gauge) / loading(gauge) - 1));
    worst = std::max(worst, std::abs(fit.unloading->ratio.value(gauge) / unloading(gauge) - 1));
  }
  std::printf("single rows off by up to %.2f %%, the curves by %.3f %%\n", 100 * scatter, 100 * worst);
  EXPECT_GT(scatter, 0.01) << "the noise should matter";
  EXPECT_LT(worst, 0.005);
  for (const double gauge : {35.0, 70.0, 105.0}) {
    const double width = fit.unloading->ratio.value(gauge) - fit.loading.ratio.value(gauge);
    EXPECT_NEAR(width, unloading(gauge) - loading(gauge), 0.006) << gauge;
  }
  // and the pressure for a ratio
  for (double gauge = 20; gauge <= 130; gauge += 10)
    EXPECT_NEAR(fit.loading.ratio.inverse(loading(gauge)), gauge, 1.5) << gauge;
}

TEST(Syringe, SpreadIsThatBetweenRunsAndPointsWithoutNoiseAreKept) {
  std::vector<calibration::CurveSample> samples;
  const double offsets[] = {-0.01, 0, 0.01};  // standard deviation 0.01
  for (std::size_t run = 0; run < 3; ++run)
    for (int i = 0; i <= 10; ++i)
      samples.push_back({10.0 * i, 1 + 0.02 * i + (i > 0 ? offsets[run] : 0), Branch::loading, run});
  const calibration::CurveFit fit = calibration::fit_curve(samples);
  ASSERT_EQ(fit.loading.ratio.x().size(), 11U);
  for (std::size_t i = 3; i <= 10; ++i) {
    EXPECT_NEAR(fit.loading.ratio.y()[i], 1 + 0.02 * static_cast<double>(i), 1e-12);
    EXPECT_NEAR(fit.loading.spread[i], 0.01, 2e-3);
  }
  EXPECT_NEAR(*fit.loading_quality.mean_error, 0.01 / std::sqrt(3.0), 1.2e-3);
  EXPECT_FALSE(fit.unloading.has_value());
}

TEST(Syringe, AFallingStretchIsPooledAndTheCurveStillAscends) {
  std::vector<calibration::CurveSample> samples;
  const double ratios[] = {1, 1.1, 1.3, 1.25, 1.2, 1.4, 1.5};
  for (int i = 0; i < 7; ++i) samples.push_back({10.0 * i, ratios[i], Branch::loading, 0});
  const calibration::CurveFit fit = calibration::fit_curve(samples);
  EXPECT_EQ(fit.loading_quality.pooled, 2U);
  EXPECT_NEAR(fit.loading.ratio.value(30), 1.25, 1e-12);
  EXPECT_FALSE(fit.loading_quality.mean_error.has_value());
  samples = {{0, 1, Branch::loading, 0}, {10, 0.9, Branch::loading, 0}, {20, 0.8, Branch::loading, 0}};
  expect_words(refusal([&] { (void)calibration::fit_curve(samples); }), {"loading", "does not rise"});
}

TEST(Syringe, SweepsAreCutWhereTheDriveTurnsAndNotByNoise) {
  std::vector<double> drive;
  for (int cycle = 0; cycle < 2; ++cycle) {
    for (int i = 0; i < 20; ++i) drive.push_back(i + (i % 2 == 0 ? 0.4 : -0.4));
    for (int i = 20; i > 0; --i) drive.push_back(i + (i % 2 == 0 ? 0.4 : -0.4));
  }
  const std::vector<calibration::Sweep> sweeps = calibration::sweeps_of(drive);
  ASSERT_EQ(sweeps.size(), 4U);
  for (std::size_t s = 0; s < 4; ++s) {
    EXPECT_EQ(sweeps[s].branch, s % 2 == 0 ? Branch::loading : Branch::unloading);
    if (s > 0) {
      EXPECT_EQ(sweeps[s].begin + 1, sweeps[s - 1].end) << "the turning row belongs to both";
    }
  }
  EXPECT_EQ(sweeps.back().end, drive.size());
  EXPECT_TRUE(calibration::sweeps_of({3, 3, 3}).empty());
  EXPECT_EQ(calibration::sweeps_of({5, 3, 1}).at(0).branch, Branch::unloading);
}

TEST(Syringe, ARunOnTheWrongScaleIsNamed) {
  std::vector<SyringeRun> runs{cycle(PressureScale::absolute, 30, {0.2, 50}, 1),
                               cycle(PressureScale::gauge, 30, {0.2, 50}, 2)};
  runs[1].scale = PressureScale::absolute;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, runs); }),
               {"test.csv", "run 2", "gauge pressures, given as absolute", "p_gauge_kpa"});
  runs[1] = cycle(PressureScale::absolute, 30, {0.2, 50}, 2);
  runs[1].scale = PressureScale::gauge;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, runs); }),
               {"run 2", "absolute pressures, given as gauge", "p_abs_kpa"});
}

TEST(Syringe, TheWrongScaleIsNoticedWithoutARowAtRest) {
  for (const PressureScale right : {PressureScale::absolute, PressureScale::gauge}) {
    SyringeRun run = cycle(right, 30, {}, 4);
    run.rows.erase(run.rows.begin(), run.rows.begin() + 8);
    run.rows.erase(run.rows.end() - 8, run.rows.end());
    EXPECT_EQ(refusal([&] { (void)calibration::chamber_ratios(setup, {run}); }), "");
    run.scale = right == PressureScale::absolute ? PressureScale::gauge : PressureScale::absolute;
    expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, {run}); }), {"run 4", "other scale"});
  }
}

TEST(Syringe, WrongUnitsAndImpossibleRowsAreRefusedByLine) {
  const SyringeRun right = cycle(PressureScale::absolute, 30, {}, 1);
  SyringeRun run = right;
  for (SyringeRow& row : run.rows) row.syringe_mm3 /= 1000;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, {run}); }), {"test.csv:", "dv_sy_ml"});
  run = right;
  for (SyringeRow& row : run.rows) row.syringe_mm3 *= 1000;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, {run}); }),
               {"test.csv:", "cannot give", "dv_sy_mm3"});
  run = right;
  for (SyringeRow& row : run.rows) row.syringe_mm3 *= -1;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, {run}); }), {"test.csv:", "sign"});
  run = right;
  run.rows[7].pressure_kPa = -3;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, {run}); }), {"test.csv:9", "above 0"});
  run = right;
  for (SyringeRow& row : run.rows) row.syringe_mm3 = 0;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(setup, {run}); }), {"does not move"});
  calibration::SyringeSetup bad = setup;
  bad.chamber_mm3 = 0;
  expect_words(refusal([&] { (void)calibration::chamber_ratios(bad, {right}); }), {"chamber"});
}

TEST(Syringe, ModulusFactorIsThatOfProportionalPressures) {
  const calibration::ModulusCheck check = calibration::check_modulus({8, 16, 24.4}, {10, 20, 30.5});
  EXPECT_NEAR(check.factor, 0.8, 1e-12);
  EXPECT_NEAR(check.misfit_after, 0, 1e-12);
  EXPECT_NEAR(check.misfit_before, 0.25, 1e-12);
  EXPECT_THROW((void)calibration::check_modulus({1, 2}, {0, 0}), InvalidInput);
  EXPECT_THROW((void)calibration::check_modulus({1}, {1, 2}), InvalidInput);
}

}  // namespace
}  // namespace softkin
