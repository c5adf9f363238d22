#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimator.hpp>
#include <softkin/kinematics/reading_plan.hpp>
#include <softkin/model/sensor.hpp>
#include <softkin/statics/deformation.hpp>

#include "kinematics/estimate_samples.hpp"

/// Forces, places and shapes that are estimated from synthetic readings.

namespace softkin {

namespace {

using namespace testing;
using estimate::Guess;
using estimate::Place;
using estimate::Problem;

}  // namespace

/// By central differences of equilibria, of forces, places along both tangents, and the pressure.
TEST(Estimator, SlopesAreThoseOfDifferences) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = touched_finger();
    if (quadratic) {
      spec.mesh = block_mesh({6, 3, 3}, {60, 12, 16});
      add_volume_region(spec.mesh, "chamber", [](const Vec3& p) {
        return p.x() > 10 && p.x() < 50 && p.y() > 4 && p.y() < 8 && p.z() > 5 && p.z() < 11;
      });
      add_volume_region(spec.mesh, "first", [](const Vec3& p) { return p.x() < 10; });
      add_volume_region(spec.mesh, "last", [](const Vec3& p) { return p.x() > 50; });
      spec.loads.forces[0].at.point = std::string("z_low");
      spec.mesh_options.quadratic = true;
    }
    const Model model = compile(spec);
    const Problem problem(model, {{"touch", true}, {model.actuators[0].name}}, all_columns(model), exactly(), 1e-9);
    const Actuation commands = commands_of(model, 0);
    Eigen::VectorXd values(4);
    values << 0.1, -0.2, 0.25, 20;
    const std::vector<Place> places = {{7, 0.3, 0.25}};
    const Guess at = problem.solve(commands, values, places, nullptr, {});
    ASSERT_TRUE(at.solved());
    const Eigen::MatrixXd slopes = problem.slopes(problem.nearby(at), at);
    ASSERT_EQ(slopes.cols(), 6);
    const estimate::Patch& patch = *problem.variables().forces()[0].patch;
    const Eigen::MatrixXd tangents = patch.fractions(places[0]).tangents;
    for (Index c = 0; c < 6; ++c) {
      const double h = c < 3 ? 0.02 : c == 3 ? 0.5 : 0.1;
      const auto computed = [&](double times) {
        Eigen::VectorXd step = Eigen::VectorXd::Zero(6), moved;
        step[c] = times * h;
        std::vector<Place> there;
        problem.move(at, step, moved, there);
        EXPECT_EQ(there[0].face, 7);
        const Guess found = problem.solve(commands, moved, there, &at, {});
        EXPECT_TRUE(found.solved());
        return found.computed;
      };
      const Eigen::VectorXd difference = (8 * (computed(1) - computed(-1)) - (computed(2) - computed(-2))) / (12 * h);
      expect_slopes(all_columns(model), slopes, c, difference, 1e-6);
    }
  }
}

/// The effects of nodal forces on readings, from one solution per reading, agree with those from one per force.
TEST(Estimator, ForcesAnywhereDoWhatEachDoes) {
  const Model model = compile(touched_finger());
  std::vector<PoseColumn> columns = all_columns(model);
  columns.resize(14);  // markers and sensors
  const Problem problem(model, {{"touch", true}}, columns, exactly(), 1e-9);
  Eigen::VectorXd values(3);
  values << 0.1, -0.2, 0.25;
  const std::vector<Place> places = {{7, 0.3, 0.25}};
  const Guess at = problem.solve(commands_of(model, 15), values, places, nullptr, {});
  ASSERT_TRUE(at.solved());
  const Eigen::MatrixXd by = problem.by_node_forces(at, 0);
  const estimate::FreeForce& force = problem.variables().forces()[0];
  ASSERT_EQ(by.cols(), 3 * static_cast<Index>(force.patch->nodes().size()));
  for (const Index node : {0, 4, 11})
    for (Index axis = 0; axis < 3; ++axis) {
      const Index all = problem.variables().model().actuators.size();
      const Eigen::VectorXd one =
          problem.slopes(at, {Actuation::Unit(all, force.first_command + 3 * node + axis)}).of_readings;
      EXPECT_LE((by.col(3 * node + axis) - one).norm(), 1e-6 * one.norm()) << node << ", " << axis;
    }
  columns.push_back({"air_volume_mm3", -1, -1, 0, Reading::volume});
  EXPECT_EQ(Problem(model, {{"touch", true}}, columns, exactly()).by_node_forces(at, 0).cols(), 0);
}

/// A solve converges to the same equilibrium from any initial guess of its caller, even from a wrong one.
TEST(Estimator, WhatIsForetoldChangesNoEquilibrium) {
  const Model model = compile(touched_finger());
  const Statics statics(model);
  const StaticsOptions options = exactly();
  const Equilibrium first = statics.solve(commands_of(model, 10), statics.rest(), options);
  Actuation there = commands_of(model, 14);
  there[3] = -0.1;
  const Equilibrium plain = Statics(model).solve(there, first.state, options);
  for (const double off : {0.0, 0.01, 3.0}) {
    const State at = statics.solve(commands_of(model, 10), first.state, options).state;
    State initial_guess = plain.state;
    initial_guess.positions.col(1).array() += off * initial_guess.positions.col(0).array() / 60;
    EXPECT_TRUE(statics.set_initial_guess(at, initial_guess, options));
    const Equilibrium found = statics.solve(there, at, options);
    ASSERT_EQ(found.report.status, Status::converged);
    EXPECT_LT((found.state.positions - plain.state.positions).cwiseAbs().maxCoeff(), 1e-6);
  }
}

namespace {

/// The effect of a force that is distributed to the corners of a face by its shape functions, as no estimator does it.
struct Touch {
  Actuation commands;
  Vec3 force, place;
  Equilibrium found;
  Eigen::VectorXd readings;
};

Touch touched(const Vec3& force, const Vec3& place, double pressure) {
  RobotSpec spec = touched_finger();
  spec.loads.forces = {{"touch", {place, {}}, force}};
  const Model model = compile(spec);
  const Statics statics(model);
  Touch touch{commands_of(model, pressure), force, place, {}, {}};
  touch.found = statics.solve(touch.commands, statics.rest());
  EXPECT_EQ(touch.found.report.status, Status::converged);
  touch.readings.resize(12);
  for (Index m = 0; m < 4; ++m) touch.readings.segment<3>(3 * m) = model.markers[m].at(touch.found.state.positions);
  // the estimator's model has more commands
  touch.commands.conservativeResize(4);
  touch.commands.tail(3).setZero();
  return touch;
}

Eigen::VectorXd noisy(const Eigen::VectorXd& readings, double deviation, std::mt19937& random) {
  std::normal_distribution<double> normal(0, deviation);
  Eigen::VectorXd noisy = readings;
  for (double& reading : noisy) reading += normal(random);
  return noisy;
}

Vec3 force_of(const Estimate& reported) {
  return {reported.numbers[0].value, reported.numbers[1].value, reported.numbers[2].value};
}

Estimator of_touch(const Model& model, double deviation_mm) {
  return {model, {{"touch", true}}, marker_columns(model), Eigen::VectorXd::Constant(12, deviation_mm)};
}

}  // namespace

/// Markers without noise determine force and place, up to the effect of the force's patch on the markers next to it.
TEST(Estimator, TellsForceAndPlace) {
  const Model model = compile(touched_finger());
  Estimator estimator = of_touch(model, 0.01);
  for (const Touch& touch : {touched({0.05, -0.1, -0.4}, {41, 7, 16}, 10), touched({-0.1, 0.1, -0.3}, {53, 4, 16}, 0),
                             touched({0, 0.25, 0.2}, {27, 9, 16}, 20)}) {
    estimator.forget();
    const Estimate& reported = estimator.update(touch.commands, touch.readings);
    ASSERT_EQ(reported.status, Status::converged) << reported.remark;
    EXPECT_TRUE(reported.left_out.empty());
    EXPECT_LT((force_of(reported) - touch.force).norm(), 0.03 * touch.force.norm());
    ASSERT_EQ(reported.places.size(), 1u);
    EXPECT_LT((reported.places[0].at_rest - touch.place).norm(), 0.02 * 60);
    const Points shape = reported.state.positions;
    EXPECT_LT((shape - touch.found.state.positions).rowwise().norm().maxCoeff(), 0.3);
  }
}

/// Ellipsoids of 90 % hold the force about that often, and the chi-square is what it is to be.
TEST(Estimator, DeviationsAreHonest) {
  const Model model = compile(touched_finger());
  Estimator estimator = of_touch(model, 0.1);
  std::mt19937 random(5);
  const Touch touch = touched({0.1, -0.2, -0.5}, {45, 5, 16}, 10);
  int held = 0, places_held = 0;
  double chi_square = 0, freedoms = 0;
  constexpr int draws = 40;
  for (int d = 0; d < draws; ++d) {
    const Estimate& reported = estimator.update(touch.commands, noisy(touch.readings, 0.1, random));
    ASSERT_EQ(reported.status, Status::converged);
    const Vec3 off = force_of(reported) - touch.force;
    const Mat3 covariance = reported.covariance.topLeftCorner<3, 3>();
    held += off.dot(covariance.inverse() * off) < 6.2514;  // 90 % of three freedoms
    const Eigen::Vector2d slid = (reported.places[0].at_rest - touch.place).head<2>();
    const Eigen::Matrix2d spread = reported.places[0].covariance.topLeftCorner<2, 2>();
    places_held += slid.dot(spread.inverse() * slid) < 4.6052;  // of two
    chi_square += reported.chi_square;
    freedoms += reported.freedoms;
  }
  EXPECT_GE(held, 30);
  EXPECT_GE(places_held, 30);
  EXPECT_NEAR(chi_square / freedoms, 1, 0.35);
}

/// The readings determine a weak force and its place poorly, and nonlinearly: better where the force is larger, worse
/// where it has the longer arm. The deviations account for this; first-order deviations would cover the truth in two of
/// three cases.
TEST(Estimator, DeviationsOfWeakForcesAreHonest) {
  const Model model = compile(touched_finger());
  Estimator estimator = of_touch(model, 0.1);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  constexpr int draws = 40;
  int held = 0, places_held = 0;
  for (int d = 0; d < draws; ++d) {
    // each draw has its place: compilers evaluate the arguments of a call in orders of their own
    const double z = normal(random), y = normal(random), x = normal(random), air = 20 * uniform(random);
    const double along = 10 + 45 * uniform(random), across = 2 + 8 * uniform(random), newtons = 0.1 * uniform(random);
    const Touch touch = touched(newtons * Vec3(x, y, z).normalized(), {along, across, 16}, air);
    estimator.forget();
    const Estimate& reported = estimator.update(touch.commands, noisy(touch.readings, 0.1, random));
    ASSERT_EQ(reported.status, Status::converged) << reported.remark;
    EXPECT_TRUE(reported.left_out.empty());
    const Vec3 off = force_of(reported) - touch.force;
    const Mat3 covariance = reported.covariance.topLeftCorner<3, 3>();
    held += off.dot(covariance.inverse() * off) < 6.2514;
    const Eigen::Vector2d slid = (reported.places[0].at_rest - touch.place).head<2>();
    const Eigen::Matrix2d spread = reported.places[0].covariance.topLeftCorner<2, 2>();
    places_held += slid.dot(spread.inverse() * slid) < 4.6052;
  }
  EXPECT_GE(held, 32);
  EXPECT_GE(places_held, 32);
}

/// With a time limit, an update takes about one equilibrium and ends within its accuracy of the converged estimate.
TEST(Estimator, UpdatesInTimeTakeAboutOneEquilibrium) {
  const Model model = compile(touched_finger());
  EstimatorOptions options, exact;
  options.fade_s = exact.fade_s = 0.5;
  exact.accuracy = 1e-4;
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(12, 0.1);
  std::mt19937 random(4);
  const Touch touch = touched({0.1, -0.1, -0.5}, {45, 6, 16}, 10);
  Estimator estimator(model, {{"touch", true}}, marker_columns(model), deviations, options),
      other(model, {{"touch", true}}, marker_columns(model), deviations, exact);
  int equilibria = 0, close = 0;
  constexpr int updates = 40;
  for (int u = 0; u <= updates; ++u) {
    const Eigen::VectorXd read = noisy(touch.readings, 0.1, random);
    const Estimate& reported = estimator.update(touch.commands, read, 0.01);
    const Estimate& best = other.update(touch.commands, read, 0.01);
    ASSERT_EQ(reported.status, Status::converged);
    ASSERT_EQ(best.status, Status::converged);
    if (u == 0) continue;
    equilibria += reported.equilibria;
    const Vec3 off = force_of(reported) - force_of(best);
    close += off.dot(best.covariance.topLeftCorner<3, 3>().inverse() * off) < 0.04;  // a fifth of a deviation
  }
  EXPECT_LE(equilibria, 3 * updates / 2);
  EXPECT_GE(close, 9 * updates / 10);
}

TEST(Estimator, NamesAndLeavesOutWrongReadings) {
  const Model model = compile(touched_finger());
  std::mt19937 random(3);
  const Touch touch = touched({0.1, -0.1, -0.4}, {42, 6, 16}, 10);
  Estimator estimator = of_touch(model, 0.1);
  for (const bool tracked : {false, true}) {
    Eigen::VectorXd off = noisy(touch.readings, 0.1, random), exchanged = off;
    if (tracked) (void)estimator.update(touch.commands, off);
    off.segment<3>(3) += Vec3(20, -15, 15);
    const Estimate& one = estimator.update(touch.commands, off);
    EXPECT_EQ(one.left_out, std::vector<std::size_t>{1});
    EXPECT_LT((force_of(one) - touch.force).norm(), 3 * std::sqrt(one.covariance.topLeftCorner<3, 3>().trace()));
    const std::vector<std::string> words = estimate_words(one, estimator.groups());
    EXPECT_NE(std::find(words.begin(), words.end(), "left out, as it contradicts the other readings: marker b"),
              words.end());
    if (!tracked) estimator.forget();
    const Vec3 first = exchanged.head<3>();
    exchanged.head<3>() = exchanged.segment<3>(6).eval();
    exchanged.segment<3>(6) = first;
    EXPECT_EQ(estimator.update(touch.commands, exchanged).left_out, (std::vector<std::size_t>{0, 2}));
    if (!tracked) estimator.forget();
  }
}

/// Two markers determine five unknowns poorly: the minimum lies in a curved valley, where steps must shorten gradually.
TEST(Estimator, FitsConvergeWhereReadingsTellLittle) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any{-1, 1};
  const Model model = compile(touched_finger());
  Estimator estimator = of_touch(model, 0.2);
  for (int draw = 0; draw < 40; ++draw) {
    const double z = 0.3 * any(random), y = 0.2 * any(random), x = 0.3 * any(random), air = 5 + 5 * any(random);
    const double along = 35 + 20 * any(random), across = 6 + 5 * any(random);
    const Touch touch = touched({x, y, z}, {along, across, 16}, air);
    Eigen::VectorXd values = noisy(touch.readings, 0.2, random);
    for (const Index lost : {draw % 4, (draw + 1 + draw / 4 % 3) % 4})
      values.segment<3>(3 * lost).setConstant(std::numeric_limits<double>::quiet_NaN());
    estimator.forget();
    EXPECT_EQ(estimator.update(touch.commands, values).status, Status::converged) << draw;
  }
}

/// A tilted camera is no wrong reading: nothing is left out, and the estimate reports that the readings do not fit.
TEST(Estimator, SaysWhereTheModelIsWrong) {
  const Model model = compile(touched_finger());
  Estimator estimator = of_touch(model, 0.02);
  const Touch touch = touched({0, 0, -0.4}, {50, 6, 16}, 20);
  const Mat3 tilt = Eigen::AngleAxisd(0.15, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  Eigen::VectorXd values = touch.readings;
  for (Index m = 0; m < 4; ++m) values.segment<3>(3 * m) = tilt * touch.readings.segment<3>(3 * m);
  const Estimate& reported = estimator.update(touch.commands, values);
  EXPECT_GT(reported.misfit(), 4.3);
  EXPECT_TRUE(reported.left_out.empty());
  const std::vector<std::string> words = estimate_words(reported, estimator.groups());
  ASSERT_FALSE(words.empty());
  EXPECT_NE(words.back().find("the readings do not fit the model"), std::string::npos) << words.back();
}

/// A chamber's volume at a pressure is one number: it determines none of five unknowns, which is reported for each.
TEST(Estimator, SaysWhatAVolumeDoesNotTell) {
  const Model model = compile(touched_finger());
  Estimator estimator(model, {{"touch", true}}, {{"air_volume_mm3", -1, -1, 0, Reading::volume}},
                      Eigen::VectorXd::Constant(1, 1.0));
  const Statics statics(model);
  const Equilibrium found = statics.solve(commands_of(model, 10), statics.rest());
  const double volume =
      achieved_ratio(model, model.actuators[0], found.state.positions) * model.actuators[0].rest_measure;
  const Estimate& reported = estimator.update(commands_of(model, 10), Eigen::VectorXd::Constant(1, volume));
  ASSERT_EQ(reported.status, Status::converged);
  EXPECT_LT(reported.numbers[2].deviation, reported.numbers[2].known_deviation);
  const std::vector<std::string> words = estimate_words(reported, estimator.groups());
  for (const std::string start : {"touch_fx is known to", "touch_fy is known to", "the place of touch is known to"})
    EXPECT_TRUE(std::any_of(words.begin(), words.end(), [&](const std::string& w) { return w.starts_with(start); }))
        << start;
}

/// An unmeasured pressure and a force at a known place are estimated from markers and the strain along the sole.
TEST(Estimator, TellsCommandsThatWereNotMeasured) {
  RobotSpec spec = touched_finger();
  spec.loads.forces[0].at.point = Vec3(50, 6, 16);
  const Model model = compile(spec);
  const Statics statics(model);
  Actuation commands = model.rest_actuation();
  commands << 24, 0.1, 0, -0.2;
  const Equilibrium found = statics.solve(commands, statics.rest());
  std::vector<PoseColumn> columns = all_columns(model);
  columns.erase(columns.begin() + 14, columns.end());  // without volume and support
  Eigen::VectorXd values(14), deviations = Eigen::VectorXd::Constant(14, 0.05);
  for (Index r = 0; r < 12; ++r) values[r] = model.markers[r / 3].at(found.state.positions)[r % 3];
  for (Index s = 0; s < 2; ++s) values[12 + s] = model.sensors[s]->at(found.state.positions);
  values[4] = std::numeric_limits<double>::quiet_NaN();  // not read
  EstimatorOptions options;
  options.accuracy = 1e-3;
  Estimator estimator(model, {{model.actuators[0].name}, {"touch"}}, columns, deviations, options);
  EXPECT_EQ(estimator.reported_actuators(), (std::vector<Index>{0, 1, 2, 3}));
  const Estimate& reported = estimator.update(model.rest_actuation(), values);
  ASSERT_EQ(reported.status, Status::converged);
  for (Index a = 0; a < 4; ++a)
    EXPECT_NEAR(reported.numbers[a].value, commands[a], 0.2 * reported.numbers[a].deviation);
  EXPECT_TRUE(reported.places.empty());
  EXPECT_TRUE(reported.actuation.isApprox(commands, 1e-2));
}

/// With a fading time, an estimate continues from the last one, and dropouts widen it.
TEST(Estimator, GoesOnFromTheLastEstimateAsFarAsItHolds) {
  const Model model = compile(touched_finger());
  EstimatorOptions options;
  options.fade_s = 1;
  Estimator estimator(model, {{"touch", true}}, marker_columns(model), Eigen::VectorXd::Constant(12, 0.1), options);
  std::mt19937 random(9);
  const Touch touch = touched({0.1, -0.1, -0.4}, {42, 6, 16}, 10);
  (void)estimator.update(touch.commands, noisy(touch.readings, 0.1, random));
  const double first = estimator.update(touch.commands, noisy(touch.readings, 0.1, random), 0.01).numbers[2].deviation;
  for (int u = 0; u < 10; ++u) (void)estimator.update(touch.commands, noisy(touch.readings, 0.1, random), 0.001);
  const Estimate after = estimator.update(touch.commands, noisy(touch.readings, 0.1, random), 0.001);
  EXPECT_LT(after.numbers[2].deviation, first);
  EXPECT_LT((force_of(after) - touch.force).norm(), 0.1);
  const Eigen::VectorXd nothing = Eigen::VectorXd::Constant(12, std::numeric_limits<double>::quiet_NaN());
  const Estimate later = estimator.update(touch.commands, nothing, 0.5);
  EXPECT_EQ(later.status, Status::converged);
  EXPECT_GT(later.numbers[2].deviation, 2 * after.numbers[2].deviation);
  const Estimate much_later = estimator.update(touch.commands, nothing, 100);
  EXPECT_NEAR(much_later.numbers[2].deviation, 1, 1e-6);  // as before any reading
  EXPECT_NEAR(much_later.numbers[2].value, 0, 1e-2);
}

/// The deviations that a plan predicts for a marker are those of an estimator with it, and the vertex that a plan
/// selects is the best of all, as an exhaustive search shows.
TEST(Estimator, PlansWhatToReadFurther) {
  const Model model = compile(touched_finger());
  const Touch touch = touched({0.1, -0.1, -0.4}, {42, 6, 16}, 10);
  std::vector<PoseColumn> columns = marker_columns(model);
  columns.resize(9);
  EstimatorOptions exact;
  exact.accuracy = 1e-5;
  const auto reported_by = [&](const std::vector<PoseColumn>& read) {
    const Index count = read.size();
    Estimator estimator(model, {{"touch", true}}, read, Eigen::VectorXd::Constant(count, 0.1), exact);
    // the model's own outputs at the estimate by all markers, so that both estimates are the same
    Eigen::VectorXd values = touch.readings.head(count);
    return Estimate(estimator.update(touch.commands, values));
  };
  const Estimate few = reported_by(columns);
  ASSERT_EQ(few.status, Status::converged);
  PlanOptions options;
  options.read = columns;
  options.deviations[static_cast<std::size_t>(Reading::coordinate)] = 0.1;
  const PlanBasis basis(few);
  const std::vector<PlannedReading> marker = plan_readings(model, {basis, basis}, options);
  ASSERT_EQ(marker.size(), 1u);  // "d" is all that is left
  EXPECT_EQ(marker[0].name, "marker d");
  EXPECT_NEAR((marker[0].at_rest - Vec3(59, 11, 2)).norm(), 0, 1e-9);
  const Eigen::MatrixXd more = reported_by(marker_columns(model)).near_covariance;
  for (Index i = 0; i < 3; ++i) EXPECT_NEAR(marker[0].numbers[i], std::sqrt(more(i, i)), 0.1 * std::sqrt(more(i, i)));
  EXPECT_NEAR(marker[0].places[0], std::sqrt(more.diagonal().tail<2>().sum()), 0.1 * marker[0].places[0]);
  EXPECT_NEAR(marker[0].bits, 0.5 * std::log2(few.near_covariance.determinant() / more.determinant()), 0.15);

  for (Index v = 0; v < model.rest.rows(); v += 3) options.vertices.push_back(v);
  options.count = 2;
  const std::vector<PlannedReading> plan = plan_readings(model, {basis}, options);
  ASSERT_EQ(plan.size(), 2u);
  double most = 0;
  for (const Index v : options.vertices) {
    Eigen::MatrixXd slopes(3, 5);
    for (Index c = 0; c < 5; ++c) slopes.col(c) = vertex_at(few.moves[c], v) / 0.1;
    const Eigen::MatrixXd posterior = (few.near_covariance.inverse() + slopes.transpose() * slopes).inverse();
    most = std::max(most, 0.5 * std::log2(few.near_covariance.determinant() / posterior.determinant()));
  }
  EXPECT_NEAR(std::max(most, marker[0].bits), plan[0].bits, 1e-6 * most);
  EXPECT_GT(plan[0].bits, plan[1].bits);
  EXPECT_GT(plan[1].bits, 0);

  EXPECT_THROW((void)plan_readings(model, {}, options), InvalidInput);
  options.vertices = {static_cast<Index>(model.rest.rows())};
  EXPECT_THROW((void)plan_readings(model, {basis}, options), InvalidInput);
  options.vertices.clear();
  options.deviations = {};
  EXPECT_THROW((void)plan_readings(model, {basis}, options), InvalidInput);
}

TEST(Estimator, Refusals) {
  const Model model = compile(touched_finger());
  const auto refused = [&](const std::vector<EstimatedUnknown>& unknowns, double deviation, const std::string& why) {
    try {
      const Estimator estimator(model, unknowns, marker_columns(model), Eigen::VectorXd::Constant(12, deviation));
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  refused({}, 1, "there is no unknown to estimate");
  refused({{"push"}}, 1, "the scene has no command of that name, and no force with a 'range'");
  refused({{model.actuators[0].name, true}}, 1, "a command has no place");
  refused({{"touch"}, {"touch_fx"}}, 1, "command 'touch_fx' is to be estimated twice");
  refused({{"touch", true, 5, 1}}, 1, "its mean, 5 N, is outside its range, -1 to 1 N");
  refused({{"touch", true, 0, -1}}, 1, "the deviation must be above 0");
  refused({{"touch"}}, 0, "needs a deviation above 0");
  EXPECT_THROW((void)parse_unknown("--unknown", "touch:where"), InvalidInput);
  EXPECT_THROW((void)parse_unknown("--unknown", "touch=1"), InvalidInput);
  EXPECT_THROW((void)parse_unknown("--unknown", "touch=1+-x"), InvalidInput);
  const EstimatedUnknown parsed = parse_unknown("--unknown", "touch:place=-0.5+-0.25");
  EXPECT_EQ(parsed.name, "touch");
  EXPECT_TRUE(parsed.somewhere);
  EXPECT_EQ(parsed.mean, -0.5);
  EXPECT_EQ(parsed.deviation, 0.25);
}

}  // namespace softkin
