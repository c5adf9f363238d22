#include <softkin/core/error.hpp>
#include <softkin/kinematics/jacobian.hpp>

#include "statics/sensitivity_samples.hpp"

/// Slopes of markers against differences of equilibria.

namespace softkin {

namespace {

using namespace testing;

/// Marker positions one below the other.
Eigen::VectorXd places(const Model& model, const std::vector<Index>& markers, const Points& positions) {
  Eigen::VectorXd all(3 * std::ssize(markers));
  for (std::size_t p = 0; p < markers.size(); ++p)
    all.segment<3>(3 * p) = model.markers[markers[p]].point.at(positions);
  return all;
}

void expect_slopes(const RobotSpec& spec, const Actuation& actuation) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, actuation);
  const std::vector<Index> markers{1, 0, 2};
  const Eigen::MatrixXd slopes = jacobian(statics, at, markers);
  ASSERT_EQ(slopes.rows(), 9);
  ASSERT_EQ(slopes.cols(), actuation.size());
  const Steps steps;
  for (Index a = 0; a < actuation.size(); ++a) {
    SCOPED_TRACE("actuator " + std::to_string(a));
    const double step = steps.of(model.actuators[a]);
    const auto moved = [&](double by) {
      Actuation there = actuation;
      there[a] += by;
      return places(model, markers, statics.solve(there, at.state, tight()).state.positions);
    };
    const Eigen::VectorXd expected =
        (8 * (moved(step) - moved(-step)) - (moved(2 * step) - moved(-2 * step))) / (12 * step);
    EXPECT_GT(expected.norm(), 0);
    EXPECT_LT(off_by(slopes.col(a), expected), 1e-5);
  }
}

/// A vertex, a point within an element, the mean of a face.
void add_markers(RobotSpec& spec, const Vec3& vertex, const Vec3& inside) {
  spec.markers = {{"vertex", {vertex, {}}}, {"inside", {inside, {}}}, {"face", {std::string("x_high"), {}}}};
}

}  // namespace

TEST(Jacobian, EqualsDifferencesOfEquilibria) {
  RobotSpec crowded = crowded_robot();
  add_markers(crowded, {48, 20, 20}, {33.3, 9.1, 1.7});
  expect_slopes(crowded, values({1.3, 30, 1.1, 0.93, 0.3}));
  RobotSpec strip = dea_strip();
  add_markers(strip, {40, 6, 2}, {17, 2.2, 0.7});
  expect_slopes(strip, values({1.25}));
  for (const bool minimum_norm : {false, true}) {
    RobotSpec mixed = mixed_robot(minimum_norm, minimum_norm ? 0.6 : 1);
    add_markers(mixed, {60, 20, 24}, {33.3, 9.1, 15.2});
    expect_slopes(mixed, values({1.2, 1.6, 0.85}));
  }
}

/// The Jacobian has three rows per marker, in the requested order and with repetitions, and a column per actuator.
TEST(Jacobian, HasThreeRowsAMarker) {
  const Model model = compile(chambers_beam(2));
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({1.3, 1.1}));
  const Sensitivity sensitivity = statics.sensitivity(at.state);
  const Eigen::MatrixXd once = jacobian(model, at.state.positions, sensitivity, {0}),
                        twice = jacobian(model, at.state.positions, sensitivity, {0, 0});
  EXPECT_EQ(once, jacobian(statics, at, {0}));
  EXPECT_EQ(once, twice.topRows(3));
  EXPECT_EQ(once, twice.bottomRows(3));
  EXPECT_EQ(jacobian(model, at.state.positions, sensitivity, {}).rows(), 0);
  EXPECT_EQ(jacobian(model, at.state.positions, sensitivity, {}).cols(), 2);
}

TEST(Jacobian, IsZeroWhereNotRegular) {
  RobotSpec spec = cable_beam();
  spec.actuators[1] = spec.actuators[0];
  spec.actuators[1].name = "twin";
  const Model model = compile(spec);
  const Statics statics(model);
  Equilibrium at = solve_converged(statics, values({0.9, 0.9}));
  at.state.multipliers.setConstant(0.1);
  EXPECT_TRUE(jacobian(statics, at, {0}).isZero(0));
}

TEST(Jacobian, RefusesUnknownMarkers) {
  const Model model = compile(chambers_beam(2));
  const Statics statics(model);
  const Equilibrium at = solve_converged(statics, values({1.3, 1.1}));
  EXPECT_THROW((void)jacobian(statics, at, {1}), InvalidInput);
  EXPECT_THROW((void)jacobian(statics, at, {0, -1}), InvalidInput);
}

}  // namespace softkin
