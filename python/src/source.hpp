#pragma once

#include <softkin/io/scene/file_contents.hpp>
#include <softkin/io/scene/tree.hpp>

#include <memory>
#include <string>
#include <vector>

namespace softkin::python {

/// All that a robot is made of: its description, what the user changed in it, and what the files it names held when it
/// was made. Plain data, so that it pickles; the robot is compiled from it again.
struct Source {
  std::string name;                         // file of the scene, or what a robot from memory is called
  std::shared_ptr<const scene::Node> tree;  // the description
  std::string formulation;                  // empty: the scene's
  std::vector<std::string> forces;          // NAME=FX,FY,FZ
  FileContents files{};

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
