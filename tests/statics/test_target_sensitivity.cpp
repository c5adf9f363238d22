#include <softkin/statics/target_shape/system.hpp>

#include "statics/sensitivity_samples.hpp"

/// Sensitivities of the target-shape formulation against differences of fixed points.

namespace softkin {

namespace {

using namespace testing;

RobotSpec with_rigid_ends(RobotSpec spec) {
  spec.rigid.push_back({{Box{{50, 0, 0}, {60, 20, 24}}, {}}, "end"});
  spec.rigid.push_back({{Box{{20, 0, 8}, {30, 20, 8}}, {}}, "patch"});
  return spec;
}

StaticsOptions solved_anew() {
  StaticsOptions options = tight();
  options.reuse_factor = false;
  return options;
}

}  // namespace

/// Of the residual at a shape that is no equilibrium, by differences of local steps; a ratio at its least value stays.
TEST(TargetSensitivity, ResidualChangesWithCommandsAsTheDifferenceQuotientSays) {
  Team alone(1);
  for (const bool minimum_norm : {false, true})
    for (const double shape_ratio : {1.0, 0.5}) {
      const Model model = compile(mixed_robot(minimum_norm, shape_ratio));
      const target_shape::System system(model);
      target_shape::System::Scratch local = system.make_scratch(), out = system.make_scratch();
      const Points positions = model.rest + noise(model.rest.rows(), 0.3, 4);
      for (const Actuation& at : {values({1.2, 1.5, 0.85}), values({1, 1, 1}), values({1.2, 0.005, 0.85})}) {
        const auto residual_at = [&](Index actuator, double change) {
          Actuation actuation = at;
          actuation[actuator] += change;
          system.local_step(actuation, positions, local, alone);
          return local.residual;
        };
        for (Index a = 0; a < 3; ++a) {
          const double h = 1e-5;
          const Points quotient = (residual_at(a, h) - residual_at(a, -h)) / (2 * h);
          (void)residual_at(a, 0);
          system.command_change(local, a, out, alone);
          if (a == 1 && at[1] < 0.01 && !minimum_norm) {  // all ratios are at their least value
            EXPECT_LT(quotient.norm(), 1e-5);
            EXPECT_EQ(out.residual.norm(), 0);
            continue;
          }
          EXPECT_GT(quotient.norm(), 1);
          EXPECT_LT((out.residual - quotient).norm(), 1e-7 * quotient.norm()) << minimum_norm << shape_ratio << a;
        }
      }
    }
}

TEST(TargetSensitivity, EveryActuatorAndMaterial) {
  for (const bool minimum_norm : {false, true})
    for (const double shape_ratio : {1.0, 0.5}) {
      SCOPED_TRACE(std::to_string(minimum_norm) + " " + std::to_string(shape_ratio));
      RobotSpec spec = mixed_robot(minimum_norm, shape_ratio);
      spec.actuators[2].high = 1.2;
      const Model model = compile(spec);
      const Statics statics(model);
      for (const Actuation& actuation : {values({1, 1, 1}), values({1.2, 1.5, 0.85}), values({0.7, 2.2, 0.7})})
        expect_differences(model, statics, solve_converged(statics, actuation), 2e-6);
    }
}

TEST(TargetSensitivity, RigidRegions) {
  for (const bool minimum_norm : {false, true})
    expect_differences_at(with_rigid_ends(mixed_robot(minimum_norm, minimum_norm ? 0.6 : 1)), values({1.2, 1.6, 0.8}),
                          2e-6);
}

TEST(TargetSensitivity, LargeBend) {
  for (const bool minimum_norm : {false, true}) {
    RobotSpec spec = finger_robot(minimum_norm);
    MaterialSpec floor;
    floor.region = "floor";
    floor.weight = 100;
    spec.materials.push_back(floor);
    spec.actuators[0].weight = 100;
    spec.actuators[0].high = 12;
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium at = solve_converged(statics, values({10}));
    EXPECT_LT(at.state.positions.col(2).minCoeff(), -25);  // its tip is bent by 160 degrees
    expect_differences(model, statics, at, 2e-6, {1e-2, 0, 0});
  }
}

/// After a few iterations only the factor is far off; after Algorithm 1 there is none.
TEST(TargetSensitivity, DoesNotDependOnTheFactor) {
  for (const bool minimum_norm : {false, true}) {
    const Model model = compile(mixed_robot(minimum_norm, 1));
    const Statics statics(model);
    const Equilibrium at = solve_converged(statics, values({1.2, 1.5, 0.85}));
    const Sensitivity reused = statics.sensitivity(at.state, {}, 1e-10),
                      fresh = statics.sensitivity(at.state, solved_anew(), 1e-10),
                      again = statics.sensitivity(at.state, {}, 1e-10), rough = statics.sensitivity(at.state, {}, 1e-4);
    StaticsOptions as_printed = tight(1e-7);
    as_printed.solver = Solver::local_global;
    const Equilibrium other = statics.solve(at.actuation, statics.rest(), as_printed);
    ASSERT_EQ(other.report.status, Status::converged);
    const Sensitivity of_other = statics.sensitivity(other.state);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_LT(off_by(reused.positions[a], fresh.positions[a]), 1e-8);
      EXPECT_LT(off_by(again.positions[a], fresh.positions[a]), 1e-8);
      EXPECT_LT(off_by(rough.positions[a], fresh.positions[a]), 1e-3);
      EXPECT_LT(off_by(of_other.positions[a], fresh.positions[a]), 1e-5);
    }
  }
}

TEST(TargetSensitivity, DoesNotDependOnThreads) {
  const Model model = compile(mixed_robot(true, 0.5));
  std::vector<Sensitivity> all;
  for (const int threads : {1, 3}) {
    const Statics statics(model);
    StaticsOptions options = tight();
    options.threads = threads;
    all.push_back(statics.sensitivity(statics.solve(values({1.2, 1.5, 0.85}), statics.rest(), options).state, options));
  }
  for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(all[0].positions[a], all[1].positions[a]);
}

/// Elements that resist no shear: a mechanism, whose shape is not determined.
TEST(TargetSensitivity, AMechanismIsNotRegular) {
  RobotSpec spec = finger_robot(false, 0);
  const Model model = compile(spec);
  const Statics statics(model);
  State state = statics.rest();
  state.actuation = values({1});
  const Sensitivity found = statics.sensitivity(state);
  EXPECT_FALSE(found.regular);
  EXPECT_TRUE(found.positions[0].isZero(0));
}

TEST(TargetSensitivity, WithoutReuseNothingDependsOnEarlierSolves) {
  for (const bool minimum_norm : {false, true}) {
    const Model model = compile(with_rigid_ends(mixed_robot(minimum_norm, minimum_norm ? 0.5 : 1)));
    const Statics used(model), fresh(model);
    State state = used.rest();
    for (const Actuation& earlier : {values({0.7, 2.0, 0.8}), values({1.1, 1.2, 0.95})}) {
      state = used.solve(earlier, state, tight()).state;
      (void)used.sensitivity(state);
    }
    state = used.solve(values({1.12, 1.22, 0.95}), state, tight()).state;
    const Sensitivity reused = used.sensitivity(state), at_once = used.sensitivity(state, solved_anew()),
                      expected = fresh.sensitivity(state, solved_anew());
    EXPECT_NE(reused.positions[0], expected.positions[0]);  // another factor, other rounding
    EXPECT_EQ(at_once.positions[0], expected.positions[0]);
    for (const bool from_rest : {false, true}) {
      const State start = from_rest ? used.rest() : state;
      const Actuation requested = values({1.15, 1.25, 0.93});
      const Equilibrium a = used.solve(requested, start, solved_anew()),
                        b = fresh.solve(requested, start, solved_anew());
      EXPECT_EQ(a.state.positions, b.state.positions);
      EXPECT_EQ(a.report.iterations, b.report.iterations);
      const Sensitivity x = used.sensitivity(a.state, solved_anew()), y = fresh.sensitivity(b.state, solved_anew());
      EXPECT_TRUE(x.regular && y.regular);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(x.positions[i], y.positions[i]);
    }
  }
}

}  // namespace softkin
