#pragma once

#include <optional>
#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <softkin/model/mesh/shells.hpp>
#include <string>
#include <vector>

namespace softkin {

/// Is the path that of a scene (.yaml, .yml)?
[[nodiscard]] bool is_scene(const std::string& path);

/// A mesh's sizes with curved edges: with those that it brings, or with those that `curve` would give it.
struct CurvedInfo {
  enum class Of { mesh, scene, smooth };
  Of of = Of::mesh;  // the mesh's own edges, those of the scene's `curve`, those of `curve: true`
  CurvedEdges done;  // but for the mesh's own
  CurvedMeasures measures;
};

/// A mesh's file and what it holds.
struct MeshInfo {
  std::string file, unit;  // of the file's lengths: "mm"
  MeshMeasures measures;
  std::vector<EmptySpace> empty_spaces;  // that the elements enclose
  std::optional<CurvedInfo> curved{};    // none: of prisms, or nothing would curve
  std::vector<std::string> warnings{};   // a sentence each
};

/// file    a mesh, or a scene, whose mesh it is then, or its meshes as one
/// unit    of a mesh; a scene has its own
/// throws  InvalidInput; also where coordinates are so large that volumes would overflow
[[nodiscard]] MeshInfo mesh_info(const std::string& file, const std::string& unit);

/// The verdict of compile() on a scene.
struct SceneVerdict {
  std::vector<std::string> warnings, notes;
  std::optional<std::string> error;
  bool accepts_errors = false;  // of the mesh
};

/// Whether a mesh can be used, and what to look at.
struct MeshVerdict {
  std::string file;
  int order = 1;
  std::size_t vertices = 0, tetrahedra = 0, prisms = 0;
  std::vector<MeshFinding> findings;
  std::vector<PartMeasures> parts;
  std::vector<EmptySpace> empty_spaces;  // that the elements enclose; of a scene that compiles those of the body
  std::optional<SceneVerdict> scene;
  std::vector<std::string> warnings{};  // a sentence each
  std::string no_volume{};              // what to do where a mesh alone has no volume element; "": it has, or a scene
                                        // defines it

  [[nodiscard]] bool usable() const;
  /// Does the scene compile in spite of the mesh's errors?
  [[nodiscard]] bool errors_accepted() const;
};

/// file: a mesh with lengths in unit, or a scene, which names its own.
/// throws  InvalidInput as mesh_info
[[nodiscard]] MeshVerdict mesh_verdict(const std::string& file, const std::string& unit);

/// What a written file holds, read from it, not from what was meant to be written.
struct MeshConversion {
  std::string input, output;
  int order = 1;
  std::size_t vertices = 0, tetrahedra = 0, prisms = 0, facets = 0;  // facets: of an .stl
  std::vector<std::string> regions{}, not_kept{};
  std::vector<std::string> warnings{};  // a sentence each
};

/// Writes the mesh in the form that output's extension names. ascii: a .msh as text. Throws InvalidInput.
[[nodiscard]] MeshConversion convert_mesh(const std::string& input, const std::string& output, bool ascii);

/// "24 tetrahedra of order 2"
[[nodiscard]] std::string tetrahedra_text(std::size_t count, int order);
[[nodiscard]] const char* name_of(MeshSeverity severity);

// As JSON, whose keys name the units.
[[nodiscard]] std::string to_json(const MeshInfo& info);
[[nodiscard]] std::string to_json(const MeshVerdict& verdict);
[[nodiscard]] std::string to_json(const MeshConversion& conversion);

}  // namespace softkin
