#include <Eigen/Eigenvalues>
#include <cmath>
#include <softkin/core/error.hpp>

#include "model/compile_testing.hpp"
#include "model/quadratic_mesh.hpp"
#include "statics/difference.hpp"
#include "statics/mixed_samples.hpp"
#include "statics/physical_equations.hpp"
#include "statics/sensitivity_samples.hpp"

/// Elements with pressures as unknowns: derivatives, inertia, closed forms, and all that knows of them.

namespace softkin {

namespace {

using namespace testing;

/// A block of elements with pressures; neither shape nor pressures are in equilibrium.
struct MixedSample : PhysicalEquations {
  explicit MixedSample(const RobotSpec& spec) : PhysicalEquations(compile(spec)) {
    const Index count = system.model().rest.rows();
    load_state = {model.rest_actuation(), 1};
    active.assign(system.actuators(), false);
    at.positions = system.model().rest + noise(count, 0.3, 1);
    at.positions.col(0).tail(system.pressures()->count()) = noise(count, 4, 3).col(0).tail(system.pressures()->count());
    at.multipliers = Eigen::VectorXd::Zero(system.actuators());
    system.placement().hold(load_state, at.positions);
  }
  Points gradient(const Points& shape) {
    physical::Iterate there = at;
    there.positions = shape;
    system.evaluate(there, load_state, active, work, balance, team);
    return work.gradient;
  }
  /// What is stationary.
  double lagrangian(const Points& shape) {
    const Points slopes = gradient(shape);
    const Index count = system.pressures()->count();
    return balance.energy + shape.col(0).tail(count).dot(slopes.col(0).tail(count));
  }
};

RobotSpec small_block(Law law, bool quadratic, double nu = 0.48) {
  const Vec3 size(8, 5, 6);
  RobotSpec spec = physical_robot(quadratic ? bent(quadratic_block({1, 1, 1}, size)) : block_mesh({1, 1, 1}, size));
  return mixed(std::move(spec), nu, quadratic, law);
}

constexpr std::array laws_with_bulk{Law::neo_hookean, Law::mooney_rivlin, Law::yeoh, Law::gent, Law::ogden};

}  // namespace

TEST(MixedElements, GradientIsThatOfTheLagrangian) {
  for (const bool quadratic : {false, true})
    for (const Law law : laws_with_bulk) {
      MixedSample sample(small_block(law, quadratic));
      const Points exact = sample.gradient(sample.at.positions);
      ASSERT_FALSE(sample.balance.forbidden);
      const Points slope =
          difference([&](const Points& shape) { return sample.lagrangian(shape); }, sample.at.positions, 1e-4);
      Points free = slope;  // y and z of a pressure are nothing
      free.bottomRightCorner(sample.system.pressures()->count(), 2).setZero();
      EXPECT_LT((free - exact).norm(), 1e-6 * exact.norm());
      EXPECT_GT(exact.bottomRows(sample.system.pressures()->count()).norm(), 1e-3 * exact.norm());
    }
}

TEST(MixedElements, StiffnessIsTheDerivativeOfTheGradient) {
  for (const bool quadratic : {false, true})
    for (const Law law : laws_with_bulk) {
      MixedSample sample(small_block(law, quadratic));
      const Index pressures = sample.system.pressures()->count();
      Points along = noise(sample.at.positions.rows(), 1, 7);
      along.bottomRightCorner(pressures, 2).setZero();
      (void)sample.gradient(sample.at.positions);
      sample.system.assemble(sample.at, sample.load_state, sample.balance, physical::System::Stiffness::exact,
                             sample.work, sample.team);
      Points exact;
      sample.work.stiffness.layout->pattern.gather(sample.work.stiffness.slots, sample.work.stiffness.blocks,
                                                   sample.team);
      sample.work.stiffness.layout->pattern.multiply(sample.work.stiffness.blocks, along, exact, sample.team);
      const Points slope =
          change_along([&](const Points& shape) { return sample.gradient(shape); }, sample.at.positions, along, 1e-5);
      EXPECT_LT((slope - exact).norm(), 1e-7 * exact.norm());
      EXPECT_LT((slope - exact).bottomRows(pressures).norm(), 1e-6 * exact.bottomRows(pressures).norm());
    }
}

/// What it counts as unstable is what the shape with pressures that follow it has of negative eigenvalues: those of
/// A + B C^-1 B^T, of dense matrices.
TEST(MixedElements, NegativePivotsAreThoseOfTheShape) {
  for (const bool quadratic : {false, true}) {
    std::vector<int> seen;
    for (const double load : {0.0, -0.2, -3.0, -9.0}) {  // pressures that press: the body buckles
      MixedSample sample(mixed(physical_robot(block_mesh({3, 1, 1}, {30, 4, 4})), 0.499, quadratic));
      const Index pressures = sample.system.pressures()->count();
      sample.at.positions = sample.system.model().rest;
      sample.at.positions.col(0).tail(pressures).setConstant(load / sample.system.pressures()->unit);
      (void)sample.gradient(sample.at.positions);
      const int counted = sample.system.factorise(sample.at, sample.load_state, sample.active, sample.balance, {},
                                                  sample.work, sample.team);
      const Index size = sample.system.freedoms().size();
      Eigen::MatrixXd whole(size, size);
      sample.system.assemble(sample.at, sample.load_state, sample.balance, physical::System::Stiffness::exact,
                             sample.work, sample.team);
      sample.system.gather(sample.at, sample.balance, sample.work, sample.team);
      sample.system.multiply(sample.at, Eigen::MatrixXd::Identity(size, size), sample.work, whole, sample.team);
      std::vector<bool> scalar(size);
      for (const Index u : sample.system.freedoms().scalar_unknowns()) scalar[u] = true;
      std::vector<Index> moves, own;
      for (Index u = 0; u < size; ++u) (scalar[u] ? own : moves).push_back(u);
      const Eigen::MatrixXd across = whole(moves, own);
      const Eigen::MatrixXd shape = whole(moves, moves) - across * whole(own, own).ldlt().solve(across.transpose());
      const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(shape).eigenvalues();
      EXPECT_EQ(counted, (values.array() < 0).count()) << load;
      seen.push_back(counted);
    }
    EXPECT_EQ(seen.front(), 0);
    EXPECT_GT(seen.back(), 0);
  }
}

namespace {

/// The inf-sup constant of pressures on a clamped block: the root of the least eigenvalue of B A^-1 B^T over that of
/// the pressures' norm, but for the constant one; D. Chapelle, K.-J. Bathe, "The inf-sup test", 1993.
double inf_sup(int cells, bool quadratic, bool smoothed) {
  RobotSpec spec = mixed(physical_robot(block_mesh({cells, cells, cells}, {1, 1, 1})), 0.5, quadratic);
  for (const char* side : {"x_high", "y_low", "y_high", "z_low", "z_high"})
    spec.fixed.push_back({{std::string(side), {}}});
  const Model model = compile(spec);
  const physical::System system(model);
  physical::Workspace work(system);
  Team team(1);
  physical::Balance balance;
  const physical::LoadState load_state{model.rest_actuation(), 1};
  const physical::Iterate at{system.model().rest, {}};
  system.evaluate(at, load_state, {}, work, balance, team);
  system.assemble(at, load_state, balance, physical::System::Stiffness::exact, work, team);
  system.gather(at, balance, work, team);
  const Index size = system.freedoms().size();
  Eigen::MatrixXd whole(size, size);
  system.multiply(at, Eigen::MatrixXd::Identity(size, size), work, whole, team);
  std::vector<Index> own = system.freedoms().scalar_unknowns(), moves;
  for (Index u = 0; u < size; ++u)
    if (std::find(own.begin(), own.end(), u) == own.end()) moves.push_back(u);
  const Index count = own.size();
  const double unit = system.pressures()->unit;
  const Eigen::MatrixXd across = whole(moves, own) / unit;
  Eigen::MatrixXd schur = across.transpose() * Eigen::MatrixXd(whole(moves, moves)).ldlt().solve(across);
  if (smoothed) schur -= whole(own, own) / (unit * unit);
  // norm of pressures by place of the unknowns
  std::vector<Index> place(count);
  Points places = Points::Zero(system.model().rest.rows(), 3);
  for (Index p = 0; p < count; ++p) places(system.pressures()->first + p, 0) = static_cast<double>(p);
  Eigen::VectorXd reduced(size);
  system.freedoms().reduce(places, at.positions, reduced);
  for (Index i = 0; i < count; ++i) place[reduced[own[i]]] = i;
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        mass(place[system.pressures()->of[e][i] - system.pressures()->first],
             place[system.pressures()->of[e][j] - system.pressures()->first]) +=
            model.elements.tetrahedron_volumes[e] * (i == j ? 0.1 : 0.05);
  const Eigen::VectorXd values = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(schur, mass).eigenvalues();
  EXPECT_NEAR(values[0], 0, 1e-6) << "of the constant pressure, which nothing answers";
  return std::sqrt(std::max(0.0, values[1]));
}

}  // namespace

/// Finer meshes do not lose pressures; linear elements do that are not smoothed.
TEST(MixedElements, PassTheInfSupTest) {
  for (const bool quadratic : {true, false}) {
    const double coarse = inf_sup(2, quadratic, true), fine = inf_sup(quadratic ? 3 : 5, quadratic, true);
    EXPECT_GT(coarse, 0.1);
    EXPECT_GT(fine, 0.75 * coarse) << quadratic;
  }
  EXPECT_LT(inf_sup(4, false, false), 1e-3);
}

/// Where strains are the same everywhere mixed elements and plain ones are the same.
TEST(MixedElements, AgreeWithPlainOnesInAStretchedBar) {
  for (const bool quadratic : {false, true})
    for (const Law law : laws_with_bulk) {
      RobotSpec spec = mixed(physical_robot(block_mesh({2, 1, 1}, {20, 6, 8})), 0.45, quadratic, law);
      spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                    {{std::string("y_low"), {}}, {false, true, false}},
                    {{std::string("z_low"), {}}, {false, false, true}}};
      spec.loads.tractions = {{"pull", {std::string("x_high"), {}}, false, {400, 0, 0}, 0}};
      const Model model = compile(spec);
      spec.materials[0].mixed = false;
      const Model plain = compile(spec);
      const Statics statics(model), plain_statics(plain);
      const Equilibrium found = solve_converged(statics, {}), other = solve_converged(plain_statics, {});
      EXPECT_LT(distance(found.state.positions, other.state.positions), 1e-8);
      EXPECT_NEAR(found.report.energy, other.report.energy, 1e-9 * std::abs(other.report.energy));
      const ElementDeformation here = statics.measured(found.state), there = plain_statics.measured(other.state);
      EXPECT_NEAR(here.stress.von_mises[0], there.stress.von_mises[0], 1e-9);
      EXPECT_NEAR(here.stress.principal[0][2], 0, 1e-8);
      EXPECT_LT(distance(here.reactions, there.reactions), 1e-7);
    }
}

/// A ball of rubber that keeps its volume: A. E. Green, W. Zerna, Theoretical Elasticity, 1954, 3.10, of W =
/// mu/2 (I1 - 3): p = mu (2/l + 1/(2 l^4)) at the outside, less that inside.
TEST(MixedElements, BallIsBlownAsGreenAndZernaSay) {
  const double mu = 1 / 3.0;
  const auto side = [](double stretch) { return 2 / stretch + 1 / (2 * std::pow(stretch, 4)); };
  const auto blown_by = [&](double inner) {
    return 1e3 * mu * (side(std::cbrt(1 + (std::pow(inner, 3) - 1) * 0.343)) - side(inner));
  };
  for (const bool quadratic : {true, false})
    for (const double stretch : {1.1, 1.35}) {
      const int cuts = quadratic ? 2 : stretch < 1.2 ? 5 : 4, layers = quadratic ? 2 : cuts + 3;
      const RobotSpec spec = blown_ball(cuts, layers, blown_by(stretch), 0.5, quadratic);
      const Model model = compile(spec);
      const Equilibrium found = solve_converged(Statics(model), {}, {});
      const double inner = marker_at(model, found)[0] / 7;
      const double exact = quadratic ? 1e-3 : 1e-2;
      EXPECT_NEAR(inner / stretch, 1, exact);
      EXPECT_NEAR(blown_by(inner) / blown_by(stretch), 1, exact);
    }
}

/// Nothing locks: Newton's method takes as many iterations, and no longer.
TEST(MixedElements, IterationsDoNotGrowTowardsOneHalf) {
  std::vector<int> iterations;
  for (const double nu : {0.4, 0.49, 0.499, 0.4999, 0.5}) {
    const Model model = compile(mixed(curling_finger(), nu));
    const Equilibrium found = solve_converged(Statics(model), values({1.6}), {});
    iterations.push_back(found.report.iterations);
  }
  const auto [least, most] = std::minmax_element(iterations.begin(), iterations.end());
  EXPECT_LE(*most, 1.5 * *least);
}

/// Derivatives by commands and by numbers.
TEST(MixedElements, SensitivitiesAreDerivatives) {
  RobotSpec spec = mixed(bending_finger());
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.3}), tight(1e-10));
  EXPECT_EQ(found.state.positions.rows(), model.rest.rows());
  expect_differences(model, statics, found, 1e-5, {});
  const auto harder = [&](double by) {
    RobotSpec other = spec;
    *other.materials[0].elastic->youngs_modulus += by;
    return compile(other);
  };
  const Model more = harder(1e-4), less = harder(-1e-4);
  const Perturbations numbers(statics, {{more, less, 2e-4}});
  const ParameterSensitivity slopes = numbers.at(found.state);
  ASSERT_TRUE(slopes.regular);
  const double exact = slopes.multipliers(0, 0);
  EXPECT_NEAR(exact, found.state.multipliers[0], 1e-5 * exact);  // pressure goes with E, the shape does not
  EXPECT_LT(slopes.positions[0].cwiseAbs().maxCoeff(), 1e-5);
}

/// Positions alone determine the pressures of an equilibrium: a shape file contains nothing else.
TEST(MixedElements, PressuresAreFoundFromPositions) {
  for (const double nu : {0.45, 0.5}) {
    RobotSpec spec = mixed(bending_finger(), nu);
    spec.materials[0].density = 1100;
    spec.loads.gravity = {0, 0, -9.81};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, values({1.4}), tight(1e-10));
    State without = found.state;
    without.pressures.resize(0);
    const ElementDeformation here = statics.measured(found.state), there = statics.measured(without);
    for (std::size_t e = 0; e < here.stress.von_mises.size(); ++e)
      EXPECT_NEAR(here.stress.principal[e][0], there.stress.principal[e][0], 1e-6);
    const Equilibrium again = statics.solve(values({1.4}), without, tight(1e-9));
    ASSERT_EQ(again.report.status, Status::converged);
    EXPECT_LT(distance(again.state.positions, found.state.positions), 1e-8);
    EXPECT_LT((again.state.pressures - found.state.pressures).cwiseAbs().maxCoeff(), 1e-6);
    without.pressures = Eigen::VectorXd::Zero(3);
    EXPECT_THROW((void)statics.solve(values({1.4}), without), InvalidInput);
  }
}

namespace {

struct Membrane {
  Model model;
  Equilibrium found;
  double rise_mm = 0;

  Membrane(int cells, bool quadratic) : model(compile(cook_membrane(cells, 6.25, 0.5, quadratic))) {
    found = solve_converged(Statics(model), {}, {});
    rise_mm = marker_at(model, found)[1] - 60;
  }
};

/// By how much pressures are those of another mesh of the same corners, root mean square, over what they vary by there.
double apart(const Eigen::VectorXd& pressures, const Eigen::VectorXd& reference) {
  const Eigen::VectorXd varies = reference.array() - reference.mean();
  return (pressures - reference).norm() / varies.norm();
}

}  // namespace

/// Cook's membrane, which rises by 6.9 mm, of an incompressible neo-Hookean sheet: errors shrink with the cells, and
/// linear elements have the pressures of quadratic ones, but not where they alternate from corner to corner.
TEST(MixedElements, CooksMembraneConverges) {
  const Membrane coarse(4, true), fine(8, true), linear(8, false), finer(16, false);
  EXPECT_NEAR(coarse.rise_mm, 6.9, 0.5);
  EXPECT_NEAR(fine.rise_mm, 6.9, 0.2);
  EXPECT_LT(std::abs(finer.rise_mm - 6.9), 0.5 * std::abs(linear.rise_mm - 6.9));
  EXPECT_LT(apart(linear.found.state.pressures, fine.found.state.pressures), 0.5);
}

/// The warning about thin walls of linear elements names them where they help, and counts with them where they are.
TEST(MixedElements, AreToldWherePlainOnesLock) {
  const auto warning = [](double nu, bool is_mixed) {
    RobotSpec spec = physical_robot(block_mesh({8, 1, 1}, {40, 5, 5}));
    spec.materials[0].elastic = elastic(Law::neo_hookean, 1, nu);
    spec.materials[0].mixed = is_mixed;
    const std::vector<std::string> all = compile(spec).warnings;
    return all.empty() ? std::string() : all.front();
  };
  EXPECT_NE(warning(0.49, false).find("'elements: mixed' of the material"), std::string::npos) << warning(0.49, false);
  EXPECT_EQ(warning(0.3, false).find("mixed"), std::string::npos) << "there is little to gain";
  EXPECT_EQ(warning(0.49, true).find("mixed"), std::string::npos);
  EXPECT_NE(warning(0.49, true), "") << "they bend no better";
}

TEST(MixedElements, WhatDoesNotFitIsRefused) {
  expect_refused(
      mixed(physical_robot(block_mesh({2, 1, 1}, {2, 1, 1}))),
      {{"plain", [](RobotSpec& s) { s.materials[0].mixed = false; }, "needs elements: mixed"},
       {"no part of the volume", [](RobotSpec& s) { s.materials[0].elastic = elastic(Law::corotational, 1, 0.5); },
        "keeps the volume"},
       {"law of no such part", [](RobotSpec& s) { s.materials[0].elastic = elastic(Law::st_venant_kirchhoff, 1, 0.4); },
        "elements: mixed, which go with"},
       {"softer in volume", [](RobotSpec& s) { s.materials[0].elastic = elastic(Law::neo_hookean, 1, -0.1); },
        "above 0"},
       {"prisms",
        [](RobotSpec& s) {
          s.mesh = block_mesh({2, 1, 1}, {2, 1, 1}, Split::prisms);
          s.mesh_options.quadratic = false;
        },
        "which prisms are not"}});
  RobotSpec kept = physical_robot(block_mesh({2, 1, 1}, {2, 1, 1}));
  kept.materials[0].elastic->poisson_ratio = 0.5;
  EXPECT_TRUE(compile(kept).elements.materials[0].mixed) << "as nothing else keeps its volume";
  kept.materials[0].elastic->poisson_ratio = 0.4999;
  EXPECT_FALSE(compile(kept).elements.materials[0].mixed);
}

}  // namespace softkin
