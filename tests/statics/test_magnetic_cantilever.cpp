#include <cmath>

#include "statics/magnetic_samples.hpp"

/// A beam magnetised along itself in a field across it: against published measurements, and against an elastica.

namespace softkin {

namespace {

using namespace testing;

constexpr double strip_length = 17.2, strip_thickness = 0.84, strip_width = 5, strip_modulus = 0.303;  // [mm], [MPa]
constexpr double strip_remanence = 143;                                                                // [mT]

/// Along x, thin along z; nearly incompressible.
RobotSpec cantilever(const std::array<int, 3>& cells, double wide) {
  constexpr double poisson_ratio = 0.49;
  RobotSpec spec = physical_robot(block_mesh(cells, {strip_length, wide, strip_thickness}));
  spec.quadratic = true;
  spec.materials[0].elastic->youngs_modulus = 2 * (1 + poisson_ratio) * strip_modulus;
  spec.materials[0].elastic->poisson_ratio = poisson_ratio;
  magnetise(spec, {strip_remanence, 0, 0});
  add_field(spec, {"field", UniformField{{0, 0, 1}}}, {FieldCommand::flux_density});
  spec.markers = {{"tip", {std::string("x_high"), {}}}};
  return spec;
}

/// How far the tip moves across, over the length, and along.
struct Tip {
  double across = 0, along = 0;
};

/// E I theta'' = -(A b_r B / mu_0) s cos theta, theta(0) = 0, theta'(L) = 0 by shooting: the angle between tip and
/// field by bisection, from there back to the clamp by Runge and Kutta's method of fourth order; all over the length.
///
/// load    12 b_r B L^2 / (mu_0 E t^2)
/// strain  b_r B / (mu_0 E), which the field stretches what lies along it by: s = 1 + strain sin theta; 0: inextensible
Tip elastica(double load, double strain) {
  constexpr int steps = 2000;
  const double h = 1.0 / steps;
  const auto shot = [&](double apart, Tip& tip) {  // from the field; returns that at the clamp, or more than it
    double angle = apart, curvature = 0;
    tip = {};
    for (int i = 0; i < steps && angle < M_PI; ++i) {
      const auto bend = [&](double at) { return load * (1 + strain * std::cos(at)) * std::sin(at); };
      const auto long_by = [&](double at, double along) { return (1 + strain * std::cos(at)) * along; };
      const double k1 = bend(angle), l1 = curvature, k2 = bend(angle + h / 2 * l1), l2 = curvature + h / 2 * k1,
                   k3 = bend(angle + h / 2 * l2), l3 = curvature + h / 2 * k2, k4 = bend(angle + h * l3),
                   l4 = curvature + h * k3, middle = angle + h / 4 * (l1 + l2),
                   next = angle + h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
      curvature += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      for (const auto& [at, weight] : {std::pair(angle, 1), std::pair(middle, 4), std::pair(next, 1)}) {
        tip.across += h / 6 * weight * long_by(at, std::cos(at));
        tip.along += h / 6 * weight * long_by(at, std::sin(at));
      }
      angle = next;
    }
    return angle;
  };
  double low = 0, high = M_PI / 2;
  Tip tip;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (shot(middle, tip) > M_PI / 2 ? high : low) = middle;
  }
  (void)shot(low, tip);
  return tip;
}

}  // namespace

/// Published measurements of a printed beam of that size, as others digitised them.
TEST(MagneticCantilever, BendsAsMeasured) {
  const Model model = compile(cantilever({24, 6, 2}, strip_width));
  const Statics statics(model);
  State start = statics.rest();
  for (const auto& [flux, measured] : {std::pair(4.64, 0.592), std::pair(9.44, 0.755), std::pair(47.2, 0.899)}) {
    const Equilibrium found = statics.solve(values({flux}), start);
    ASSERT_EQ(found.report.status, Status::converged);
    start = found.state;
    const double across = (marker_at(model, found).z() - 0.5 * strip_thickness) / strip_length;
    std::printf("%.4g mT: %.4f of the length, measured %.4f\n", flux, across, measured);
    EXPECT_LT(std::abs(across / measured - 1), 0.08) << flux;
  }
}

/// The elastica does not shear and knows nothing of the width, which a clamp may not hold either. Under the strongest
/// field the strip gets longer by 0.5 %, which an inextensible one does not.
TEST(MagneticCantilever, IsAMagneticElastica) {
  const std::array<int, 3> cells{24, 2, 2};
  RobotSpec spec = cantilever(cells, strip_thickness);
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{VertexList{{grid_vertex(cells, 0, 1, 1)}}, {}}, {false, true, true}},
                {{VertexList{{grid_vertex(cells, 0, 0, 1)}}, {}}, {false, false, true}}};
  const Model model = compile(spec);
  const Statics statics(model);
  State start = statics.rest();
  const double modulus = spec.materials[0].elastic->youngs_modulus.value();
  for (const double flux : {0.5, 4.64, 9.44, 47.2}) {
    const Equilibrium found = statics.solve(values({flux}), start);
    ASSERT_EQ(found.report.status, Status::converged);
    start = found.state;
    const double strain = strip_remanence * flux * inverse_permeability / modulus;
    const double load = 12 * strain * std::pow(strip_length / strip_thickness, 2);
    const Tip expected = elastica(load, strain), stiff = elastica(load, 0);
    const Vec3 tip = marker_at(model, found);
    std::printf("%.4g mT: %.4f across, %.4f along; elastica %.4f, %.4f; inextensible %.4f\n", flux,
                (tip.z() - 0.5 * strip_thickness) / strip_length, tip.x() / strip_length, expected.across,
                expected.along, stiff.across);
    EXPECT_LT(std::abs((tip.z() - 0.5 * strip_thickness) / strip_length / expected.across - 1), 0.006) << flux;
    EXPECT_LT(std::abs((tip.z() - 0.5 * strip_thickness) / strip_length / stiff.across - 1), flux < 10 ? 0.006 : 0.012)
        << flux;
  }
}

}  // namespace softkin
