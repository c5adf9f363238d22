#pragma once

#include <cstdint>
#include <softkin/statics/physical/contact_points.hpp>
#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

#include "support/exact_crossing.hpp"
#include "support/random_drops.hpp"

namespace softkin::testing {

/// A random drop that was solved, step by step.
struct PressedDrop {
  struct Shape {
    SolveReport report;
    std::size_t crossings = 0;  // of the surfaces that may touch, exactly decided
  };
  std::vector<Shape> shapes;  // of every step that was made; the last one may have failed
  std::string refusal;        // why there is none
  std::size_t tetrahedra = 0;
};

/// Returns the robot of a drop whose top moves by a fraction of its displacement. The contact distance is a fifth of
/// the gap and at most 0.04 of the diagonal. A slack cable, whose tension is 0, lets the states of one fraction start
/// those of another.
[[nodiscard]] inline RobotSpec drop_robot(const Drop& drop, double fraction) {
  RobotSpec spec = drop.robot;
  const Points& at = spec.mesh.vertices;
  const double diagonal = (at.colwise().maxCoeff() - at.colwise().minCoeff()).norm();
  ContactSpec contact;
  contact.distance_mm = std::min(0.2 * drop.gap_mm, 0.04 * diagonal);
  spec.contact = contact;
  spec.fixed.back().displacement *= fraction;
  ActuatorSpec cable;
  cable.name = "slack";
  cable.drive = CableSpec{};
  cable.control = Control::load;
  cable.rest = 0;
  cable.low = 0;
  cable.high = 1;
  for (const Index v : {Index{0}, drop.upper}) cable.as<CableSpec>()->points.push_back({Vec3(at.row(v)), {}});
  spec.actuators.push_back(cable);
  return spec;
}

/// Presses a drop in equal steps, each from the shape of the one before, and looks at every shape that comes back.
///
/// cable  gives the robot its slack cable; without one the start does not contain the fraction it belongs to
[[nodiscard]] inline PressedDrop press_drop(std::uint64_t seed, int steps, bool cable = true) {
  const Drop drop = random_drop(seed);
  PressedDrop out;
  out.tetrahedra = drop.robot.mesh.tetrahedra.size();
  State state;
  StaticsOptions options;
  options.threads = 1;
  options.keep_history = false;
  try {
    for (int step = 1; step <= steps; ++step) {
      RobotSpec spec = drop_robot(drop, static_cast<double>(step) / steps);
      if (!cable) spec.actuators.clear();
      const Model model = compile(spec);
      const Statics statics(model);
      if (step == 1)
        state = statics.rest();
      else
        state.load_factor *= static_cast<double>(step - 1) / step;
      const Equilibrium found = statics.solve(Actuation::Zero(cable ? 1 : 0), state, options);
      Points room;
      const Points& points = physical::ContactPoints(model).of(found.state.positions, room);
      out.shapes.push_back({found.report, crossings(points, model.contact.triangles).size()});
      state = found.state;
      if (state.load_factor < 0) break;
    }
  } catch (const InvalidInput& error) {
    out.refusal = error.what();
  }
  return out;
}

}  // namespace softkin::testing
