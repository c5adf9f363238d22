#pragma once

#include <string>
#include <string_view>

namespace softkin {

/// What a file is, as its content shows.
enum class FileForm {
  unknown,
  stl,
  obj,
  ply,
  off,
  gmsh,
  vtk_legacy,
  vtk_xml,
  medit,
  abaqus,
  step,
  iges,
  brep,
  gltf,
  collada,
  threemf,
  vrml,
  amf,
  febio,
  hdf5,
  fbx,
  zip,
  picture
};

/// By its first bytes; of a binary STL by its size.
[[nodiscard]] FileForm form_of_content(std::string_view content);

/// "a Gmsh mesh", for messages.
[[nodiscard]] const char* words_of(FileForm form);

}  // namespace softkin
