#pragma once

#include <filesystem>
#include <softkin/model/robot_spec.hpp>

namespace softkin {

/// Reads a scene (YAML, docs/scene.md) and the files that it names, relative to it. Lengths become mm.
/// throws  InvalidInput naming file and line; unknown keys are errors with the nearest valid name
[[nodiscard]] RobotSpec read_scene(const std::filesystem::path& path);

}  // namespace softkin
