#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/sampling.hpp>

namespace softkin {
namespace {

/// Actuators with these ranges and nothing else: sampling asks for no more.
Model ranges(const std::vector<std::pair<double, double>>& each) {
  Model model;
  for (const auto& [low, high] : each) {
    Actuator actuator;
    actuator.low = low;
    actuator.high = high;
    model.actuators.push_back(actuator);
  }
  return model;
}

Model unit_ranges(std::size_t count) {
  return ranges(std::vector<std::pair<double, double>>(count, {0.0, 1.0}));
}

Actuations samples(const Model& model, Sampling kind, Index count, std::uint64_t seed = 0) {
  return sample_actuations(model, {kind, count, seed});
}

/// Square of the L2 star discrepancy (Warnock 1972).
double discrepancy(const Actuations& points) {
  const auto n = static_cast<double>(points.rows());
  double single = 0, pairs = 0;
  for (Index i = 0; i < points.rows(); ++i) {
    single += (1 - points.row(i).array().square()).prod();
    for (Index j = 0; j < points.rows(); ++j) pairs += (1 - points.row(i).array().max(points.row(j).array())).prod();
  }
  const auto d = static_cast<double>(points.cols());
  return std::pow(3, -d) - std::pow(2, 1 - d) / n * single + pairs / (n * n);
}

void expect_refused(const Model& model, const SamplingOptions& options, const std::string& message) {
  try {
    (void)sample_actuations(model, options);
    ADD_FAILURE() << "not refused: " << message;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
  }
}

TEST(Sampling, GridHasBothEndsAndTheLastActuatorChangesFastest) {
  const Actuations grid = samples(ranges({{0.5, 1}, {2, 2}, {-10, 30}}), Sampling::grid, 9);
  Actuations expected(9, 3);
  expected << 0.5, 2, -10, 0.5, 2, 10, 0.5, 2, 30, 0.75, 2, -10, 0.75, 2, 10, 0.75, 2, 30, 1, 2, -10, 1, 2, 10, 1, 2,
      30;
  EXPECT_EQ(grid, expected);
}

TEST(Sampling, NearestGridIsTheOneWithTheNearestNumberOfSamples) {
  const Model three = unit_ranges(3);
  for (const auto& [samples, values] : std::vector<std::pair<Index, Index>>{
           {1, 2}, {8, 2}, {17, 2}, {18, 3}, {100, 5}, {94, 4}, {3375, 15}, {3374, 15}, {1'000'000, 100}})
    EXPECT_EQ(nearest_grid(three, samples), values) << samples;
  EXPECT_EQ(nearest_grid(unit_ranges(1), 17), 17);
}

TEST(Sampling, SobolsFirstPointsAreThePublishedOnes) {
  const Actuations points = samples(unit_ranges(3), Sampling::sobol, 8);
  Actuations expected(8, 3);
  expected << 0, 0, 0, 0.5, 0.5, 0.5, 0.75, 0.25, 0.25, 0.25, 0.75, 0.75, 0.375, 0.375, 0.625, 0.875, 0.875, 0.125,
      0.625, 0.125, 0.875, 0.125, 0.625, 0.375;
  EXPECT_EQ(points, expected);
}

TEST(Sampling, SobolFillsEveryActuatorsRangeEvenly) {
  const Actuations points = samples(unit_ranges(8), Sampling::sobol, 1024);
  for (Index d = 0; d < 8; ++d) {
    std::set<double> values(points.col(d).begin(), points.col(d).end());
    EXPECT_EQ(values.size(), 1024u) << d;
    for (const double value : values) EXPECT_EQ(std::fmod(value * 1024, 1), 0) << d;
  }
}

/// Sobol's property A: among 2^d points there is one in every orthant of the cube.
TEST(Sampling, SobolHasPropertyA) {
  const Actuations points = samples(unit_ranges(8), Sampling::sobol, 1024);
  for (Index begin = 0; begin < 1024; begin += 256) {
    std::set<int> orthants;
    for (Index i = begin; i < begin + 256; ++i) {
      int orthant = 0;
      for (Index d = 0; d < 8; ++d) orthant = 2 * orthant + (points(i, d) >= 0.5 ? 1 : 0);
      orthants.insert(orthant);
    }
    EXPECT_EQ(orthants.size(), 256u) << begin;
  }
}

TEST(Sampling, SobolIsOfLowerDiscrepancyThanRandomSamples) {
  const Model model = unit_ranges(4);
  const double random = discrepancy(samples(model, Sampling::random, 512, 1));
  EXPECT_LT(discrepancy(samples(model, Sampling::sobol, 512)), random / 8);
  EXPECT_GT(random, 0);
}

TEST(Sampling, RandomSamplesAreThoseOfTheStandardsGenerator) {
  // first output with the seed 5489, and the 10000th, which the standard states
  const Actuations points = samples(ranges({{1, 3}}), Sampling::random, 10000, 5489);
  const auto value = [](std::uint64_t output) { return 1 + 2 * std::ldexp(static_cast<double>(output >> 11), -53); };
  EXPECT_EQ(points(0, 0), value(14514284786278117030u));
  EXPECT_EQ(points(9999, 0), value(9981545732273789042u));
}

TEST(Sampling, SeedsAndNothingElseTellRandomSamplesApart) {
  const Model model = ranges({{0.5, 1}, {-100, 250}});
  EXPECT_EQ(samples(model, Sampling::random, 50, 7), samples(model, Sampling::random, 50, 7));
  EXPECT_NE(samples(model, Sampling::random, 50, 7), samples(model, Sampling::random, 50, 8));
  EXPECT_EQ(samples(model, Sampling::random, 50, 7), samples(model, Sampling::random, 80, 7).topRows(50));
}

TEST(Sampling, NoSampleLeavesItsRange) {
  const std::vector<std::pair<double, double>> each{{0.1, 0.3}, {-1e3, 1e-3}, {1, 1}, {0.7, 1.4}};
  const Model model = ranges(each);
  for (const auto& [kind, count] : {std::pair{Sampling::grid, 1000}, {Sampling::sobol, 999}, {Sampling::random, 999}}) {
    const Actuations points = samples(model, kind, count);
    for (Index a = 0; a < points.cols(); ++a) {
      EXPECT_GE(points.col(a).minCoeff(), each[a].first);
      EXPECT_LE(points.col(a).maxCoeff(), each[a].second);
      if (kind == Sampling::grid) {
        EXPECT_EQ(points.col(a).maxCoeff(), each[a].second);
      }
    }
  }
}

TEST(Sampling, NeighboursFollowEachOtherAlongAHilbertCurve) {
  for (const int dimensions : {2, 3, 4}) {
    const Index edge = 4, count = static_cast<Index>(std::pow(edge, dimensions));
    Actuations points(count, dimensions);
    for (Index i = 0; i < count; ++i)
      for (Index d = 0, rest = i; d < dimensions; ++d, rest /= edge) points(i, d) = (rest % edge + 0.5) / edge;
    const std::vector<Index> order = order_of_neighbours(unit_ranges(dimensions), points);
    EXPECT_EQ(std::set<Index>(order.begin(), order.end()).size(), static_cast<std::size_t>(count));
    for (std::size_t i = 1; i < order.size(); ++i)
      EXPECT_NEAR((points.row(order[i]) - points.row(order[i - 1])).lpNorm<1>(), 1.0 / edge, 1e-12)
          << dimensions << " " << i;
  }
}

TEST(Sampling, RefusesWhatCannotBeSampled) {
  expect_refused(unit_ranges(3), {Sampling::grid, 100, 0}, "the nearest grid has 5 values each, 125 samples");
  expect_refused(unit_ranges(3), {Sampling::sobol, 0, 0}, "must be 1 or more");
  expect_refused(unit_ranges(9), {Sampling::sobol, 10, 0}, "8 actuators at most");
  expect_refused(unit_ranges(64), {Sampling::grid, 100, 0}, "at least 1.84e+19 samples");
  expect_refused(ranges({{1, 1}}), {Sampling::random, 10, 0}, "no actuator whose range is more than one value");
}

}  // namespace
}  // namespace softkin
