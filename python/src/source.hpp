#pragma once

#include <softkin/io/scene/scene.hpp>
#include <softkin/io/scene/tree.hpp>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace softkin::python {

/// A measured curve as plain data.
struct CurveData {
  struct Line {
    std::vector<double> x, y, spread;
  };
  std::string file, end;
  CurveInput input = CurveInput::pressure;
  double atmosphere_kPa = 100;
  Line loading;
  std::optional<Line> unloading;
};

/// All that a robot is made of: its description, what the user changed in it, and what the files it names held when it
/// was made. Plain data, so that it pickles; the robot is compiled from it again.
struct Source {
  std::string name;                         // file of the scene, or what a robot from memory is called
  std::shared_ptr<const scene::Node> tree;  // the description
  std::string formulation;                  // empty: the scene's
  std::vector<std::string> forces;          // NAME=FX,FY,FZ
  std::map<std::string, Mesh> meshes;       // by the path that names them
  std::map<std::string, TriangleSurface> surfaces;
  std::map<std::string, Sidecar> sidecars;
  std::map<std::string, CurveData> curves;
  std::map<std::string, std::string> scenes;  // texts of those that the scene's `robots` name
  std::map<std::string, FieldSamples> samples;

  /// The description with its files: those known here, and where `read` is set, others from disk, which are kept here.
  ///
  /// throws  InvalidInput as parse_scene
  [[nodiscard]] RobotSpec spec(bool read);
};

/// The path by which a description that was not read from a file names its mesh.
inline constexpr const char* mesh_in_memory = "the mesh";

[[nodiscard]] std::string pickled(const Source& source);
[[nodiscard]] Source unpickled(std::string_view bytes);

}  // namespace softkin::python
