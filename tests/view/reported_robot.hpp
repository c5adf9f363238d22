#pragma once

#include <softkin/io/table/measured_poses.hpp>

#include "served_robot.hpp"
#include "view/reading_stream.hpp"

namespace softkin::view::testing {

/// A block that is pushed at its tip, its chamber's pressure commanded; markers tip and corner.
inline Model pushed_model() {
  return runs::testing::block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{region: base}]\n"
      "actuators: [{name: air, kind: pneumatic, region: chamber, control: pressure, range: [-100, 300]}]\n"
      "forces: [{name: push, region: tip, range: [[0, 0], [-0.5, 0.5], [-0.5, 0.5]]}]\n"
      "markers: [{name: tip, region: tip}, {name: corner, point: [12, 12, 12]}]\n");
}

/// Returns a setup with coordinates to 0.001 mm and a push at the tip. place: estimates where the push acts, too
inline EstimateSetup pushed_setup(const Model& model, bool place = false, double fade_s = 0) {
  std::array<double, readings> deviations{};
  deviations[static_cast<std::size_t>(Reading::coordinate)] = 0.001;
  std::array<std::string, readings> options;
  options.fill("--deviation");
  EstimatorOptions how;
  how.statics = runs::testing::one_thread();
  how.fade_s = fade_s;
  return estimate_setup(model, {{"push", place}}, deviations, options, how);
}

/// What markers read under commands in the order air, push_fy, push_fz.
inline Eigen::VectorXd read_at(const Model& model, const Actuation& commands) {
  const Statics statics(model);
  const Equilibrium found = statics.solve(commands, statics.rest(), runs::testing::one_thread());
  Eigen::VectorXd values(3 * model.markers.size());
  for (std::size_t m = 0; m < model.markers.size(); ++m)
    values.segment<3>(3 * m) = model.markers[m].at(found.state.positions);
  return values;
}

}  // namespace softkin::view::testing
