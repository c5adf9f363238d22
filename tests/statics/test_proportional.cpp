#include <gtest/gtest.h>

#include <cmath>
#include <softkin/statics/target_shape/system.hpp>

#include "statics/sensitivity_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

RobotSpec proportional(RobotSpec spec) {
  for (ActuatorSpec& actuator : spec.actuators) actuator.distribution = Distribution::proportional;
  return spec;
}

struct ProportionalCase {
  explicit ProportionalCase(const RobotSpec& spec)
      : model(compile(spec)),
        system(model),
        local(system.make_scratch()),
        out(system.make_scratch()),
        positions(model.rest + noise(model.rest.rows(), 0.3, 5)) {}

  [[nodiscard]] Points residual_at(const Actuation& actuation, const Points& at) {
    system.local_step(actuation, at, local, alone);
    return local.residual;
  }

  Model model;
  target_shape::System system;
  target_shape::System::Scratch local, out;
  Points positions;
  Team alone{1};
};

}  // namespace

/// a_i = c a_i^cur, by volumes of the chamber's elements that are computed here, and their volumes so sum to a U.
TEST(Proportional, RatiosAreInProportionToTheCurrentOnes) {
  ProportionalCase c(proportional(finger_robot(true)));
  const double requested = 1.7;
  (void)c.residual_at(values({requested}), c.positions);
  const auto& set = c.system.sets().pneumatic.at(0);
  const auto volume = [&](const Points& points, Index e) {
    std::array<Vec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = points.row(set.nodes[e / energy::lanes][i][e % energy::lanes]).transpose();
    return (p[1] - p[0]).dot((p[2] - p[0]).cross(p[3] - p[0])) / 6;
  };
  double rest = 0, current = 0, sum = 0;
  for (Index e = 0; e < set.count; ++e) {
    rest += volume(c.model.rest, e);
    current += volume(c.positions, e);
  }
  std::size_t index = 0;  // of the set: after those of the body
  while (c.local.ratios[index].empty()) ++index;
  for (Index e = 0; e < set.count; ++e) {
    const double ratio = c.local.ratios[index][e / energy::lanes][e % energy::lanes];
    EXPECT_NEAR(ratio, requested * rest / current * volume(c.positions, e) / volume(c.model.rest, e), 1e-12);
    sum += ratio * volume(c.model.rest, e);
  }
  EXPECT_NEAR(sum, requested * rest, 1e-9 * rest);
}

TEST(Proportional, ResidualChangesAsTheDifferenceQuotientSays) {
  for (const double shape_ratio : {1.0, 0.5}) {
    ProportionalCase c(proportional(mixed_robot(true, shape_ratio)));
    EXPECT_FALSE(c.system.is_gradient());
    const Points along = noise(c.model.rest.rows(), 1, 9);
    constexpr double h = 1e-5;
    for (const Actuation& at : {values({1.2, 1.5, 0.85}), values({1, 1, 1}), values({1.3, 0.7, 0.95})}) {
      const Points by_shape =
          (c.residual_at(at, c.positions + h * along) - c.residual_at(at, c.positions - h * along)) / (2 * h);
      (void)c.residual_at(at, c.positions);
      c.system.residual_change(c.local, along, c.out, c.alone);
      EXPECT_LT((c.out.residual - by_shape).norm(), 1e-6 * by_shape.norm());
      for (Index a = 0; a < at.size(); ++a) {
        Actuation more = at, less = at;
        more[a] += h;
        less[a] -= h;
        const Points by_command = (c.residual_at(more, c.positions) - c.residual_at(less, c.positions)) / (2 * h);
        (void)c.residual_at(at, c.positions);
        c.system.command_change(c.local, a, c.out, c.alone);
        EXPECT_GT(by_command.norm(), 1);
        EXPECT_LT((c.out.residual - by_command).norm(), 1e-7 * by_command.norm()) << shape_ratio << a;
      }
    }
  }
}

/// Solves from rest, at R_omega = 1 and blended; sensitivities of the equilibria agree with differences.
TEST(Proportional, NewtonFindsTheFixedPointOfAlgorithm1) {
  for (const double shape_ratio : {1.0, 0.5}) {
    const Model model = compile(proportional(mixed_robot(true, shape_ratio)));
    const Statics statics(model);
    const Actuation requested = values({1.2, 1.5, 0.85});
    const Equilibrium newton = solve_converged(statics, requested);
    EXPECT_LT(newton.report.iterations, 60);
    StaticsOptions printed = tight(1e-8);
    printed.solver = Solver::local_global;
    const Equilibrium algorithm = statics.solve(requested, statics.rest(), printed);
    EXPECT_EQ(algorithm.report.status, Status::converged) << algorithm.report.remark;
    EXPECT_LT(distance(newton.state.positions, algorithm.state.positions), 1e-4);
    expect_differences(model, statics, newton, 1e-6);
  }
}

/// Where every element has the same ratio all distributions are the same: what is all chamber, held at three vertices
/// without force, swells evenly. Beside it stands a body, which a robot needs.
TEST(Proportional, IsAsTheOthersWhereAllElementsAreAlike) {
  const std::array<int, 3> cells{4, 2, 2};
  for (const Distribution distribution :
       {Distribution::minimum_norm, Distribution::uniform, Distribution::proportional}) {
    Mesh mesh = block_mesh(cells, {40, 20, 20});
    add_volume_region(mesh, "chamber", [](const Vec3& p) { return p.x() < 20; });
    RobotSpec spec = block_robot(std::move(mesh));
    spec.voids.push_back({Box{{20, 0, 0}, {30, 20, 20}}, {}});
    spec.fixed = {{{Box{{30, 0, 0}, {40, 20, 20}}, {}}, {true, true, true}},
                  {{VertexList{{grid_vertex(cells, 0, 0, 0)}}, {}}, {true, true, true}},
                  {{VertexList{{grid_vertex(cells, 2, 0, 0)}}, {}}, {false, true, true}},
                  {{VertexList{{grid_vertex(cells, 0, 2, 0)}}, {}}, {false, false, true}}};
    ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 3, true);
    air.distribution = distribution;
    spec.actuators = {air};
    const Model model = compile(spec);
    const Equilibrium found = solve_converged(Statics(model), values({2}));
    for (Index v = 0; v < model.rest.rows(); ++v)
      if (model.rest(v, 0) < 21) {
        EXPECT_LT((found.state.positions.row(v) - std::cbrt(2) * model.rest.row(v)).norm(), 1e-6) << v;
      }
  }
}

}  // namespace softkin
