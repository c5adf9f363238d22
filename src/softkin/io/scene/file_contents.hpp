#pragma once

#include <map>
#include <softkin/io/scene/scene.hpp>

namespace softkin {

/// What the files that a scene names hold, by the path that names them.
struct FileContents {
  std::map<std::string, Mesh> meshes{};
  std::map<std::string, TriangleSurface> surfaces{};
  std::map<std::string, Sidecar> sidecars{};
  std::map<std::string, ActuatorCurve> curves{};
  std::map<std::string, std::string> scenes{};  // texts of those that the scene's `robots` name
  std::map<std::string, FieldSamples> samples{};
  std::map<std::string, Points> ways{};
  std::map<std::string, FieldSamples> directions{};

  /// How a scene takes them from here. For one thread at a time; *this must outlive what is returned.
  ///
  /// read  files that are not here are read from disk, and kept; else they are refused
  [[nodiscard]] SceneFiles kept(bool read);
  [[nodiscard]] std::vector<std::filesystem::path> paths() const;
};

}  // namespace softkin
