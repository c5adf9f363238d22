#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/model/joined.hpp>

namespace softkin::scene {

namespace {

/// A label that regions, markers and actuators begin with.
const std::string& read_robot_name(const Node& node, Names& names) {
  const std::string& name = names.add_label(node);
  if (name.find('.') != std::string::npos)
    fail(node,
         "the name " + excerpt(name) + " must not hold a '.', which parts a robot's name from those of its parts");
  if (name == "all" || name == "robot")
    fail(node, "the name " + excerpt(name) + " is reserved: it stands for all of the robots");
  return name;
}

Placement read_placement(const Context& context, const Node& node) {
  const Map map(node, {"rotate", "quaternion", "translate"});
  Placement place;
  if (map.find("rotate") != nullptr && map.find("quaternion") != nullptr) (void)map.one_of({"rotate", "quaternion"});
  if (const Node* rotate = map.find("rotate")) {
    const RigidMotion motion = read_rotations(context, *rotate);
    place = {motion.rotation, motion.translation};
  }
  if (const Node* quaternion = map.find("quaternion")) place.rotation = read_quaternion(*quaternion);
  if (const Node* move = map.find("translate")) place.translation += read_position(context, *move);
  return place;
}

RobotSpec read_robot_scene(const Context& context, const Node& file, const std::string& name) {
  const std::filesystem::path path = context.folder / text(file);
  try {
    const auto root = parse_yaml(context.files.scene(path), path.string());
    for (const Node::Entry& entry : root->entries)
      if (entry.key == "robots")
        throw InvalidInput(entry.origin,
                           "a robot among several cannot be several robots itself: name the scenes of these");
    return parse_scene(*root, path.string(), context.files);
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.origin, "robot '" + name + "': " + error.what());
  }
}

PlacedRobot read_robot(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "scene", "place"});
  PlacedRobot placed;
  placed.name = read_robot_name(map.at("name"), names);
  placed.origin = node.origin;
  if (const Node* place = map.find("place")) placed.place = read_placement(context, *place);
  placed.robot = read_robot_scene(context, map.at("scene"), placed.name);
  return placed;
}

}  // namespace

RobotSpec read_robots(const Context& context, const Map& scene, const std::string& file_name) {
  CommonSpec common;
  common.name = file_name;
  if (const Node* node = scene.find("formulation")) common.formulation = read_formulation(*node);
  if (const Node* node = scene.find("weights")) common.weights = read_weights(*node);
  if (const Node::Entry* gravity = scene.entry("gravity")) {
    common.gravity = read_vector(*gravity->value);
    common.gravity_origin = gravity->origin;
  }
  const Node& several = scene.at("robots");
  if (list(several).empty()) fail(several, "'robots' is empty");
  std::vector<PlacedRobot> robots;
  Names names;
  for (const auto& item : list(several)) robots.push_back(read_robot(context, *item, names));
  return joined(std::move(robots), common);
}

}  // namespace softkin::scene
