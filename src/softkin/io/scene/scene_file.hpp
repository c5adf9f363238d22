#pragma once

#include <filesystem>
#include <string>

namespace softkin {

/// The text of a scene's file.
///
/// throws  InvalidInput: the file cannot be read, or its name is that of a mesh, a surface or a result, with what a
///         scene is and how to get one
[[nodiscard]] std::string read_scene_file(const std::filesystem::path& path);

}  // namespace softkin
