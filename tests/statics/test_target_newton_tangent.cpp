#include <Eigen/LU>
#include <softkin/linear/krylov.hpp>
#include <softkin/statics/target_shape/newton_tangent.hpp>

#include "statics/robots.hpp"

namespace softkin {

namespace {

using testing::mixed_robot;
using testing::noise;

Actuation away_from_rest() {
  return (Actuation(3) << 1.2, 1.5, 0.85).finished();
}

/// A robot at a shape that is no equilibrium, after a local step.
struct Case {
  explicit Case(const RobotSpec& spec) : model(compile(spec)), system(model), local(system.make_scratch()) {
    positions = model.rest + noise(model.rest.rows(), 0.3, 4);
  }

  Points residual_at(const Points& shape) {
    target_shape::System::Scratch scratch = system.make_scratch();
    system.local_step(away_from_rest(), shape, scratch, alone);
    return scratch.residual;
  }

  Model model;
  target_shape::System system;
  target_shape::System::Scratch local;
  Points positions;
  Team alone{1};
};

RobotSpec with_rigid_regions(RobotSpec spec) {
  spec.rigid.push_back({{Box{{50, 0, 0}, {60, 20, 24}}, {}}, "end"});
  spec.rigid.push_back({{Box{{20, 0, 8}, {30, 20, 8}}, {}}, "patch"});
  return spec;
}

}  // namespace

TEST(TargetTangent, ResidualChangesAsTheDifferenceQuotientSays) {
  for (const bool minimum_norm : {false, true})
    for (const double shape_ratio : {1.0, 0.5}) {
      Case c(mixed_robot(minimum_norm, shape_ratio));
      EXPECT_EQ(c.system.is_gradient(), !minimum_norm && shape_ratio == 1);
      const Points along = noise(c.model.rest.rows(), 1, 9);
      c.system.local_step(away_from_rest(), c.positions, c.local, c.alone);
      target_shape::System::Scratch out = c.system.make_scratch();
      c.system.residual_change(c.local, along, out, c.alone);
      const double h = 1e-5;
      const Points quotient =
          (c.residual_at(c.positions + h * along) - c.residual_at(c.positions - h * along)) / (2 * h);
      EXPECT_LT((out.residual - quotient).norm(), 1e-6 * quotient.norm());
    }
}

TEST(TargetTangent, MatrixIsTheDerivativeWhereThatIsSymmetric) {
  Case c(mixed_robot(false));
  const target_shape::NewtonMatrix matrix(c.model, c.system);
  const Points along = noise(c.model.rest.rows(), 1, 9);
  c.system.local_step(away_from_rest(), c.positions, c.local, c.alone);
  target_shape::System::Scratch out = c.system.make_scratch();
  c.system.residual_change(c.local, along, out, c.alone);
  LargeVector<double> slots, blocks;
  matrix.assemble(c.local, false, slots, c.alone);
  matrix.pattern().gather(slots, blocks, c.alone);
  Points product;
  matrix.pattern().multiply(blocks, along, product, c.alone);
  EXPECT_LT((product + out.residual).norm(), 1e-11 * product.norm());
}

/// What couples all elements of an actuator is of rank one: without it, moving a vertex is felt next to it only.
TEST(TargetTangent, RedistributionIsTheCouplingOfAllElements) {
  Case c(testing::finger_robot(true));
  c.system.local_step(Actuation::Constant(1, 1.5), c.positions, c.local, c.alone);
  target_shape::System::Scratch out = c.system.make_scratch();
  std::vector<target_shape::System::Redistribution> parts;
  c.system.redistributions(c.local, out, parts, c.alone);
  ASSERT_EQ(parts.size(), 1u);
  Index corner = -1;  // of the chamber, x from 5 to 45
  for (Index v = 0; v < c.model.rest.rows(); ++v)
    if ((c.model.rest.row(v) - Eigen::RowVector3d(10, 4, 4)).norm() < 1e-9) corner = v;
  ASSERT_GE(corner, 0);
  Points along = Points::Zero(c.model.rest.rows(), 3);
  along.row(corner) << 1, 0.5, -0.2;
  c.system.residual_change(c.local, along, out, c.alone);
  const Points nearby = out.residual + parts[0].source * parts[0].target.cwiseProduct(along).sum();
  double far = 0, far_coupled = 0;
  for (Index v = 0; v < c.model.rest.rows(); ++v)
    if (c.model.rest(v, 0) > 16) {
      far = std::max(far, nearby.row(v).norm());
      far_coupled = std::max(far_coupled, out.residual.row(v).norm());
    }
  EXPECT_GT(far_coupled, 1e-3);
  EXPECT_LT(far, 1e-10 * out.residual.norm());
}

/// K step = right, with K from differences of the reduced residual along the step's own motion.
TEST(TargetTangent, SolvesTheExactDerivative) {
  for (const bool minimum_norm : {false, true})
    for (const double shape_ratio : {1.0, 0.5})
      for (const bool rigid : {false, true}) {
        RobotSpec spec = mixed_robot(minimum_norm, shape_ratio);
        Case c(rigid ? with_rigid_regions(spec) : spec);
        const target_shape::Unknowns unknowns(c.model, c.system);
        target_shape::Tangent tangent(unknowns);
        c.positions = c.model.rest + noise(c.model.rest.rows(), 0.1, 4);
        unknowns.freedoms.hold(1, c.positions);
        c.system.local_step(away_from_rest(), c.positions, c.local, c.alone);
        SolveReport report;
        ASSERT_TRUE(tangent.factorise(c.local, c.positions, false, c.alone, report));
        if (tangent.symmetric() && report.projections > 0) continue;  // not the exact one
        const Eigen::VectorXd right = Eigen::VectorXd::Random(unknowns.freedoms.size());
        Eigen::VectorXd preconditioned = right, step;
        tangent.precondition(preconditioned, c.alone);
        ASSERT_TRUE(tangent.solve(c.local, c.positions, preconditioned, 1e-10, c.alone, step));
        const double h = 1e-5 / step.cwiseAbs().maxCoeff();
        const auto reduced = [&](double scale) {
          Points moved = c.positions;
          unknowns.freedoms.move(step, scale, moved);
          Eigen::VectorXd out;
          tangent.reduce(c.residual_at(moved), moved, out);
          return out;
        };
        const Eigen::VectorXd quotient = (reduced(-h) - reduced(h)) / (2 * h);
        EXPECT_LT((quotient - right).norm(), 1e-4 * right.norm()) << minimum_norm << shape_ratio << rigid;
      }
}

/// Indefinite matrices are projected, and what then still is none is shifted.
TEST(TargetTangent, FactorisesAnyShape) {
  Case c(mixed_robot(false));
  const target_shape::Unknowns unknowns(c.model, c.system);
  target_shape::Tangent tangent(unknowns);
  SolveReport report;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    c.positions = c.model.rest + noise(c.model.rest.rows(), 5, seed);
    c.system.local_step(away_from_rest(), c.positions, c.local, c.alone);
    ASSERT_TRUE(tangent.factorise(c.local, c.positions, false, c.alone, report));
    Eigen::VectorXd right, step;
    tangent.reduce(c.local.residual, c.positions, right);
    step = right;
    tangent.precondition(step, c.alone);
    EXPECT_GT(step.dot(right), 0);
  }
  EXPECT_GT(report.projections, 0);
  EXPECT_GE(report.factorisations, 5 + report.projections);
}

TEST(Gmres, SolvesAsADenseFactorDoes) {
  std::srand(3);
  for (const int size : {1, 5, 40})
    for (const int columns : {3, 10, 60}) {
      const Eigen::MatrixXd matrix =
          Eigen::MatrixXd::Random(size, size) + 2 * std::sqrt(size) * Eigen::MatrixXd::Identity(size, size);
      const Eigen::VectorXd right = Eigen::VectorXd::Random(size);
      std::vector<Eigen::VectorXd> basis(columns + 1);
      Eigen::VectorXd x;
      const auto product = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) { out = matrix * in; };
      EXPECT_TRUE(linear::gmres(product, right, 1e-12, 200, basis, x));
      EXPECT_LT((x - matrix.partialPivLu().solve(right)).norm(), 1e-10);
    }
}

TEST(Gmres, SaysSoWhereItFails) {
  const Eigen::MatrixXd shift = (Eigen::MatrixXd(3, 3) << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
  const Eigen::VectorXd right = Eigen::Vector3d(1, 0, 0);
  std::vector<Eigen::VectorXd> basis(3);
  Eigen::VectorXd x;
  const auto permute = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) { out = shift * in; };
  EXPECT_FALSE(linear::gmres(permute, right, 1e-6, 5, basis, x));  // two columns see nothing of a cycle of three
  const auto nothing = [](const Eigen::VectorXd& in, Eigen::VectorXd& out) { out = Eigen::VectorXd::Zero(in.size()); };
  EXPECT_FALSE(linear::gmres(nothing, right, 1e-6, 5, basis, x));
  EXPECT_TRUE(x.allFinite());
  EXPECT_TRUE(linear::gmres(permute, Eigen::VectorXd(Eigen::VectorXd::Zero(3)), 1e-6, 5, basis, x));
  EXPECT_EQ(x.norm(), 0);
}

}  // namespace softkin
