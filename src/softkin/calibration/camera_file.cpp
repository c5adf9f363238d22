#include <array>
#include <cmath>
#include <cstdlib>
#include <softkin/calibration/camera.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scene/tree.hpp>
#include <sstream>
#include <vector>

namespace softkin {

namespace {

using scene::Node;

struct Key {
  const char* name;
  double* value;
  double low, high;
};

double number_in(const Node& node, double low, double high) {
  char* end = nullptr;
  const double value = node.kind == Node::Kind::scalar && node.plain ? std::strtod(node.text.c_str(), &end) : NAN;
  if (end == nullptr || *end != '\0' || end == node.text.c_str() || !(value >= low && value <= high)) {
    std::ostringstream message;
    message << node.name << " must be a number from " << low << " to " << high;
    throw InvalidInput(node.origin, message.str());
  }
  return value;
}

void read_keys(const Node& node, const std::vector<Key>& keys) {
  if (node.kind != Node::Kind::map) throw InvalidInput(node.origin, node.name + " must be a map of numbers");
  std::vector<std::string> names;
  for (const Key& key : keys) names.emplace_back(key.name);
  for (const Node::Entry& entry : node.entries) {
    std::size_t i = 0;
    while (i < keys.size() && entry.key != keys[i].name) ++i;
    if (i == keys.size())
      throw InvalidInput(entry.origin, "unknown key '" + entry.key + "'" + suggest_name(entry.key, names));
    *keys[i].value = number_in(*entry.value, keys[i].low, keys[i].high);
  }
  for (const Key& key : keys) {
    bool given = false;
    for (const Node::Entry& entry : node.entries) given = given || entry.key == key.name;
    if (!given) throw InvalidInput(node.origin, std::string("'") + key.name + "' is missing in " + node.name);
  }
}

void check_folding(const Camera& camera, const std::string& file) {
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) {
      const Vec2 seen(i / 16.0 * (camera.width - 1), j / 16.0 * (camera.height - 1));
      const Vec2 back = distorted(camera, undistorted(camera, seen));
      if (!((back - seen).norm() < 1e-3))
        throw InvalidInput({file},
                           "the distortion folds the picture over itself near a corner; take pictures of the "
                           "board nearer to the corners and find the camera again");
    }
}

}  // namespace

std::string camera_text(const Camera& camera) {
  std::ostringstream text;
  text.precision(10);
  text << "# made by softkin measure camera; lengths in pixels, distortion without unit\n"
       << "softkin_camera: 1\n"
       << "picture: {width: " << camera.width << ", height: " << camera.height << "}\n"
       << "matrix: {fx: " << camera.fx << ", fy: " << camera.fy << ", cx: " << camera.cx << ", cy: " << camera.cy
       << "}\n"
       << "distortion: {k1: " << camera.k1 << ", k2: " << camera.k2 << ", p1: " << camera.p1 << ", p2: " << camera.p2
       << ", k3: " << camera.k3 << "}\n"
       << "quality: {reprojection_error: " << camera.reprojection_error << ", focal_error: " << camera.focal_error
       << ", pictures: " << camera.pictures << "}\n";
  return text.str();
}

Camera read_camera(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::shared_ptr<const Node> root = scene::parse_yaml(read_file(path), file);
  if (root->kind != Node::Kind::map) throw InvalidInput({file}, "not a camera file");
  Camera camera;
  double version = 0, width = 0, height = 0, pictures = 0;
  struct Group {
    std::string name;
    std::vector<Key> keys;  // empty: the version
    bool given = false;
  };
  std::array<Group, 5> groups{Group{"softkin_camera", {}},
                              Group{"picture", {{"width", &width, 16, 1e5}, {"height", &height, 16, 1e5}}},
                              Group{"matrix",
                                    {{"fx", &camera.fx, 1, 1e7},
                                     {"fy", &camera.fy, 1, 1e7},
                                     {"cx", &camera.cx, -1e6, 1e6},
                                     {"cy", &camera.cy, -1e6, 1e6}}},
                              Group{"distortion",
                                    {{"k1", &camera.k1, -100, 100},
                                     {"k2", &camera.k2, -1e4, 1e4},
                                     {"p1", &camera.p1, -1, 1},
                                     {"p2", &camera.p2, -1, 1},
                                     {"k3", &camera.k3, -1e6, 1e6}}},
                              Group{"quality",
                                    {{"reprojection_error", &camera.reprojection_error, 0, 1e6},
                                     {"focal_error", &camera.focal_error, 0, 1e7},
                                     {"pictures", &pictures, 0, 1e6}}}};
  for (const Node::Entry& entry : root->entries) {
    std::vector<std::string> names;
    bool known = false;
    for (Group& group : groups) {
      names.push_back(group.name);
      if (group.name != entry.key) continue;
      known = group.given = true;
      if (group.keys.empty())
        version = number_in(*entry.value, 1, 1);
      else
        read_keys(*entry.value, group.keys);
    }
    if (!known) throw InvalidInput(entry.origin, "unknown key '" + entry.key + "'" + suggest_name(entry.key, names));
  }
  for (const Group& group : groups)
    if (!group.given) throw InvalidInput({file}, "not a camera file: '" + group.name + "' is missing");
  if (version != 1 || width != std::floor(width) || height != std::floor(height))
    throw InvalidInput({file}, "width and height of a picture are whole numbers of pixels");
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  camera.pictures = static_cast<int>(pictures);
  check_folding(camera, file);
  return camera;
}

}  // namespace softkin
