#include <gtest/gtest.h>

#include <softkin/core/team.hpp>
#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/physical/newton.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;
using Precision = linear::MixedLdlt::Precision;

/// A strip of 2 x 2 mm, so long, with a tendon along its upper side.
RobotSpec strip(int cells, double length) {
  RobotSpec spec = physical_robot(block_mesh({cells, 2, 2}, {length, 2, 2}));
  std::vector<Vec3> points;
  for (int i = 0; i <= 10; ++i) points.emplace_back(length * i / 10, 1, 1.8);
  spec.actuators = {cable("top", points)};
  return spec;
}

struct Bent {
  physical::Newton::Outcome outcome;
  physical::SolveRecord report;
  Points shape;
};

double tolerance_mm(const Model& model) {
  return 1e-7 * model.diagonal_mm;
}

Bent bend(const Model& model, Precision precision) {
  const physical::System system(model);
  physical::Workspace work(system);
  work.saddle.precision() = precision;
  Team team(1);
  Bent bent;
  const ProgressCallback silent;
  physical::Newton newton(system, work, team, {tolerance_mm(model), 1e-6, 200, true}, silent, bent.report);
  physical::Iterate at{model.rest, Eigen::VectorXd::Zero(1)};
  bent.outcome = newton.solve({Actuation::Constant(1, 0.99), 1}, {true}, physical::Newton::Policy::descend, false, at);
  bent.shape = at.positions;
  return bent;
}

}  // namespace

/// A factor in single precision makes a long strip too stiff in bending, and where that shows steps are refined, or a
/// factor is made in double precision: there are hardly more of them than with that alone, and they lead to the same.
/// Where rounding, which each instruction set does in its own order, leads where no step helps, double precision begins
/// again, for a third of these strips at most (three with one compiler, two with another): then there are at most about
/// twice as many.
TEST(RoundedFactor, LongStripsBendAsInDouble) {
  int single_factors = 0, begun_again = 0;
  for (const double cell : {2.0, 1.0, 0.5})
    for (const int cells : {50, 100, 200, 400}) {
      const Model model = compile(strip(cells, cells * cell));
      const Bent single = bend(model, Precision::enough), twice = bend(model, Precision::twice);
      EXPECT_EQ(single.outcome, twice.outcome) << cell << " " << cells;
      EXPECT_LE(single.report.factorisations, 2.2 * twice.report.factorisations) << cell << " " << cells;
      begun_again += single.report.factorisations > twice.report.factorisations + 1;
      EXPECT_LE(single.report.iterations, 2.2 * twice.report.iterations) << cell << " " << cells;
      EXPECT_LT(distance(single.shape, twice.shape), 2 * tolerance_mm(model)) << cell << " " << cells;
      single_factors += single.report.factorisations - single.report.factorisations_in_double;
    }
  EXPECT_GT(single_factors, 5);
  EXPECT_LE(begun_again, 4);
}

/// Far from straight a rounded factor may lead where no step helps: then double precision begins again.
TEST(RoundedFactor, WhatGetsStuckIsTriedInDouble) {
  for (const int cells : {340, 360}) {
    const Model model = compile(strip(cells, cells));
    const Bent single = bend(model, Precision::enough), twice = bend(model, Precision::twice);
    EXPECT_EQ(single.outcome, physical::Newton::Outcome::converged) << cells;
    EXPECT_EQ(single.outcome, twice.outcome) << cells;
    EXPECT_LT(distance(single.shape, twice.shape), 2 * tolerance_mm(model)) << cells;
  }
}

/// A step that is refined is that of a factor in double precision.
TEST(RoundedFactor, ARefinedStepIsExact) {
  const Model model = compile(strip(50, 50));
  const physical::System system(model);
  Team team(1);
  const physical::LoadState load_state{Actuation::Constant(1, 0.99), 1};
  const physical::Iterate at{model.rest, Eigen::VectorXd::Zero(1)};
  struct Found {
    Eigen::VectorXd step, change, refined, refined_change;
  };
  const auto step_of = [&](Precision precision) {
    physical::Workspace work(system);
    work.saddle.precision() = precision;
    physical::Balance balance;
    system.evaluate(at, load_state, {true}, work, balance, team);
    (void)system.factorise(at, load_state, {true}, balance, {.step = true}, work, team);
    EXPECT_EQ(work.saddle.factor().in_double(), precision == Precision::twice);
    Found found;
    work.saddle.step(balance, found.step, found.change, team);
    physical::Bordered equations(system, work, team);
    equations.set_factorised(at);
    EXPECT_LT(equations.step(balance, 1e-9, 20, found.refined, found.refined_change).left, 1e-9);
    return found;
  };
  const Found single = step_of(Precision::enough), twice = step_of(Precision::twice);
  EXPECT_LT((single.refined - twice.step).norm(), 1e-7 * twice.step.norm());
  EXPECT_LT((single.refined_change - twice.change).norm(), 1e-7 * twice.change.norm());
  EXPECT_GT((single.step - twice.step).norm(), 1e-5 * twice.step.norm());
}

}  // namespace softkin
