#include <gtest/gtest.h>

#include <softkin/model/mesh/mesh_order.hpp>

#include "model/open_walls.hpp"
#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

/// A block of 24 mm that hangs from its top, with a chamber that ends at a number of planes of symmetry.
RobotSpec hanging_block(int planes, bool quadratic) {
  Mesh mesh = block_mesh({4, 4, 4}, {24, 24, 24});
  add_volume_region(mesh, "chamber", [planes](const Vec3& p) {
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
      inside = inside && p[axis] < (axis == 2 ? 18 : 12) && (axis < planes || p[axis] > 6);
    return inside;
  });
  add_open_wall(mesh, "chamber");
  if (quadratic) {
    mesh = elevated(mesh);
    for (Index v = 0; v < mesh.vertices.rows(); ++v) {  // edges in the planes of symmetry are curved
      const Vec3 p = mesh.vertices.row(v).transpose() / 24;
      for (int axis = 0; axis < 3; ++axis)
        mesh.vertices(v, axis) += 3 * p[axis] * (1 - p[axis]) * (1 + p[(axis + 1) % 3]);
    }
  }
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.fixed = {{{std::string("z_high"), {}}, {true, true, true}}};
  for (int axis = 0; axis < planes; ++axis)
    spec.fixed.push_back({{std::string(1, "xyz"[axis]) + "_low", {}}, {axis == 0, axis == 1, axis == 2}});
  spec.voids = {{std::string("chamber"), {}}};
  return spec;
}

ActuatorSpec air_behind_wall() {
  ActuatorSpec spec = air("air");
  spec.as<PneumaticSpec>()->region.reset();
  spec.as<PneumaticSpec>()->wall = "wall";
  return spec;
}

/// A traction on the wall knows nothing of what closes the chamber.
TEST(OpenChambers, PressureActsAsTractionsOnTheWallAlone) {
  for (const bool quadratic : {false, true})
    for (int planes = 1; planes <= 3; ++planes) {
      SCOPED_TRACE(std::to_string(planes) + (quadratic ? " planes, order 2" : " planes"));
      const double pressure = 60;  // [kPa]
      RobotSpec chamber = hanging_block(planes, quadratic), traction = chamber;
      chamber.actuators = {by_load(air_behind_wall())};
      TractionSpec& load = traction.loads.tractions.emplace_back();
      load.name = "load";
      load.where = {std::string("wall"), {}};
      load.follows = true;
      load.pressure_kPa = pressure;
      const Model one = compile(chamber), other = compile(traction);
      const Points inflated = solve_converged(Statics(one), values({pressure})).state.positions,
                   loaded = solve_converged(Statics(other), {}).state.positions;
      const double moved = (loaded - other.rest).cwiseAbs().maxCoeff();
      EXPECT_GT(moved, 0.5);
      EXPECT_LT((inflated.topRows(loaded.rows()) - loaded).cwiseAbs().maxCoeff(), 1e-5 * moved);
    }
}

/// By volume: the same pressure as with the chamber meshed, whose elements close it in the planes.
TEST(OpenChambers, VolumeTakesThePressureOfTheMeshedChamber) {
  for (const bool quadratic : {false, true})
    for (int planes = 1; planes <= 3; ++planes) {
      RobotSpec walled = hanging_block(planes, quadratic), meshed = walled;
      walled.actuators = {air_behind_wall()};
      meshed.voids.clear();
      meshed.actuators = {air("chamber")};
      const auto pressure_of = [](const RobotSpec& spec) {
        const Model model = compile(spec);
        return solve_converged(Statics(model), values({1.2})).state.multipliers[0];
      };
      const double pressure = pressure_of(meshed);
      EXPECT_NEAR(pressure_of(walled), pressure, 1e-6 * pressure) << planes << (quadratic ? ", order 2" : "");
    }
}

}  // namespace

}  // namespace softkin
