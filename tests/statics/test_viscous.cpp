#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "statics/physical_samples.hpp"
#include "statics/runge_kutta.hpp"

namespace softkin {

namespace {

using namespace testing;

constexpr double side = 10;  // of the cube [mm]
const std::vector<ViscousBranch> vhb{{0.02606, 0.61}, {0.02653, 6.56}, {0.01083, 61.25}};

/// A cube that is held to a length along x; its sides are free to move, or do not move across.
RobotSpec stretched_cube(double stretch, bool held_sides, const ElasticSpec& law,
                         const std::vector<ViscousBranch>& branches) {
  RobotSpec spec = physical_robot(block_mesh({1, 1, 1}, {side, side, side}));
  spec.materials[0].elastic = law;
  spec.materials[0].viscosity = branches;
  const auto hold = [&](const char* face, int axis, double move) {
    FixedSpec fixed{{std::string(face), {}}, {false, false, false}, Vec3::Zero()};
    fixed.axes[axis] = true;
    fixed.displacement[axis] = move;
    return fixed;
  };
  spec.fixed = {hold("x_low", 0, 0), hold("x_high", 0, (stretch - 1) * side), hold("y_low", 1, 0), hold("z_low", 2, 0)};
  if (held_sides) {
    spec.fixed.push_back(hold("y_high", 1, 0));
    spec.fixed.push_back(hold("z_high", 2, 0));
  }
  return spec;
}

struct Pulled {
  double stress = 0;  // nominal [MPa]
  ViscousFlow flow;
};

/// The cube after a step of time that ends at a stretch.
Pulled pulled(const RobotSpec& spec, const std::shared_ptr<const ViscousHistory>& history, double elapsed_s) {
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options;
  options.history = history;
  options.elapsed_s = elapsed_s;
  const Equilibrium found = statics.solve({}, statics.rest(), options);
  EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
  const Reaction held = reactions(model, found.state.positions, statics.measured(found.state))[1];
  return {held.force.x() / (side * side), statics.flow(found.state)};
}

RobotSpec viscous_finger() {
  RobotSpec spec = bending_finger();
  spec.materials[0].viscosity = vhb;
  spec.materials[0].viscosity[0].modulus_MPa = 0.5;
  return spec;
}

/// What the cube remembers that nobody has stretched.
std::shared_ptr<const ViscousHistory> unstretched(const ElasticSpec& law, const std::vector<ViscousBranch>& branches) {
  return pulled(stretched_cube(1, false, law, branches), nullptr, std::numeric_limits<double>::infinity()).flow.history;
}

}  // namespace

/// A strain that is held relaxes as the sum of G_i exp(-t / tau_i), in steps of any length.
TEST(Viscosity, ASmallStrainRelaxesByItsBranches) {
  const double strain = 1e-5;
  const ElasticSpec law = elastic(Law::neo_hookean, 0.2, 0.4);
  const double mu = 0.2 / 2.8, lambda = 0.2 * 0.4 / (1.4 * 0.2);
  const RobotSpec spec = stretched_cube(1 + strain, true, law, vhb);
  const double relaxed = (lambda + 2 * mu) * strain;
  Pulled now = pulled(spec, unstretched(law, vhb), 0);
  double time = 0;
  for (const double step : {0.0, 0.01, 0.3, 0.3, 2.0, 10.0, 100.0}) {
    if (step > 0) now = pulled(spec, now.flow.history, step);
    time += step;
    double expected = relaxed;
    for (const ViscousBranch& branch : vhb)
      expected += 4.0 / 3 * branch.modulus_MPa * std::exp(-time / branch.time_s) * strain;
    EXPECT_NEAR(now.stress, expected, 1e-4 * expected) << time;
    EXPECT_GE(now.flow.lost_mJ, 0);
  }
  EXPECT_NEAR(pulled(spec, now.flow.history, std::numeric_limits<double>::infinity()).stress, relaxed, 1e-4 * relaxed);
}

/// A strain that comes evenly, over many relaxation times: what is left of a branch is what its damper takes.
TEST(Viscosity, ASlowStrainIsBorneByTheDampers) {
  const double strain = 1e-5, modulus = 50, time = 0.01;
  const ElasticSpec law = elastic(Law::neo_hookean, 0.2, 0.4);
  const RobotSpec spec = stretched_cube(1 + strain, true, law, {{modulus, time}});
  const auto begin = unstretched(law, {{modulus, time}});
  const double relaxed = pulled(spec, nullptr, std::numeric_limits<double>::infinity()).stress;
  for (const double x : {1e2, 1e3, 1e4, 1e5}) {
    const double damped = 4.0 / 3 * modulus * strain / x;
    EXPECT_NEAR(pulled(spec, begin, x * time).stress - relaxed, damped, 1e-3 * damped) << x;
  }
}

/// At once the branches are springs: the cube is as stiff as one of their shear moduli together. Nearly incompressible,
/// as they resist no change of volume.
TEST(Viscosity, InstantAndRelaxedAnswersAreElastic) {
  const double nu = 0.499, mu = 0.05, bulk = 2 * mu * (1 + nu) / (3 * (1 - 2 * nu));
  double together = mu;
  for (const ViscousBranch& branch : vhb) together += branch.modulus_MPa;
  ElasticSpec soft;
  soft.law = Law::mooney_rivlin;
  soft.c10 = mu / 2;
  soft.c01 = 0;
  soft.bulk_modulus = bulk;
  ElasticSpec stiff = soft;
  stiff.c10 = together / 2;
  const double infinite = std::numeric_limits<double>::infinity();
  const auto begin = unstretched(soft, vhb);
  for (const double stretch : {0.7, 1.2, 2.0}) {
    const double instant = pulled(stretched_cube(stretch, false, soft, vhb), begin, 0).stress;
    EXPECT_NEAR(instant, pulled(stretched_cube(stretch, false, stiff, {}), nullptr, infinite).stress,
                1e-8 * std::abs(instant));
    EXPECT_EQ(pulled(stretched_cube(stretch, false, soft, vhb), nullptr, infinite).stress,
              pulled(stretched_cube(stretch, false, soft, {}), nullptr, infinite).stress);
  }
}

namespace {

/// Nominal stress [MPa] by a stretch along the axis and one across: along or across.
using PrincipalStress = std::function<double(double stretch, double across, bool along)>;

PrincipalStress neo_hooke(double e, double nu) {
  const double mu = e / (2 * (1 + nu)), lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
  return [mu, lambda](double stretch, double across, bool along) {
    const double j = stretch * across * across, own = along ? stretch : across;
    return mu * own + ((lambda + mu) * (j - 1) - mu) * j / own;
  };
}

/// Of -mu/2 jm ln(1 - (bar I1 - 3) / jm) + bulk/2 (J - 1)^2.
PrincipalStress gents_law(double mu, double jm, double bulk) {
  return [=](double stretch, double across, bool along) {
    const double j = stretch * across * across, own = along ? stretch : across, scale = std::pow(j, -2.0 / 3),
                 i1 = scale * (stretch * stretch + 2 * across * across);
    return (mu / (1 - (i1 - 3) / jm) * (scale * own * own - i1 / 3) + bulk * (j - 1) * j) / own;
  };
}

/// The cube with free sides, integrated apart from the solver: stretches and the branch equations along the axes, by
/// Runge and Kutta's method of fourth order.
class OneElement {
 public:
  OneElement(PrincipalStress law, std::vector<ViscousBranch> branches)
      : law_(std::move(law)), branches_(std::move(branches)), flowed_(branches_.size(), 1) {}

  /// Nominal stress along the axis at a stretch [MPa].
  [[nodiscard]] double stress(double stretch) const {
    return principal(stretch, side_at(stretch, flowed_), flowed_, true);
  }

  void advance(double from, double to, double time, int steps) {
    integrate(flowed_, from, to, time, steps, [this](double l, const Flowed& flowed) { return rate(l, flowed); });
  }

 private:
  using Flowed = std::vector<double>;  // of each branch C_v along the axis; across it is 1 / sqrt of that

  [[nodiscard]] Flowed rate(double stretch, const Flowed& flowed) const {
    const double across = side_at(stretch, flowed), j = stretch * across * across, scale = std::pow(j, -2.0 / 3);
    Flowed rates;
    for (std::size_t k = 0; k < flowed.size(); ++k) {
      const double along = scale * stretch * stretch, aside = scale * across * across * std::sqrt(flowed[k]);
      rates.push_back((along - (along / flowed[k] + 2 * aside) / 3 * flowed[k]) / branches_[k].time_s);
    }
    return rates;
  }
  [[nodiscard]] double principal(double stretch, double across, const Flowed& flowed, bool along) const {
    const double j = stretch * across * across, scale = std::pow(j, -2.0 / 3), own = along ? stretch : across;
    double stress = law_(stretch, across, along);
    for (std::size_t k = 0; k < flowed.size(); ++k) {
      const double first = scale * stretch * stretch / flowed[k],
                   second = scale * across * across * std::sqrt(flowed[k]);
      stress += branches_[k].modulus_MPa / own * ((along ? first : second) - (first + 2 * second) / 3);
    }
    return stress;
  }
  /// The stretch across at which nothing pulls there.
  [[nodiscard]] double side_at(double stretch, const Flowed& flowed) const {
    double low = 0.2 / std::sqrt(stretch), high = 3 / std::sqrt(stretch);
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (principal(stretch, middle, flowed, false) > 0 ? high : low) = middle;
    }
    return 0.5 * (low + high);
  }

  PrincipalStress law_;
  std::vector<ViscousBranch> branches_;
  Flowed flowed_;
};

/// A cycle of stretches from 1 to the largest and back, at one rate.
double triangle(double fraction, double largest) {
  return 1 + (largest - 1) * (fraction < 0.5 ? 2 * fraction : 2 - 2 * fraction);
}

/// Largest difference of the stresses over a cycle, over the largest stress.
double error_over_cycle(const ElasticSpec& law, OneElement apart, double period_s, int steps, double largest) {
  std::shared_ptr<const ViscousHistory> history = unstretched(law, vhb);
  double worst = 0, most = 0;
  for (int i = 1; i <= steps; ++i) {
    const double from = triangle((i - 1.0) / steps, largest), to = triangle(static_cast<double>(i) / steps, largest);
    const Pulled now = pulled(stretched_cube(to, false, law, vhb), history, period_s / steps);
    history = now.flow.history;
    apart.advance(from, to, period_s / steps, 200);
    worst = std::max(worst, std::abs(now.stress - apart.stress(to)));
    most = std::max(most, std::abs(apart.stress(to)));
  }
  return worst / most;
}

}  // namespace

TEST(Viscosity, AStepOfLargeStrainRelaxesAsTheBranchEquationsDo) {
  const ElasticSpec law = elastic(Law::neo_hookean, 0.1, 0.45);
  OneElement apart(neo_hooke(0.1, 0.45), vhb);
  const double stretch = 2.5;
  const RobotSpec spec = stretched_cube(stretch, false, law, vhb);
  Pulled now = pulled(spec, unstretched(law, vhb), 0);
  EXPECT_NEAR(now.stress, apart.stress(stretch), 1e-6 * now.stress);
  double step = 0.002;
  for (int i = 0; i < 60; ++i, step *= 1.12) {
    now = pulled(spec, now.flow.history, step);
    apart.advance(stretch, stretch, step, 50);
    EXPECT_NEAR(now.stress, apart.stress(stretch), 1e-3 * now.stress) << step;
  }
}

/// Half the time step, half the error: of large strain, over what is exact at small strain.
TEST(Viscosity, LoopsConvergeWithTheTimeStep) {
  const ElasticSpec law = elastic(Law::neo_hookean, 0.1, 0.45);
  const OneElement apart(neo_hooke(0.1, 0.45), vhb);
  for (const double period : {2.0, 20.0}) {
    const double coarse = error_over_cycle(law, apart, period, 20, 2),
                 fine = error_over_cycle(law, apart, period, 40, 2);
    EXPECT_LT(fine, 0.6 * coarse) << period;
    EXPECT_LT(fine, 1e-3) << period;
  }
}

/// VHB 4910 as published (equilibrium 15.36 kPa and a limit stretch of 5.85 of its chains, three branches): loops to
/// three times the length at 0.4, 0.04 and 0.004 a second.
TEST(Viscosity, LoopsOfVhbAtThreeRates) {
  const double limit = 5.85, mu = 0.01536, jm = 3 * (limit * limit - 1), bulk = 10;
  ElasticSpec law;
  law.law = Law::gent;
  law.shear_modulus = mu;
  law.jm = jm;
  law.bulk_modulus = bulk;
  const OneElement apart(gents_law(mu, jm, bulk), vhb);
  for (const double rate : {0.4, 0.04, 0.004}) {
    const double coarse = error_over_cycle(law, apart, 4 / rate, 20, 3),
                 fine = error_over_cycle(law, apart, 4 / rate, 80, 3);
    EXPECT_LT(fine, 0.3 * coarse) << rate;
    EXPECT_LT(fine, 1e-3) << rate;
  }
}

/// A bar that hangs on a cable's tension shortens as a standard linear solid does: the exact answer of one branch.
TEST(Viscosity, ABarCreepsUnderALoad) {
  RobotSpec spec = physical_robot(block_mesh({4, 1, 1}, {40, 10, 10}));
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0);
  const double added = 0.4, time = 2;
  spec.materials[0].viscosity = {{added, time}};
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}}};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  const Model free = compile(spec);
  const Statics freely(free);
  spec.loads.forces = {{"pull", {std::string("x_high"), {}}, {1e-3, 0, 0}}};
  const Model model = compile(spec);
  const Statics statics(model);
  const double stress = 1e-3 / 100;
  // the branch stores G : dev(strain - flowed)^2; along the bar, with the volume's stiffness of nu = 0
  const double mu = 0.5, bulk = 1.0 / 3;
  const auto modulus = [&](double shear) { return 9 * bulk * shear / (3 * bulk + shear); };
  const double instant = stress / modulus(mu + added), relaxed = stress / modulus(mu);
  // shear compliance: J(t) = 1/mu - (1/mu - 1/(mu + G)) exp(-t / retardation)
  const double retardation = time * (mu + added) / mu;
  StaticsOptions options;
  options.history = freely.flow(solve_converged(freely, {}).state).history;
  options.elapsed_s = 0;
  State state = statics.rest();
  double at = 0;
  const double step = 0.02;
  for (int i = 0; i <= 200; ++i) {
    const Equilibrium found = statics.solve({}, state, options);
    ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
    const double strain = (model.markers[0].point.at(found.state.positions).x() - 40) / 40;
    EXPECT_NEAR(strain, relaxed - (relaxed - instant) * std::exp(-at / retardation), 4e-3 * relaxed) << at;
    state = found.state;
    options.history = statics.flow(state).history;
    options.elapsed_s = step;
    at += step;
  }
}

/// What hangs in the loads of its scene for long has relaxed under them when times begin: a shape that nobody commands
/// to change stays, and one that is commanded to jumps as stiffly as it is at once from there.
TEST(Viscosity, TimesBeginAfterALongRestUnderTheLoads) {
  RobotSpec spec = viscous_finger();
  spec.materials[0].density = 50000;
  spec.loads.gravity = {0, 0, -9.81};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium relaxed = solve_converged(statics, values({1}));
  ASSERT_GT((relaxed.state.positions - model.rest).cwiseAbs().maxCoeff(), 0.05);
  StaticsOptions timed;
  for (const double time : {0.0, 0.5, 100.0}) {
    timed.elapsed_s = time;
    const Equilibrium found = statics.solve(values({1}), statics.rest(), timed);
    ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
    EXPECT_LT((found.state.positions - relaxed.state.positions).cwiseAbs().maxCoeff(), 1e-5) << time;
    EXPECT_LT(statics.flow(found.state).lost_mJ, 1e-9);
  }
  timed.elapsed_s = 0;
  const Equilibrium jumped = statics.solve(values({1.2}), statics.rest(), timed);
  timed.history = statics.flow(relaxed.state).history;
  const Equilibrium reported = statics.solve(values({1.2}), relaxed.state, timed);
  EXPECT_LT((jumped.state.positions - reported.state.positions).cwiseAbs().maxCoeff(), 1e-5);
}

/// From the shape before as from rest: the same.
TEST(Viscosity, TheStartOfASearchDoesNotMatter) {
  const Model model = compile(viscous_finger());
  const Statics statics(model);
  StaticsOptions options;
  options.elapsed_s = 0;
  Equilibrium now = statics.solve(values({1.4}), statics.rest(), options);
  for (const double ratio : {1.4, 1.7, 1.2}) {
    options.history = statics.flow(now.state).history;
    options.elapsed_s = 0.4;
    const Equilibrium next = statics.solve(values({ratio}), now.state, options);
    ASSERT_EQ(next.report.status, Status::converged) << next.report.remark;
    const Equilibrium fresh = statics.solve(values({ratio}), statics.rest(), options);
    ASSERT_EQ(fresh.report.status, Status::converged) << fresh.report.remark;
    EXPECT_LT((next.state.positions - fresh.state.positions).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_NEAR(next.state.multipliers[0], fresh.state.multipliers[0], 1e-6 * std::abs(fresh.state.multipliers[0]));
    now = next;
  }
}

/// Derivatives of a shape within a time step.
TEST(Viscosity, SensitivitiesAreThoseOfTheTimeStep) {
  const Model model = compile(viscous_finger());
  const Statics statics(model);
  StaticsOptions options;
  options.elapsed_s = 0;
  const Equilibrium before = statics.solve(values({1.4}), statics.rest(), options);
  options.history = statics.flow(before.state).history;
  options.elapsed_s = 0.3;
  const auto solved = [&](double ratio) {
    const Equilibrium found = statics.solve(values({ratio}), before.state, options);
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    return found.state;
  };
  const double step = 1e-3;
  const State below = solved(1.3 - step), above = solved(1.3 + step), middle = solved(1.3);
  const Sensitivity slopes = statics.sensitivity(middle);
  ASSERT_TRUE(slopes.regular);
  const Points change = (above.positions - below.positions) / (2 * step);
  EXPECT_LT((slopes.positions[0] - change).cwiseAbs().maxCoeff(), 1e-4 * change.cwiseAbs().maxCoeff());
  EXPECT_NEAR(slopes.multipliers(0, 0), (above.multipliers[0] - below.multipliers[0]) / (2 * step),
              1e-4 * std::abs(slopes.multipliers(0, 0)));
}

TEST(Viscosity, RefusesWhatIsNoTime) {
  RobotSpec spec = bending_finger();
  spec.materials[0].viscosity = vhb;
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options;
  for (const double time : {-1.0, std::nan("")}) {
    options.elapsed_s = time;
    EXPECT_THROW((void)statics.solve(values({1}), statics.rest(), options), InvalidInput);
  }
  options.elapsed_s = 1;
  options.history = std::make_shared<ViscousHistory>(ViscousHistory{{1, 2, 3}});
  EXPECT_THROW((void)statics.solve(values({1}), statics.rest(), options), InvalidInput);
}

}  // namespace softkin
