#include <algorithm>
#include <iterator>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/scene/scene_file.hpp>

namespace softkin {

namespace {

struct OtherKind {
  const char *extension, *what, *cure;
};

constexpr const char *make_mesh = "'python -m softkin mesh generate' makes a mesh and a scene of it",
                     *name_mesh = "write a scene that names it, 'mesh: {file: ...}' (docs/scene.md)",
                     *give_scene = "give the scene that it is of (docs/scene.md)";

constexpr OtherKind other_kinds[] = {{".stl", "a surface", make_mesh},
                                     {".obj", "a surface", make_mesh},
                                     {".ply", "a surface", make_mesh},
                                     {".off", "a surface", make_mesh},
                                     {".step", "a CAD model", make_mesh},
                                     {".stp", "a CAD model", make_mesh},
                                     {".iges", "a CAD model", make_mesh},
                                     {".igs", "a CAD model", make_mesh},
                                     {".brep", "a CAD model", make_mesh},
                                     {".geo", "a Gmsh model", make_mesh},
                                     {".pvd", "a series of shapes", give_scene},
                                     {".skmap", "a kinematic map", give_scene},
                                     {".csv", "a table", give_scene},
                                     {".json", "a report", give_scene},
                                     {".png", "a picture", give_scene},
                                     {".svg", "a plot", give_scene},
                                     {".html", "a page", give_scene},
                                     {".zip", "an archive", give_scene},
                                     {".gz", "an archive", give_scene},
                                     {".py", "a program", give_scene}};

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what, const std::string& cure) {
  throw InvalidInput({path.string()}, "is " + what + " by its name, not a scene in YAML: " + cure);
}

}  // namespace

std::string read_scene_file(const std::filesystem::path& path) {
  (void)read_beginning(path, 1);  // reports first whether it is there
  const std::string extension = lower_extension(path);
  const auto other = std::find_if(std::begin(other_kinds), std::end(other_kinds),
                                  [&](const OtherKind& kind) { return kind.extension == extension; });
  if (other != std::end(other_kinds)) refuse(path, other->what, other->cure);
  if (!mesh_form(path).empty()) refuse(path, "a mesh", name_mesh);
  return read_file(path);
}

}  // namespace softkin
