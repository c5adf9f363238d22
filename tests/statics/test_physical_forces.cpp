#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <numeric>
#include <softkin/model/mesh/quadratic_elements.hpp>

#include "statics/physical_samples.hpp"

/// Reactions of supports and stresses of a robot.

namespace softkin {

namespace {

using namespace testing;

std::vector<Reaction> reactions_of(const Model& model, const Statics& statics, const Equilibrium& found) {
  return reactions(model, found.state.positions, statics.measured(found.state));
}

Vec3 moment_about_origin(const Reaction& reaction) {
  return reaction.moment + reaction.center.cross(reaction.force);
}

/// Of the dead loads, where they act on the shape.
std::pair<Vec3, Vec3> loads_of(const Model& model, const Points& positions) {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (Index v = 0; v < positions.rows(); ++v) {
    const Vec3 load = model.loads.dead.row(v).transpose(), place = positions.row(v).transpose();
    force += load;
    moment += place.cross(load);
  }
  return {force, moment};
}

/// Cauchy stress by the textbook's formulas, each from its law alone [MPa].
Mat3 stress_by_hand(const ElasticLaw& law, const Mat3& f) {
  const double j = f.determinant();
  const Mat3 one = Mat3::Identity(), b = f * f.transpose(), bar = std::pow(j, -2.0 / 3) * b;
  const auto deviator = [&](const Mat3& m) { return Mat3(m - m.trace() / 3 * one); };
  switch (law.law) {
    case Law::st_venant_kirchhoff: {
      const Mat3 e = 0.5 * (f.transpose() * f - one);
      return f * (law.lambda * e.trace() * one + 2 * law.mu * e) * f.transpose() / j;
    }
    case Law::corotational: {  // in the principal frame
      const Eigen::SelfAdjointEigenSolver<Mat3> left(b);
      const Vec3 s = left.eigenvalues().cwiseSqrt();
      const Vec3 nominal = 2 * law.mu * (s.array() - 1) + law.lambda * (s.sum() - 3);
      return left.eigenvectors() * (nominal.cwiseProduct(s) / j).asDiagonal() * left.eigenvectors().transpose();
    }
    case Law::neo_hookean:
      return law.mu / j * b + ((law.lambda + law.mu) * (j - 1) - law.mu) * one;
    case Law::mooney_rivlin:
      return 2 / j * (law.c10 * deviator(bar) + law.c01 * deviator(bar.trace() * bar - bar * bar)) +
             law.bulk * (j - 1) * one;
    case Law::yeoh: {
      const double over = bar.trace() - 3;
      const double slope = law.c10 + 2 * law.c20 * over + 3 * law.c30 * over * over;
      return 2 / j * slope * deviator(bar) + law.bulk * (j - 1) * one;
    }
    case Law::gent:
      return law.mu / j * law.jm / (law.jm - bar.trace() + 3) * deviator(bar) + law.bulk * (j - 1) * one;
    case Law::ogden: {  // in the principal frame
      const Eigen::SelfAdjointEigenSolver<Mat3> left(bar);
      Vec3 pull = Vec3::Zero();
      for (const OgdenTerm& term : law.ogden) pull.array() += term.mu * left.eigenvalues().array().pow(term.alpha / 2);
      return deviator(left.eigenvectors() * pull.asDiagonal() * left.eigenvectors().transpose()) / j +
             law.bulk * (j - 1) * one;
    }
  }
  return Mat3::Zero();
}

Vec3 principal_of(const Mat3& stress) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(stress).eigenvalues().reverse();
}

double von_mises_of(const Vec3& s) {
  return std::sqrt(0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)));
}

ElasticSpec constants(Law law) {
  ElasticSpec spec = elastic(law, 1.3, 0.4);
  if (law == Law::mooney_rivlin) spec.c01 = 0.05;
  if (law == Law::yeoh) spec.c20 = 0.04, spec.c30 = 0.01;
  return spec;
}

}  // namespace

/// A robot hangs in gravity with a payload on it: its support carries both, and their moment.
TEST(Reactions, BearWeightAndMoment) {
  RobotSpec spec = bending_finger();
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0.3, -0.5, -9.81};
  spec.loads.forces.push_back({"payload", {std::string("x_high"), {}}, {0.002, 0, -0.01}});
  spec.rigid.push_back({{std::string("x_high"), {}}, "plate"});
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.3}));
  const auto held = reactions_of(model, statics, found);
  ASSERT_EQ(held.size(), 1u);
  EXPECT_EQ(model.held.supports[0].name, "x_low");
  double volume =
      std::accumulate(model.elements.tetrahedron_volumes.begin(), model.elements.tetrahedron_volumes.end(), 0.0);
  const Vec3 weight = 1100e-9 * volume * spec.loads.gravity + Vec3(0.002, 0, -0.01);
  EXPECT_LT((held[0].force + weight).norm(), 1e-8 * weight.norm());
  const auto [force, moment] = loads_of(model, found.state.positions);
  EXPECT_LT((moment_about_origin(held[0]) + moment).norm(), 1e-7 * moment.norm());
  EXPECT_GT(held[0].moment.norm(), 0.1) << "it is clamped";
}

/// Air and cables push and pull from inside: nothing is left for the support, while its vertices are pulled at.
TEST(Reactions, InnerForcesAddUpToNothing) {
  RobotSpec spec = bending_finger();
  spec.actuators.push_back(cable("tendon", {{2, 6, 14}, {30, 6, 14}, {58, 6, 14}}));
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.6, 0.95}));
  EXPECT_GT(found.state.multipliers[1], 1e-2);
  const Points nodal = statics.measured(found.state).reactions;
  const auto held = reactions_of(model, statics, found);
  const double pulls = nodal.rowwise().norm().sum();
  EXPECT_GT(pulls, 0.1);
  EXPECT_LT(held[0].force.norm(), 1e-8 * pulls);
  EXPECT_LT(held[0].moment.norm(), 1e-7 * pulls);
}

/// Holding a bar's end away takes E A dL / L, and the other end the opposite.
TEST(Reactions, OfADisplacedEndIsThatOfABar) {
  RobotSpec spec = physical_robot(block_mesh({8, 2, 2}, {80, 10, 6}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 2.5, 0.3);
  const double pull = 0.004;
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("x_high"), {}}, {true, false, false}, Vec3(pull, 0, 0)},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}}};
  const Model model = compile(spec);
  const Statics statics(model);
  const auto held = reactions_of(model, statics, solve_converged(statics, {}));
  ASSERT_EQ(held.size(), 4u);
  const double expected = 2.5 * 10 * 6 * pull / 80;
  EXPECT_NEAR(held[1].force.x(), expected, 2e-4 * expected);
  EXPECT_NEAR(held[0].force.x(), -expected, 2e-4 * expected);
  for (const std::size_t side : {2u, 3u}) EXPECT_LT(held[side].force.norm(), 1e-8 * expected);
  EXPECT_LT((held[1].center - Vec3(80 + pull, 5, 3)).norm(), 0.01);
}

/// Two supports, one of them a rigid plate held by a part of its face alone, together carry all loads, and no vertex
/// and axis counts twice where they overlap.
TEST(Reactions, OfSeveralSupportsBearAllLoads) {
  RobotSpec spec = physical_robot(block_mesh({10, 3, 3}, {60, 12, 12}));
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 0, -9.81};
  spec.loads.forces.push_back({"push", {Vec3(30, 6, 12), {}}, {0.01, 0.02, -0.05}});
  spec.rigid.push_back({{Box{{54, -1, -1}, {61, 13, 13}}, {}}, "plate"});
  spec.fixed.push_back({{std::string("x_high"), {}}, {false, true, true}});
  spec.fixed.push_back({{Box{{-1, -1, -1}, {6.1, 13, 13}}, {}}, {true, false, true}});
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, {});
  const auto held = reactions_of(model, statics, found);
  ASSERT_EQ(held.size(), 3u);
  EXPECT_EQ(model.held.supports[1].name, "x_high");
  EXPECT_EQ(model.held.supports[2].name, "fixed_3");
  const auto [force, moment] = loads_of(model, found.state.positions);
  Vec3 forces = Vec3::Zero(), moments = Vec3::Zero();
  for (const Reaction& each : held) {
    forces += each.force;
    moments += moment_about_origin(each);
    EXPECT_GT(each.force.norm(), 1e-3);
  }
  EXPECT_LT((forces + force).norm(), 1e-8 * force.norm());
  EXPECT_LT((moments + moment).norm(), 1e-7 * moment.norm());
  EXPECT_LT(std::abs(held[1].force.x()), 1e-8 * force.norm()) << "the plate slides along x";
}

/// Reactions are of the shape that is given, whatever was solved in between.
TEST(Reactions, AreAFunctionOfTheState) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.5}));
  const Points before = statics.measured(found.state).reactions;
  (void)solve_converged(statics, values({0.9}));
  EXPECT_EQ(before, statics.measured(found.state).reactions);
  const ElementDeformation alone = statics.measured(State{found.state.positions});
  EXPECT_EQ(alone.volume_ratio, statics.measured(found.state).volume_ratio);
  EXPECT_TRUE(alone.stress.von_mises.empty());
  EXPECT_EQ(alone.reactions.rows(), 0);
}

/// Every law, far strained and turned, against the textbook's formula.
TEST(Stress, IsThatOfTheLaw) {
  Mat3 f;
  f << 1.4, 0.3, -0.2, 0.1, 0.8, 0.25, -0.15, 0.2, 1.1;
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const Law law : all_laws)
    for (const int kind : {1, 2, 3}) {  // tetrahedra of order 1 and 2, prisms
      RobotSpec spec = physical_robot(block_mesh({2, 1, 1}, {6, 4, 3}, kind == 3 ? Split::prisms : Split::six));
      spec.mesh_options.quadratic = kind == 2;
      spec.materials[0].elastic = constants(law);
      const Model model = compile(spec);
      const Statics statics(model);
      const Vec3 expected = principal_of(stress_by_hand(model.elements.materials[0].elastic, f));
      for (const Mat3& gradient : {f, Mat3(turn * f)}) {
        const ElementStress stress = statics.measured(State{model.rest * gradient.transpose(), {}, {}}).stress;
        ASSERT_EQ(stress.von_mises.size(), model.elements.tetrahedra.size() + model.elements.prisms.size());
        for (std::size_t e = 0; e < stress.von_mises.size(); ++e) {
          EXPECT_NEAR(stress.von_mises[e], von_mises_of(expected), 1e-9);
          for (int i = 0; i < 3; ++i) EXPECT_NEAR(stress.principal[e][i], expected[i], 1e-9);
        }
      }
    }
}

/// Of order 2 an element shows the point where von Mises' stress is largest, and elements keep the model's order.
TEST(Stress, OfABentElementIsThatOfItsWorstPoint) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 2}, {9, 4, 4}));
  spec.mesh_options.quadratic = true;
  const Model model = compile(spec);
  const Statics statics(model);
  Points bent = model.rest;
  bent.col(2) += 0.03 * bent.col(0).cwiseAbs2();
  bent.col(1) += 0.02 * bent.col(0).cwiseProduct(bent.col(2));
  const ElementStress stress = statics.measured(State{bent, {}, {}}).stress;
  const double far = (5 + 3 * std::sqrt(5.0)) / 20, near = (5 - std::sqrt(5.0)) / 20;  // Hammer and Stroud 1956
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    const auto frame = [&](const Points& points, const Barycentric& l) {
      const Eigen::Matrix<double, 3, 4> along =
          nodes_of(points, model.elements.tetrahedra[e], model.elements.edge_nodes[e]).transpose() * quadratic_slope(l);
      return Mat3(along.rightCols<3>().colwise() - along.col(0));
    };
    double most = 0;
    for (int i = 0; i < 4; ++i) {
      Barycentric l = Barycentric::Constant(near);
      l[i] = far;
      const Mat3 f = frame(bent, l) * frame(model.rest, l).inverse();
      most = std::max(most, von_mises_of(principal_of(stress_by_hand(model.elements.materials[0].elastic, f))));
    }
    EXPECT_NEAR(stress.von_mises[e], most, 1e-9) << e;
  }
}

/// A thick sphere under pressure at small strain: von Mises' stress falls with the cube of the radius (Lame).
TEST(Stress, OfAThickSphereIsThatOfLame) {
  RobotSpec spec = hollow_ball(12, 40, 10);
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0.3);
  spec.actuators = {by_load(air("hollow"))};
  const Model model = compile(spec);
  const Statics statics(model);
  const double pressure = 0.1;  // [kPa]
  const Equilibrium found = solve_converged(statics, values({pressure}));
  const ElementStress stress = statics.measured(found.state).stress;
  double sum = 0, volume = 0;
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : model.elements.tetrahedra[e]) middle += model.rest.row(v).transpose() / 4;
    sum += model.elements.tetrahedron_volumes[e] * stress.von_mises[e] * std::pow(middle.norm(), 3);
    volume += model.elements.tetrahedron_volumes[e];
  }
  const double a = 1000, b = 8000;  // cubes of the radii [mm^3]
  const double expected = 1.5 * 1e-3 * pressure * a * b / (b - a);
  EXPECT_NEAR(sum / volume, expected, 0.1 * expected);
  const auto extremes = stress_extremes(model, found.state.positions, statics.measured(found.state));
  ASSERT_TRUE(extremes.has_value());
  EXPECT_LT(extremes->von_mises.at.norm(), 14) << "at the inner wall";
  EXPECT_EQ(extremes->von_mises.value, *std::max_element(stress.von_mises.begin(), stress.von_mises.end()));
  EXPECT_NEAR(extremes->von_mises.value, expected / a, 0.35 * expected / a);
  EXPECT_GT(extremes->greatest.value, 0);
  EXPECT_NEAR(extremes->least.value, -1e-3 * pressure, 0.4e-3 * pressure) << "the pressure on the inner wall";
}

}  // namespace softkin
