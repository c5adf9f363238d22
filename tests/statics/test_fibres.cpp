#include <Eigen/Dense>
#include <numbers>
#include <softkin/statics/deformation.hpp>

#include "model/round_mesh.hpp"
#include "statics/sensitivity_samples.hpp"

/// Threads that elements carry along: the forces that they add, and tubes that are wound with them.

namespace softkin {

namespace {

using namespace testing;

FibreSpec thread(const std::string& name, std::vector<Vec3> path, double stiffness_N, bool tension_only = false) {
  FibreSpec fibre;
  fibre.name = name;
  fibre.path = std::move(path);
  fibre.stiffness_N = stiffness_N;
  fibre.tension_only = tension_only;
  return fibre;
}

/// A block of nu 0 between plates that do not hold its ends across; pulled to a stretch.
RobotSpec pulled_block(const Mesh& mesh, bool quadratic, double stretch) {
  RobotSpec spec = physical_robot(mesh);
  spec.materials[0].elastic = elastic(Law::corotational, 1, 0);
  spec.mesh_options.quadratic = quadratic;
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}},
                {{std::string("x_high"), {}}, {true, false, false}, {20 * (stretch - 1), 0, 0}}};
  return spec;
}

struct Pulled {
  double force_N;  // on the end that is pulled
  FibreForces fibre;
  Equilibrium found;
};

Pulled pulled(const RobotSpec& spec) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  const ElementDeformation measured = statics.measured(found.state);
  return {reactions(model, found.state.positions, measured).back().force.x(),
          measured.fibres.empty() ? FibreForces{} : measured.fibres.front(), found};
}

/// A thick tube along x of which both ends keep their planes, wound with two families of threads.
struct WoundTube {
  static constexpr double outer = 8, length = 6, nu = 0.45;
  static constexpr int threads = 60;  // of a family
  double degrees;                     // of the threads to the axis
  double inner = 6, pressure_kPa = 40, axial = 1.03, modulus = 0.5, stiffness_N = 16;

  [[nodiscard]] double angle() const { return degrees * std::numbers::pi / 180; }
};

struct TubeShape {
  double inner = 0, outer = 0;  // radii [mm]
  double force_N = 0;           // that pulls its end
};

RobotSpec wound(const WoundTube& tube) {
  constexpr int corners = 24;
  RobotSpec spec = physical_robot(rod_mesh(corners, 2, 2, tube.outer, tube.length, tube.inner / tube.outer));
  spec.mesh_options.quadratic = true;
  const Vec3 end(tube.length, 0, 0);
  spec.mesh_options.curve =
      CurveSpec{{{Cylinder{Vec3::Zero(), end, tube.inner}, {}}, {Cylinder{Vec3::Zero(), end, tube.outer}, {}}}};
  spec.materials[0].elastic = elastic(Law::neo_hookean, tube.modulus, tube.nu);
  const auto chosen = [&](const auto& is) {
    VertexList list;
    for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
      if (const Vec3 p = vertex_at(spec.mesh.vertices, v); std::hypot(p.y(), p.z()) > tube.inner / 2 && is(p))
        list.vertices.push_back(v);
    return RegionRef{Selector(list), {}};
  };
  const auto bottom = [](const Vec3& p) { return std::abs(p.x()) < 1e-9; };
  spec.fixed = {{chosen(bottom), {true, false, false}},
                {chosen([&](const Vec3& p) { return std::abs(p.x() - tube.length) < 1e-9; }),
                 {true, false, false},
                 {(tube.axial - 1) * tube.length, 0, 0}},
                {chosen([&](const Vec3& p) { return bottom(p) && std::abs(p.y()) < 1e-9; }), {false, true, false}},
                {chosen([&](const Vec3& p) { return bottom(p) && std::abs(p.z()) < 1e-9; }), {false, false, true}}};
  spec.loads.tractions = {{"air",
                           chosen([&](const Vec3& p) { return std::hypot(p.y(), p.z()) < tube.inner + 1e-9; }),
                           true,
                           {0, 0, 0},
                           tube.pressure_kPa}};
  for (int t = 0; t < 2 * tube.threads; ++t) {
    const double begin = 2 * std::numbers::pi * (t / 2) / tube.threads;
    FibreSpec fibre = thread("thread" + std::to_string(t), {}, tube.stiffness_N);
    fibre.path = Helix{.start = Vec3::Zero(),
                       .axis = Vec3::UnitX(),
                       .first = Vec3(0, std::cos(begin), std::sin(begin)),
                       .radius = tube.outer,
                       .pitch = 2 * std::numbers::pi * tube.outer / std::tan(tube.angle()),
                       .turns = tube.length * std::tan(tube.angle()) / (2 * std::numbers::pi * tube.outer),
                       .left_handed = t % 2 == 1};
    spec.fibres.push_back(fibre);
  }
  return spec;
}

/// The same with threads that are spread over the outside, as a problem of the radius alone: linear pieces of r(R),
/// their energy per length of the tube in a state of principal stretches r', r / R and the axial one.
class SpreadTube {
 public:
  explicit SpreadTube(const WoundTube& tube) : tube_(tube) {
    mu_ = tube.modulus / (2 * (1 + tube.nu));
    both_ = tube.modulus * tube.nu / ((1 + tube.nu) * (1 - 2 * tube.nu)) + mu_;
    const Eigen::VectorXd rest = Eigen::VectorXd::LinSpaced(pieces + 1, tube.inner, tube.outer);
    Eigen::VectorXd r = rest;
    for (int i = 0; i < 30; ++i) {
      const auto [gradient, hessian] = slopes(rest, r);
      r -= hessian.ldlt().solve(gradient);
    }
    shape = {r[0], r[pieces], axial_force(rest, r)};
  }

  TubeShape shape;

 private:
  static constexpr int pieces = 300;

  struct Stress {
    Vec3 stress;
    Mat3 slope;
  };
  [[nodiscard]] Stress stress(const Vec3& s) const {
    const double j = s.prod(), p = -mu_ + both_ * (j - 1);
    Stress found;
    for (int a = 0; a < 3; ++a) {
      found.stress[a] = mu_ * s[a] + p * j / s[a];
      for (int b = 0; b < 3; ++b)
        found.slope(a, b) = both_ * j * j / (s[a] * s[b]) + (a == b ? mu_ : p * j / (s[a] * s[b]));
    }
    return found;
  }
  [[nodiscard]] Vec3 stretches(const Eigen::VectorXd& rest, const Eigen::VectorXd& r, int k) const {
    return {(r[k + 1] - r[k]) / (rest[k + 1] - rest[k]), (r[k + 1] + r[k]) / (rest[k + 1] + rest[k]), tube_.axial};
  }
  /// Area of a ring at rest.
  static double area(const Eigen::VectorXd& rest, int k) {
    return std::numbers::pi * (rest[k + 1] * rest[k + 1] - rest[k] * rest[k]);
  }
  /// Of both families per length of the tube: tension times (cos^2, sin^2) over the stretch and the cosine.
  struct Threads {
    double stretch, tension_N;
  };
  [[nodiscard]] Threads threads(double r) const {
    const double c = std::cos(tube_.angle()), s = std::sin(tube_.angle());
    const double stretch = std::hypot(tube_.axial * c, r / tube_.outer * s);
    return {stretch, tube_.stiffness_N * (stretch - 1)};
  }
  [[nodiscard]] std::pair<Eigen::VectorXd, Eigen::MatrixXd> slopes(const Eigen::VectorXd& rest,
                                                                   const Eigen::VectorXd& r) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(pieces + 1);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(pieces + 1, pieces + 1);
    for (int k = 0; k < pieces; ++k) {
      const Stress at = stress(stretches(rest, r, k));
      Eigen::Matrix<double, 3, 2> by = Eigen::Matrix<double, 3, 2>::Zero();
      by.row(0) << -1 / (rest[k + 1] - rest[k]), 1 / (rest[k + 1] - rest[k]);
      by.row(1).setConstant(1 / (rest[k + 1] + rest[k]));
      gradient.segment<2>(k) += area(rest, k) * by.transpose() * at.stress;
      hessian.block<2, 2>(k, k) += area(rest, k) * by.transpose() * at.slope * by;
    }
    const double push = 2 * std::numbers::pi * 1e-3 * tube_.pressure_kPa * tube_.axial;
    gradient[0] -= push * r[0];
    hessian(0, 0) -= push;
    const auto pull = [&](double outside) {
      const Threads at = threads(outside);
      const double s = std::sin(tube_.angle()) / tube_.outer;
      return 2 * tube_.threads / std::cos(tube_.angle()) * at.tension_N / at.stretch * outside * s * s;
    };
    gradient[pieces] += pull(r[pieces]);
    hessian(pieces, pieces) += (pull(r[pieces] + 1e-6) - pull(r[pieces] - 1e-6)) / 2e-6;
    return {gradient, hessian};
  }
  [[nodiscard]] double axial_force(const Eigen::VectorXd& rest, const Eigen::VectorXd& r) const {
    double force = 0;
    for (int k = 0; k < pieces; ++k) force += area(rest, k) * stress(stretches(rest, r, k)).stress[2];
    const Threads at = threads(r[pieces]);
    return force + 2 * tube_.threads * std::cos(tube_.angle()) * at.tension_N / at.stretch * tube_.axial;
  }

  WoundTube tube_;
  double mu_, both_;  // mu, lambda + mu [MPa]
};

TubeShape solved(const RobotSpec& spec, const WoundTube& tube) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  const auto radius = [&](double at_rest) {
    double sum = 0, count = 0;
    for (Index v = 0; v < found.state.positions.rows(); ++v) {
      if (std::abs(model.rest.row(v).tail<2>().norm() - at_rest) > 1e-6) continue;
      sum += found.state.positions.row(v).tail<2>().norm();
      ++count;
    }
    return sum / count;
  };
  return {radius(tube.inner), radius(tube.outer),
          reactions(model, found.state.positions, statics.measured(found.state))[1].force.x()};
}

}  // namespace

/// With nu 0 a fibre along the pull is strained as the block is, wherever it runs: it adds its tension, no more.
TEST(Fibres, AddTheirTensionAlongThePull) {
  const Vec3 size(20, 10, 10);
  for (const auto& [mesh, quadratic] :
       {std::pair{block_mesh({3, 2, 2}, size), false}, std::pair{block_mesh({3, 2, 2}, size), true},
        std::pair{block_mesh({3, 2, 2}, size, Split::prisms), false}})
    for (const double stretch : {1.2, 0.85})
      for (const bool tension_only : {false, true}) {
        RobotSpec spec = pulled_block(mesh, quadratic, stretch);
        const Pulled without = pulled(spec);
        EXPECT_NEAR(without.force_N, 100 * (stretch - 1), 1e-7);
        spec.fibres = {thread("inside", {{0, 3.1, 4.3}, {7, 3.1, 4.3}, {20, 3.1, 4.3}}, 30, tension_only),
                       thread("edge", {{0, 0, 0}, {20, 0, 0}}, 50, tension_only)};
        const Pulled with = pulled(spec);
        const double tension = tension_only ? std::max(0.0, stretch - 1) : stretch - 1;
        EXPECT_NEAR(with.force_N, without.force_N + 80 * tension, 1e-7) << quadratic << tension_only << stretch;
        EXPECT_LT(distance(with.found.state.positions, without.found.state.positions), 1e-6);
        EXPECT_NEAR(with.fibre.mean_N, 30 * tension, 1e-7);
        EXPECT_NEAR(with.fibre.largest_N, 30 * tension, 1e-7);
        EXPECT_NEAR(with.fibre.min_N, 30 * tension, 1e-7);
        EXPECT_NEAR(with.fibre.stretch, stretch, 1e-9);
        EXPECT_EQ(with.fibre.slack, tension_only && stretch < 1 ? 1 : 0);
        EXPECT_NEAR(with.fibre.where.y(), 3.1, 1e-6);
      }
}

/// A fibre that does not stretch holds the ends of a block together.
TEST(Fibres, ThoseThatDoNotStretchHold) {
  RobotSpec spec = pulled_block(block_mesh({8, 2, 2}, {20, 10, 10}), true, 1);
  spec.fixed.pop_back();
  spec.loads.forces = {{"pull", {std::string("x_high"), {}}, {2, 0, 0}}};
  spec.markers.push_back({"end", {std::string("x_high"), {}}});
  const Model free = compile(spec);
  EXPECT_GT(marker_at(free, solve_converged(Statics(free), free.rest_actuation())).x(), 20.35);
  for (const double z : {0.0, 10.0})
    for (const double y : {0.0, 10.0}) {
      FibreSpec fibre = thread("f" + std::to_string(spec.fibres.size()), {{0, y, z}, {20, y, z}}, 1);
      fibre.stiffness_N.reset();
      spec.fibres.push_back(fibre);
    }
  const Model held = compile(spec);
  const Statics statics(held);
  const Equilibrium found = solve_converged(statics, held.rest_actuation());
  for (const FibreForces& fibre : statics.measured(found.state).fibres) {
    EXPECT_NEAR(fibre.stretch, 1, 1e-5);
    EXPECT_GT(fibre.mean_N, 0.1);
  }
}

/// Turned with all that it has a robot keeps its shape and its tensions.
TEST(Fibres, TurnWithTheRobot) {
  RobotSpec spec = physical_robot(block_mesh({8, 2, 2}, {40, 8, 8}));
  spec.mesh_options.quadratic = true;
  spec.fixed[0].rotation = RotationSpec{{0, 1, 0}, 0, Vec3(0, 0, 0)};
  FibreSpec fibre = thread("wound", {}, 20, true);
  fibre.path = Helix{{2, 4, 4}, {1, 0, 0}, {0, 1, 0}, 3, 9, 4};
  spec.fibres = {fibre};
  spec.loads.tractions = {{"wind", {std::string("x_high"), {}}, true, {1.5, 0.4, -1}, 0}};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium straight = solve_converged(statics, values({0})), turned = solve_converged(statics, values({130}));
  EXPECT_GT(distance(straight.state.positions, model.rest), 3);
  const Mat3 rotation = Eigen::AngleAxisd(130 * std::numbers::pi / 180, Vec3(0, 1, 0)).toRotationMatrix();
  EXPECT_LT(distance(straight.state.positions * rotation.transpose(), turned.state.positions), 1e-6);
  const FibreForces a = statics.measured(straight.state).fibres[0], b = statics.measured(turned.state).fibres[0];
  EXPECT_GT(a.largest_N, 0.01);
  EXPECT_NEAR(a.largest_N, b.largest_N, 1e-6 * a.largest_N);
  EXPECT_NEAR(a.slack, b.slack, 1e-9);
}

/// Radius and force of tubes under pressure, wound at five angles, against threads spread evenly.
TEST(Fibres, WoundTubesSwellAndPullAsTheyShould) {
  for (const double degrees : {25.0, 40.0, std::atan(std::sqrt(2.0)) * 180 / std::numbers::pi, 65.0, 80.0}) {
    const WoundTube tube{degrees};
    const TubeShape expected = SpreadTube(tube).shape, found = solved(wound(tube), tube);
    const double thrust = std::numbers::pi * 1e-3 * tube.pressure_kPa * tube.inner * tube.inner;
    EXPECT_NEAR(found.outer, expected.outer, 0.002 * expected.outer) << degrees;
    EXPECT_NEAR(found.force_N, expected.force_N, 0.01 * (std::abs(expected.force_N) + thrust)) << degrees;
  }
}

/// A McKibben muscle: threads that hardly stretch around a soft tube with closed ends, which pulls as it contracts. The
/// ideal law (Chou and Hannaford, IEEE Trans. Robot. Autom. 12(1), 1996) is of a wall without thickness or stiffness,
/// whose radius follows from threads of one length; the wall takes some of it, by what it is strained.
TEST(Fibres, AMuscleOfMcKibben) {
  for (const double axial : {1.0, 0.94, 0.88}) {
    const WoundTube tube{25, 7, 60, axial, 0.06, 1200};
    const double pressure = std::numbers::pi * 1e-3 * tube.pressure_kPa;
    const auto pull = [&](const TubeShape& at) { return at.force_N - pressure * at.inner * at.inner; };
    const TubeShape spread = SpreadTube(tube).shape, found = solved(wound(tube), tube);
    const double cosine = axial * std::cos(tube.angle()), sine = std::sqrt(1 - cosine * cosine);
    const double r = tube.outer * sine / std::sin(tube.angle());
    EXPECT_NEAR(found.outer, r, 0.01 * r) << axial;
    EXPECT_NEAR(pull(found), pull(spread), 0.01 * std::abs(pull(spread))) << axial;
    // -p dV / dL of the volume within the threads
    const double ideal = pressure * r * r * (2 * cosine * cosine / (sine * sine) - 1);
    EXPECT_NEAR(pull(spread), ideal, 0.15 * ideal) << axial;
  }
}

/// At rest threads carry nothing, whatever rounding makes of the pieces that corners of elements cut.
TEST(Fibres, CarryNothingAtRest) {
  RobotSpec spec = wound({54.7});
  spec.loads.tractions.clear();
  spec.fixed[1].displacement = Vec3::Zero();
  for (FibreSpec& fibre : spec.fibres) fibre.stiffness_N = 1e4;
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  EXPECT_LT(distance(found.state.positions, model.rest), 1e-12);
  for (const FibreForces& fibre : statics.measured(found.state).fibres) EXPECT_LT(std::abs(fibre.largest_N), 1e-9);
}

/// Derivatives of equilibria by the actuator and by the fibre's stiffness.
TEST(Fibres, DerivativesOfShapes) {
  RobotSpec spec = bending_finger();
  FibreSpec wound = thread("wound", {}, 20);
  wound.path = Helix{{6, 6, 8}, {1, 0, 0}, {0, 1, 0}, 5, 8, 6};
  spec.fibres = {wound, thread("floor", {{0, 6, 1}, {60, 6, 1}}, 100, true)};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1.4}));
  EXPECT_GT(statics.measured(found.state).fibres[1].largest_N, 0.05);
  const Sensitivity exact = statics.sensitivity(found.state);
  const Difference expected = central(statics, found.state, 0, 5e-4);
  EXPECT_LT(off_by(exact.positions[0], expected.positions), 1e-6);
}

}  // namespace softkin
