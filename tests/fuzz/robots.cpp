#include <softkin/io/scene/scene.hpp>

#include "fuzz/targets.hpp"
#include "model/block_mesh.hpp"

namespace softkin::fuzz {

namespace {

ActuatorCurve small_curve(CurveInput input) {
  const CurveBranch up{MonotoneCurve({0, 2, 5}, {1, 1.1, 1.4}), {0.01, 0.02, 0.02}};
  const CurveBranch down{MonotoneCurve({0, 2, 5}, {1.05, 1.2, 1.4}), {}};
  return {"curve.yaml", input, 101, "pull-in", up, down};
}

Model robot(const std::string& scene, const Mesh& mesh, CurveInput input) {
  SceneFiles files;
  files.mesh = [&mesh](const std::filesystem::path&) { return mesh; };
  files.curve = [input](const std::filesystem::path&) { return small_curve(input); };
  return compile(parse_scene(scene, "robot.yaml", files));
}

}  // namespace

const Model& finger() {
  static const Model model = robot(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, linear_range: 0.05}]\n"
      "fixed: [{region: x_low}]\n"
      "actuators:\n"
      "  - {name: air, kind: pneumatic, region: chamber, control: volume, range: [0.5, 3], curve: curve.yaml}\n"
      "  - {name: tendon, kind: cable, points: [[0, 15, 30], [30, 15, 30]], control: tension, range: [0, 20]}\n"
      "markers: [{name: tip, region: x_high}, {name: corner, point: [30, 30, 30]}]\n",
      testing::hollow_mesh(), CurveInput::pressure);
  return model;
}

const Model& sheet() {
  static const Model model = robot(
      "softkin: 1\nmesh: {file: sheet.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{region: x_low}]\n"
      "actuators:\n"
      "  - {name: skin, kind: dea, region: body, range: [0.9, 1.4], prestretch: 1, curve: curve.yaml}\n"
      "markers: [{name: tip, region: x_high}]\n",
      testing::block_mesh({2, 1, 1}, {20, 10, 1}, testing::Split::prisms), CurveInput::voltage);
  return model;
}

}  // namespace softkin::fuzz
