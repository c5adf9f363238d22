#include <cmath>

#include "statics/magnetic_samples.hpp"

/// A beam magnetised along itself in a field across it, and in one against it: against published measurements, and
/// against an elastica.

namespace softkin {

namespace {

using namespace testing;

constexpr double strip_length = 17.2, strip_thickness = 0.84, strip_width = 5, strip_modulus = 0.303;  // [mm], [MPa]
constexpr double strip_remanence = 143;                                                                // [mT]

/// Along x, thin along z; nearly incompressible.
RobotSpec cantilever(const std::array<int, 3>& cells, double wide, Magnetisation magnetisation) {
  constexpr double poisson_ratio = 0.49;
  RobotSpec spec = physical_robot(block_mesh(cells, {strip_length, wide, strip_thickness}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic->youngs_modulus = 2 * (1 + poisson_ratio) * strip_modulus;
  spec.materials[0].elastic->poisson_ratio = poisson_ratio;
  magnetise(spec, {strip_remanence, 0, 0}, magnetisation);
  add_field(spec, {"field", UniformField{{0, 0, 1}}}, {FieldCommand::flux_density});
  spec.markers = {{"tip", {std::string("x_high"), {}}}};
  return spec;
}

/// How far the tip moves across, over the length, and along.
struct Tip {
  double across = 0, along = 0;
};

/// E I theta'' = -(A b_r B / mu_0) s sin(apart), apart = opening - theta, theta(0) = 0, theta'(L) = 0 by shooting: the
/// angle between remanence and field at the tip by bisection, from there back to the clamp by Runge and Kutta's method
/// of fourth order; all over the length.
///
/// load     12 b_r B L^2 / (mu_0 E t^2)
/// strain   b_r B / (mu_0 E), by which the field stretches material along it: s = 1 + strain cos(apart)
/// opening  from the remanence at rest to the field
Tip elastica(double load, double strain, double opening = M_PI / 2) {
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
        tip.across += h / 6 * weight * long_by(at, std::sin(opening - at));
        tip.along += h / 6 * weight * long_by(at, std::cos(opening - at));
      }
      angle = next;
    }
    return angle;
  };
  double low = 0, high = opening;
  Tip tip;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (shot(middle, tip) > opening ? high : low) = middle;
  }
  (void)shot(low, tip);
  return tip;
}

double across(const Model& model, const Equilibrium& found) {
  return (marker_at(model, found).z() - 0.5 * strip_thickness) / strip_length;
}

/// Solves along a path of flux densities and visits each shape.
template <class Look>
void along_fluxes(const RobotSpec& spec, const std::vector<double>& fluxes, const Look& look) {
  const Model model = compile(spec);
  const Statics statics(model);
  State start = statics.rest();
  for (const double flux : fluxes) {
    const Equilibrium found = statics.solve(values({flux}), start);
    ASSERT_EQ(found.report.status, Status::converged);
    start = found.state;
    look(flux, model, found);
  }
}

/// Bends as a beam does: its cross-section is free to change where it is held.
RobotSpec narrow(Magnetisation magnetisation) {
  const std::array<int, 3> cells{24, 2, 2};
  RobotSpec spec = cantilever(cells, strip_thickness, magnetisation);
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{VertexList{{grid_vertex(cells, 0, 1, 1)}}, {}}, {false, true, true}},
                {{VertexList{{grid_vertex(cells, 0, 0, 1)}}, {}}, {false, false, true}}};
  return spec;
}

/// The field against the strip, whose remanence is 5 degrees off.
RobotSpec reversed(RobotSpec spec) {
  constexpr double off = 5 * M_PI / 180;
  magnetise(spec, strip_remanence * Vec3(std::cos(off), 0, std::sin(off)), spec.materials[0].remanence->magnetisation);
  spec.actuators.clear();
  add_field(spec, {"field", UniformField{{-1, 0, 0}}}, {FieldCommand::flux_density});
  return spec;
}

}  // namespace

/// Published measurements of a printed beam of that size, as others digitised them.
TEST(MagneticCantilever, BendsAsMeasured) {
  const std::vector<double> measured{0.592, 0.755, 0.899};
  for (const Magnetisation magnetisation : both_magnetisations) {
    std::size_t at = 0;
    along_fluxes(cantilever({24, 6, 2}, strip_width, magnetisation), {4.64, 9.44, 47.2},
                 [&](double flux, const Model& model, const Equilibrium& found) {
                   const double now = across(model, found);
                   std::printf("%.4g mT: %.4f of the length, measured %.4f\n", flux, now, measured[at]);
                   EXPECT_LT(std::abs(now / measured[at++] - 1), 0.08) << flux;
                 });
  }
}

/// The same beam in a field against it. Where a beam bends much and stretches little, both formulations agree.
TEST(MagneticCantilever, IsReversedAsMeasured) {
  const std::vector<double> fluxes{9.98, 14.99, 25.08, 40.2}, measured{0.77, 0.669, 0.530, 0.419};
  std::vector<double> turning;
  for (const Magnetisation magnetisation : both_magnetisations) {
    std::size_t at = 0;
    along_fluxes(reversed(cantilever({24, 4, 1}, strip_width, magnetisation)), fluxes,
                 [&](double flux, const Model& model, const Equilibrium& found) {
                   const double now = across(model, found);
                   std::printf("%.4g mT: %.4f of the length, measured %.4f\n", flux, now, measured[at]);
                   EXPECT_LT(std::abs(now - measured[at]), 0.075) << flux;
                   if (magnetisation == Magnetisation::turns)
                     turning.push_back(now);
                   else
                     EXPECT_LT(std::abs(now - turning.at(at)), 0.002) << flux;
                   ++at;
                 });
  }
}

/// The elastica does not shear and knows nothing of the width, which a clamp may not hold either. Where magnets stretch
/// the strongest field makes the strip longer by 0.5 %, where they turn it does not.
TEST(MagneticCantilever, IsAMagneticElastica) {
  for (const Magnetisation magnetisation : both_magnetisations) {
    const RobotSpec spec = narrow(magnetisation);
    const double modulus = spec.materials[0].elastic->youngs_modulus.value();
    along_fluxes(spec, {0.5, 4.64, 9.44, 47.2}, [&](double flux, const Model& model, const Equilibrium& found) {
      const double strain = strip_remanence * flux * inverse_permeability / modulus;
      const double load = 12 * strain * std::pow(strip_length / strip_thickness, 2);
      const Tip expected = elastica(load, magnetisation == Magnetisation::turns ? 0 : strain);
      const double now = across(model, found);
      std::printf("%.4g mT: %.4f across, %.4f along; elastica %.4f, %.4f\n", flux, now,
                  marker_at(model, found).x() / strip_length, expected.across, expected.along);
      EXPECT_LT(std::abs(now / expected.across - 1), 0.006) << flux;
    });
  }
}

TEST(MagneticCantilever, IsReversedAsAnElastica) {
  const RobotSpec spec = reversed(narrow(Magnetisation::turns));
  const double modulus = spec.materials[0].elastic->youngs_modulus.value();
  along_fluxes(spec, {9.98, 14.99, 25.08, 40.2}, [&](double flux, const Model& model, const Equilibrium& found) {
    const double load =
        12 * strip_remanence * flux * inverse_permeability / modulus * std::pow(strip_length / strip_thickness, 2);
    const Tip expected = elastica(load, 0, 175 * M_PI / 180);
    const double now = across(model, found), along = marker_at(model, found).x() / strip_length;
    std::printf("%.4g mT: %.4f across, %.4f along; elastica %.4f, %.4f\n", flux, now, along, expected.across,
                expected.along);
    EXPECT_LT(std::hypot(now - expected.across, along - expected.along), 0.01) << flux;
  });
}

}  // namespace softkin
