#pragma once

#include "statics/physical_samples.hpp"

namespace softkin::testing {

/// Derivatives by one command, from converged equilibria.
struct Difference {
  Points positions;             // #V by 3 [mm per unit of command]
  Eigen::VectorXd multipliers;  // m [N or kPa per unit of command]
};

/// Weighted sum of the equilibria at offsets from an actuation, each solved from the state `at`.
inline Difference weighted_sum(const Statics& statics, const State& at, Index actuator,
                               const std::vector<double>& offsets, const std::vector<double>& weights) {
  Difference sum{Points::Zero(at.positions.rows(), 3), Eigen::VectorXd::Zero(at.actuation.size())};
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    Actuation moved = at.actuation;
    moved[actuator] += offsets[k];
    const Equilibrium found = statics.solve(moved, at, tight());
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    sum.positions += weights[k] * found.state.positions;
    sum.multipliers += weights[k] * found.state.multipliers;
  }
  return sum;
}

/// Central differences of fourth order.
inline Difference central(const Statics& statics, const State& at, Index actuator, double step) {
  const double h = 1 / (12 * step);
  return weighted_sum(statics, at, actuator, {-2 * step, -step, step, 2 * step}, {h, -8 * h, 8 * h, -h});
}

/// One-sided differences of fourth order, towards the sign of step.
inline Difference one_sided(const Statics& statics, const State& at, Index actuator, double step) {
  const double h = 1 / (12 * step);
  return weighted_sum(statics, at, actuator, {0, step, 2 * step, 3 * step, 4 * step},
                      {-25 * h, 48 * h, -36 * h, 16 * h, -3 * h});
}

/// Largest entry of a - b over the largest of b.
template <class A, class B>
double off_by(const A& a, const B& b) {
  const double error = (a - b).cwiseAbs().maxCoeff();
  return error == 0 ? 0 : error / b.cwiseAbs().maxCoeff();
}

/// Steps of commands for differences: of a ratio, in N or in kPa.
struct Steps {
  double ratio = 5e-4, tension = 1e-3, pressure = 0.1;

  [[nodiscard]] double of(const Actuator& actuator) const {
    if (actuator.control == Control::ratio) return ratio;
    return actuator.is<CableDrive>() ? tension : pressure;
  }
};

/// Returns the difference, one-sided at a command from which only one direction has the same active cables.
inline Difference difference_by(const Model& model, const Statics& statics, const State& at, Index actuator,
                                double step) {
  const Actuator& a = model.actuators[actuator];
  const double command = at.actuation[actuator];
  if (model.formulation == Formulation::physical && a.is<CableDrive>()) {
    if (a.control == Control::load && command < 3 * step) return one_sided(statics, at, actuator, step);
    if (a.control == Control::ratio && at.multipliers[actuator] < 1e-6) return one_sided(statics, at, actuator, -step);
  }
  return central(statics, at, actuator, step);
}

/// Positions and multipliers of a sensitivity against differences, for every actuator.
inline void expect_differences(const Model& model, const Statics& statics, const Equilibrium& at, double tolerance,
                               const Steps& steps = {}) {
  const Sensitivity found = statics.sensitivity(at.state);
  EXPECT_TRUE(found.regular);
  for (Index a = 0; a < at.actuation.size(); ++a) {
    SCOPED_TRACE("actuator " + std::to_string(a) + " at " + std::to_string(at.actuation[a]));
    const double step = steps.of(model.actuators[a]);
    const Difference expected = difference_by(model, statics, at.state, a, step);
    EXPECT_GT(expected.positions.cwiseAbs().maxCoeff(), 0);
    EXPECT_LT(off_by(found.positions[a], expected.positions), tolerance);
    if (model.formulation == Formulation::physical)
      EXPECT_LT(off_by(found.multipliers.col(a), expected.multipliers), tolerance);
    else
      EXPECT_EQ(found.multipliers.cwiseAbs().maxCoeff(), 0);
  }
}

/// From rest to an actuation, and there.
inline void expect_differences_at(const RobotSpec& spec, const Actuation& actuation, double tolerance = 1e-6,
                                  const Steps& steps = {}) {
  const Model model = compile(spec);
  const Statics statics(model);
  expect_differences(model, statics, solve_converged(statics, actuation), tolerance, steps);
}

/// A slender finger of quadratic elements with a stiff sole; inflated it curls down.
inline RobotSpec curling_finger() {
  Mesh mesh = block_mesh({16, 3, 3}, {120, 9, 9});
  add_volume_region(mesh, "chamber", [](const Vec3& p) {
    return p.x() > 6 && p.x() < 114 && p.y() > 3 && p.y() < 6 && p.z() > 3 && p.z() < 6;
  });
  add_volume_region(mesh, "sole", [](const Vec3& p) { return p.z() < 3; });
  RobotSpec spec = physical_robot(std::move(mesh));
  MaterialSpec sole = spec.materials[0];
  sole.region = "sole";
  sole.elastic = elastic(Law::neo_hookean, 20, 0.4);
  spec.materials.push_back(sole);
  spec.mesh_options.quadratic = true;
  spec.actuators = {air("chamber")};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// A strip whose upper half is a layer of dielectric elastomer.
inline RobotSpec dea_strip() {
  Mesh mesh = block_mesh({12, 2, 2}, {40, 6, 2}, Split::prisms);
  add_volume_region(mesh, "layer", [](const Vec3& p) { return p.z() > 1; });
  RobotSpec spec = physical_robot(std::move(mesh));
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "layer"}, 0.3, 3, true);
  spec.actuators = {skin};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// Chambers by volume and by pressure, tendons by length and by tension, weight, a displaced support, a rigid end and a
/// rigid patch.
inline RobotSpec crowded_robot() {
  RobotSpec spec = chambers_beam(3);
  spec.actuators[1] = by_load(spec.actuators[1]);
  spec.actuators.push_back(cable("tendon", {{0, 10, 19}, {24, 10, 19}, {48, 10, 19}}));
  spec.actuators.push_back(by_load(cable("rope", {{0, 1, 10}, {24, 1, 10}, {48, 1, 10}})));
  spec.materials[0].density = 1200;
  spec.loads.gravity = {0, 0, -9.81};
  spec.loads.forces.push_back({"payload", {std::string("x_high"), {}}, {0, 0.01, -0.02}});
  spec.rigid.push_back({{Box{{42, 0, 0}, {48, 20, 20}}, {}}, "end"});
  spec.rigid.push_back({{Box{{18, 0, 20}, {30, 20, 20}}, {}}, "patch"});
  spec.fixed[0].displacement = {0, 0, 2};
  return spec;
}

}  // namespace softkin::testing
