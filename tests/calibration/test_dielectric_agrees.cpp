#include <gtest/gtest.h>

#include <cmath>
#include <softkin/calibration/actuator_curves.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/statics.hpp>

#include "model/physical_robots.hpp"

/// The equations of state of `calibrate dea` and elements under voltage give the same curve.

namespace softkin::calibration {

namespace {

using namespace testing;

constexpr double thickness_mm = 0.5, permittivity = 4.7, shear_MPa = 0.045, limit = 60;

/// A free sheet of prisms, hardly compressible.
Model sheet_of(DielectricLaw law) {
  const std::array<int, 3> cells{2, 2, 1};
  RobotSpec spec = physical_robot(block_mesh(cells, {6, 5, thickness_mm}, Split::prisms));
  ElasticSpec& elastic = *spec.materials[0].elastic;
  elastic = {};
  elastic.law = Law::gent;
  elastic.shear_modulus = shear_MPa;
  elastic.jm = law == DielectricLaw::gent ? limit : 1e7;
  elastic.bulk_modulus = 1e4 * shear_MPa;
  spec.materials[0].permittivity = permittivity;
  spec.fixed = {{{VertexList{{0}}, {}}, {true, true, true}},
                {{VertexList{{grid_vertex(cells, 2, 0, 0)}}, {}}, {false, true, true}},
                {{VertexList{{grid_vertex(cells, 0, 2, 0)}}, {}}, {false, false, true}}};
  ActuatorSpec skin;
  skin.name = "skin";
  skin.drive = DeaSpec{.region = "all"};
  skin.high = 40;
  skin.control = Control::load;
  skin.rest = 0;
  spec.actuators = {skin};
  return compile(spec);
}

}  // namespace

TEST(DielectricAgrees, WithElementsUnderVoltage) {
  for (const DielectricLaw law : {DielectricLaw::neo_hookean, DielectricLaw::gent}) {
    const Dielectric elastomer{law, shear_MPa, permittivity, thickness_mm, 1, limit};
    const PullIn end = pull_in(elastomer).value();
    const Model model = sheet_of(law);
    const Statics statics(model);
    State at = statics.rest();
    for (const double fraction : {0.3, 0.6, 0.9, 0.99}) {
      double low = 1, high = end.stretch;
      for (int i = 0; i < 80; ++i) {
        const double middle = (low + high) / 2;
        (voltage_of(elastomer, middle) < fraction * end.voltage_kV ? low : high) = middle;
      }
      const Equilibrium found = statics.solve(Actuation::Constant(1, fraction * end.voltage_kV), at);
      ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
      EXPECT_NEAR(achieved_ratio(model, model.actuators[0], found.state.positions), low * low, 1e-3 * (low * low - 1));
      at = found.state;
    }
    const Equilibrium found = statics.solve(Actuation::Constant(1, 40), at);
    EXPECT_EQ(found.report.status, Status::limit);
    EXPECT_NEAR(found.state.actuation[0], end.voltage_kV, 5e-3 * end.voltage_kV);
  }
}

}  // namespace softkin::calibration
