#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/scene/scene.hpp>

namespace softkin {

RobotSpec read_scene(const std::filesystem::path& path) {
  return parse_scene(read_file(path), path.string(), {read_mesh, read_stl, read_sidecar});
}

}  // namespace softkin
