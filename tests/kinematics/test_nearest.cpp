#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/nearest.hpp>

namespace softkin {
namespace {

NearestPoints::Rows random_rows(Index rows, Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> anywhere(-50, 50);
  NearestPoints::Rows points(rows, columns);
  for (Index i = 0; i < points.size(); ++i) points.data()[i] = anywhere(generator);
  return points;
}

/// Two markers and nothing else: goals ask for no more.
Model two_markers() {
  Model model;
  model.markers.resize(2);
  model.markers[0].name = "tip";
  model.markers[1].name = "end";
  return model;
}

std::vector<WorkspaceSample> random_samples(Index count) {
  const NearestPoints::Rows values = random_rows(count, 6, 11);
  std::vector<WorkspaceSample> samples;
  for (Index i = 0; i < count; ++i) {
    WorkspaceSample sample;
    sample.number = i;
    sample.status = Status::converged;
    sample.markers = Eigen::Map<const Points>(values.row(i).data(), 2, 3);
    samples.push_back(sample);
  }
  return samples;
}

/// Samples in the order of their errors, by trying all.
template <class Error>
std::vector<Index> by_brute_force(const std::vector<WorkspaceSample>& samples, Index count, const Error& error) {
  std::vector<Index> order(samples.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return error(samples[a].markers) < error(samples[b].markers); });
  order.resize(count);
  return order;
}

TEST(NearestPoints, AreThoseOfBruteForce) {
  for (const Index columns : {1, 3, 6}) {
    const NearestPoints::Rows points = random_rows(2000, columns, 1);
    const NearestPoints nearest(points);
    const NearestPoints::Rows targets = random_rows(50, columns, 2);
    for (Index t = 0; t < targets.rows(); ++t) {
      const Eigen::VectorXd target = targets.row(t);
      const Eigen::VectorXd distances = (points.rowwise() - target.transpose()).rowwise().norm();
      std::vector<double> sorted(distances.begin(), distances.end());
      std::sort(sorted.begin(), sorted.end());
      const auto found = nearest.find(target, 5);
      ASSERT_EQ(found.size(), 5u);
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(found[i].distance, sorted[i], 1e-9);
        EXPECT_NEAR(distances[found[i].row], sorted[i], 1e-9);
      }
    }
  }
}

TEST(NearestPoints, AreAllWhereMoreAreAskedFor) {
  const NearestPoints nearest(random_rows(3, 2, 4));
  EXPECT_EQ(nearest.find(Eigen::Vector2d(0, 0), 10).size(), 3u);
}

TEST(NearestPoints, RefusesWhatIsNoPoint) {
  EXPECT_THROW(NearestPoints(NearestPoints::Rows(0, 3)), InvalidInput);
  NearestPoints::Rows points = random_rows(3, 2, 4);
  const NearestPoints nearest(points);
  EXPECT_THROW((void)nearest.find(Vec3(0, 0, 0)), InvalidInput);
  EXPECT_THROW((void)nearest.find(Eigen::Vector2d(0, std::numeric_limits<double>::infinity())), InvalidInput);
  points(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(NearestPoints{points}, InvalidInput);
}

TEST(NearestSamples, OfPositionsWithAxesAndWeightsAreThoseOfBruteForce) {
  const Model model = two_markers();
  const auto samples = random_samples(500);
  NearestSamples nearest(model, samples);
  const Vec3 tip(10, -20, 5), end(-3, 8, 0);
  const std::vector<Goal> goals{{PositionGoal{0, tip, {true, false, true}}, 4}, {PositionGoal{1, end}, 0.25}};
  const auto error = [&](const Points& m) {
    return 4 * (std::pow(m(0, 0) - 10, 2) + std::pow(m(0, 2) - 5, 2)) +
           0.25 * (m.row(1).transpose() - end).squaredNorm();
  };
  EXPECT_EQ(nearest.find(goals, 7), by_brute_force(samples, 7, error));
  // other goals, another tree
  const std::vector<Goal> other{{PositionGoal{0, tip}, 1}};
  EXPECT_EQ(nearest.find(other, 7),
            by_brute_force(samples, 7, [&](const Points& m) { return (m.row(0).transpose() - tip).squaredNorm(); }));
}

TEST(NearestSamples, OfPlanesAndDirectionsAreThoseOfBruteForce) {
  const Model model = two_markers();
  const auto samples = random_samples(300);
  NearestSamples nearest(model, samples);
  const Vec3 point(1, 2, 3), normal(0, 3, 4), direction(1, 1, 0);
  const std::vector<Goal> goals{{PlaneGoal{1, point, normal}, 2}, {DirectionGoal{0, 1, direction, 15}, 3}};
  const auto error = [&](const Points& m) {
    const Vec3 from = m.row(1).transpose() - point, line = (m.row(1) - m.row(0)).transpose();
    return 2 * std::pow(from.dot(normal) / 5, 2) + 3 * 225 * (line.normalized() - direction.normalized()).squaredNorm();
  };
  EXPECT_EQ(nearest.find(goals, 9), by_brute_force(samples, 9, error));
}

TEST(NearestSamples, LeavesOutSamplesWithoutAnEquilibrium) {
  const Model model = two_markers();
  auto samples = random_samples(10);
  const Vec3 target = samples[3].markers.row(0);
  samples[3].status = Status::limit;
  NearestSamples nearest(model, samples);
  EXPECT_EQ(nearest.samples().size(), 9u);
  for (const Index row : nearest.find({{PositionGoal{0, target}, 1}}, 9)) EXPECT_NE(nearest.samples()[row].number, 3);
  for (WorkspaceSample& sample : samples) sample.status = Status::not_converged;
  EXPECT_THROW(NearestSamples(model, samples), InvalidInput);
}

TEST(NearestSamples, RefusesSamplesOfOtherMarkersAndGoalsThatAreNone) {
  const Model model = two_markers();
  auto samples = random_samples(10);
  NearestSamples nearest(model, samples);
  EXPECT_THROW((void)nearest.find({}), InvalidInput);
  EXPECT_THROW((void)nearest.find({{PositionGoal{2, Vec3::Zero()}, 1}}), InvalidInput);
  samples[4].markers.conservativeResize(1, 3);
  EXPECT_THROW(NearestSamples(model, samples), InvalidInput);
}

}  // namespace
}  // namespace softkin
