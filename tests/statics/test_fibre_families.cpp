#include <Eigen/Dense>
#include <numbers>
#include <softkin/model/families.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/mixed_samples.hpp"
#include "statics/physical_equations.hpp"
#include "statics/sensitivity_samples.hpp"

/// Families of fibres in a material, against closed forms of their law (Gasser, Ogden, Holzapfel 2006).

namespace softkin {

namespace {

using namespace testing;

std::shared_ptr<const FamiliesSpec> families(std::vector<FamilySpec> all) {
  return std::make_shared<const FamiliesSpec>(FamiliesSpec{std::move(all)});
}

/// Two families at an angle to x on either side [degrees], in planes across z.
std::shared_ptr<const FamiliesSpec> crossed(double degrees, double k1, double k2, double dispersion) {
  const double angle = degrees * std::numbers::pi / 180;
  const Vec3 one(std::cos(angle), std::sin(angle), 0), two(std::cos(angle), -std::sin(angle), 0);
  return families({{k1, k2, dispersion, {.uniform = one}}, {k1, k2, dispersion, {.uniform = two}}});
}

/// Energy per volume of families at a deformation, as it is written [MPa].
double energy_of(const FamiliesSpec& all, const Mat3& f) {
  const Mat3 c = std::pow(f.determinant(), -2.0 / 3) * f.transpose() * f;
  double sum = 0;
  for (const FamilySpec& family : all.families) {
    const Vec3 d = family.direction.uniform.normalized();
    const double strain = family.dispersion * (c.trace() - 3) + (1 - 3 * family.dispersion) * (d.dot(c * d) - 1);
    if (strain <= 0) continue;
    sum += family.k2 > 0 ? family.k1_MPa / (2 * family.k2) * (std::exp(family.k2 * strain * strain) - 1)
                         : family.k1_MPa / 2 * strain * strain;
  }
  return sum;
}

/// A block of what keeps its volume, with fibres, pulled along x, and along y unless that is free.
struct Stretched {
  double modulus = 0.3, along = 1.2, across = 0;  // across 0: free
  std::shared_ptr<const FamiliesSpec> fibres;
  static constexpr double length = 12, width = 8, height = 6;
};

RobotSpec robot_of(const Stretched& s, bool quadratic) {
  RobotSpec spec = physical_robot(block_mesh({2, 2, 2}, {s.length, s.width, s.height}));
  spec.materials[0].elastic->youngs_modulus = s.modulus;
  spec = mixed(spec, 0.5, quadratic);
  spec.materials[0].families = s.fibres;
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}},
                {{std::string("x_high"), {}}, {true, false, false}, {s.length * (s.along - 1), 0, 0}}};
  if (s.across > 0)
    spec.fixed.push_back({{std::string("y_high"), {}}, {false, true, false}, {0, s.width * (s.across - 1), 0}});
  return spec;
}

/// The same by its energy as a function of two stretches.
struct ClosedForm {
  const Stretched& s;
  [[nodiscard]] double energy(double along, double across) const {
    const Mat3 f = Vec3(along, across, 1 / (along * across)).asDiagonal();
    return s.modulus / 6 * (f.squaredNorm() - 3) + energy_of(*s.fibres, f);
  }
  [[nodiscard]] double slope(double along, double across, bool by_across) const {
    const double reach = 1e-5, a = by_across ? 0 : reach, b = by_across ? reach : 0;
    return (energy(along + a, across + b) - energy(along - a, across - b)) / (2 * reach);
  }
  /// Stretch across that is without force.
  [[nodiscard]] double across() const {
    if (s.across > 0) return s.across;
    double low = 0.3, high = 2;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (slope(s.along, middle, true) > 0 ? high : low) = middle;
    }
    return low;
  }
};

void expect_closed_form(const Stretched& s) {
  const ClosedForm expected{s};
  const double across = expected.across(), area = Stretched::width * Stretched::height;
  const double pull = expected.slope(s.along, across, false) * area;
  for (const bool quadratic : {false, true}) {
    const Model model = compile(robot_of(s, quadratic));
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, model.rest_actuation(), tight(1e-10));
    const ElementDeformation measured = statics.measured(found.state);
    const auto borne = reactions(model, found.state.positions, measured);
    EXPECT_NEAR(borne[3].force.x(), pull, 1e-6 * std::abs(pull)) << s.along << quadratic;
    const double width = found.state.positions.col(1).maxCoeff() - found.state.positions.col(1).minCoeff();
    EXPECT_NEAR(width / Stretched::width, across, 1e-6);
    if (s.across > 0) {
      const double sideways = expected.slope(s.along, across, true) * Stretched::length * Stretched::height;
      EXPECT_NEAR(borne[4].force.y(), sideways, 1e-6 * std::abs(sideways));
    } else {
      for (const double each : measured.stress.von_mises)
        EXPECT_NEAR(each, std::abs(pull / area * s.along), 1e-5 * std::abs(pull / area));
    }
  }
}

const FamiliesSpec oblique{{{0.7, 2.5, 0.1, {.uniform = {1, 1, 0.2}}}, {0.3, 0, 0, {.uniform = {0, 1, -1}}}}};

}  // namespace

TEST(FibreFamilies, OneWayPullsAsTheClosedForm) {
  for (const double along : {1.08, 1.25})
    for (const double degrees : {0.0, 35.0, 49.0})
      for (const double dispersion : {0.0, 0.12}) {
        Stretched s;
        s.along = along;
        s.fibres = crossed(degrees, 0.2, 1.5, dispersion);
        expect_closed_form(s);
      }
  Stretched stiffening;
  stiffening.along = 1.3;
  stiffening.fibres = crossed(20, 0.05, 12, 0.05);
  expect_closed_form(stiffening);
}

TEST(FibreFamilies, TwoWayPullsAsTheClosedForm) {
  for (const double across : {1.1, 1.25}) {
    Stretched s;
    s.along = 1.15;
    s.across = across;
    s.fibres = crossed(35, 0.2, 3, 0.08);
    expect_closed_form(s);
  }
}

TEST(FibreFamilies, PressedOnesCarryNothing) {
  Stretched s;
  s.along = 0.8;
  s.fibres = crossed(0, 5, 10, 0);
  const ClosedForm form{s};
  EXPECT_NEAR(form.across(), 1 / std::sqrt(0.8), 1e-6);
  expect_closed_form(s);
}

/// Of every kind of element; dispersed in all directions the fibres have no direction.
TEST(FibreFamilies, AffineShapesHaveTheEnergyOfTheLaw) {
  Mat3 f;
  f << 1.2, 0.3, -0.1, 0.05, 0.95, 0.2, 0.1, -0.25, 1.1;
  for (const auto& [split, quadratic] :
       {std::pair{Split::six, false}, std::pair{Split::six, true}, std::pair{Split::prisms, false}}) {
    RobotSpec spec = physical_robot(block_mesh({2, 2, 2}, {20, 8, 6}, split));
    spec.mesh_options.quadratic = quadratic;
    spec.materials[0].families = std::make_shared<const FamiliesSpec>(oblique);
    PhysicalEquations sample(compile(spec));
    const auto energy_at = [&](const Mat3& map, Points& gradient) {
      physical::Iterate at = sample.at;
      at.positions = sample.model.rest * map.transpose();
      at.multipliers = Eigen::VectorXd::Zero(0);
      gradient = Points::Zero(at.positions.rows(), 3);
      physical::Term::Sum sum{gradient};
      for (std::size_t t = 0; t < sample.system.terms().size(); ++t)
        if (dynamic_cast<const physical::FibreFamilies*>(sample.system.terms()[t]) != nullptr)
          sample.system.terms()[t]->evaluate(at, sample.load_state, *sample.work.terms[t], sum, sample.team);
      EXPECT_FALSE(sum.forbidden);
      return sum.energy;
    };
    const double volume = 20 * 8 * 6;
    Points gradient, turned;
    const double energy = energy_at(f, gradient);
    EXPECT_GT(energy, 1);
    EXPECT_NEAR(energy, volume * energy_of(oblique, f), 1e-12 * energy);
    const Mat3 stress = gradient.transpose() * sample.model.rest / volume;  // first Piola-Kirchhoff's
    for (int i = 0; i < 9; ++i) {
      Mat3 more = f, less = f;
      more.data()[i] += 1e-5;
      less.data()[i] -= 1e-5;
      EXPECT_NEAR(stress.data()[i], (energy_of(oblique, more) - energy_of(oblique, less)) / 2e-5, 1e-7);
    }
    const Mat3 rotation = Eigen::AngleAxisd(2, Vec3(1, -2, 3).normalized()).toRotationMatrix();
    EXPECT_NEAR(energy_at(rotation * f, turned), energy, 1e-12 * energy);
    EXPECT_LT((turned - gradient * rotation.transpose()).norm(), 1e-12 * gradient.norm());
    EXPECT_NEAR(energy_at(rotation, turned), 0, 1e-12);
  }
}

/// Rings around a tube hold it under pressure, where fibres along it do not.
TEST(FibreFamilies, RingsHoldATube) {
  const auto radius = [](double degrees) {
    RobotSpec spec = physical_robot(rod_mesh(16, 2, 2, 8, 6, 0.7));
    spec.mesh_options.quadratic = true;
    spec.materials[0].elastic = elastic(Law::neo_hookean, 0.3, 0.45);
    DirectionSpec around{DirectionSpec::Kind::circumferential, {}, {0, 0, 0}, {1, 0, 0}, degrees};
    spec.materials[0].families = families({{2, 1, 0, around}});
    spec.fixed = {{{Selector(Halfspace{{1e-6, 0, 0}, {-1, 0, 0}}), {}}, {true, false, false}},
                  {{Selector(Halfspace{{6 - 1e-6, 0, 0}, {1, 0, 0}}), {}}, {true, false, false}}};
    VertexList inside, line;
    for (Index v = 0; v < spec.mesh.vertices.rows(); ++v) {
      const Vec3 p = vertex_at(spec.mesh.vertices, v);
      if (std::abs(p.z()) < 1e-9 && p.x() < 1e-9) line.vertices.push_back(v);
      if (p.tail<2>().norm() < 5.6 + 1e-6) inside.vertices.push_back(v);
    }
    VertexList across = line;
    spec.fixed.push_back({{Selector(line), {}}, {false, false, true}});
    std::erase_if(across.vertices, [&](Index v) { return spec.mesh.vertices(v, 1) < 0; });
    VertexList other;
    for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
      if (const Vec3 p = vertex_at(spec.mesh.vertices, v); std::abs(p.y()) < 1e-9 && p.x() < 1e-9)
        other.vertices.push_back(v);
    spec.fixed.push_back({{Selector(other), {}}, {false, true, false}});
    spec.loads.tractions = {{"air", {Selector(inside), {}}, true, {0, 0, 0}, 30}};
    const Model model = compile(spec);
    const Points shape = solve_converged(Statics(model), model.rest_actuation()).state.positions;
    return shape.rightCols(2).rowwise().norm().maxCoeff();
  };
  const double rings = radius(0), along = radius(90);
  EXPECT_LT(rings, 8.2);
  EXPECT_GT(along, 8.6);
}

TEST(FibreFamilies, DerivativesOfShapes) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = cable_beam();
    spec.mesh_options.quadratic = quadratic;
    spec.materials[0].families = std::make_shared<const FamiliesSpec>(oblique);
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, values({0.9, 1.4}), tight(1e-11));
    const Sensitivity exact = statics.sensitivity(found.state);
    const Difference expected = central(statics, found.state, 0, 1e-4);
    EXPECT_LT(off_by(exact.positions[0], expected.positions), 1e-5);
  }
}

}  // namespace softkin
