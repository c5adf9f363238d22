#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "statics/contact_scenes.hpp"
#include "statics/physical_samples.hpp"

/// A solve that is stopped at any instant returns the last equilibrium on its path, from which another solve continues.

namespace softkin {

namespace {

using namespace testing;

StaticsOptions traced() {
  StaticsOptions options = tight(1e-8);
  options.trace = true;
  return options;
}

/// Stops after a number of calls of the progress callback.
Equilibrium stopped_after(const Statics& statics, const Actuation& requested, int looks, const State& start,
                          const StaticsOptions& options = tight(1e-8)) {
  statics.forget();
  return statics.solve(requested, start, options, [looks](const Progress&) mutable { return looks-- > 0; });
}

/// Checks at every instant that the state is an equilibrium of its load state, and that the rest of the path has the
/// same end.
void expect_stoppable(const RobotSpec& spec, const Actuation& requested, double within_mm) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium whole = statics.solve(requested, statics.rest(), traced());
  ASSERT_EQ(whole.report.status, Status::converged) << whole.report.remark;
  int between = 0;  // of the stopped ones, with a part of the path completed
  for (int looks = 0;; ++looks) {
    const Equilibrium part = stopped_after(statics, requested, looks, statics.rest());
    if (!part.report.stopped) {
      EXPECT_GT(looks, 3);
      break;
    }
    ASSERT_EQ(part.report.status, Status::interrupted) << looks;
    ASSERT_TRUE(part.state.knows(requested.size())) << looks;
    EXPECT_TRUE(part.state.positions.allFinite());
    between += part.report.reached > 0 && part.report.reached < 1;
    statics.forget();
    const Equilibrium on = statics.solve(requested, part.state, tight(1e-8));
    ASSERT_EQ(on.report.status, Status::converged) << looks << ": " << on.report.remark;
    EXPECT_LT(distance(on.state.positions, whole.state.positions), within_mm) << looks;
    if (part.state.load_factor < 1) continue;  // an equilibrium at the full load factor can be solved for itself
    const Equilibrium same = statics.solve(part.state.actuation, part.state, tight(1e-8));
    EXPECT_LT(distance(same.state.positions, part.state.positions), within_mm) << looks;
  }
  EXPECT_GT(between, 0) << "nothing was stopped on its way";
}

TEST(Stopped, AtAnyInstantOfALength) {
  expect_stoppable(cable_beam(), values({0.6, 1.5}), 1e-5);
}

/// A solve can be stopped, too, during measure-controlled continuation to the maximum of the pressure.
TEST(Stopped, AtAnyInstantOfTheSearchForAMaximum) {
  RobotSpec spec = bending_finger();
  spec.materials[0].elastic = elastic(Law::neo_hookean, 0.1, 0.45);
  spec.actuators[0] = by_load(spec.actuators[0]);
  const Model model = compile(spec);
  const Statics statics(model);
  const Actuation requested = values({1000});
  double most = 0;
  for (int looks = 0;; looks += 11) {
    const Equilibrium part = stopped_after(statics, requested, looks, statics.rest());
    if (!part.report.stopped) break;
    ASSERT_TRUE(part.state.knows(1)) << looks;
    EXPECT_GE(part.state.actuation[0], most) << "what was found is lost";
    most = part.state.actuation[0];
    EXPECT_NEAR(part.report.reached, most / 1000, 1e-12);
    statics.forget();
    const Equilibrium same = statics.solve(part.state.actuation, part.state, tight(1e-8));
    ASSERT_EQ(same.report.status, Status::converged) << looks;
    EXPECT_LT(distance(same.state.positions, part.state.positions), 1e-5) << looks;
  }
  EXPECT_GT(most, 0);
}

/// A factorisation of a large robot takes seconds: continuation, up to a load and back, polls for cancellation before
/// each of them, except for one more that counts the unstable modes of an answer.
TEST(Stopped, WithinOneFactorisation) {
  RobotSpec pressed = bending_finger(), onto = BlockOnFloor{0.05, 0.03, 0.3}.robot();
  pressed.materials[0].elastic = elastic(Law::neo_hookean, 0.1, 0.45);
  pressed.actuators[0] = by_load(pressed.actuators[0]);
  StaticsOptions beyond = tight(1e-8);
  beyond.beyond = 4;
  const auto expect_heard = [](const Statics& statics, const Actuation& requested, const State& start,
                               const StaticsOptions& options = tight(1e-8)) {
    int before = 0;
    for (int looks = 0;; ++looks) {
      const Equilibrium part = stopped_after(statics, requested, looks, start, options);
      EXPECT_LE(part.report.factorisations, before + 1 + (part.report.physical.unstable_modes > 0)) << looks;
      before = part.report.factorisations;
      if (!part.report.stopped) break;
    }
    EXPECT_GT(before, 3);
  };
  const Model by_load_model = compile(pressed);
  const Statics by_measure(by_load_model);
  expect_heard(by_measure, values({1000}), by_measure.rest());
  const Equilibrium far = by_measure.solve(values({1000}), by_measure.rest(), beyond);
  ASSERT_EQ(far.report.physical.unstable_modes, 1) << far.report.remark;
  expect_heard(by_measure, 1.01 * far.state.actuation, far.state, beyond);
  for (const auto& [spec, requested] : {std::pair{cable_beam(), values({0.6, 1.5})}, std::pair{onto, Actuation(0)}}) {
    const Model model = compile(spec);
    const Statics statics(model);
    expect_heard(statics, requested, statics.rest());
  }
}

/// A callback throws at every instant: the next solve gives the same result as a new solver.
void expect_unharmed_by_exceptions(const RobotSpec& spec, const Actuation& requested) {
  struct Thrown {};
  const Model model = compile(spec);
  const Equilibrium whole = solve_converged(Statics(model), requested);
  ASSERT_EQ(whole.report.status, Status::converged) << whole.report.remark;
  const Statics statics(model);
  int looks = 0;
  for (bool thrown = true; thrown; ++looks) {
    thrown = false;
    try {
      (void)statics.solve(requested, statics.rest(), tight(), [left = looks](const Progress&) mutable {
        if (left-- == 0) throw Thrown{};
        return true;
      });
    } catch (const Thrown&) {
      thrown = true;
    }
    const Equilibrium again = solve_converged(statics, requested);
    ASSERT_EQ(again.state.positions, whole.state.positions) << looks;
    ASSERT_EQ(again.report.iterations, whole.report.iterations) << looks;
  }
  EXPECT_GT(looks, 5);
}

TEST(Stopped, ByAnExceptionItLeavesNothingBehind) {
  expect_unharmed_by_exceptions(cable_beam(), values({0.6, 1.5}));
  RobotSpec pressed = BlockOnFloor{0.05, 0.03, 0.3}.robot();
  pressed.fixed[0].displacement = {1, 0, -0.3};
  pressed.fixed[0].axes = {true, true, true};
  pressed.fixed.resize(1);
  pressed.contact->friction = 0.4;
  expect_unharmed_by_exceptions(pressed, Actuation(0));
}

TEST(Stopped, ByItsDeadlineItIsNotConvergedAndSaysSo) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  StaticsOptions options;
  options.deadline = Deadline(1e-9);
  const Equilibrium found = statics.solve(values({2}), statics.rest(), options);
  EXPECT_EQ(found.report.status, Status::not_converged);
  EXPECT_TRUE(found.report.stopped);
  EXPECT_EQ(found.report.remark, "the budget of 1e-09 s was spent");
  EXPECT_EQ(found.state.positions, model.rest);
  options.deadline = Deadline(1e5);
  EXPECT_EQ(statics.solve(values({2}), statics.rest(), options).report.status, Status::converged);
  for (const double wrong : {0.0, -1.0, std::nan("")}) EXPECT_THROW((void)Deadline(wrong), InvalidInput) << wrong;
  EXPECT_FALSE(Deadline(HUGE_VAL).any());
}

/// The callback may read the same deadline, which passes meanwhile.
TEST(Stopped, ByADeadlineThatPassesWhileItAsks) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  StaticsOptions options;
  options.deadline = Deadline(0.2);
  const Equilibrium found = statics.solve(values({2}), statics.rest(), options, [&](const Progress&) {
    while (!options.deadline.passed()) continue;
    return false;
  });
  EXPECT_EQ(found.report.status, Status::not_converged);
  EXPECT_EQ(found.report.remark, "the budget of 0.2 s was spent");
}

TEST(Stopped, ATargetShapeToo) {
  RobotSpec spec = bending_finger();
  spec.formulation = Formulation::target_shape;
  spec.materials[0].shape_ratio = 1;
  const Model model = compile(spec);
  const Statics statics(model);
  for (const Solver solver : {Solver::newton, Solver::local_global}) {
    StaticsOptions options;
    options.solver = solver;
    options.deadline = Deadline(1e-9);
    const Equilibrium found = statics.solve(values({1.5}), statics.rest(), options);
    EXPECT_EQ(found.report.status, Status::not_converged);
    EXPECT_TRUE(found.report.stopped);
    EXPECT_TRUE(found.state.positions.allFinite());
  }
}

/// A solve that converges with its last allowed iteration is the same to the last bit; with one iteration less it
/// returns its last good shape and load factor, from which it continues.
TEST(Stopped, ByItsLimitOfIterations) {
  RobotSpec target = bending_finger();
  target.formulation = Formulation::target_shape;
  target.materials[0].shape_ratio = 1;
  for (const RobotSpec& spec : {bending_finger(), cable_beam(), target}) {
    const Model model = compile(spec);
    const Statics statics(model);
    Actuation requested = Actuation::Constant(std::ssize(model.actuators), 1.5);
    if (model.actuators.size() == 2) requested[0] = 0.6;
    StaticsOptions options;
    options.reuse_factor = false;
    const Equilibrium found = statics.solve(requested, statics.rest(), options);
    ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
    ASSERT_GT(found.report.iterations, 3);
    options.max_iterations = found.report.iterations;
    const Equilibrium just = statics.solve(requested, statics.rest(), options);
    EXPECT_EQ(just.report.status, Status::converged) << just.report.remark;
    EXPECT_EQ(just.state.positions, found.state.positions);
    // the limit is one of a step as long as the path advances, so that several steps may take more in all
    Equilibrium cut = found;
    while (cut.report.status == Status::converged && options.max_iterations > 1) {
      --options.max_iterations;
      cut = statics.solve(requested, statics.rest(), options);
    }
    EXPECT_EQ(cut.report.status, Status::not_converged);
    EXPECT_GE(cut.report.iterations, options.max_iterations);
    EXPECT_FALSE(cut.report.stopped);  // so that a path continues
    EXPECT_EQ(cut.report.remark,
              "the limit of " + std::to_string(options.max_iterations) + " iterations (max_iterations) was reached");
    const Equilibrium on = statics.solve(requested, cut.state, {});
    EXPECT_EQ(on.report.status, Status::converged) << on.report.remark;
    EXPECT_LT((on.state.positions - found.state.positions).rowwise().norm().maxCoeff(), 1e-4);
  }
}

/// Who stops at the same iteration has stopped it.
TEST(Stopped, ByWhoAsksAtItsLimitOfIterations) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  StaticsOptions options;
  options.max_iterations = 2;
  const Equilibrium found =
      statics.solve(values({2}), statics.rest(), options, [](const Progress& p) { return p.iteration < 2; });
  EXPECT_EQ(found.report.status, Status::interrupted);
  EXPECT_TRUE(found.report.stopped);
}

/// Every iteration and factorisation of the steps is in the trace once, and what was taken leads from rest to the end.
TEST(Trace, HasEveryStepOfTheWay) {
  const Model model = compile(cable_beam());
  const Statics statics(model);
  const Equilibrium found = statics.solve(values({0.6, 1.5}), statics.rest(), traced());
  ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
  double at = 0;
  int iterations = 0, taken = 0;
  for (const TracedStep& step : found.report.trace) {
    EXPECT_EQ(step.from, at);
    EXPECT_GT(step.to, step.from);
    EXPECT_EQ(step.taken ? "" : step.why, step.why);
    iterations += step.iterations;
    if (!step.taken) continue;
    at = step.to;
    ++taken;
    EXPECT_GT(step.predicted_mm, 0);
    EXPECT_GT(step.corrected_mm, 0);
  }
  EXPECT_EQ(at, 1);
  EXPECT_EQ(iterations, found.report.iterations);
  EXPECT_EQ(taken, found.report.continuation_steps);
  EXPECT_GT(found.report.trace.size(), static_cast<std::size_t>(taken)) << "nothing was rejected";
  EXPECT_TRUE(solve_converged(statics, values({0.6, 1.5})).report.trace.empty());
}

/// Along the volume to the maximum of a pressure.
TEST(Trace, NamesTheChamberThatItGoesAlong) {
  RobotSpec spec = bending_finger();
  spec.materials[0].elastic = elastic(Law::neo_hookean, 0.1, 0.45);
  spec.actuators[0] = by_load(spec.actuators[0]);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = statics.solve(values({1000}), statics.rest(), traced());
  ASSERT_EQ(found.report.status, Status::limit);
  int taken_along = 0, rejected = 0;
  for (const TracedStep& step : found.report.trace) {
    taken_along += step.along == "chamber" && step.taken;
    rejected += !step.taken;
    EXPECT_EQ(step.taken, step.why.empty()) << step.why;
  }
  EXPECT_GT(taken_along, 2);
  EXPECT_GT(rejected, 0);
}

}  // namespace

}  // namespace softkin
