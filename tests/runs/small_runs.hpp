#pragma once

#include <cmath>
#include <fstream>
#include <softkin/io/scene/scene.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/jobs.hpp>
#include <string>

#include "cli/fk_samples.hpp"

namespace softkin::runs::testing {

using softkin::testing::Block;
using softkin::testing::TemporaryFolder;

/// A robot whose mesh is a block.
inline Model block_model(const std::string& scene, int cells = 3) {
  const TemporaryFolder folder;
  folder.write("block.msh", Block(cells).mesh.text());
  return compile(read_scene(folder.write("block.yaml", scene)));
}

inline Model bending_model() {
  return block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, linear_range: 0.05}]\n"
      "fixed: [{region: base}]\n"
      "actuators:\n"
      "  - {name: air, kind: pneumatic, region: chamber, control: volume, range: [0.5, 3]}\n"
      "  - {name: tendon, kind: cable, points: [[0, 6, 12], [12, 6, 12]], control: length, range: [0.5, 1.2]}\n"
      "markers: [{name: tip, region: tip}, {name: corner, point: [12, 12, 12]}]\n");
}

/// Target shapes know no pressures.
inline Model swelling_model() {
  return block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{region: body, shape_ratio: 1.0}]\nfixed: [{region: base}]\n"
      "actuators: [{name: air, kind: pneumatic, region: chamber, range: [1.0, 2.0]}]\n"
      "markers: [{name: tip, region: tip}]\n");
}

inline Model walking_model() {
  return block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{region: base}, {region: tip, axes: yz}]\n"
      "actuators: [{name: tendon, kind: cable, points: [[0, 6, 6], [12, 6, 6]], control: tension, range: [0, 5]}]\n"
      "markers: [{name: heel, region: base}, {name: toe, region: tip}]\n"
      "feet: [{marker: heel, forward: 0.02, backward: 9}, {marker: toe, forward: 0.02, backward: 9}]\n");
}

/// A block that its support pushes 0.5 mm down onto a floor at that height.
inline Model leaning_model(double height) {
  return block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{region: base}]\nforces: [{name: load, region: tip, force: [0, 0, -1]}]\n"
      "markers: [{name: tip, region: tip}]\n"
      "contact: {distance: 0.1}\n"
      "obstacles: [{name: floor, halfspace: {point: [0, 0, " +
      std::to_string(height) + "], normal: [0, 0, 1]}}]\n");
}

/// Returns a path through the ranges that does not return to its start.
inline std::vector<ActuationStep> steps_of(const Model& model, std::size_t count) {
  std::vector<ActuationStep> steps;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i);
    ActuationStep step{model.rest_actuation(), 0.1 * t, i + 2};
    step.actuation[0] += 0.1 * (1 - std::cos(0.31 * t));
    if (step.actuation.size() > 1) step.actuation[1] -= 0.1 * (1 - std::cos(0.23 * t));
    steps.push_back(std::move(step));
  }
  return steps;
}

inline StaticsOptions one_thread() {
  StaticsOptions options;
  options.threads = 1;
  return options;
}

/// The tip along x and z where the steps lead it.
inline MarkerPath path_through(const Model& model, const std::vector<ActuationStep>& steps) {
  const Statics statics(model);
  State state = statics.rest();
  MarkerPath path{{0}, {{true, false, true}}, {}};
  for (const ActuationStep& step : steps) {
    state = statics.solve(step.actuation, state, one_thread()).state;
    Vec3 target = model.markers[0].point.at(state.positions);
    target[1] = 0;
    path.waypoints.push_back({{target}, step.time, step.line, false});
  }
  return path;
}

}  // namespace softkin::runs::testing
