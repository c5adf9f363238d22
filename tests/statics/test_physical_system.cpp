#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/system.hpp>

#include "statics/physical_equations.hpp"
#include "statics/physical_samples.hpp"

/// One Newton step: the equations, their derivative, and how a step is taken.

namespace softkin {

namespace {

using namespace testing;

/// Chambers, a cable, weight and a rigid end: every kind of term.
RobotSpec full_robot() {
  RobotSpec spec = chambers_beam(2);
  spec.actuators.push_back(cable("tendon", {{0, 10, 19}, {24, 10, 19}, {48, 10, 19}}));
  spec.materials[0].density = 1200;
  spec.loads.gravity = {0, 0, -1};
  spec.rigid.push_back({{Box{{42, 0, 0}, {48, 20, 20}}, {}}, "end"});
  return spec;
}

/// A shape that is no equilibrium, and its load state.
struct SystemSample : PhysicalEquations {
  explicit SystemSample(const RobotSpec& spec) : PhysicalEquations(compile(spec)) {
    load_state = {Actuation::Constant(system.actuators(), 1.2), 1};
    at.positions = model.rest + noise(model.rest.rows(), 0.1, 1);
    system.freedoms().hold(1, at.positions);
    at.multipliers = Eigen::VectorXd::Constant(system.actuators(), 0.01);
    active.assign(system.actuators(), true);
    for (Index a = 0; a < system.actuators(); ++a) active[a] = system.measures().constrains(a);
  }

  physical::Balance balance_at(const physical::Iterate& iterate) {
    system.evaluate(iterate, load_state, active, work, balance, team);
    return balance;
  }
  int factorise(physical::System::Stiffness kind = physical::System::Stiffness::exact) {
    (void)balance_at(at);
    return system.factorise(at, load_state, active, balance, {kind}, work, team);
  }
};

physical::Iterate moved(const SystemSample& sample, const Eigen::VectorXd& step, const Eigen::VectorXd& change,
                        double scale) {
  physical::Iterate iterate = sample.at;
  sample.system.freedoms().move(step, scale, iterate.positions);
  iterate.multipliers += scale * change;
  return iterate;
}

}  // namespace

/// After a fraction of a Newton step, what is not in balance has fallen by that fraction, to second order.
TEST(System, ANewtonStepSolvesTheLinearisedEquations) {
  for (const bool partly : {false, true}) {
    RobotSpec spec = full_robot();
    if (partly) spec.rigid.clear();
    SystemSample sample(spec);
    if (partly) sample.active[1] = false;  // its multiplier is given
    const physical::Balance before = sample.balance_at(sample.at);
    (void)sample.factorise();
    Eigen::VectorXd step, change;
    sample.work.saddle.step(before, step, change, sample.team);
    EXPECT_GT(before.force.norm(), 1e-2);
    if (partly) {
      EXPECT_EQ(change[1], 0);
      EXPECT_EQ(before.constraint[1], 0);
    }
    double errors[2];
    for (int i = 0; i < 2; ++i) {
      const double scale = i == 0 ? 1e-3 : 5e-4;
      const physical::Balance after = sample.balance_at(moved(sample, step, change, scale));
      EXPECT_LT((after.constraint - (1 - scale) * before.constraint).norm(), 2e-3 * scale * before.constraint.norm());
      if (partly) {  // turns aside, in which T changes too
        errors[i] = (after.force - (1 - scale) * before.force).norm() / before.force.norm();
        EXPECT_LT(errors[i], 0.1 * scale);
      }
    }
    if (partly) {
      EXPECT_NEAR(errors[1] / errors[0], 0.25, 0.05);
    }
  }
}

/// Inertia of the bordered matrix: negative eigenvalues on the changes that keep the measures, by a dense null space.
TEST(System, CountsUnstableDirections) {
  RobotSpec spec = physical_robot(block_mesh({6, 3, 3}, {60, 9, 9}));
  add_volume_region(spec.mesh, "chamber", [](const Vec3& p) {
    return p.x() > 10 && p.x() < 50 && p.y() > 3 && p.y() < 6 && p.z() > 3 && p.z() < 6;
  });
  spec.actuators = {air("chamber"), cable("tendon", {{0, 4, 8}, {30, 4, 8}, {60, 4, 8}})};
  SystemSample sample(spec);
  for (const double compression : {1.0, 0.8, 0.55}) {
    sample.at.positions = sample.model.rest * Eigen::Vector3d(compression, 1, 1).asDiagonal();
    sample.system.freedoms().hold(1, sample.at.positions);
    const int found = sample.factorise();
    const Index n = sample.system.freedoms().size();
    const Eigen::MatrixXd slopes = sample.work.saddle.slopes();
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(n, n);
    sample.work.saddle.solve(inverse, sample.team);
    const Eigen::MatrixXd stiffness = inverse.inverse();
    const Eigen::MatrixXd kept = singular_values(slopes.transpose()).right.rightCols(n - slopes.cols());
    const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(kept.transpose() * stiffness * kept);
    EXPECT_EQ(found, (eigenvalues.array() < 0).count()) << compression;
    if (compression == 1.0) {
      EXPECT_EQ(found, 0);
    }
    if (compression < 0.6) {
      EXPECT_GT(found, 0);
    }
  }
}

/// The change of balance that the predictor assumes is that of the equations.
TEST(System, ResidualChangeIsTheDerivativeInTheLoadState) {
  RobotSpec spec = physical_robot(mixed_robot(true).mesh);
  spec.actuators = mixed_robot(true).actuators;
  for (const char* side : {"y_low", "y_high"}) spec.fixed.push_back({{std::string(side), {}}, {false, true, false}});
  spec.actuators[1] = by_load(spec.actuators[1]);
  spec.materials[0].density = 1000;
  spec.loads.gravity = {0, 0, -2};
  SystemSample sample(spec);
  sample.at.multipliers[1] = sample.system.measures().unit(1) * 30;
  const physical::LoadState from{values({1.1, 30, 0.95}), 0.5}, to{values({1.4, 80, 0.9}), 0.8};
  sample.load_state = from;
  (void)sample.factorise();
  sample.system.assemble(sample.at, from, sample.balance, physical::System::Stiffness::exact, sample.work, sample.team);
  physical::Balance residual_change;
  sample.system.residual_change(sample.at, from, to, sample.active, sample.work, residual_change, sample.team);
  constexpr double reach = 1e-4;
  physical::Balance sides[2];
  for (int side = 0; side < 2; ++side) {
    const double path = side == 0 ? reach : -reach;
    sample.load_state = {from.actuation + path * (to.actuation - from.actuation),
                         from.load_factor + path * (to.load_factor - from.load_factor)};
    physical::Iterate iterate = sample.at;
    iterate.multipliers[1] = sample.system.measures().unit(1) * sample.load_state.actuation[1];
    sides[side] = sample.balance_at(iterate);
  }
  const Eigen::VectorXd force = (sides[0].force - sides[1].force) / (2 * reach);
  const Eigen::VectorXd constraint = (sides[0].constraint - sides[1].constraint) / (2 * reach);
  EXPECT_GT(force.norm(), 1e-3);
  EXPECT_LT((residual_change.force - force).norm(), 1e-5 * force.norm());
  EXPECT_LT((residual_change.constraint - constraint).norm(), 1e-8 * constraint.norm());
}

/// What is held moves from rest to its place, and the body is pulled along.
TEST(System, UpsetFollowsDisplacedSupports) {
  RobotSpec spec = physical_robot(block_mesh({6, 2, 2}, {30, 10, 10}));
  FixedSpec end{{std::string("x_high"), {}}};
  end.displacement = {2, 1, -1};
  spec.fixed.push_back(end);
  SystemSample sample(spec);
  const physical::LoadState from{Actuation(0), 0.3}, to{Actuation(0), 0.8};
  sample.load_state = from;
  sample.system.freedoms().hold(from.load_factor, sample.at.positions);
  (void)sample.factorise();
  sample.system.assemble(sample.at, from, sample.balance, physical::System::Stiffness::exact, sample.work, sample.team);
  physical::Balance residual_change;
  sample.system.residual_change(sample.at, from, to, sample.active, sample.work, residual_change, sample.team);
  constexpr double reach = 1e-5;
  physical::Iterate high = sample.at, low = sample.at;
  sample.system.freedoms().hold(from.load_factor + 0.5 * reach, high.positions);
  sample.system.freedoms().hold(from.load_factor - 0.5 * reach, low.positions);
  const Eigen::VectorXd force = (sample.balance_at(high).force - sample.balance_at(low).force) / (2 * reach);
  EXPECT_LT((residual_change.force - force).norm(), 1e-6 * force.norm());
}

/// A step is taken as it is to first order: the difference falls with its square.
TEST(System, AdvanceIsTheStepToFirstOrder) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = full_robot();
    spec.mesh_options.quadratic = quadratic;
    SystemSample sample(spec);
    std::mt19937 engine(2);
    std::normal_distribution<double> normal(0, 0.1);
    const Eigen::VectorXd step =
        Eigen::VectorXd::NullaryExpr(sample.system.freedoms().size(), [&] { return normal(engine); });
    double differences[2];
    for (int i = 0; i < 2; ++i) {
      const double scale = i == 0 ? 0.1 : 0.05;
      Points advanced = sample.at.positions, straight = sample.at.positions;
      sample.system.advance(step, scale, sample.work, advanced, sample.team);
      sample.system.freedoms().move(step, scale, straight);
      differences[i] = (advanced - straight).norm();
    }
    EXPECT_GT(differences[0], 1e-6);
    EXPECT_NEAR(differences[1] / differences[0], 0.25, 0.03);
  }
}

/// The linear step that bends a bar lengthens its outer end; turned, it keeps its length, through a right angle and
/// more.
TEST(System, AdvanceBendsABarWithoutStretchingIt) {
  const double length = 60;
  RobotSpec spec = physical_robot(block_mesh({24, 2, 2}, {length, 5, 5}));
  SystemSample sample(spec);
  sample.at.positions = sample.model.rest;
  for (const double angle : {0.5, 1.5, 2.5}) {
    // the tangent of an evenly bent bar: section at x turns by angle x / length about y
    Points moves(sample.model.rest.rows(), 3);
    for (Index v = 0; v < moves.rows(); ++v) {
      const double x = sample.model.rest(v, 0), z = sample.model.rest(v, 2) - 2.5;
      moves.row(v) << angle * x / length * z, 0, -angle * x * x / (2 * length);
    }
    Eigen::VectorXd step(sample.system.freedoms().size());
    sample.system.freedoms().reduce(moves, sample.at.positions, step);  // nothing rigid: picks the free ones
    Points bent = sample.at.positions, straight = sample.at.positions;
    sample.system.advance(step, 1, sample.work, bent, sample.team);
    sample.system.freedoms().move(step, 1, straight);
    double bent_error = 0, straight_error = 0;
    for (const Tetrahedron& t : sample.model.elements.tetrahedra)
      for (const int i : {1, 2, 3}) {
        const double rest = (sample.model.rest.row(t[i]) - sample.model.rest.row(t[0])).norm();
        const auto stretch = [&](const Points& p) { return std::abs((p.row(t[i]) - p.row(t[0])).norm() / rest - 1); };
        // fibres off the middle do stretch, by half the height over the radius
        bent_error = std::max(bent_error, stretch(bent) - 2.5 * angle / length);
        straight_error = std::max(straight_error, stretch(straight) - 2.5 * angle / length);
      }
    EXPECT_LT(bent_error, 0.05) << angle;
    EXPECT_GT(straight_error, 5 * bent_error) << angle;
  }
}

}  // namespace softkin
