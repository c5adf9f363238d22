#include <array>
#include <cmath>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/vision/camera.hpp>
#include <sstream>
#include <utility>

namespace softkin::vision {

namespace {

using scene::Node;

/// A number in the file, its range and where it belongs.
struct Key {
  std::string name;
  double low, high;
  double* value;
};

struct Group {
  std::string name;
  std::vector<Key> keys;
  bool given = false;
};

/// The file's groups. whole: width, height and number of pictures.
std::vector<Group> groups_of(Camera& camera, std::array<double, 3>& whole) {
  return {{"picture", {{"width", 16, 1e5, &whole[0]}, {"height", 16, 1e5, &whole[1]}}},
          {"matrix",
           {{"fx", 1, 1e7, &camera.fx},
            {"fy", 1, 1e7, &camera.fy},
            {"cx", -1e6, 1e6, &camera.cx},
            {"cy", -1e6, 1e6, &camera.cy}}},
          {"distortion",
           {{"k1", -100, 100, &camera.k1},
            {"k2", -1e4, 1e4, &camera.k2},
            {"p1", -1, 1, &camera.p1},
            {"p2", -1, 1, &camera.p2},
            {"k3", -1e6, 1e6, &camera.k3}}},
          {"quality",
           {{"reprojection_error", 0, 1e6, &camera.reprojection_error},
            {"focal_error", 0, 1e7, &camera.focal_error},
            {"pictures", 0, 1e6, &whole[2]}}}};
}

void read_number(const Node& node, const Key& key) {
  if (node.kind == Node::Kind::scalar && node.plain && parse_real(node.text, *key.value) && *key.value >= key.low &&
      *key.value <= key.high)
    return;
  std::ostringstream message;
  message << node.name << " must be a number from " << key.low << " to " << key.high;
  throw InvalidInput(node.origin, message.str());
}

/// The one of this name. Throws InvalidInput where there is none.
template <class Named>
Named& named(std::vector<Named>& known, const Node::Entry& entry) {
  std::vector<std::string> names;
  for (Named& each : known) {
    if (each.name == entry.key) return each;
    names.push_back(each.name);
  }
  throw InvalidInput(entry.origin, "unknown key '" + entry.key + "'" + suggest_name(entry.key, names));
}

void read_group(const Node& node, std::vector<Key>& keys) {
  if (node.kind != Node::Kind::map) throw InvalidInput(node.origin, node.name + " must be a map of numbers");
  for (const Key& key : keys) *key.value = NAN;
  for (const Node::Entry& entry : node.entries) read_number(*entry.value, named(keys, entry));
  for (const Key& key : keys)
    if (std::isnan(*key.value)) throw InvalidInput(node.origin, "'" + key.name + "' is missing in " + node.name);
}

void check_folding(const Camera& camera, const std::string& file) {
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) {
      const Vec2 seen(i / 16.0 * (camera.width - 1), j / 16.0 * (camera.height - 1));
      if (!((distorted(camera, undistorted(camera, seen)) - seen).norm() < 1e-3))
        throw InvalidInput({file},
                           "the distortion folds the picture over itself near a corner; take pictures of the "
                           "board nearer to the corners and find the camera again");
    }
}

}  // namespace

std::string camera_text(const Camera& camera) {
  Camera copy = camera;
  std::array<double, 3> whole{double(camera.width), double(camera.height), double(camera.pictures)};
  std::ostringstream text;
  text.precision(10);
  text << "# made by softkin measure camera; lengths in pixels, distortion without unit\nsoftkin_camera: 1\n";
  for (const Group& group : groups_of(copy, whole)) {
    const char* before = ": {";
    text << group.name;
    for (const Key& key : group.keys) text << std::exchange(before, ", ") << key.name << ": " << *key.value;
    text << "}\n";
  }
  return text.str();
}

Camera read_camera(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::shared_ptr<const Node> root = scene::parse_yaml(read_file(path), file);
  if (root->kind != Node::Kind::map) throw InvalidInput({file}, "not a camera file");
  Camera camera;
  double version = 0;
  std::array<double, 3> whole{};
  std::vector<Group> groups = groups_of(camera, whole);
  groups.insert(groups.begin(), {"softkin_camera", {{"", 1, 1, &version}}});
  for (const Node::Entry& entry : root->entries) {
    Group& group = named(groups, entry);
    group.given = true;
    if (&group == &groups[0])
      read_number(*entry.value, group.keys[0]);
    else
      read_group(*entry.value, group.keys);
  }
  for (const Group& group : groups)
    if (!group.given) throw InvalidInput({file}, "not a camera file: '" + group.name + "' is missing");
  if (whole[0] != std::floor(whole[0]) || whole[1] != std::floor(whole[1]))
    throw InvalidInput({file}, "width and height of a picture are whole numbers of pixels");
  camera.width = static_cast<int>(whole[0]);
  camera.height = static_cast<int>(whole[1]);
  camera.pictures = static_cast<int>(whole[2]);
  check_folding(camera, file);
  return camera;
}

}  // namespace softkin::vision
