#include <gtest/gtest.h>

#include <cmath>
#include <softkin/kinematics/maps/piece_fit.hpp>

/// Maps of functions in place of a robot's equilibria.

namespace softkin::maps {
namespace {

/// Of two inputs from -1 to 1 and one output [mm].
struct Made {
  MapData data;
  MapPiece piece;
  Index equilibria = 0;
  bool gave_up = false;

  template <class Function>
  Made(const Function& function, Index most) {
    data.inputs = {{"u", "N", 0, -1, 1}, {"v", "N", 1, -1, 1}};
    data.outputs = {{"tip_x", "mm", 0.01}};
    piece.inputs = {0, 1};
    const Wanted wanted{Eigen::VectorXd::Constant(1, 0.01), {}, 0, most};
    PieceFit fit(data, wanted, piece);
    for (RowMatrix requested = fit.next(); requested.rows() > 0; requested = fit.next()) {
      std::vector<Sample> samples(requested.rows());
      for (Index i = 0; i < requested.rows(); ++i) {
        Sample& sample = samples[i];
        sample.commands = requested.row(i);
        sample.values = Eigen::VectorXd::Constant(1, function(sample.commands));
        sample.slopes.resize(2, 1);
        for (Index j = 0; j < 2; ++j) {
          const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(2, j);
          sample.slopes(j, 0) = (function(sample.commands + step) - function(sample.commands - step)) / 2e-6;
        }
      }
      fit.take(std::move(samples));
    }
    equilibria = fit.samples().size();
    gave_up = fit.gave_up();
    data.pieces = {piece};
    data.actuation = Actuation::Zero(2);
  }

  /// Share of a grid's points that are inside, and the largest error there.
  template <class Function>
  [[nodiscard]] std::pair<double, double> compared(const Function& function) const {
    const KinematicMap map(data);
    int inside = 0, points = 0;
    double largest = 0;
    for (double u = -0.99; u < 1; u += 0.033)
      for (double v = -0.99; v < 1; v += 0.033, ++points) {
        const Eigen::VectorXd at = Eigen::Vector2d(u, v);
        double value = 0;
        if (!map.evaluate(at.data(), &value)) continue;
        ++inside;
        largest = std::max(largest, std::abs(value - function(at)));
      }
    return {static_cast<double>(inside) / points, largest};
  }
};

double smooth(const Eigen::VectorXd& at) {
  return 20 * std::sin(at[0] + 0.5 * at[1]);
}

/// A contact that opens: the slope jumps along a slanting line.
double kinked(const Eigen::VectorXd& at) {
  return smooth(at) + 5 * std::max(0.0, at[0] - 0.3 * at[1] - 0.2);
}

TEST(MapPieces, SmoothOnesAreOneBox) {
  const Made made(smooth, 1000);
  EXPECT_EQ(made.piece.cells.size(), 1u);
  EXPECT_LE(made.equilibria, 40);
  const auto [inside, largest] = made.compared(smooth);
  EXPECT_EQ(inside, 1);
  EXPECT_LT(largest, 0.01);
}

TEST(MapPieces, BesideAKinkCommandsAreOutsideInsteadOfWrong) {
  const Made made(kinked, 1500);
  const auto [inside, largest] = made.compared(kinked);
  EXPECT_GT(inside, 0.6);
  EXPECT_LT(inside, 1);
  EXPECT_LT(largest, 0.02);
}

/// What was not refined to the end is no map.
TEST(MapPieces, WhatAFewEquilibriaDoNotTellIsOutside) {
  const Made made(kinked, 60);
  EXPECT_TRUE(made.gave_up);
  const auto [inside, largest] = made.compared(kinked);
  EXPECT_LT(inside, 0.9);
  EXPECT_LT(largest, 0.05);
}

}  // namespace
}  // namespace softkin::maps
