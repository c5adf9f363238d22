#pragma once

#include <softkin/model/mesh/mesh.hpp>
#include <string>

namespace softkin::cli {

struct MeshOptions {
  std::string input;   // a mesh; for check also a scene
  std::string output;  // convert
  std::string unit = "mm";
  bool json = false, ascii = false;
};

/// Is the path that of a scene (.yaml, .yml)?
[[nodiscard]] bool is_scene(const std::string& path);

/// Throws InvalidInput where coordinates [mm] are so large that volumes would overflow.
void refuse_huge(const Mesh& mesh, const std::string& file);

/// The mesh in mm. Throws InvalidInput.
[[nodiscard]] Mesh read_mesh_in_mm(const MeshOptions& options);

// The commands, after their options have been checked. Return the exit code; throw InvalidInput.
[[nodiscard]] int mesh_info(const MeshOptions& options);
[[nodiscard]] int mesh_check(const MeshOptions& options);
[[nodiscard]] int mesh_convert(const MeshOptions& options);

}  // namespace softkin::cli
