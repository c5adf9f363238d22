#include <softkin/core/error.hpp>
#include <softkin/io/scene/file_contents.hpp>

namespace softkin {

SceneFiles FileContents::kept(bool read) {
  using Path = std::filesystem::path;
  const auto of = [read](auto& known, const auto& reader) {
    return [&known, read, reader](const Path& path) {
      const auto found = known.find(path.string());
      if (found != known.end()) return found->second;
      if (!read) throw InvalidInput({path.string()}, "the robot was made without this file");
      return known.emplace(path.string(), reader(path)).first->second;
    };
  };
  return {of(meshes, read_mesh),           of(surfaces, read_surface),     of(sidecars, read_sidecar),
          of(curves, read_actuator_curve), of(scenes, read_scene_file),    of(samples, read_field_samples),
          of(routes, read_path),           of(directions, read_directions)};
}

std::vector<std::filesystem::path> FileContents::paths() const {
  std::vector<std::filesystem::path> all;
  const auto add = [&all](const auto& known) {
    for (const auto& [path, content] : known) all.emplace_back(path);
  };
  add(meshes), add(surfaces), add(sidecars), add(curves), add(scenes), add(samples), add(routes), add(directions);
  return all;
}

}  // namespace softkin
