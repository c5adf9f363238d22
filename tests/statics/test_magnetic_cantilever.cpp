#include <cmath>

#include "statics/magnetic_samples.hpp"

/// A beam magnetised along itself in a field across it: against published measurements, and against an elastica.

namespace softkin {

namespace {

using namespace testing;

constexpr double length = 17.2, thickness = 0.84, width = 5, shear_modulus = 0.303;  // [mm], [MPa]
constexpr double remanence = 143;                                                    // [mT]

/// Along x, thin along z; nearly incompressible.
RobotSpec cantilever(double poisson_ratio, double wide) {
  RobotSpec spec = physical_robot(block_mesh({16, 2, 1}, {length, wide, thickness}));
  spec.quadratic = true;
  spec.materials[0].elastic->youngs_modulus = 2 * (1 + poisson_ratio) * shear_modulus;
  spec.materials[0].elastic->poisson_ratio = poisson_ratio;
  magnetise(spec, {remanence, 0, 0});
  add_field(spec, {"field", UniformField{{0, 0, 1}}}, {FieldCommand::flux_density});
  spec.markers = {{"tip", {std::string("x_high"), {}}}};
  return spec;
}

/// How far the tip moves across, over the length, and along.
struct Tip {
  double across = 0, along = 0;
};

/// E I theta'' = -(A b_r B / mu_0) cos theta, theta(0) = 0, theta'(L) = 0 by shooting: the curvature at the clamp by
/// bisection, the equation by Runge and Kutta's method of fourth order; all over the length.
Tip elastica(double load) {
  constexpr int steps = 2000;
  const double h = 1.0 / steps;
  struct End {
    double angle, curvature;
    Tip tip;
  };
  const auto shot = [&](double curvature) {
    End at{0, curvature, {}};
    for (int i = 0; i < steps; ++i) {
      const auto bend = [&](double angle) { return -load * std::cos(angle); };
      const double a = at.angle, c = at.curvature;
      const double k1 = bend(a), l1 = c, k2 = bend(a + h / 2 * l1), l2 = c + h / 2 * k1, k3 = bend(a + h / 2 * l2),
                   l3 = c + h / 2 * k2, k4 = bend(a + h * l3), l4 = c + h * k3;
      at.angle += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
      at.curvature += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      const double middle = a + h / 4 * (l1 + l2);
      at.tip.across += h / 6 * (std::sin(a) + 4 * std::sin(middle) + std::sin(at.angle));
      at.tip.along += h / 6 * (std::cos(a) + 4 * std::cos(middle) + std::cos(at.angle));
    }
    return at;
  };
  double low = 0, high = std::sqrt(2 * load);  // that of a beam so long that it ends along the field
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (shot(middle).curvature > 0 ? high : low) = middle;
  }
  return shot(low).tip;
}

}  // namespace

/// Published measurements of a printed beam of that size, as others digitised them.
TEST(MagneticCantilever, BendsAsMeasured) {
  const Model model = compile(cantilever(0.49, width));
  const Statics statics(model);
  State start = statics.rest();
  for (const auto& [flux, measured] : {std::pair(4.64, 0.592), std::pair(9.44, 0.755), std::pair(47.2, 0.899)}) {
    const Equilibrium found = statics.solve(values({flux}), start);
    ASSERT_EQ(found.report.status, Status::converged);
    start = found.state;
    const double across = (marker_at(model, found).z() - 0.5 * thickness) / length;
    std::printf("%.4g mT: %.4f of the length, measured %.4f\n", flux, across, measured);
    EXPECT_LT(std::abs(across / measured - 1), 0.08) << flux;
  }
}

/// The elastica neither stretches nor shears, and knows nothing of the width: a clamped end may not hold it either.
TEST(MagneticCantilever, IsAMagneticElastica) {
  RobotSpec spec = cantilever(0.3, 1);
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{VertexList{{grid_vertex({16, 2, 1}, 0, 1, 0)}}, {}}, {false, true, true}},
                {{VertexList{{grid_vertex({16, 2, 1}, 0, 0, 0)}}, {}}, {false, false, true}}};
  const Model model = compile(spec);
  const Statics statics(model);
  State start = statics.rest();
  const double modulus = spec.materials[0].elastic->youngs_modulus.value();
  for (const double flux : {0.5, 4.64, 9.44, 47.2}) {
    const Equilibrium found = statics.solve(values({flux}), start);
    ASSERT_EQ(found.report.status, Status::converged);
    start = found.state;
    const double load =
        12 * remanence * flux * inverse_permeability * length * length / (modulus * thickness * thickness);
    const Tip expected = elastica(load);
    const Vec3 tip = marker_at(model, found);
    std::printf("%.4g mT: %.4f across, %.4f along; elastica %.4f, %.4f\n", flux, (tip.z() - 0.5 * thickness) / length,
                tip.x() / length, expected.across, expected.along);
    EXPECT_LT(std::abs((tip.z() - 0.5 * thickness) / length / expected.across - 1), 0.01) << flux;
  }
}

}  // namespace softkin
