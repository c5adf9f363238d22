#include <set>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/asked_scene.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>

namespace softkin {

namespace fs = std::filesystem;

namespace {

RobotSpec read_scene_and(std::vector<fs::path>& inputs, const std::string& scene) {
  const auto noting = [&inputs](auto read) {
    return [&inputs, read](const fs::path& path) {
      inputs.push_back(path);
      return read(path);
    };
  };
  return parse_scene(read_file(scene), scene,
                     {noting(read_mesh), noting(read_stl), noting(read_sidecar), noting(read_actuator_curve)});
}

bool parse_vector(const std::string& text, Vec3& vector) {
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos || !parse_real(text.substr(begin, end - begin), vector[axis])) return false;
    begin = end + 1;
  }
  return true;
}

ForceSpec* find_force(RobotSpec& spec, const std::string& name) {
  for (ForceSpec& force : spec.forces)
    if (force.name == name) return &force;
  return nullptr;
}

std::string unknown_force(const RobotSpec& spec, const std::string& name) {
  std::vector<std::string> names;
  for (const ForceSpec& force : spec.forces) names.push_back(force.name);
  return "no force " + excerpt(name) + (names.empty() ? "; the scene has none" : suggest_name(name, names));
}

void change_forces(RobotSpec& spec, const std::vector<std::string>& forces) {
  std::set<std::string> changed;
  for (const std::string& force : forces) {
    const auto refuse = [&](const std::string& why) { throw InvalidInput("--force " + excerpt(force) + ": " + why); };
    if (spec.formulation != Formulation::physical)
      refuse("the target-shape formulation knows no forces; the physical one does (--formulation physical)");
    const std::size_t equals = force.find('=');
    if (equals == std::string::npos) refuse("expected NAME=FX,FY,FZ in N, for example --force payload=0,0,-0.5");
    const std::string name = force.substr(0, equals), text = force.substr(equals + 1);
    ForceSpec* found = find_force(spec, name);
    if (found == nullptr) refuse(unknown_force(spec, name));
    if (!parse_vector(text, found->force))
      refuse("the force must be three finite numbers in N, FX,FY,FZ, not " + excerpt(text));
    if (!changed.insert(name).second) refuse("force '" + name + "' is given twice");
  }
}

}  // namespace

RobotSpec read_asked_scene(const AskedScene& asked, std::vector<fs::path>& inputs) {
  RobotSpec spec = read_scene_and(inputs, asked.scene);
  if (asked.formulation == "physical") spec.formulation = Formulation::physical;
  if (asked.formulation == "target-shape") spec.formulation = Formulation::target_shape;
  change_forces(spec, asked.forces);
  return spec;
}

}  // namespace softkin
