#pragma once

#include <filesystem>
#include <functional>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/scene/scene_file.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/io/table/field_samples.hpp>
#include <softkin/io/table/path_table.hpp>
#include <softkin/model/robot_spec.hpp>
#include <string>
#include <vector>

namespace softkin {

namespace scene {
struct Node;
}

/// Reads a scene (YAML, docs/scene.md) and the files that it names, relative to it. Lengths become mm.
/// throws  InvalidInput naming file and line; unknown keys are errors with the nearest valid name
[[nodiscard]] RobotSpec read_scene(const std::filesystem::path& path);

/// How the files that a scene names are read; lengths in the file's unit.
struct SceneFiles {
  std::function<Mesh(const std::filesystem::path&)> mesh;                // of `mesh`
  std::function<TriangleSurface(const std::filesystem::path&)> surface;  // of chambers, obstacles and other surfaces
  std::function<Sidecar(const std::filesystem::path&)> sidecar;          // of regions beside a mesh
  std::function<ActuatorCurve(const std::filesystem::path&)> curve = read_actuator_curve;  // of actuators
  std::function<std::string(const std::filesystem::path&)> scene = read_scene_file;  // the text of one of `robots`
  std::function<FieldSamples(const std::filesystem::path&)> samples = read_field_samples;  // of fields
  std::function<Points(const std::filesystem::path&)> route = read_path;                   // corners [mm]
  std::function<FieldSamples(const std::filesystem::path&)> directions = read_directions;  // of fibres and growths
};

/// As read_scene, from a text in memory. file_name is for messages; the paths given to `files` are relative to its
/// folder. An InvalidInput of `files` is passed on with the line of the scene that names the file.
[[nodiscard]] RobotSpec parse_scene(const std::string& yaml_text, const std::string& file_name,
                                    const SceneFiles& files);

/// The same of a scene that was not written as a text: the keys and values of docs/scene.md as a tree.
[[nodiscard]] RobotSpec parse_scene(const scene::Node& root, const std::string& file_name, const SceneFiles& files);

/// A scene, and what the user changes in it.
struct RequestedScene {
  std::string scene;                     // file
  std::string formulation;               // "physical" or "target-shape"; empty: the scene's
  std::vector<std::string> forces;       // NAME=FX,FY,FZ [N]
  std::vector<std::string> materials{};  // REGION.KEY=VALUE, of the scene's materials
  std::vector<std::string> changes{};    // PATH=VALUE, of anything in the scene (changes.hpp)
};

/// inputs  the files that the scene names are added
/// throws  InvalidInput naming --force, --material or --change, or file and line
[[nodiscard]] RobotSpec read_requested_scene(const RequestedScene& requested,
                                             std::vector<std::filesystem::path>& inputs);

/// Applies the changes of the user to a description: all of `requested` but the scene.
///
/// option  that gives the forces, for messages
/// throws  InvalidInput naming it
void change(RobotSpec& spec, const RequestedScene& requested, const std::string& option = "--force");

}  // namespace softkin
