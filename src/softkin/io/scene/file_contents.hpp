#pragma once

#include <map>
#include <softkin/io/scene/scene.hpp>

namespace softkin {

/// What the files that a scene names hold, by the path that names them.
struct FileContents {
  std::map<std::string, Mesh> meshes{};               // of `mesh`
  std::map<std::string, TriangleSurface> surfaces{};  // of chambers, obstacles and other surfaces
  std::map<std::string, Sidecar> sidecars{};          // of regions beside a mesh
  std::map<std::string, ActuatorCurve> curves{};      // of actuators
  std::map<std::string, std::string> scenes{};        // texts of those that the scene's `robots` name
  std::map<std::string, FieldSamples> samples{};      // of magnetic fields
  std::map<std::string, Points> routes{};             // of threads and curves [mm]
  std::map<std::string, FieldSamples> directions{};   // of fibres and growths

  /// How a scene takes them from here. For one thread at a time; *this must outlive what is returned.
  ///
  /// read  files that are not here are read from disk, and kept; else they are refused
  [[nodiscard]] SceneFiles kept(bool read);
  [[nodiscard]] std::vector<std::filesystem::path> paths() const;
};

}  // namespace softkin
